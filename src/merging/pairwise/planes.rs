//! Planes of one part with points of the other part on them.
//!
//! Question     where does a point of one part lie against a plane of the other under a pose, and how well is that known?
//! Method       a robust plane through the points, within the noise that their rays foretell; there is none where too few of the points lie
//!              in one plane, or where the camera sees it edge-on (its points then lie before and behind a contour). How firm a plane is
//!              follows from how far its points spread, not from a threshold

use crate::geometry::{Point3, Similarity, Vector3};
use crate::merging::limits::MergeLimits;
use crate::merging::point_covariance::KnownPoint;
use crate::planes::{FittedPlane, fit_plane_robustly};
use crate::robust::median;

/// Which part has the plane; the other has the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::merging) enum PlaneOf {
    A,
    B,
}

/// A plane and the other part's points on it.
#[derive(Clone, Debug)]
pub(in crate::merging) struct PlaneGroup {
    pub plane_of: PlaneOf,
    /// The plane in the frame of the part that has it.
    pub plane: FittedPlane,
    pub plane_points: usize,
    /// Variance of the plane's own points across it, square units of its frame.
    pub variance: f64,
    /// The same as measured, whatever the rays foretell.
    pub scatter: f64,
    /// What is left of that when the points' noise is taken off: the surface is not flat.
    pub roughness: f64,
    /// Points further from the centre lie beside the plane's own, where nothing is known of it.
    pub reach: f64,
    /// The other part's points, in its own frame.
    pub points: Vec<KnownPoint>,
    /// One half where the same two sets of points count both ways, else one.
    pub share: f64,
}

/// All planes of two parts, both ways.
#[derive(Clone, Debug)]
pub(in crate::merging) struct SharedPlanes {
    pub groups: Vec<PlaneGroup>,
    /// Radius of a and of b, each in its own units.
    pub radius: [f64; 2],
}

/// A point against its plane under a pose, in a's frame and units.
pub(in crate::merging) struct Measured {
    /// The normal equations' row is that of a point here with this normal.
    pub at: Point3<f64>,
    pub normal: Vector3<f64>,
    pub residual: f64,
    /// True where the point comes to lie beside the plane's own.
    pub is_beside: bool,
    /// Variance that each point has of its own, and variance that all points of the group have in common.
    pub own: f64,
    pub common: f64,
}

impl PlaneGroup {
    /// The plane of a part's `own` points, seen from `eye`, with the `others` on it.
    pub fn of(
        plane_of: PlaneOf,
        own: &[KnownPoint],
        others: &[KnownPoint],
        eye: &Point3<f64>,
        limits: &MergeLimits,
    ) -> Option<PlaneGroup> {
        if own.len() < limits.planes.fewest_points {
            return None;
        }
        let at: Vec<Point3<f64>> = own.iter().map(|p| p.at).collect();
        let mut noise: Vec<f64> = own.iter().map(|p| p.covariance.trace().sqrt()).collect();
        let (plane, inside) = fit_plane_robustly(&at, limits.patches.gate_sigmas * median(&mut noise)?)?;
        let count = inside.len();
        if count < limits.planes.fewest_points || (count as f64) < limits.patches.planar_share * own.len() as f64 {
            return None;
        }
        if plane.rms > limits.planes.flatness * plane.spread[1] || is_edge_on(&plane, eye, limits.planes.edge_on) {
            return None;
        }
        let normal = plane.plane.normal;
        let foretold = inside.iter().map(|&i| normal.dot(&(own[i].covariance * normal))).sum::<f64>() / count as f64;
        // Three of the points' freedoms went into the plane.
        let measured = plane.rms * plane.rms * count as f64 / (count as f64 - 3.0);
        Some(PlaneGroup {
            plane_of,
            reach: limits.planes.beside_spreads * plane.spread[0],
            plane,
            plane_points: count,
            variance: measured.max(foretold),
            scatter: measured,
            roughness: (measured - foretold).max(0.0),
            points: others.to_vec(),
            share: 1.0,
        })
    }

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

    /// Under the right pose the other part's points lie among the plane's own.
    fn is_beside(&self, at: &Point3<f64>) -> bool {
        (self.plane.plane.project(at) - self.plane.center).norm() > self.reach
    }

    /// `bend`: the deformation that both parts have in common, as a share of the radius of the part that has the plane.
    pub fn measured(&self, point: &KnownPoint, a_from_b: &Similarity, bend: f64, radius: [f64; 2]) -> Measured {
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

impl SharedPlanes {
    /// Points on planes, both ways.
    pub fn correspondences(&self) -> usize {
        self.groups.iter().map(|g| g.points.len()).sum()
    }
}

impl SharedPlanes {
    /// The same planes with the points of other superpixels: what agrees here agrees by chance.
    pub fn shuffled(&self) -> SharedPlanes {
        let mut groups = Vec::with_capacity(self.groups.len());
        for side in [PlaneOf::A, PlaneOf::B] {
            let own: Vec<&PlaneGroup> = self.groups.iter().filter(|g| g.plane_of == side).collect();
            let other = |i: usize| own[(i + own.len().div_ceil(2)) % own.len()].points.clone();
            groups.extend(own.iter().enumerate().map(|(i, g)| PlaneGroup { points: other(i), ..(*g).clone() }));
        }
        SharedPlanes { groups, radius: self.radius }
    }

    /// Part b mirrored at its origin.
    pub fn mirrored(&self) -> SharedPlanes {
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

fn is_edge_on(plane: &FittedPlane, eye: &Point3<f64>, least_cos: f64) -> bool {
    let sight = plane.center - eye;
    plane.plane.normal.dot(&sight).abs() < least_cos * sight.norm()
}

#[cfg(test)]
mod tests;
