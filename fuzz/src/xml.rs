//! XML as a tree: elements with their attributes; text, comments and all else as they are written.

use crate::tree::{DEEPEST, Kind, Node};

/// `None` where tags do not match, or where an earlier damage has nested them too deep. The root is a nameless element about all.
pub fn parse(text: &str) -> Option<Node> {
    let mut open = vec![element("")];
    let mut rest = text;
    while !rest.is_empty() {
        if open.len() > DEEPEST {
            return None;
        }
        let Some(after) = rest.strip_prefix('<') else {
            let end = rest.find('<').unwrap_or(rest.len());
            open.last_mut()?.children.push(Node::raw(&rest[..end]));
            rest = &rest[end..];
            continue;
        };
        let close = if after.starts_with("!--") {
            "-->"
        } else if after.starts_with("![CDATA[") {
            "]]>"
        } else {
            ">"
        };
        let end = rest.find(close)? + close.len();
        let (tag, after_tag) = rest.split_at(end);
        rest = after_tag;
        match tag.as_bytes()[1] {
            b'!' | b'?' => open.last_mut()?.children.push(Node::raw(tag)),
            b'/' => {
                let done = open.pop()?;
                open.last_mut()?.children.push(done);
            }
            _ => {
                let inside = &tag[1..tag.len() - 1];
                let node = tag_of(inside.trim_end_matches('/'))?;
                if inside.ends_with('/') { open.last_mut()?.children.push(node) } else { open.push(node) }
            }
        }
    }
    open.pop().filter(|_| open.is_empty())
}

fn element(name: &str) -> Node {
    Node { kind: Kind::Element, label: name.to_owned(), ..Node::raw("") }
}

/// Name and attributes.
fn tag_of(inside: &str) -> Option<Node> {
    let (name, mut rest) = inside.split_once(char::is_whitespace).unwrap_or((inside, ""));
    let mut node = element(name);
    while let Some((key, after)) = rest.split_once('=') {
        let after = after.trim_start();
        let quote = after.chars().next()?;
        let (value, after) = after.get(1..)?.split_once(quote)?;
        node.attributes.push([key.trim().to_owned(), value.to_owned()]);
        rest = after;
    }
    Some(node)
}

pub fn written(node: &Node) -> String {
    let mut text = String::new();
    write(node, &mut text);
    text
}

fn write(node: &Node, text: &mut String) {
    if let Kind::Raw(raw) = &node.kind {
        return text.push_str(raw);
    }
    let name = &node.label;
    if !name.is_empty() {
        *text += &format!("<{name}");
        for [key, value] in &node.attributes {
            *text += &format!(" {key}=\"{value}\"");
        }
        text.push('>');
    }
    node.children.iter().for_each(|child| write(child, text));
    if !name.is_empty() {
        *text += &format!("</{name}>");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_written_the_same() {
        let text = "<?xml version=\"1.0\"?><a x=\"1\" y:z=\"2\">t <b>1 2</b><!-- > --><c></c></a>\n";
        assert_eq!(written(&parse(text).unwrap()), text);
        assert_eq!(written(&parse("<a><c d='1'/></a>").unwrap()), "<a><c d=\"1\"></c></a>");
        for broken in ["<a>", "</a>", "<a", "<a b=\"></a>"] {
            assert_eq!(parse(broken), None, "{broken}");
        }
    }
}
