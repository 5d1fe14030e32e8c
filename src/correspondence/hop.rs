//! Out of a basin beside the right one.
//!
//! Question     does a pose close by, in another basin of refinement, explain more?
//! Method       the pose is moved to and fro along each of its seven principal directions by about the width of a basin and refined
//!              again; the best share of the vote wins, and the round is repeated from there while it gains (basin hopping, Wales
//!              and Doye 1997, with fixed moves instead of random ones)
//! Why          facades have several parallel planes some decimetres apart; a cloud may settle with some of its patches one plane
//!              off, held as firmly as at the right place

use super::refine::Refiner;
use crate::geometry::Similarity;
use crate::robust::Vector7;

/// Moves in units of the scene: a gate of refinement is as wide.
const MOVES_UNITS: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];
/// Gates of refinement after a move, and of the vote, in units of the scene.
const GATES_UNITS: [f64; 4] = [1.7, 1.3, 1.0, 1.0];
const VOTING_GATE_UNITS: f64 = 1.0;
const MOST_ROUNDS: usize = 3;

/// The best pose about `pose`, by the probes of `panel`.
pub fn hop(refiner: &Refiner, panel: &[u32], pose: &Similarity, unit_m: f64) -> Similarity {
    let gates_m = GATES_UNITS.map(|g| g * unit_m);
    let scorer = refiner.scorer;
    let score =
        |pose: &Similarity| scorer.panel_share(panel, pose, VOTING_GATE_UNITS * unit_m) - scorer.prior_cost(pose);
    let mut best = refiner.refine(panel, pose, &gates_m);
    let mut most = score(&best.city_from_level);
    for _ in 0..MOST_ROUNDS {
        let from = best.clone();
        let directions = from.equations.spectrum().directions;
        for (k, units) in (0..7).flat_map(|k| MOVES_UNITS.map(|units| (k, units))) {
            let motion: Vector7 = directions.column(k) * (units * unit_m);
            let moved = from.chart.moved(&from.city_from_level, &motion);
            let refined = refiner.refine(panel, &moved, &gates_m);
            let found = score(&refined.city_from_level);
            if found > most && scorer.within_reach(&refined.city_from_level) {
                (most, best) = (found, refined);
            }
        }
        if best.city_from_level == from.city_from_level {
            break;
        }
    }
    best.city_from_level
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::city::{CityModel, CityOptions, read_city};
    use crate::correspondence::{Scene, Scorer, refiner};
    use crate::geometry::{Point3, Start, Vector3};
    use crate::planes::{PatchOptions, Upright, patches};
    use crate::reconstruction::Reconstruction;

    /// Corner and two edges of each rectangle: a wall behind a plinth half a metre deep, a side wall and the ground.
    const RECTANGLES: [[[f64; 3]; 3]; 4] = [
        [[0.0, 20.0, 0.0], [0.0, -20.0, 0.0], [0.0, 0.0, 8.0]],
        [[-0.5, 20.0, 0.0], [0.0, -20.0, 0.0], [0.0, 0.0, 4.0]],
        [[-0.5, 0.0, 0.0], [12.0, 0.0, 0.0], [0.0, 0.0, 8.0]],
        [[-20.0, -20.0, 0.0], [40.0, 0.0, 0.0], [0.0, 60.0, 0.0]],
    ];

    fn city() -> CityModel {
        let mut obj = String::new();
        for [corner, u, v] in RECTANGLES.map(|r| r.map(Vector3::from)) {
            for c in [corner, corner + u, corner + u + v, corner + v] {
                obj.push_str(&format!("v {} {} {}\n", c.x, c.y, c.z));
            }
            obj.push_str("f -4 -3 -2 -1\n");
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("city.obj");
        std::fs::write(&path, obj).unwrap();
        read_city(&path, &[], &CityOptions::default()).unwrap()
    }

    /// What is seen: the wall above the plinth, the plinth, the side wall, the ground before them.
    fn seen() -> Reconstruction {
        let mut points = Vec::new();
        let mut on = |corner: [f64; 3], u: [f64; 3], v: [f64; 3], columns: u32, rows: u32| {
            for i in 0..columns * rows {
                let (a, b) = (f64::from(i % columns) / f64::from(columns), f64::from(i / columns) / f64::from(rows));
                points.push(Point3::from(Vector3::from(corner) + Vector3::from(u) * a + Vector3::from(v) * b));
            }
        };
        on([0.0, 0.5, 4.5], [0.0, 19.0, 0.0], [0.0, 0.0, 3.0], 20, 8);
        on([-0.5, 0.5, 0.5], [0.0, 19.0, 0.0], [0.0, 0.0, 3.0], 40, 12);
        on([0.5, 0.0, 0.5], [11.0, 0.0, 0.0], [0.0, 0.0, 7.0], 20, 12);
        on([-10.0, -10.0, 0.0], [9.0, 0.0, 0.0], [0.0, 30.0, 0.0], 10, 30);
        Reconstruction { points, ..Reconstruction::default() }
    }

    #[test]
    fn a_cloud_whose_plinth_lies_on_the_wall_hops_to_its_own_place() {
        let city = city();
        let start = Start::with_default_sigmas(Similarity::identity());
        let start = Start { city_from_sfm: start.city_from_sfm.relative_to(&city.origin), ..start };
        let upright = Upright { up: Vector3::z(), sigma_rad: 0.0, known: true };
        let patches = patches(&seen(), None, &PatchOptions::default());
        let scene = Scene::new(&city, &patches, &start, &upright);
        let scorer = Scorer { votes: &scene.votes, field: &scene.field, start: scene.start };
        let refiner = refiner(&scene, &scorer, false);
        let panel = scene.votes.panel(1500);

        let right = Similarity { translation: scene.votes.center_in_city.coords, ..Similarity::identity() };
        let off = |pose: &Similarity| (pose.translation - right.translation).x;
        let shifted = Similarity { translation: right.translation + Vector3::new(0.5, 0.0, 0.0), ..right };
        let stuck = refiner.refine(&panel, &shifted, &GATES_UNITS.map(|g| g * scene.unit_m)).city_from_level;
        assert!(off(&stuck) > 0.4, "{}", off(&stuck));
        let hopped = hop(&refiner, &panel, &stuck, scene.unit_m);
        assert!(off(&hopped).abs() < 0.01, "{}", off(&hopped));
    }
}
