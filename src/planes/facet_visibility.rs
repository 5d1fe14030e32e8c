//! Which facets somebody could have seen.
//!
//! Question     can a triangle of the model be seen from open space, or only from inside a building?
//! Method       lines of sight leave the triangle on its outward side; one that next meets the *back* of a facet was inside a
//!              solid all along. A triangle is exposed if from some place on it most lines of sight end in the open.
//! Assumptions  most facets are wound with their outward side out (98.6 % and more in the models at hand)
//! Why          party walls, inner walls and ground under houses stand close to the truth and make wrong poses fit

use std::sync::atomic::{AtomicU8, Ordering};

use super::surface::CitySurface;
use crate::geometry::{Point3, Vector3};
use crate::limits::FacetVisibilityLimits;

/// For each triangle of a city whether it is exposed, found out when first asked where the model does not tell it.
pub(super) struct FacetVisibility {
    known: Vec<AtomicU8>,
    limits: FacetVisibilityLimits,
}

const UNKNOWN: u8 = 0;
const HIDDEN: u8 = 1;
const EXPOSED: u8 = 2;

impl FacetVisibility {
    pub fn new(surface: &CitySurface, limits: &FacetVisibilityLimits) -> FacetVisibility {
        let triangles = surface.model.triangles.len();
        // What an index knows was asked by the usual limits.
        let is_told = surface.model.exposed.len() == triangles && *limits == FacetVisibilityLimits::default();
        let told = |triangle: usize| match is_told.then(|| surface.model.exposed[triangle]) {
            None => UNKNOWN,
            Some(exposed) => {
                if exposed {
                    EXPOSED
                } else {
                    HIDDEN
                }
            }
        };
        FacetVisibility { known: (0..triangles).map(|t| AtomicU8::new(told(t))).collect(), limits: *limits }
    }

    /// Whether a triangle is exposed; several threads may ask at once.
    pub fn of(&self, triangle: u32, surface: &CitySurface) -> bool {
        let known = &self.known[triangle as usize];
        match known.load(Ordering::Relaxed) {
            UNKNOWN => {
                let exposed = is_exposed(triangle, surface, &self.limits);
                known.store(if exposed { EXPOSED } else { HIDDEN }, Ordering::Relaxed);
                exposed
            }
            answer => answer == EXPOSED,
        }
    }
}

fn is_exposed(triangle: u32, surface: &CitySurface, limits: &FacetVisibilityLimits) -> bool {
    let normal = |t: u32| surface.normal_of(t);
    let ends_in_the_open =
        |from: &Point3<f64>, direction: &Vector3<f64>| match surface.rays().first_hit(from, direction, limits.open_m) {
            None => true,
            Some(sight) => {
                let is_back = |t: u32| normal(t).dot(direction) >= 0.0;
                let leaves_a_solid =
                    || surface.rays().first_hit_of(is_back, from, direction, sight.distance + limits.joint_m).is_some();
                sight.distance > limits.narrowest_gap_m && !is_back(sight.triangle) && !leaves_a_solid()
            }
        };
    let outward = normal(triangle);
    let directions = fan(&outward);
    places(&surface.corners(triangle), limits.large_triangle_m2).iter().any(|place| {
        let from = place + limits.start_m * outward;
        most(directions.iter().map(|d| ends_in_the_open(&from, d)), directions.len())
    })
}

/// True where more than half of `count` answers are yes; asks no more of them than it must.
fn most(answers: impl Iterator<Item = bool>, count: usize) -> bool {
    let (mut yes, mut no) = (0, 0);
    for answer in answers {
        *(if answer { &mut yes } else { &mut no }) += 1;
        if 2 * yes > count || 2 * no >= count {
            break;
        }
    }
    2 * yes > count
}

/// The normal and four directions at 55 degrees from it.
fn fan(normal: &Vector3<f64>) -> [Vector3<f64>; 5] {
    let mut axis = Vector3::zeros();
    axis[normal.iamin()] = 1.0;
    let a = normal.cross(&axis).normalize();
    let b = normal.cross(&a);
    let (sin, cos) = 55f64.to_radians().sin_cos();
    // Turned by an odd angle, so that no line of sight runs along the walls of a rectangular block.
    let (s, c) = 0.37f64.sin_cos();
    let (u, v) = (c * a + s * b, c * b - s * a);
    [*normal, cos * normal + sin * u, cos * normal - sin * u, cos * normal + sin * v, cos * normal - sin * v]
}

/// Places on a triangle to look from: its middle, or three well inside a large one.
fn places([a, b, c]: &[Point3<f64>; 3], large_m2: f64) -> Vec<Point3<f64>> {
    let at = |u: f64, v: f64, w: f64| Point3::from(a.coords * u + b.coords * v + c.coords * w);
    if (b - a).cross(&(c - a)).norm() / 2.0 < large_m2 {
        vec![at(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)]
    } else {
        vec![at(0.7, 0.15, 0.15), at(0.15, 0.7, 0.15), at(0.15, 0.15, 0.7)]
    }
}

#[cfg(test)]
mod tests;
