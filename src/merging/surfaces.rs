//! The planar patches of a part, with their points in a tree.

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::part::Part;
use super::point_covariance::KnownPoint;
use crate::geometry::{Point3, Vector3};
use crate::limits::PatchLimits;
use crate::planes::patches;
use crate::reconstruction::PointIndex;
use crate::robust::median;

/// The points of a part's patches, in its own frame.
pub(super) struct Surfaces {
    pub points: Vec<KnownPoint>,
    /// For each point its patch.
    pub patch_of: Vec<u32>,
    /// For each patch its normal, towards the cameras.
    pub normals: Vec<Vector3<f64>>,
    /// For each patch a place from which it was seen.
    pub eyes: Vec<Point3<f64>>,
    /// Median distance from a point to its nearest neighbour.
    pub spacing: f64,
    tree: ImmutableKdTree<f64, 3>,
    same_normal_cos: f64,
}

impl Surfaces {
    pub fn of(part: &Part, known: impl Fn(PointIndex) -> KnownPoint, limits: &PatchLimits) -> Option<Surfaces> {
        let found = patches(&part.sfm, part.superpixels.as_ref(), limits);
        let (mut points, mut patch_of, mut normals, mut eyes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (index, patch) in found.patches.iter().enumerate() {
            let views: Vector3<f64> = patch.members.iter().map(|&m| found.views[m as usize]).sum();
            normals.push(patch.fit.plane.normal);
            eyes.push(patch.fit.center + views);
            for &m in &patch.members {
                points.push(KnownPoint { at: found.points[m as usize], ..known(found.support[m as usize]) });
                patch_of.push(index as u32);
            }
        }
        let entries: Vec<[f64; 3]> = points.iter().map(|p| p.at.coords.into()).collect();
        let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&entries).ok()?;
        let spacing = spacing(&points, &tree)?;
        let same_normal_cos = limits.same_normal_deg.to_radians().cos();
        Some(Surfaces { points, patch_of, normals, eyes, spacing, tree, same_normal_cos })
    }

    /// The patch of the point that is nearest to a place, if it is within reach and faces the way of `normal`.
    pub fn patch_at(&self, place: &Point3<f64>, normal: &Vector3<f64>, reach: f64) -> Option<u32> {
        let one = std::num::NonZero::<usize>::MIN;
        let found = self.tree.query(&place.coords.into()).nearest_n::<SquaredEuclidean<f64>>(one).execute();
        let nearest = found.first().filter(|n| n.distance <= reach * reach)?;
        let patch = self.patch_of[nearest.item as usize];
        let cos = self.normals[patch as usize].dot(normal);
        (cos > self.same_normal_cos).then_some(patch)
    }
}

/// Median distance from a point to its nearest neighbour.
fn spacing(points: &[KnownPoint], tree: &ImmutableKdTree<f64, 3>) -> Option<f64> {
    let two = std::num::NonZero::new(2)?;
    let to_neighbour = |p: &KnownPoint| {
        let found = tree.query(&p.at.coords.into()).nearest_n::<SquaredEuclidean<f64>>(two).execute();
        found.iter().map(|n| n.distance.sqrt()).fold(0.0, f64::max)
    };
    let mut spacings: Vec<f64> = points.iter().map(to_neighbour).collect();
    median(&mut spacings)
}

#[cfg(test)]
mod tests;
