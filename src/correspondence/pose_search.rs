//! Poses of minimal samples as the robust loop sees them: drawn, solved, and scored on facets.

use super::level_cloud::LevelPatch;
use super::sample::{MinimalSample, PatchPlanePair};
use super::sampler::Sampler;
use super::scene::Scene;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::robust::{Problem, Random};
use crate::solvers::{Configuration, Row, Sought, solve_minimal};

/// The alignment as the robust loop sees it. Poses are `city_from_level`.
pub struct PoseSearch<'a> {
    pub scene: &'a Scene<'a>,
    pub sampler: &'a Sampler<'a>,
    pub sought: Sought,
    /// How many points the samples take from each pair, the first pair's first.
    pub configuration: &'a Configuration,
    /// Sample points that rank hypotheses.
    pub point_subset: &'a [u32],
}

impl Problem for PoseSearch<'_> {
    type Pose = Similarity;

    fn hypothesize(&self, random: &mut Random, poses: &mut Vec<Similarity>) {
        self.sample(random, poses);
    }

    fn score(&self, pose: &Similarity) -> f64 {
        self.scene.score(self.point_subset, pose, self.gate_m())
    }

    fn score_from(&self, pose: &Similarity, least: f64) -> Option<f64> {
        self.scene.score_from(self.point_subset, pose, self.gate_m(), least)
    }

    fn same(&self, a: &Similarity, b: &Similarity) -> bool {
        largest_shift(a, b, self.scene.level_cloud.radius_m) < self.scene.limits.search.same_place_m
    }
}

impl PoseSearch<'_> {
    /// Wide: a minimal sample extrapolates the noise of a few patches over the whole scene.
    fn gate_m(&self) -> f64 {
        self.scene.limits.search.gate_units * self.scene.gate_unit_m
    }

    /// Draws one sample and appends its poses within the start's reach. Tells the chance that the sample is right; `None` where
    /// its patches fit nothing or cannot give the points.
    pub fn sample(&self, random: &mut Random, poses: &mut Vec<Similarity>) -> Option<f64> {
        let points_per_plane = self.configuration.points_per_plane;
        let sample = self.sampler.draw(points_per_plane.len(), random)?;
        let rows = self.rows(&sample)?;
        let solved = solve_minimal(&self.sought, points_per_plane, &rows);
        let right_way_up = |pose: &&Similarity| self.faces_its_planes(&sample, pose);
        poses.extend(solved.iter().filter(right_way_up).filter(|pose| self.scene.prior.reaches(pose)));
        Some(sample.chance)
    }

    /// So many points of each pair on its plane; then what completes the sample, one row for each plane that is left.
    fn rows(&self, sample: &MinimalSample) -> Option<Vec<Row>> {
        let mut rows = Vec::with_capacity(self.sought.unknowns());
        let mut completion = sample.completion.iter();
        for (k, &points) in self.configuration.points_per_plane.iter().enumerate() {
            match sample.pairs.get(k) {
                Some(pair) => {
                    let patch = &self.scene.level_cloud.patches[pair.patch as usize];
                    let places = places(patch, points, &self.across(sample, k));
                    rows.extend(places[..points].iter().map(|place| row(place, pair)));
                }
                None if points == 1 => rows.push(*completion.next()?),
                None => return None,
            }
        }
        Some(rows)
    }

    /// What two points of the pair's patch must stand across, to tell most: the direction that is known already. Known up holds
    /// its vertical; else a patch is turned about the normal of the pair before it.
    fn across(&self, sample: &MinimalSample, k: usize) -> Vector3<f64> {
        if self.sampler.up_is_known() {
            return Vector3::z();
        }
        let count = sample.pairs.len();
        sample.pairs[(k + count - 1) % count].normal
    }

    /// Three points of a patch lie as well on their plane when the patch is turned over.
    fn faces_its_planes(&self, sample: &MinimalSample, pose: &Similarity) -> bool {
        let wholes = self.configuration.points_per_plane.iter().take_while(|points| **points == 3).count();
        let mut pairs = sample.pairs.iter().take(wholes);
        pairs.all(|pair| (pose.rotation * pair.normal).dot(&pair.target.normal) > 0.0)
    }
}

fn row(place: &Vector3<f64>, pair: &PatchPlanePair) -> Row {
    Row { point: *place, normal: pair.target.normal, offset: pair.target.offset }
}

/// One, two or three points for a patch, as far apart as its own points are: its middle; a pair at right angles to `across`; a
/// triangle.
fn places(patch: &LevelPatch, points: usize, across: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let middle = patch.center.coords;
    match points {
        1 => [middle; 3],
        2 => {
            let along = in_plane(patch, across);
            [middle + along, middle - along, middle]
        }
        _ => {
            let [long, short] = [patch.axes[0] * patch.spread[0], patch.axes[1] * patch.spread[1]];
            let (back, aside) = (-0.5 * long, 0.75f64.sqrt() * short);
            [middle + long, middle + back + aside, middle + back - aside]
        }
    }
}

/// The direction in a patch's plane at right angles to `across`, as long as the patch.
fn in_plane(patch: &LevelPatch, across: &Vector3<f64>) -> Vector3<f64> {
    let direction = across.cross(&patch.normal).try_normalize(0.0).unwrap_or_default();
    let [a, b] = [0, 1].map(|k| patch.axes[k].dot(&direction) * patch.spread[k]);
    direction * (a * a + b * b).sqrt().max(f64::MIN_POSITIVE)
}

/// The largest distance between the images of six places round the middle of the level frame.
pub fn largest_shift(a: &Similarity, b: &Similarity, radius_m: f64) -> f64 {
    let r = radius_m;
    let places =
        [[r, 0.0, 0.0], [-r, 0.0, 0.0], [0.0, r, 0.0], [0.0, -r, 0.0], [0.0, 0.0, r / 3.0], [0.0, 0.0, -r / 3.0]];
    places
        .iter()
        .map(|p| Point3::from(Vector3::from(*p)))
        .map(|p| (a.apply(&p) - b.apply(&p)).norm())
        .fold(0.0, f64::max)
}
