//! Everything that is prepared before the search: the cloud's votes on one side, the visible city on the other.

use super::field::FacetField;
use super::sight::Sightlines;
use super::votes::Votes;
use crate::city::CityModel;
use crate::geometry::{Point3, Start};
use crate::planes::{CityPlanes, Patches, PlaneId, Upright, city_planes, exposed_triangles};

/// The cloud and the part of the city that the start can reach.
pub struct Scene {
    pub start: Start,
    /// Whether the level frame's z may be taken for up.
    pub up_is_known: bool,
    pub votes: Votes,
    pub planes: CityPlanes,
    pub field: FacetField,
    pub sightlines: Sightlines,
    /// For each plane whether any of it can be seen near the scene.
    seen: Vec<bool>,
    /// What "near" means to all gates, metres of the start.
    pub unit_m: f64,
}

/// Gates are multiples of this: what eaves, reveals and a model's error put between a point and its facet ...
const MODEL_UNIT_M: f64 = 0.25;
/// ... and so many sigmas of the cloud's own noise.
const NOISE_SIGMAS: f64 = 2.0;
/// The widest gate, in units.
pub const WIDEST_GATE: f64 = 5.0;

impl Scene {
    /// `start` maps to the city's local frame.
    pub fn new(city: &CityModel, patches: &Patches, start: &Start, upright: &Upright) -> Scene {
        let votes = Votes::new(patches, start, upright);
        let unit_m = MODEL_UNIT_M + NOISE_SIGMAS * votes.noise_m;
        let planes = city_planes(city);
        let (low, high) = reach(&votes, start, upright.known);
        let near = |t: u32| {
            let corners = city.triangles[t as usize].map(|v| city.vertices[v as usize]);
            (0..2).all(|k| corners.iter().any(|c| c[k] <= high[k]) && corners.iter().any(|c| c[k] >= low[k]))
        };
        let (exposed, rays) = exposed_triangles(city, near);
        // A pose may be as much larger than the start as three sigmas of the scale allow, and its gates with it.
        let widest_m = WIDEST_GATE * unit_m * (3.0 * start.log_scale_sigma).exp();
        let field = FacetField::new(city, &low, &high, widest_m, |t| exposed[t as usize]);
        let mut seen = vec![false; planes.planes.len()];
        for t in &field.triangles {
            seen[planes.of_facet(t.facet).0 as usize] = true;
        }
        let up_is_known = upright.known;
        Scene { start: *start, up_is_known, votes, planes, field, sightlines: Sightlines { rays }, seen, unit_m }
    }

    pub fn is_seen(&self, plane: PlaneId) -> bool {
        self.seen[plane.0 as usize]
    }
}

/// Room for points beyond the nine tenths that the radius holds.
const BEYOND_RADIUS: f64 = 1.2;
/// Slack round everything, metres.
const MARGIN_M: f64 = 2.0;

/// The box that the cloud can come to lie in, within three sigmas of the start.
fn reach(votes: &Votes, start: &Start, up_is_known: bool) -> (Point3<f64>, Point3<f64>) {
    let grow = (3.0 * start.log_scale_sigma).exp();
    let radius = BEYOND_RADIUS * votes.radius_m * grow;
    let mut heights: Vec<f64> = votes.probes[..votes.firm].iter().map(|p| p.position.z).collect();
    heights.sort_by(f64::total_cmp);
    let at = |share: f64| heights.get((heights.len() as f64 * share) as usize).copied().unwrap_or(0.0);
    let (bottom, top) = (at(0.002).min(0.0) * grow, at(0.998).max(0.0) * grow);
    // A scene that leans rises by what it is wide, and is wider by what it is high.
    let lean = if up_is_known { 0.0 } else { (3.0 * start.tilt_sigma_rad).min(std::f64::consts::FRAC_PI_2).sin() };
    let side = radius + lean * top.max(-bottom) + 3.0 * start.position_sigma_m + MARGIN_M;
    let rise = lean * radius + 3.0 * start.height_sigma_m + MARGIN_M;
    let c = votes.center_in_city;
    (Point3::new(c.x - side, c.y - side, c.z + bottom - rise), Point3::new(c.x + side, c.y + side, c.z + top + rise))
}
