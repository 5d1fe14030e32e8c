//! JSON as a tree whose numbers and texts stand as they are written. The seeds are sound: what cannot be parsed is left to the other
//! mutators.

use crate::tree::{DEEPEST, Kind, Node};

/// `None` where the text is no JSON, or where an earlier damage has nested it too deep.
pub fn parse(text: &str) -> Option<Node> {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    let node = value(&mut rest, DEEPEST)?;
    rest.trim().is_empty().then_some(node)
}

fn value(rest: &mut &str, deepest: usize) -> Option<Node> {
    let deepest = deepest.checked_sub(1)?;
    *rest = rest.trim_start();
    match rest.bytes().next()? {
        b'{' => within(rest, Kind::Object, '}', &mut |rest| {
            let key = quoted(rest)?;
            *rest = rest.trim_start().strip_prefix(':')?;
            Some(Node { label: key.to_owned(), ..value(rest, deepest)? })
        }),
        b'[' => within(rest, Kind::List, ']', &mut |rest| value(rest, deepest)),
        b'"' => quoted(rest).map(Node::raw),
        _ => {
            let end = rest.find(|c: char| ",]} \n\r\t".contains(c)).unwrap_or(rest.len());
            let (atom, after) = rest.split_at(end);
            *rest = after;
            (!atom.is_empty()).then(|| Node::raw(atom))
        }
    }
}

fn within(rest: &mut &str, kind: Kind, close: char, item: &mut dyn FnMut(&mut &str) -> Option<Node>) -> Option<Node> {
    let mut node = Node { kind, ..Node::raw("") };
    *rest = rest[1..].trim_start();
    while !rest.starts_with(close) {
        node.children.push(item(rest)?);
        *rest = rest.trim_start();
        if let Some(after) = rest.strip_prefix(',') {
            *rest = after.trim_start();
        }
    }
    *rest = &rest[1..];
    Some(node)
}

/// A text with its quotes.
fn quoted<'a>(rest: &mut &'a str) -> Option<&'a str> {
    let bytes = rest.as_bytes();
    let mut at = 1;
    while *bytes.get(at)? != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    let (text, after) = rest.split_at_checked(at + 1)?;
    *rest = after;
    text.starts_with('"').then_some(text)
}

pub fn written(node: &Node) -> String {
    let mut text = String::new();
    write(node, &mut text);
    text
}

fn write(node: &Node, text: &mut String) {
    let (open, close) = match &node.kind {
        Kind::Raw(raw) => return text.push_str(raw),
        Kind::List => ('[', ']'),
        Kind::Object | Kind::Element => ('{', '}'),
    };
    text.push(open);
    for (number, child) in node.children.iter().enumerate() {
        if number > 0 {
            text.push(',');
        }
        if open == '{' {
            // What came out of a list has no key.
            text.push_str(if child.label.is_empty() { "\"\"" } else { &child.label });
            text.push(':');
        }
        write(child, text);
    }
    text.push(close);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_written_the_same() {
        let text = r#"{"a":[1,-2.5e3,"x\"]",{}],"b":null,"c":{"d":[]}}"#;
        assert_eq!(written(&parse(text).unwrap()), text);
        assert_eq!(written(&parse(" { \"a\" : [ 1 , 2 ] } ").unwrap()), r#"{"a":[1,2]}"#);
        for broken in ["", "{", "[1", "{\"a\"}", "\"a", "[1] 2"] {
            assert_eq!(parse(broken), None, "{broken}");
        }
    }
}
