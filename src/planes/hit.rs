//! What is asked of the facets of a city, and what they answer.

use super::city_planes::PlaneId;
use crate::geometry::{Point3, Vector3};

/// Where a point meets the city.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub plane: PlaneId,
    /// Of the facet's plane, outward.
    pub normal: Vector3<f64>,
    /// Signed distance from the facet's plane, metres.
    pub across_m: f64,
    /// How far the foot of the perpendicular lies outside the triangle, metres; 0 inside.
    pub outside_m: f64,
}

impl Hit {
    pub fn distance_sq(&self) -> f64 {
        self.across_m * self.across_m + self.outside_m * self.outside_m
    }
}

/// A point as the grid sees it.
#[derive(Clone, Copy, Debug)]
pub struct OrientedPoint {
    pub position: Point3<f64>,
    /// Of the patch; for a loose point the direction to the cameras that saw it.
    pub normal: Vector3<f64>,
    /// False where it is not known from which side the point was seen: both signs of the normal count.
    pub sided: bool,
    /// Cosine of the largest angle between `normal` and the outward normal of a facet that the point may lie on.
    pub min_cos: f64,
}
