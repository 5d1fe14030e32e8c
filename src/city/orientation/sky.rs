//! Rays from a facet into the open, past the triangles of its object.

use std::ops::ControlFlow;

use crate::city::{CityModel, Facet};
use crate::geometry::{Point3, RayCaster, Vector3};

/// Directions in which rays rise, evenly around, so that both sides of a wall get as many. Begun off the axes, on which
/// walls stand; two slopes, so that a low one passes under what a steep one meets.
const AZIMUTHS: usize = 8;
const FIRST_AZIMUTH: f64 = 0.2134;
const SLOPES_DEG: [f64; 2] = [37.0, 61.0];

/// Share by which votes for one side must exceed those for the other, of rays and of facets: seven of eight agree.
pub(super) const CERTAIN: f64 = 0.75;

/// Free rays that tell that a facet's back is outside: a single one may have found a crack.
const LEAST_FREE: usize = 2;

/// Boxes that one ray may pass; in a building of 10,000 triangles it passes some 50.
const BOXES_PER_RAY: usize = 512;

/// Limits of what counts as the facet's own place, metres: a copy of a wall is no second wall, a window pane is.
const OWN_PLACE_M: (f64, f64) = (1e-4, 0.02);

/// The triangles of an object, and the rays that look for the open.
pub(super) struct Sky {
    rays: RayCaster,
    /// Shell of each triangle.
    shell_of: Vec<u32>,
    directions: Vec<Vector3<f64>>,
    own_place_m: f64,
}

impl Sky {
    /// Over triangles, each with the number of its shell.
    pub fn new(triangles: impl Iterator<Item = (u32, [Point3<f64>; 3])>, precision_m: f64) -> Sky {
        let (shell_of, triangles): (Vec<u32>, Vec<[Point3<f64>; 3]>) = triangles.unzip();
        let direction = |at: usize| {
            let azimuth = FIRST_AZIMUTH + at as f64 * std::f64::consts::TAU / AZIMUTHS as f64;
            let slope = SLOPES_DEG[at % SLOPES_DEG.len()].to_radians();
            Vector3::new(slope.cos() * azimuth.cos(), slope.cos() * azimuth.sin(), slope.sin())
        };
        Sky {
            rays: RayCaster::new(triangles.into_iter()),
            shell_of,
            directions: (0..AZIMUTHS).map(direction).collect(),
            own_place_m: precision_m.clamp(OWN_PLACE_M.0, OWN_PLACE_M.1),
        }
    }

    /// 1 where one gets into the open from the facet's front and not at once from its back, -1 from its back alone, else 0.
    pub fn free_rays(&self, model: &CityModel, facet: &Facet) -> f64 {
        let Some(from) = inner_point(model, facet) else { return 0.0 };
        let is_free = |direction: &&Vector3<f64>| {
            let (mut boxes, mut is_free) = (0, true);
            self.rays.hits(&from, direction, self.own_place_m, |hit| {
                boxes += 1;
                is_free = hit.is_none() && boxes < BOXES_PER_RAY;
                if is_free { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
            is_free
        };
        let on_front = |direction: &&Vector3<f64>| facet.plane.normal.dot(direction) > 0.0;
        let back = || self.directions.iter().filter(|direction| !on_front(direction));
        let is_front_free = || self.directions.iter().filter(on_front).any(|direction| is_free(&direction));
        // Most facets are right, and for them two rays are enough.
        match (back().next().is_some_and(|direction| is_free(&direction)), is_front_free()) {
            (false, true) => 1.0,
            (_, false) if back().filter(is_free).count() >= LEAST_FREE => -1.0,
            _ => 0.0,
        }
    }

    /// 1 where the rays cross the object as they must if the facet looks outward, -1 where as if it looked inward, else 0.
    pub fn parity(&self, model: &CityModel, facet: &Facet) -> f64 {
        let Some(from) = inner_point(model, facet) else { return 0.0 };
        let vote = |direction: &Vector3<f64>| {
            let (mut boxes, mut crossings) = (0, 0);
            self.rays.hits(&from, direction, self.own_place_m, |hit| {
                boxes += 1;
                crossings += usize::from(hit.is_some());
                if boxes < BOXES_PER_RAY { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            });
            let leaves_on_its_front = facet.plane.normal.dot(direction) > 0.0;
            match boxes {
                BOXES_PER_RAY => 0.0,
                _ if (crossings % 2 == 0) == leaves_on_its_front => 1.0,
                _ => -1.0,
            }
        };
        let votes = self.directions.iter().map(vote).sum::<f64>() / AZIMUTHS as f64;
        if votes.abs() >= CERTAIN { votes.signum() } else { 0.0 }
    }

    /// The shells that a ray crosses an odd number of times, ascending; `None` where it passes too much to tell.
    pub fn crossed_oddly(&self, from: &Point3<f64>) -> Option<Vec<u32>> {
        let (mut boxes, mut met) = (0, Vec::new());
        self.rays.hits(from, &self.directions[0], self.own_place_m, |hit| {
            boxes += 1;
            met.extend(hit.map(|hit| self.shell_of[hit.triangle as usize]));
            if boxes < BOXES_PER_RAY { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        if boxes == BOXES_PER_RAY {
            return None;
        }
        met.sort_unstable();
        Some(met.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1).map(|same| same[0]).collect())
    }
}

/// The middle of the facet's largest triangle.
pub(super) fn inner_point(model: &CityModel, facet: &Facet) -> Option<Point3<f64>> {
    let doubled_area = |[a, b, c]: &[Point3<f64>; 3]| (b - a).cross(&(c - a)).norm();
    let largest = model.triangles_of(facet).max_by(|a, b| doubled_area(a).total_cmp(&doubled_area(b)))?;
    Some(Point3::from((largest[0].coords + largest[1].coords + largest[2].coords) / 3.0))
}
