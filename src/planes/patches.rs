//! Planar groups of points: the sensor's side of every correspondence.
//!
//! Question     which points of the cloud lie in one plane, and on which side of it stood the cameras?
//! Input        the cloud, its tracks, and superpixels where there are photographs or labels
//! Output       [`Patches`]: disjoint groups with a fitted plane each, and the groups that have none with the reason
//! Method       0. points at one place are one point;
//!              1. a plane through each point's neighbours gives the cloud's noise and a first normal;
//!              2. a superpixel's points get a plane by robust fitting; its inliers take over that firmer normal;
//!              3. regions grow from the flattest points over neighbours (in space, and in the same superpixel) that lie in
//!                 the region's plane and agree with its normal, so that small superpixels of one wall become one patch.
//! Assumptions  the noise of neighbouring points is alike; planes are larger than the spacing of the points
//! Fails when   the cloud has no planes (trees, rubble): then there are few patches or none, and that is the answer
//! Source       region growing after Rabbani, van den Heuvel and Vosselman 2006; superpixel planes after Ramalingam et al. 2010

use super::cloud::local_surfaces;
use super::fit::{FittedPlane, fit_plane};
use super::places::{Places, thinned};
use super::regions::{Grower, RejectedGroup};
use super::viewers::{outward_hints, viewers};
use crate::geometry::{Point3, Rotation3, Vector3};
use crate::imagery::LiftedSuperpixels;
use crate::limits::PatchLimits;
use crate::reconstruction::{PointIndex, Reconstruction};
use crate::robust::median;

/// Points of one plane, seen from one side.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Indices into [`Patches::points`].
    pub members: Vec<u32>,
    /// Sfm frame; the normal points to the cameras where `sided`.
    pub fit: FittedPlane,
    /// True where cameras (or the file's own normals) tell the outward side.
    pub sided: bool,
}

/// All patches of a reconstruction.
#[derive(Clone, Debug, Default)]
pub struct Patches {
    /// The points that take part, one at each place: all of them, or an even thinning of a large cloud. Their order is that of
    /// their places, so that neither the order of the file nor copies in it change what follows.
    pub support: Vec<PointIndex>,
    /// Their positions, sfm frame.
    pub points: Vec<Point3<f64>>,
    /// Mean direction from each of them to the cameras that saw it (or the file's own normal), any length; zero where
    /// neither is known.
    pub views: Vec<Vector3<f64>>,
    /// Centres of the cameras, sfm frame.
    pub cameras: Vec<Point3<f64>>,
    /// How the cameras were held, one for each of `cameras`.
    pub cam_from_sfm_rotations: Vec<Rotation3<f64>>,
    /// For each supporting point the nearest and the farthest camera that saw it.
    pub viewers: Vec<[Option<u32>; 2]>,
    pub patches: Vec<Patch>,
    /// Median standard deviation of points across their local planes, sfm units.
    pub noise: f64,
    /// Superpixels without a plane, by reason.
    pub too_few_points: usize,
    pub not_planar: usize,
    /// Points that stand exactly at the place of another one and count once with it.
    pub repeated: usize,
}

impl Patches {
    /// The median of each coordinate over the patches' points.
    pub fn middle(&self) -> Point3<f64> {
        let middle = |k: usize| {
            let members = self.patches.iter().flat_map(|p| &p.members);
            let mut values: Vec<f64> = members.map(|&m| self.points[m as usize][k]).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(0.0)
        };
        Point3::new(middle(0), middle(1), middle(2))
    }
}

/// Finds the patches of a reconstruction.
pub fn patches(r: &Reconstruction, superpixels: Option<&LiftedSuperpixels>, limits: &PatchLimits) -> Patches {
    let places = Places::of(&r.points);
    let support = thinned(&r.points, &places.firsts, limits.most_points);
    let points: Vec<Point3<f64>> = support.iter().map(|p| r.points[p.0 as usize]).collect();
    let slots = places.slots(&support);
    let (surfaces, neighbours) = local_surfaces(&points);
    let smooth = surfaces.iter().flatten().filter(|s| s.roughness < limits.seed_roughness);
    let noise = median(&mut smooth.map(|s| s.rms).collect::<Vec<f64>>()).unwrap_or(0.0);
    let repeated = r.points.len() - places.firsts.len();
    let mut found = Patches { support, points, noise, repeated, ..Patches::default() };
    let mut grower = Grower::new(&found.points, surfaces, neighbours, noise, limits);
    if let Some(lifted) = superpixels {
        for group in groups_in_support(lifted, &slots) {
            match grower.add_superpixel(group) {
                Ok(()) => {}
                Err(RejectedGroup::TooFewPoints) => found.too_few_points += 1,
                Err(RejectedGroup::NotPlanar) => found.not_planar += 1,
            }
        }
    }
    let regions = grower.grow(limits.fewest_points);
    found.cameras = r.images.iter().map(|image| image.center()).collect();
    found.cam_from_sfm_rotations = r.images.iter().map(|image| image.cam_from_sfm_rotation).collect();
    found.views = outward_hints(r, &slots, &found.points, &found.cameras);
    found.viewers = viewers(r, &slots, &found.points, &found.cameras);
    found.patches = regions.into_iter().filter_map(|members| patch(&found.points, members, &found.views)).collect();
    found
}

/// The superpixels' points as indices into the support, each once.
fn groups_in_support(lifted: &LiftedSuperpixels, slots: &[Option<u32>]) -> Vec<Vec<u32>> {
    let of = |points: &[PointIndex]| -> Vec<u32> {
        let mut group: Vec<u32> = points.iter().filter_map(|p| *slots.get(p.0 as usize)?).collect();
        group.sort_unstable();
        group.dedup();
        group
    };
    lifted.superpixels.iter().map(|s| of(&s.points)).filter(|g| !g.is_empty()).collect()
}

/// The patch of a region; `None` where its points lie on a line.
fn patch(points: &[Point3<f64>], members: Vec<u32>, views: &[Vector3<f64>]) -> Option<Patch> {
    let mut fit = fit_plane(members.iter().map(|&i| points[i as usize]))?;
    let side: f64 = members.iter().map(|&i| views[i as usize].dot(&fit.plane.normal)).sum();
    if side < 0.0 {
        fit.plane = fit.plane.flipped();
    }
    Some(Patch { members, fit, sided: side != 0.0 })
}

#[cfg(test)]
mod tests;
