//! All parts and the edges that hold them, and where the strongest edges put the parts.
//!
//! Method       the greatest spanning tree by inliers, grown from the anchors or else from one part

use crate::geometry::Similarity;
use crate::merging::fault::EdgeFault;
use crate::merging::limits::MergeLimits;
use crate::merging::pairwise::Pair;
use crate::merging::part::Anchor;
use crate::merging::prepared::PreparedPart;
use crate::robust::{Matrix7, MotionParameters, Vector7};

/// Step of numerical derivatives, share of the radius.
const DIFFERENCE: f64 = 1e-6;

/// A measured relation that holds a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EdgeId {
    /// Index of a pair of parts.
    Pair(usize),
    /// Index of a part that the city holds.
    Anchor(usize),
}

/// All parts and their edges.
pub(super) struct Network<'a> {
    pub parts: &'a [PreparedPart<'a>],
    /// The parts by their content.
    pub order: &'a [usize],
    pub pairs: Vec<Pair>,
    /// Which parts' anchors are in use.
    pub anchored: Vec<bool>,
    /// Why an anchor that is determined is not used.
    pub anchor_faults: Vec<Option<EdgeFault>>,
    /// Where a cycle does not close and nothing says which of its edges is wrong.
    pub ambiguity: Option<EdgeFault>,
    pub limits: &'a MergeLimits,
}

/// Places along the strongest edges.
#[derive(Clone)]
pub(super) struct Placement {
    pub poses: Vec<Option<Similarity>>,
    /// The edges that lead to each part.
    pub paths: Vec<Vec<EdgeId>>,
}

impl<'a> Network<'a> {
    pub fn new(
        parts: &'a [PreparedPart<'a>],
        order: &'a [usize],
        pairs: Vec<Pair>,
        limits: &'a MergeLimits,
    ) -> Network<'a> {
        let anchored = parts.iter().map(|p| p.part.anchor.as_ref().is_some_and(Anchor::is_determined)).collect();
        Network { parts, order, pairs, anchored, anchor_faults: vec![None; parts.len()], ambiguity: None, limits }
    }

    /// The edges in use, but for one.
    pub fn edges(&self, without: Option<EdgeId>) -> impl Iterator<Item = EdgeId> {
        let pairs = (0..self.pairs.len()).filter(|&i| self.pairs[i].edge.is_used()).map(EdgeId::Pair);
        let anchors = (0..self.parts.len()).filter(|&p| self.anchored[p]).map(EdgeId::Anchor);
        pairs.chain(anchors).filter(move |edge| Some(*edge) != without)
    }

    pub fn touches(&self, edge: EdgeId, part: usize) -> bool {
        match edge {
            EdgeId::Pair(index) => self.pairs[index].edge.touches(part),
            EdgeId::Anchor(p) => p == part,
        }
    }

    /// Carries places along the strongest edges. Without an anchor the largest group of joined parts is placed, in the frame
    /// of the one that was given first.
    pub fn place(&self, without: Option<EdgeId>) -> Placement {
        let count = self.parts.len();
        let mut found = Placement { poses: vec![None; count], paths: vec![Vec::new(); count] };
        for edge in self.edges(without) {
            if let EdgeId::Anchor(p) = edge {
                found.poses[p] = self.anchor_pose(p);
                found.paths[p] = vec![edge];
            }
        }
        let (tree, group) = self.tree(without);
        let has_frame = found.poses.iter().any(Option::is_some);
        if let Some(root) = self.root(&group).filter(|_| !has_frame) {
            found.poses[root] = Some(Similarity::identity());
        }
        // Each sweep reaches at least one further part.
        for _ in 0..count {
            tree.iter().for_each(|&index| self.carry(&mut found, index));
        }
        found
    }

    /// The pairs of the strongest tree, and a number for the group that each part is in.
    fn tree(&self, without: Option<EdgeId>) -> (Vec<usize>, Vec<usize>) {
        let pairs = self.edges(without).filter_map(|edge| match edge {
            EdgeId::Pair(index) => Some(index),
            EdgeId::Anchor(_) => None,
        });
        let mut strongest: Vec<usize> = pairs.collect();
        strongest.sort_by_key(|i| std::cmp::Reverse(self.pairs[*i].edge.inliers));
        let mut group: Vec<usize> = (0..self.parts.len()).collect();
        strongest.retain(|&index| {
            let edge = &self.pairs[index].edge;
            let (a, b) = (group[edge.a], group[edge.b]);
            group.iter_mut().filter(|g| **g == b).for_each(|g| *g = a);
            a != b
        });
        (strongest, group)
    }

    /// The part that gives the frame: the first of the largest group.
    fn root(&self, group: &[usize]) -> Option<usize> {
        let size = |g: usize| group.iter().filter(|other| **other == g).count();
        let members = |g: usize| (0..group.len()).filter(move |p| group[*p] == g);
        let points = |g: usize| members(g).map(|p| self.parts[p].sfm().points.len()).sum::<usize>();
        // The last of equals is taken, so the canonical order is walked backwards.
        let largest = self.order.iter().rev().map(|p| group[*p]).max_by_key(|g| (size(*g), points(*g)));
        largest.filter(|g| size(*g) > 1).and_then(|g| members(g).next())
    }

    fn carry(&self, found: &mut Placement, index: usize) {
        let pair = &self.pairs[index];
        let (a, b) = (pair.edge.a, pair.edge.b);
        let Some(fit) = &pair.fit else { return };
        let (from, to, pose) = match (found.poses[a], found.poses[b]) {
            (Some(pose), None) => (a, b, pose * fit.a_from_b),
            (None, Some(pose)) => (b, a, pose * fit.a_from_b.inverse()),
            _ => return,
        };
        found.poses[to] = Some(pose);
        found.paths[to] = found.paths[from].clone();
        found.paths[to].push(EdgeId::Pair(index));
    }

    fn anchor_pose(&self, part: usize) -> Option<Similarity> {
        self.parts[part].part.anchor.as_ref().map(|a| a.common_from_part)
    }

    /// The seven unknowns by which the poses miss an edge, in its motion parameters: of a pair in the frame of its first part, of an anchor in the
    /// city's.
    pub fn miss(&self, poses: &[Option<Similarity>], edge: EdgeId) -> Option<Vector7> {
        let parameters = self.parameters(edge)?;
        match edge {
            EdgeId::Pair(index) => {
                let Pair { edge, fit, .. } = &self.pairs[index];
                let a_from_b = poses[edge.a]?.inverse() * poses[edge.b]?;
                Some(parameters.between(&fit.as_ref()?.a_from_b, &a_from_b))
            }
            EdgeId::Anchor(p) => Some(parameters.between(&self.anchor_pose(p)?, &poses[p]?)),
        }
    }

    pub fn parameters(&self, edge: EdgeId) -> Option<MotionParameters> {
        match edge {
            EdgeId::Pair(index) => Some(self.pairs[index].fit.as_ref()?.parameters),
            EdgeId::Anchor(p) => Some(self.parts[p].part.anchor.as_ref()?.parameters),
        }
    }

    pub fn information(&self, edge: EdgeId) -> Option<Matrix7> {
        match edge {
            EdgeId::Pair(index) => Some(self.pairs[index].fit.as_ref()?.information),
            EdgeId::Anchor(p) => Some(self.parts[p].part.anchor.as_ref()?.information),
        }
    }

    /// Edges of parts that were not placed carry nothing.
    pub fn retire_unplaced(&mut self, poses: &[Option<Similarity>]) {
        for edge in self.pairs.iter_mut().map(|pair| &mut pair.edge).filter(|edge| edge.is_used()) {
            if poses[edge.a].is_none() || poses[edge.b].is_none() {
                edge.refusal = Some(self.ambiguity.clone().unwrap_or(EdgeFault::OtherGroup));
            }
        }
        (0..poses.len()).for_each(|p| self.anchored[p] &= poses[p].is_some());
    }
}

/// How a miss changes with seven unknowns in a scene of this radius; `miss_at` says what it is beside `miss`.
pub(super) fn derivative(
    radius: f64,
    miss: &Vector7,
    mut miss_at: impl FnMut(&Vector7) -> Option<Vector7>,
) -> Option<Matrix7> {
    let mut derivative = Matrix7::zeros();
    for column in 0..7 {
        let mut nudge = Vector7::zeros();
        nudge[column] = DIFFERENCE * radius;
        derivative.set_column(column, &((miss_at(&nudge)? - miss) / nudge[column]));
    }
    Some(derivative)
}
