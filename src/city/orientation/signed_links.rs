//! Which facets hang together, and with which sense.

/// Facets tied to each other with one sense or the opposite (a union-find with signs).
pub(super) struct Links {
    /// The facet that each hangs on, and whether it runs as that one does.
    pub on: Vec<(usize, bool)>,
    pub is_twisted: Vec<bool>,
}

/// How two facets run along the edge that they share.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum EdgeRuns {
    /// In one direction: one of them is wound the wrong way round.
    Alike,
    Opposed,
}

impl Links {
    pub fn new(count: usize) -> Links {
        Links { on: (0..count).map(|at| (at, true)).collect(), is_twisted: vec![false; count] }
    }

    /// The first facet of all that hang together, and whether this one runs as that does.
    pub fn root(&mut self, facet: usize) -> (usize, bool) {
        let (mut root, mut agrees) = (facet, true);
        while self.on[root].0 != root {
            let (next, same) = self.on[root];
            (root, agrees) = (next, agrees == same);
        }
        // Hang all that were passed directly on the root.
        let (mut at, mut rest) = (facet, agrees);
        while at != root {
            let (next, same) = std::mem::replace(&mut self.on[at], (root, rest));
            (at, rest) = (next, rest == same);
        }
        (root, agrees)
    }

    /// Two facets at one edge: they have one sense unless both run along it in the same direction.
    pub fn tie(&mut self, one: usize, other: usize, along: EdgeRuns) {
        let ((a, a_agrees), (b, b_agrees)) = (self.root(one), self.root(other));
        let same = (a_agrees == b_agrees) != (along == EdgeRuns::Alike);
        if a == b {
            self.is_twisted[a] |= !same;
            return;
        }
        let (low, high) = (a.min(b), a.max(b));
        self.on[high] = (low, same);
        self.is_twisted[low] |= self.is_twisted[high];
    }
}
