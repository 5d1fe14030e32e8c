//! What JSON and XML have in common: nodes within nodes, and what may go wrong with them.

use crate::chance::Chance;
use crate::words::{number, odd, spoiled};

#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub kind: Kind,
    /// The key under which the node stands (JSON, with its quotes), or the name of the element (XML).
    pub label: String,
    /// Of an element: name and value, without quotes.
    pub attributes: Vec<[String; 2]>,
    pub children: Vec<Node>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Written as it is: a number, a text, a comment, or anything a mutation made.
    Raw(String),
    List,
    Object,
    Element,
}

/// How a node and its nesting are written.
pub type Written = fn(&Node) -> String;

/// Levels of nesting: what a reader may still follow, and what no stack holds.
const DEPTHS: [usize; 4] = [1, 10, 500, 50_000];

/// Levels of a tree that our own functions, which call themselves, are given.
pub const DEEPEST: usize = 200;

/// Nodes up to which a node is copied hundreds of times.
const SMALL: usize = 50;

impl Node {
    pub fn raw(text: impl Into<String>) -> Node {
        Node { kind: Kind::Raw(text.into()), label: String::new(), attributes: Vec::new(), children: Vec::new() }
    }

    /// Itself and all below.
    pub fn count(&self) -> usize {
        1 + self.children.iter().map(Node::count).sum::<usize>()
    }

    /// The node of a number, in the order of the file.
    fn at(&mut self, number: usize) -> Option<&mut Node> {
        if number == 0 {
            return Some(self);
        }
        let mut before = 1;
        for child in &mut self.children {
            let count = child.count();
            if number < before + count {
                return child.at(number - before);
            }
            before += count;
        }
        None
    }
}

/// Spoils one place of the tree.
pub fn spoil(root: &mut Node, written: Written, chance: &mut Chance) {
    let count = root.count();
    let other = root.at(chance.below(count)).cloned();
    let Some(node) = root.at(chance.below(count)) else { return };
    // Leaves outnumber what holds them; half of the draws go to the structure.
    if node.children.is_empty() || chance.one_in(4) {
        return spoil_itself(node, other, written, chance);
    }
    let [at, second] = [(); 2].map(|()| chance.below(node.children.len()));
    match chance.below(5) {
        0 => drop(node.children.remove(at)),
        1 => {
            let copies =
                if node.children[at].count() <= SMALL { chance.copies(written(&node.children[at]).len()) } else { 1 };
            let copy = node.children[at].clone();
            node.children.splice(at..at, std::iter::repeat_n(copy, copies));
        }
        2 => node.children.swap(at, second),
        3 => {
            let Some(other) = other else { return };
            let label = std::mem::take(&mut node.children[at].label);
            node.children[at] = if chance.one_in(2) && !label.is_empty() { Node { label, ..other } } else { other };
        }
        _ => node.children.truncate(at),
    }
}

/// Changes what a node is, is called, or says.
fn spoil_itself(node: &mut Node, other: Option<Node>, written: Written, chance: &mut Chance) {
    match chance.below(8) {
        0 => {
            if let Some(other) = other {
                node.label = other.label;
            }
        }
        1 => nest(node, written, chance),
        2 => retype(node, chance),
        3 | 4 if !node.attributes.is_empty() => spoil_attribute(node, other, chance),
        _ => {
            if let Kind::Raw(text) = &mut node.kind {
                *text = spoiled_words(text, chance);
            } else {
                retype(node, chance);
            }
        }
    }
}

fn spoil_attribute(node: &mut Node, other: Option<Node>, chance: &mut Chance) {
    let at = chance.below(node.attributes.len());
    match chance.below(4) {
        0 => drop(node.attributes.remove(at)),
        1 => node.attributes.push(node.attributes[at].clone()),
        2 => node.attributes[at][1] = spoiled(&node.attributes[at][1], chance),
        _ => {
            let theirs = other.and_then(|other| other.attributes.into_iter().next());
            node.attributes[at][1] = theirs.map_or(String::new(), |attribute| attribute[1].clone());
        }
    }
}

/// Puts a node within many of its own kind. As text: a tree so deep could not even be freed without a deep stack.
fn nest(node: &mut Node, written: Written, chance: &mut Chance) {
    let depth = *chance.pick(&DEPTHS).unwrap_or(&1);
    let is_xml = node.kind == Kind::Element;
    let (open, close) = match chance.below(2) {
        _ if is_xml => (format!("<{}>", node.label), format!("</{}>", node.label)),
        0 => ("[".to_owned(), "]".to_owned()),
        _ => ("{\"a\":".to_owned(), "}".to_owned()),
    };
    let label = std::mem::take(&mut node.label);
    let inside = written(&Node { label: if is_xml { label.clone() } else { String::new() }, ..node.clone() });
    // Half of these are never closed.
    let end = if chance.one_in(2) { close.repeat(depth) } else { String::new() };
    *node = Node { label, ..Node::raw(open.repeat(depth) + &inside + &end) };
}

/// A number becomes a text, a list an object, and so on.
fn retype(node: &mut Node, chance: &mut Chance) {
    node.kind = match (chance.below(5), &node.kind) {
        (0, Kind::List) => Kind::Object,
        (0, Kind::Object) => Kind::List,
        (1, Kind::Raw(text)) => Kind::Raw(format!("[{text}]")),
        (2, _) => Kind::Raw("{}".to_owned()),
        (3, _) => Kind::Raw(format!("\"{}\"", number(chance))),
        _ => Kind::Raw(odd(chance)),
    };
    if matches!(node.kind, Kind::Raw(_)) {
        node.children.clear();
    }
}

/// Some of the words of a text (XML writes whole rings as one), or the whole of it.
fn spoiled_words(text: &str, chance: &mut Chance) -> String {
    let mut words: Vec<&str> = text.split(' ').collect();
    let at = chance.below(words.len());
    let changed = spoiled(words[at], chance);
    match chance.below(6) {
        0 => drop(words.remove(at)),
        1 => words.insert(at, words[at]),
        2 => words.truncate(at),
        _ => words[at] = &changed,
    }
    words.join(" ")
}
