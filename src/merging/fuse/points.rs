//! Which points of several parts are one, and where that one lies.

use std::collections::{BTreeMap, BTreeSet};

use super::moved::Moved;
use crate::geometry::{Matrix3, Point3, Vector3};
use crate::merging::extent::Extent;
use crate::merging::limits::MergeLimits;
use crate::merging::point_covariance::covariance;
use crate::reconstruction::PointIndex;

/// Points of all parts, joined into sets.
pub(super) struct PointSets<'a> {
    moved: &'a [Moved<'a>],
    starts: Vec<usize>,
    parent: Vec<u32>,
    /// Members of a set, at its root; empty for a point alone.
    members: BTreeMap<u32, Vec<u32>>,
    radius: Vec<f64>,
    bend: f64,
    limits: &'a MergeLimits,
}

impl PointSets<'_> {
    pub fn of<'a>(moved: &'a [Moved<'a>], limits: &'a MergeLimits) -> PointSets<'a> {
        let mut starts = vec![0];
        for part in moved {
            starts.push(starts[starts.len() - 1] + part.given.points.len());
        }
        let radius: Vec<f64> = moved.iter().map(|part| Extent::of(&part.posed.points).radius).collect();
        let bend = limits.fuse.bend * radius.iter().copied().fold(f64::INFINITY, f64::min);
        let parent = (0..starts[moved.len()] as u32).collect();
        PointSets { moved, starts, parent, members: BTreeMap::new(), radius, bend, limits }
    }

    pub fn key(&self, part: usize, point: PointIndex) -> u32 {
        (self.starts[part] + point.0 as usize) as u32
    }

    pub fn part_of(&self, key: u32) -> (usize, PointIndex) {
        let part = self.starts.partition_point(|start| *start <= key as usize) - 1;
        (part, PointIndex((key as usize - self.starts[part]) as u32))
    }

    pub fn root(&self, key: u32) -> u32 {
        self.parent[key as usize]
    }

    /// Whether it is one point out of several.
    pub fn is_joined(&self, root: u32) -> bool {
        self.members.contains_key(&root)
    }

    /// Points of all parts, joined or not.
    pub fn count(&self) -> usize {
        self.parent.len()
    }

    fn members(&self, root: u32) -> Vec<u32> {
        self.members.get(&root).cloned().unwrap_or_else(|| vec![root])
    }

    fn uncertainty(&self, key: u32) -> (Point3<f64>, Matrix3<f64>) {
        let (part, point) = self.part_of(key);
        let moved = &self.moved[part];
        let covariance =
            covariance(&moved.posed, moved.given.track(point), point, self.radius[part], &self.limits.keypoints);
        (moved.point(point), covariance)
    }

    /// Joins two points if they may be one; a part's own points stay apart.
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        let (ra, rb) = (self.root(a), self.root(b));
        if ra == rb {
            return true;
        }
        let (of_a, of_b) = (self.members(ra), self.members(rb));
        let parts: BTreeSet<usize> = of_a.iter().map(|k| self.part_of(*k).0).collect();
        if of_b.iter().any(|k| parts.contains(&self.part_of(*k).0)) || !self.may_be_one(a, b) {
            return false;
        }
        let root = ra.min(rb);
        let mut all = of_a;
        all.extend(of_b);
        all.sort_unstable();
        all.iter().for_each(|k| self.parent[*k as usize] = root);
        self.members.remove(&ra.max(rb));
        self.members.insert(root, all);
        true
    }

    fn may_be_one(&self, a: u32, b: u32) -> bool {
        let ((xa, ca), (xb, cb)) = (self.uncertainty(a), self.uncertainty(b));
        let covariance = ca + cb + Matrix3::identity() * (self.bend * self.bend);
        let apart: Vector3<f64> = xa - xb;
        let gate = self.limits.fit.gate_sigmas;
        covariance.try_inverse().is_some_and(|info| apart.dot(&(info * apart)) < gate * gate)
    }

    /// Where a set lies, weighted by what each part knows of it.
    pub fn position(&self, root: u32) -> Point3<f64> {
        let members = self.members(root);
        if members.len() == 1 {
            let (part, point) = self.part_of(root);
            return self.moved[part].point(point);
        }
        let (mut information, mut sum) = (Matrix3::zeros(), Vector3::zeros());
        for key in members {
            let (x, covariance) = self.uncertainty(key);
            let bent = covariance + Matrix3::identity() * (self.bend * self.bend);
            let own = bent.try_inverse().unwrap_or_else(Matrix3::identity);
            information += own;
            sum += own * x.coords;
        }
        Point3::from(information.try_inverse().map_or_else(Vector3::zeros, |covariance| covariance * sum))
    }
}

#[cfg(test)]
mod tests;
