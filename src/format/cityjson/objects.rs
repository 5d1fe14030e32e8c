//! City objects and what they are parts of.

use std::collections::HashMap;

use crate::format::surfaces::ObjectRecord;

/// Levels of parts; deeper ones go in a circle.
const DEEPEST: usize = 16;

/// A group is no building that its members are parts of.
const GROUP: &str = "CityObjectGroup";

/// Family ties of one document: ids of parents and of children by object.
#[derive(Default)]
pub(super) struct Ties {
    /// Object, and the id of what it says it is a part of.
    pub parents: Vec<(u32, String)>,
    /// Object, and the id of what it says is a part of it.
    pub children: Vec<(u32, String)>,
}

/// Ties that lead nowhere, each with its first object.
#[derive(Default)]
pub(super) struct LooseTies {
    pub missing: Vec<u32>,
    pub circular: Vec<u32>,
}

impl Ties {
    /// Sets the parents of the objects from `first` on, which are those of the document.
    pub fn resolve(&self, objects: &mut [ObjectRecord], first: usize) -> LooseTies {
        let mut loose = LooseTies::default();
        if self.parents.is_empty() && self.children.is_empty() {
            return loose;
        }
        let ids: HashMap<&str, u32> =
            objects[first..].iter().zip(first as u32..).map(|(object, at)| (object.id.as_str(), at)).collect();
        let mut parent_of: Vec<Option<u32>> = vec![None; objects.len() - first];
        let mut tie = |child: u32, parent: u32| {
            let place = &mut parent_of[child as usize - first];
            if place.is_none() && objects[parent as usize].class != GROUP && child != parent {
                *place = Some(parent);
            }
        };
        for (child, id) in &self.parents {
            match ids.get(id.as_str()) {
                Some(&parent) => tie(*child, parent),
                None => loose.missing.push(*child),
            }
        }
        for (parent, id) in &self.children {
            match ids.get(id.as_str()) {
                Some(&child) => tie(child, *parent),
                None => loose.missing.push(*parent),
            }
        }
        for at in 0..parent_of.len() {
            let mut above = parent_of[at];
            for _ in 0..DEEPEST {
                above = above.and_then(|parent| parent_of[parent as usize - first]);
            }
            if above.is_some() {
                loose.circular.push((first + at) as u32);
            }
        }
        loose.circular.iter().for_each(|&object| parent_of[object as usize - first] = None);
        objects[first..].iter_mut().zip(parent_of).for_each(|(object, parent)| object.parent = parent);
        loose
    }
}
