use super::*;

#[test]
fn a_node_that_shows_nothing_takes_eight_bytes() {
    assert_eq!(size_of::<Slot>(), 8);
    let tree = read(br#"{"nodes": [{}, {"name": "n", "rotation": [0, 0, 0, 0]}, {"mesh": 0}]}"#).unwrap();
    let is_kept: Vec<bool> = tree.nodes.iter().map(|Slot(node)| node.is_some()).collect();
    assert_eq!(is_kept, [false, false, true]);
}

#[test]
fn what_is_only_looked_at_takes_no_memory() {
    assert_eq!(size_of::<CheckedPrimitive>() + size_of::<CheckedReference>(), 3);
}
