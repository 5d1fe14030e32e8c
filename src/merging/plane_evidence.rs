//! Superpixels of the shared photographs: one part's points give each a plane, the other part's points lie on it.
//!
//! Question     which planes does one part have, and which points of the other part lie on them?
//! Input        the superpixels of both parts, for the photographs that both have
//! Output       [`PlaneEvidence`]: for each superpixel, both ways, a plane with its uncertainty and the other part's points
//! Method       a robust plane through the points, within the noise that their rays foretell; a superpixel is dropped where too
//!              few of its points lie in one plane, or where the camera sees it edge-on (its points then lie before and behind a
//!              contour). How firm a plane is follows from how far its points spread, not from a threshold.
//! Assumptions  a superpixel shows one piece of surface
//! Fails when   the superpixels hold fewer than a handful of points (sparse clouds, small superpixels)
//! Source       Ramalingam, Taguchi, Marks and Tuzel (ECCV 2010), section 5

use std::collections::HashMap;

use super::Part;
use super::links::SharedPhoto;
use super::sigma::{covariance, extent, median};
use crate::geometry::{Matrix3, Point3, Similarity, Vector3};
use crate::planes::{FittedPlane, fit_plane_robustly};
use crate::reconstruction::{ImageIndex, PointIndex, Reconstruction};

/// Fewest points that get a plane: three define it, one more can contradict.
const FEWEST_POINTS: usize = 4;
/// A superpixel has a plane when at least this share of its points lies in it.
const PLANAR_SHARE: f64 = 0.6;
/// Points belong to a plane within this many sigmas of their noise.
const GATE_SIGMAS: f64 = 2.5;
/// A plane that is thicker than this share of its narrow spread is a heap of points.
const FLATNESS: f64 = 0.25;
/// Cosine between normal and line of sight below which a plane is seen edge-on: 11 degrees.
const EDGE_ON: f64 = 0.2;

/// A point further from the plane's centre than this many of its longer spreads lies beside the superpixel. Points that fill a
/// disc reach two spreads, four points of it may have a third of the spread of all.
const BESIDE: f64 = 6.0;

/// Which part has the plane; the other has the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlaneOf {
    A,
    B,
}

/// A point of the part that does not have the plane, in its own frame.
#[derive(Clone, Debug)]
pub(super) struct PointOnPlane {
    pub at: Point3<f64>,
    pub covariance: Matrix3<f64>,
}

/// One superpixel, one way.
#[derive(Clone, Debug)]
pub(super) struct PlaneGroup {
    pub plane_of: PlaneOf,
    /// In the frame of the part that has it.
    pub plane: FittedPlane,
    pub plane_points: usize,
    /// Variance of the plane's own points across it, square units of its frame.
    pub variance: f64,
    /// The same as measured, whatever the rays foretell.
    pub scatter: f64,
    /// What is left of that when the points' noise is taken off: the surface is not flat.
    pub roughness: f64,
    pub points: Vec<PointOnPlane>,
    /// One half where the superpixel counts both ways: it is the same two sets of points.
    pub share: f64,
}

#[derive(Clone, Debug)]
pub(super) struct PlaneEvidence {
    pub groups: Vec<PlaneGroup>,
    /// Of a and of b, each in its own units.
    pub radius: [f64; 2],
}

/// A point against its plane under a pose, in a's frame and units.
pub(super) struct Measured {
    /// The normal equations' row is that of a point here with this normal.
    pub at: Point3<f64>,
    pub normal: Vector3<f64>,
    pub residual: f64,
    /// True where the point comes to lie beside the superpixel, of which the plane knows nothing.
    pub is_beside: bool,
    /// Variance that each point has of its own, and variance that all points of the group have in common.
    pub own: f64,
    pub common: f64,
}

impl PlaneGroup {
    /// Variance of the plane's place at a point of its frame: `sigma^2 / n (1 + (u / s_u)^2 + (v / s_v)^2)`, with u and v the
    /// point's coordinates from the centre along the principal axes and s the spreads of the n points along them.
    pub fn plane_variance(&self, at: &Point3<f64>) -> f64 {
        let from_center = at - self.plane.center;
        let leverage = |k: usize| (self.plane.axes[k].dot(&from_center) / self.plane.spread[k]).powi(2);
        self.variance / self.plane_points as f64 * (1.0 + leverage(0) + leverage(1))
    }

    /// Variances of the normal's tilts towards the two principal axes, square radians.
    pub fn tilt_variances(&self) -> [f64; 2] {
        self.plane.spread.map(|spread| self.scatter / (self.plane_points as f64 * spread * spread))
    }

    /// The plane's principal axes as they lie in a.
    pub fn axes_in_a(&self, a_from_b: &Similarity) -> [Vector3<f64>; 2] {
        match self.plane_of {
            PlaneOf::A => self.plane.axes,
            PlaneOf::B => self.plane.axes.map(|axis| a_from_b.rotation * axis),
        }
    }

    /// The other part's points are seen in the same superpixel, so under the right pose they lie among the plane's own.
    fn is_beside(&self, at: &Point3<f64>) -> bool {
        (self.plane.plane.project(at) - self.plane.center).norm() > BESIDE * self.plane.spread[0]
    }

    /// `bend`: the deformation that both parts have in common, as a share of the radius of the part that has the plane.
    pub fn measured(&self, point: &PointOnPlane, a_from_b: &Similarity, bend: f64, radius: [f64; 2]) -> Measured {
        let normal = self.plane.plane.normal;
        match self.plane_of {
            PlaneOf::A => {
                let at = a_from_b.apply(&point.at);
                let normal_in_b = a_from_b.rotation.inverse() * normal * a_from_b.scale;
                Measured {
                    residual: self.plane.plane.signed_distance(&at),
                    own: normal_in_b.dot(&(point.covariance * normal_in_b)) + self.roughness,
                    common: self.plane_variance(&at) + (bend * radius[0]).powi(2),
                    is_beside: self.is_beside(&at),
                    at,
                    normal,
                }
            }
            PlaneOf::B => {
                // The plane moves with the pose and the point stays: the same row with the sign of the residual turned.
                let at_in_b = a_from_b.inverse().apply(&point.at);
                let normal = a_from_b.rotation * normal;
                let unit = a_from_b.scale * a_from_b.scale;
                Measured {
                    at: point.at,
                    residual: -a_from_b.scale * self.plane.plane.signed_distance(&at_in_b),
                    own: normal.dot(&(point.covariance * normal)) + unit * self.roughness,
                    common: unit * (self.plane_variance(&at_in_b) + (bend * radius[1]).powi(2)),
                    is_beside: self.is_beside(&at_in_b),
                    normal,
                }
            }
        }
    }
}

impl PlaneEvidence {
    /// Points on planes, both ways.
    pub fn correspondences(&self) -> usize {
        self.groups.iter().map(|g| g.points.len()).sum()
    }
}

impl PlaneEvidence {
    /// The same planes with the points of other superpixels: what agrees here agrees by chance.
    pub fn shuffled(&self) -> PlaneEvidence {
        let mut groups = Vec::with_capacity(self.groups.len());
        for side in [PlaneOf::A, PlaneOf::B] {
            let own: Vec<&PlaneGroup> = self.groups.iter().filter(|g| g.plane_of == side).collect();
            let other = |i: usize| own[(i + own.len().div_ceil(2)) % own.len()].points.clone();
            groups.extend(own.iter().enumerate().map(|(i, g)| PlaneGroup { points: other(i), ..(*g).clone() }));
        }
        PlaneEvidence { groups, radius: self.radius }
    }

    /// Part b mirrored at its origin.
    pub fn mirrored(&self) -> PlaneEvidence {
        let mut mirrored = self.clone();
        for group in &mut mirrored.groups {
            match group.plane_of {
                PlaneOf::A => group.points.iter_mut().for_each(|p| p.at = -p.at),
                PlaneOf::B => {
                    group.plane.center = -group.plane.center;
                    group.plane.plane.offset = -group.plane.plane.offset;
                }
            }
        }
        mirrored
    }
}

/// `None` where one of the parts has no superpixels.
pub(super) fn gather_planes(a: &Part, b: &Part, photos: &[SharedPhoto]) -> Option<PlaneEvidence> {
    let (of_a, of_b) = (by_superpixel(a)?, by_superpixel(b)?);
    let radius = [extent(&a.sfm.points).1, extent(&b.sfm.points).1];
    let mut groups = Vec::new();
    for photo in photos {
        let mut labels: Vec<u32> = of_a.keys().filter(|(image, _)| *image == photo.in_a).map(|(_, l)| *l).collect();
        labels.sort_unstable();
        for label in labels {
            let in_a = &of_a[&(photo.in_a, label)];
            let Some(in_b) = of_b.get(&(photo.in_b, label)) else { continue };
            let points_a = points(&a.sfm, in_a, radius[0]);
            let points_b = points(&b.sfm, in_b, radius[1]);
            let eye = |r: &Reconstruction, image: ImageIndex| r.images[image.0 as usize].center();
            let forth = group(PlaneOf::A, &points_a, &points_b, &eye(&a.sfm, photo.in_a));
            let back = group(PlaneOf::B, &points_b, &points_a, &eye(&b.sfm, photo.in_b));
            let share = if forth.is_some() && back.is_some() { 0.5 } else { 1.0 };
            groups.extend(forth.into_iter().chain(back).map(|g| PlaneGroup { share, ..g }));
        }
    }
    (!groups.is_empty()).then_some(PlaneEvidence { groups, radius })
}

type BySuperpixel<'a> = HashMap<(ImageIndex, u32), &'a [PointIndex]>;

fn by_superpixel(part: &Part) -> Option<BySuperpixel<'_>> {
    let lifted = part.superpixels.as_ref()?;
    Some(lifted.superpixels.iter().map(|s| ((s.image, s.label), s.points.as_slice())).collect())
}

fn points(r: &Reconstruction, indices: &[PointIndex], radius: f64) -> Vec<PointOnPlane> {
    indices.iter().map(|&p| PointOnPlane { at: r.points[p.0 as usize], covariance: covariance(r, p, radius) }).collect()
}

pub(super) fn group(
    plane_of: PlaneOf,
    own: &[PointOnPlane],
    others: &[PointOnPlane],
    eye: &Point3<f64>,
) -> Option<PlaneGroup> {
    if own.len() < FEWEST_POINTS {
        return None;
    }
    let at: Vec<Point3<f64>> = own.iter().map(|p| p.at).collect();
    let mut noise: Vec<f64> = own.iter().map(|p| p.covariance.trace().sqrt()).collect();
    let (plane, inside) = fit_plane_robustly(&at, GATE_SIGMAS * median(&mut noise)?)?;
    let count = inside.len();
    if count < FEWEST_POINTS || (count as f64) < PLANAR_SHARE * own.len() as f64 {
        return None;
    }
    if plane.rms > FLATNESS * plane.spread[1] || is_edge_on(&plane, eye) {
        return None;
    }
    let normal = plane.plane.normal;
    let foretold = inside.iter().map(|&i| normal.dot(&(own[i].covariance * normal))).sum::<f64>() / count as f64;
    // Three of the points' freedoms went into the plane.
    let measured = plane.rms * plane.rms * count as f64 / (count as f64 - 3.0);
    Some(PlaneGroup {
        plane_of,
        plane,
        plane_points: count,
        variance: measured.max(foretold),
        scatter: measured,
        roughness: (measured - foretold).max(0.0),
        points: others.to_vec(),
        share: 1.0,
    })
}

fn is_edge_on(plane: &FittedPlane, eye: &Point3<f64>) -> bool {
    let sight = plane.center - eye;
    plane.plane.normal.dot(&sight).abs() < EDGE_ON * sight.norm()
}

#[cfg(test)]
mod tests {
    use super::super::plane_scene::{RADIUS, scene, truth};
    use super::*;

    #[test]
    fn both_ways_measure_the_same_distance_with_the_same_sense() {
        let planes = scene(1e-7, |x| *x);
        let moved = Similarity { translation: truth().translation + Vector3::new(0.01, 0.02, -0.01), ..truth() };
        for pair in planes.groups.chunks(2) {
            let measured = |g: &PlaneGroup| {
                let m = g.measured(&g.points[0], &moved, 0.0, planes.radius);
                // The fitted normals' senses are arbitrary.
                m.residual * m.normal
            };
            assert!((measured(&pair[0]) - measured(&pair[1])).norm() < 1e-5);
        }
    }

    #[test]
    fn a_plane_is_known_worse_away_from_its_centre() {
        let planes = scene(0.002, |x| *x);
        let group = &planes.groups[0];
        let (center, plane) = (group.plane.center, &group.plane);
        let at_center = group.variance / group.plane_points as f64;
        assert!((group.plane_variance(&center) - at_center).abs() < 1e-15);
        // Two spreads along an axis: 1 + 4 times the variance at the centre.
        let beside = center + plane.axes[0] * 2.0 * plane.spread[0];
        assert!((group.plane_variance(&beside) - 5.0 * at_center).abs() < 1e-12);
        assert!(group.is_beside(&(center + plane.axes[0] * 7.0 * plane.spread[0])));
        assert!(RADIUS > 7.0 * plane.spread[0]);
    }

    #[test]
    fn a_heap_of_points_and_a_plane_seen_edge_on_are_no_plane() {
        let at =
            |x: f64, y: f64, z: f64| PointOnPlane { at: Point3::new(x, y, z), covariance: Matrix3::identity() * 1e-4 };
        let flat = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(1.0, 1.0, 0.0), at(0.4, 0.7, 0.0)];
        assert!(group(PlaneOf::A, &flat, &flat, &Point3::new(0.0, 0.0, 9.0)).is_some());
        assert!(group(PlaneOf::A, &flat, &flat, &Point3::new(9.0, 0.0, 0.1)).is_none());
        let heap = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.9), at(0.0, 1.0, 0.8), at(1.0, 1.0, 0.1), at(0.4, 0.7, -1.0)];
        assert!(group(PlaneOf::A, &heap, &heap, &Point3::new(0.0, 0.0, 9.0)).is_none());
    }
}
