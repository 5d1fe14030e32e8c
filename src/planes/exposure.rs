//! Which facets somebody could have seen.
//!
//! Question     can a triangle of the model be seen from open space, or only from inside a building?
//! Method       lines of sight leave the triangle on its outward side; one that next meets the *back* of a facet was inside a
//!              solid all along. A triangle is exposed if from some place on it most lines of sight end in the open.
//! Assumptions  most facets are wound with their outward side out (98.6 % and more in the models at hand)
//! Why          party walls, inner walls and ground under houses stand close to the truth and make wrong poses fit

use rayon::prelude::*;

use crate::city::CityModel;
use crate::geometry::{Point3, RayCaster, Vector3};

/// Lines of sight start this far off the facet, beyond the mortar between the walls of two houses.
const START_M: f64 = 0.06;
/// What is nearer than this in front of a facet hides it: nobody stands there.
const NARROWEST_GAP_M: f64 = 0.5;
/// Lines of sight that meet nothing within this distance end in the open.
const REACH_M: f64 = 40.0;
/// Larger triangles are looked at from three places.
const LARGE_TRIANGLE_M2: f64 = 4.0;

/// For each triangle of `city` whether it is exposed; those for which `ask` does not hold are not looked at (`false`). Besides, the
/// triangles that were asked about as obstacles.
pub fn exposed_triangles(city: &CityModel, ask: impl Fn(u32) -> bool + Sync) -> (Vec<bool>, RayCaster) {
    let asked: Vec<u32> = (0..city.triangles.len() as u32).filter(|&t| ask(t)).collect();
    let corners = |t: u32| city.triangles[t as usize].map(|v| city.vertices[v as usize]);
    let mut facet_of = vec![0u32; city.triangles.len()];
    for (f, facet) in city.facets.iter().enumerate() {
        facet_of[facet.triangles.start as usize..facet.triangles.end as usize].fill(f as u32);
    }
    let normal = |t: u32| city.facets[facet_of[t as usize] as usize].plane.normal;
    let rays = RayCaster::new(asked.iter().map(|&t| corners(t)));
    let ends_in_the_open = |from: &Point3<f64>, direction: &Vector3<f64>| match rays.first_hit(from, direction, REACH_M)
    {
        None => true,
        Some(sight) => sight.distance > NARROWEST_GAP_M && normal(asked[sight.triangle as usize]).dot(direction) < 0.0,
    };
    let is_exposed = |&t: &u32| {
        let outward = normal(t);
        let directions = fan(&outward);
        places(&corners(t)).iter().any(|place| {
            let from = place + START_M * outward;
            most(directions.iter().map(|d| ends_in_the_open(&from, d)), directions.len())
        })
    };
    let flags: Vec<bool> = asked.par_iter().map(is_exposed).collect();
    let mut exposed = vec![false; city.triangles.len()];
    for (&t, flag) in asked.iter().zip(flags) {
        exposed[t as usize] = flag;
    }
    (exposed, rays)
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
fn places([a, b, c]: &[Point3<f64>; 3]) -> Vec<Point3<f64>> {
    let at = |u: f64, v: f64, w: f64| Point3::from(a.coords * u + b.coords * v + c.coords * w);
    if (b - a).cross(&(c - a)).norm() / 2.0 < LARGE_TRIANGLE_M2 {
        vec![at(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)]
    } else {
        vec![at(0.7, 0.15, 0.15), at(0.15, 0.7, 0.15), at(0.15, 0.15, 0.7)]
    }
}
