//! Candidate pairs of patches and city planes, drawn so that a minimal sample agrees with the start and with itself.
//!
//! Question     which patch may lie on which plane of the city, given what the start says and the pairs already chosen?
//! Input        level cloud (patches in the level frame), city planes that can be seen, the prior
//! Output       minimal samples: rows for the solvers
//! Method       with known up the first pair fixes the rotation, by its two azimuths; with free up the first two pairs do, by
//!              their four normals. What is known of scale and place is a [`ScaleTranslationEstimate`]. The next patch is one on
//!              which it says least; its planes are those that face its way and lie within three sigmas of where
//!              it expects the patch. Each draw tells the chance that it took the right plane: offers have their likelihoods
//!              for weights, so an offer with the share w of all is right with chance w and taken as often: sum of w^2.
//! Source       samples over patch-plane pairs and then
//!              points inside them: Ramalingam et al. 2010, section 5
//!
//! Frames: `level` is centred on the cloud, z up, in metres of the start; the city frame is its own local one.

use nalgebra::Matrix3;

use super::belief::{RowErrors, ScaleTranslationEstimate};
use super::level_cloud::{LevelCloud, LevelPatch};
use super::offers::FirstOffers;
use super::prior::{Prior, Vertical, heading_of};
use super::rotations::{about_up, about_up_from, bisectors};
use super::sample::{Draft, MinimalSample, PatchPlanePair};
use super::scene::Scene;
use super::targets::{LEAST_SIN_FOR_AZIMUTH, Target, Targets, azimuth, elevation, has_azimuth, wrapped};
use super::weighted_choice::{Choice, Drawn};
use crate::geometry::{Rotation3, Vector3};
use crate::limits::SearchLimits;
use crate::planes::{CityPlanes, PlaneId};
use crate::robust::{Motion, Random};

/// Draws samples.
pub struct Sampler<'a> {
    pub(super) level_cloud: &'a LevelCloud,
    pub(super) prior: &'a Prior,
    limits: &'a SearchLimits,
    errors: RowErrors,
    planes: &'a CityPlanes,
    pub(super) targets: Targets,
    /// Patches drawn for a place in a sample until one can lie anywhere.
    draws: usize,
    /// Rising sums of the patches' weights: all, and those with an azimuth.
    all: Vec<f64>,
    turned: Vec<f64>,
    /// For each patch what it is offered as the first of a sample, which nothing but the prior decides.
    pub(super) firsts: FirstOffers,
}

/// Result of drawing the next pair.
enum NextPair {
    PatchPlanePair(Drawn<PatchPlanePair>),
    /// No patch drawn would say anything new.
    AllIsKnown,
    /// None of the patches drawn can lie anywhere.
    NothingFits,
}

/// Draws of the pilot that tells whether patches find planes. Derived: a share is then known to 3 %.
const PILOT_DRAWS: u64 = 256;
/// Fixed seed of the pilot, independent of the user's.
const PILOT_SEED: u64 = 0;
/// Two normals nearer to parallel than this do not fix a rotation.
const LEAST_SIN_BETWEEN: f64 = 0.3;
/// Patches compared when the next one is chosen.
const PATCHES_COMPARED: usize = 6;

impl<'a> Sampler<'a> {
    pub fn new(scene: &'a Scene<'a>) -> Sampler<'a> {
        let (level_cloud, prior, limits) = (&scene.level_cloud, &scene.prior, &scene.limits.search);
        let in_sight = scene.city.planes_in_sight(&scene.reach.low, &scene.reach.high);
        let rising = |take: fn(&LevelPatch) -> bool| -> Vec<f64> {
            let weights = level_cloud.patches.iter().map(|p| if take(p) { p.weight } else { 0.0 });
            weights
                .scan(0.0, |sum, weight| {
                    *sum += weight;
                    Some(*sum)
                })
                .collect()
        };
        let sampler = Sampler {
            level_cloud,
            prior,
            limits,
            errors: RowErrors::new(scene.limits, level_cloud.radius_m),
            planes: scene.city.planes(),
            targets: Targets::new(scene.city.planes(), &in_sight, limits.smallest_target_m2),
            firsts: FirstOffers::of(level_cloud.patches.len()),
            all: rising(|_| true),
            turned: rising(|p| has_azimuth(&p.normal)),
            draws: 1,
        };
        let draws = if sampler.feasible_draws() < limits.feasible_share { limits.most_draws } else { 1 };
        Sampler { draws, ..sampler }
    }

    /// The share of draws that a pilot can feed.
    fn feasible_draws(&self) -> f64 {
        let is_fed = |draw: &u64| self.draw(0, &mut Random::stream(PILOT_SEED, *draw)).is_some();
        (0..PILOT_DRAWS).filter(is_fed).count() as f64 / PILOT_DRAWS as f64
    }

    /// Whether the level frame's z may be taken for up.
    pub fn up_is_known(&self) -> bool {
        self.prior.vertical == Vertical::Known
    }

    /// A sample on so many planes, or `None` where a drawn patch fits nothing.
    pub fn draw(&self, planes: usize, random: &mut Random) -> Option<MinimalSample> {
        let mut draft = if self.up_is_known() { self.begin_level(random)? } else { self.begin_leaning(random)? };
        // Scale and translation: with the rotation fixed, each pair settles one of them.
        let unknowns = match self.prior.motion {
            Motion::Rigid => 3,
            Motion::Similarity => 4,
        };
        while draft.pairs.len() < unknowns {
            match self.informative_pair(&draft.belief, random) {
                NextPair::PatchPlanePair(pair) => draft.take(self.level_cloud, pair),
                NextPair::AllIsKnown => break,
                NextPair::NothingFits => return None,
            }
        }
        let (completion, chance) = draft.belief.completion(unknowns.saturating_sub(draft.pairs.len()), random)?;
        // Planes beyond those hold the rotation.
        while draft.pairs.len() + completion.len() < planes {
            let patch = random.weighted(&self.all)?;
            if draft.pairs.iter().any(|pair| pair.patch as usize == patch) {
                return None;
            }
            let pair = self.next_pair(patch, &draft.belief, random)?;
            draft.take(self.level_cloud, pair);
        }
        Some(MinimalSample { pairs: draft.pairs, completion, chance: draft.chance * chance })
    }

    /// Known up: one pair, and the heading that turns its patch into its plane.
    fn begin_level(&self, random: &mut Random) -> Option<Draft> {
        let pair = (0..self.draws).find_map(|_| self.first_pair(random.weighted(&self.turned)?, random))?;
        let mut draft = Draft::new(self.belief(about_up_from(&pair.what.normal, &pair.what.target.normal)));
        draft.take(self.level_cloud, pair);
        Some(draft)
    }

    /// Free up: two pairs, and the rotation that lays both patches along their planes.
    fn begin_leaning(&self, random: &mut Random) -> Option<Draft> {
        let [first, second] = [random.weighted(&self.all)?, random.weighted(&self.all)?];
        let normal = |i: usize| &self.level_cloud.patches[i].normal;
        if normal(first).cross(normal(second)).norm() < LEAST_SIN_BETWEEN {
            return None;
        }
        let pair = self.first_pair(first, random)?;
        let Drawn { what: (rotation, other), chance } = self.second_pair(&pair.what, second, random)?;
        let mut draft = Draft::new(self.belief(rotation));
        draft.take(self.level_cloud, pair);
        draft.take(self.level_cloud, Drawn { what: other, chance });
        Some(draft)
    }

    /// A pair of which the belief says little. A patch that can lie nowhere is not on the city, and another takes its turn.
    fn informative_pair(&self, belief: &ScaleTranslationEstimate, random: &mut Random) -> NextPair {
        for _ in 0..self.draws {
            let Some(patch) = self.least_known(belief, random) else { return NextPair::AllIsKnown };
            if let Some(pair) = self.next_pair(patch, belief, random) {
                return NextPair::PatchPlanePair(pair);
            }
        }
        NextPair::NothingFits
    }

    pub(super) fn belief(&self, rotation: Matrix3<f64>) -> ScaleTranslationEstimate {
        ScaleTranslationEstimate::new(self.prior, rotation, self.errors)
    }

    /// A plane for the second patch under free up, and the rotation that lays both normals along their planes'.
    fn second_pair(
        &self,
        first: &PatchPlanePair,
        patch: usize,
        random: &mut Random,
    ) -> Option<Drawn<(Matrix3<f64>, PatchPlanePair)>> {
        let p = &self.level_cloud.patches[patch];
        let belief = self.belief(Matrix3::identity());
        let first_center = &self.level_cloud.patches[first.patch as usize].center;
        let mut choice = Choice::default();
        for normal in p.sides() {
            let cos = first.normal.dot(&normal);
            let Some(level_axes) = bisectors(&first.normal, &normal) else { continue };
            for t in self.targets.all() {
                let towards = t.normal();
                if (first.target.normal.dot(&towards) - cos).abs() > self.limits.same_cos {
                    continue;
                }
                let Some(city_axes) = bisectors(&first.target.normal, &towards) else { continue };
                let rotation = city_axes * level_axes.transpose();
                if !self.allows(&rotation) {
                    continue;
                }
                let mut turned = belief.turned(rotation);
                turned.learn(first_center, &first.target);
                if let Some(likelihood) = turned.predict(&p.center).likelihood(t) {
                    choice.offer(likelihood, (rotation, normal, t.id), random);
                }
            }
        }
        let Drawn { what: (rotation, normal, id), chance } = choice.drawn()?;
        Some(Drawn { what: (rotation, self.pair(patch, normal, id)), chance })
    }

    pub(super) fn pair(&self, patch: usize, normal: Vector3<f64>, plane: PlaneId) -> PatchPlanePair {
        PatchPlanePair { patch: patch as u32, plane, target: self.planes.planes[plane.0 as usize].plane, normal }
    }

    /// The rotation that lays a normal onto a target's: a heading first, as far as both have an azimuth, then the least tilt;
    /// `None` where the start does not reach so far.
    pub(super) fn turning(&self, normal: &Vector3<f64>) -> impl Fn(&Target) -> Option<Matrix3<f64>> {
        let (normal, has, own) = (*normal, has_azimuth(normal), [azimuth(normal), elevation(normal)]);
        let tilt = self.prior.most_tilt_rad();
        // A tilt turns azimuths too: by its tangent's share on slopes, to second order on walls.
        let slope = normal.z.abs() / normal.xy().norm().max(LEAST_SIN_FOR_AZIMUTH);
        let most_heading = self.prior.most_heading_rad() + tilt * slope + 0.5 * tilt * tilt;
        let most_tilt = tilt + self.limits.same_angle_rad;
        let least_cos = most_tilt.min(std::f64::consts::PI).cos();
        move |t| {
            let towards = t.normal();
            let both_turned = has && has_azimuth(&towards);
            let heading = if both_turned { wrapped(t.azimuth() - own[0]) } else { 0.0 };
            if heading.abs() > most_heading || (f64::from(t.elevation) - own[1]).abs() > most_tilt {
                return None;
            }
            let upright = about_up(heading);
            let turned = upright * normal;
            let within = turned.dot(&towards) >= least_cos;
            let leaning = within.then(|| Rotation3::rotation_between(&turned, &towards))??;
            Some(leaning.into_inner() * upright)
        }
    }

    /// Whether the prior reaches a rotation, with the slack of patch normals.
    fn allows(&self, r: &Matrix3<f64>) -> bool {
        let most = |reach: f64| (reach + self.limits.same_angle_rad).min(std::f64::consts::PI);
        r[(2, 2)] >= most(self.prior.most_tilt_rad()).cos()
            && heading_of(r).abs() <= most(self.prior.most_heading_rad())
    }

    /// Of a few patches drawn by weight, the one whose place is known least; `None` when all are known well.
    fn least_known(&self, belief: &ScaleTranslationEstimate, random: &mut Random) -> Option<usize> {
        let mut best = None;
        let mut most = self.limits.informative_sigma_m.powi(2);
        for _ in 0..PATCHES_COMPARED {
            let i = random.weighted(&self.all)?;
            let p = &self.level_cloud.patches[i];
            let variance = belief.variance(&p.center, &(belief.turn(&p.normal)));
            if variance > most {
                most = variance;
                best = Some(i);
            }
        }
        best
    }

    fn next_pair(
        &self,
        patch: usize,
        belief: &ScaleTranslationEstimate,
        random: &mut Random,
    ) -> Option<Drawn<PatchPlanePair>> {
        let p = &self.level_cloud.patches[patch];
        let expected = belief.predict(&p.center);
        let mut choice = Choice::default();
        for side in p.sides() {
            let normal = belief.turn(&side);
            let has_same_tilt = self.tilted_as(&normal);
            let offer = |t: &Target| {
                if let Some(likelihood) = has_same_tilt(t).then(|| expected.likelihood(t)).flatten() {
                    choice.offer(likelihood, (side, t.id), random);
                }
            };
            if has_azimuth(&normal) || !self.targets.has_level() {
                let reach = self.limits.same_angle_rad;
                self.targets.each_facing_within(azimuth(&normal), reach, &expected.bounds, offer);
            } else {
                self.targets.each_level(&expected.bounds, offer);
            }
        }
        let Drawn { what: (side, id), chance } = choice.drawn()?;
        Some(Drawn { what: self.pair(patch, side, id), chance })
    }

    /// Whether a target is tilted as a normal is.
    pub(super) fn tilted_as(&self, normal: &Vector3<f64>) -> impl Fn(&Target) -> bool + use<> {
        let (own, most) = (elevation(normal) as f32, self.limits.same_angle_rad as f32);
        move |target| (own - target.elevation).abs() < most
    }
}

#[cfg(test)]
mod tests;
