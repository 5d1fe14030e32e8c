//! The scan: every pose that lays a strong wall of the cloud on a wall of the city.
//!
//! Question     at which poses do more walls of the cloud meet walls of the city than by chance?
//! Method       one wall tied to another gives the heading and one offset; scale and the slide along the wall are stepped through. The
//!              strongest other walls are looked up first, and few poses get past them.
//!                  z = sum W (hit - p) / sqrt(sum W^2 p (1 - p) + 1)
//!              hit: share of three places of a wall that meet one of its direction, side and height; p: how often chance does;
//!              the 1 keeps thin evidence small
//! Cost         0.2 microseconds a pose; linear in the walls of the city

use rayon::prelude::*;

use super::blocks::CELL_M;
use super::chance::Chance;
use super::city_walls::CityWall;
use super::cloud_walls::{CloudWall, CloudWalls};
use super::effort::Effort;
use super::poses::{PlanPose, ScoredPose, distinct};
use super::prior::{PlacePrior, wrapped};
use super::raster::{Question, Raster, angle, classes_asked, height_code};
use super::weights::weights;
use crate::limits::PlaceSearchLimits;
use crate::observer::Cancelled;

/// Places of a wall that are looked up, as shares of its length; the middle one first.
const PLACES: [f64; 3] = [0.5, 1.0 / 6.0, 5.0 / 6.0];
/// City walls of one block of work, and blocks between two reports.
const BLOCK: usize = 16;
const ROUND: usize = 64;
/// A block's list is cut back when it has grown to so many times what is kept.
const SLACK: usize = 8;
/// Poses that are no better than this are chance whatever the others are.
const LEAST_Z: f64 = 2.0;

/// What the scan goes through.
pub struct Scan<'a> {
    /// Those that poses are tied to.
    pub walls: &'a [CityWall],
    pub raster: &'a Raster,
    pub chance: &'a Chance,
    pub cloud: &'a CloudWalls,
    pub scales: &'a [f64],
    pub prior: &'a PlacePrior,
    pub limits: &'a PlaceSearchLimits,
}

/// The best poses at distinct places, and how many were looked at.
struct Scanned {
    poses: Vec<ScoredPose>,
    count: u64,
}

impl Scan<'_> {
    /// The best poses at distinct places, of as many walls as there is time for.
    pub fn run(&self, anchors: &[usize], effort: &mut Effort) -> Result<Vec<ScoredPose>, Cancelled> {
        let tied: Vec<Tied> = anchors.iter().map(|&anchor| Tied::new(self, anchor)).collect();
        let long: Vec<&CityWall> = self.walls.iter().filter(|w| w.length_m() >= self.limits.least_tied_m).collect();
        let keep = self.limits.keep * long.len().div_ceil(self.limits.walls_of_keep).max(1);
        let (mut best, mut least_z) = (Vec::new(), LEAST_Z);
        for round in long.chunks(ROUND * BLOCK) {
            effort.begin_round()?;
            if effort.is_over() {
                break;
            }
            let blocks: Vec<&[&CityWall]> = round.chunks(BLOCK).collect();
            let found: Vec<Scanned> = blocks.par_iter().map(|walls| self.block(walls, &tied, least_z)).collect();
            effort.add(round.len(), found.iter().map(|scanned| scanned.count).sum());
            best.extend(found.into_iter().flat_map(|scanned| scanned.poses));
            if best.len() > SLACK * keep {
                best = self.distinct(best, keep);
                // What is no better than the last that is kept need not be told, whichever thread comes upon it: rounds are one after the other.
                least_z = best.get(keep - 1).map_or(least_z, |last: &ScoredPose| last.z);
            }
        }
        Ok(self.distinct(best, keep))
    }

    fn distinct(&self, poses: Vec<ScoredPose>, keep: usize) -> Vec<ScoredPose> {
        distinct(poses, keep, self.limits.apart_m, self.cloud.radius)
    }

    fn block(&self, walls: &[&CityWall], tied: &[Tied], least_z: f64) -> Scanned {
        let mut best = Best { poses: Vec::with_capacity(SLACK * self.limits.keep), least_z, count: 0 };
        let mut laid = Laid::default();
        for wall in walls {
            for tied in tied {
                for turn in tied.turns() {
                    self.along(wall, tied, turn, &mut laid, &mut best);
                }
            }
        }
        Scanned { poses: self.distinct(best.poses, self.limits.keep), count: best.count }
    }

    /// All scales and slides of one wall of the cloud on one of the city.
    fn along(&self, wall: &CityWall, tied: &Tied, turn: f64, laid: &mut Laid, best: &mut Best) {
        let heading_rad = wrapped(angle(wall.normal) - tied.anchor.azimuth() + turn);
        if !self.may_head(heading_rad) {
            return;
        }
        laid.lay(tied, heading_rad);
        let tallest = (wall.height_m() + self.limits.overshoot_m) / tied.anchor.height();
        let slides = (wall.length_m() / self.limits.step_m).ceil();
        let anchor = PlanPose { center: [0.0; 2], heading_rad, scale: 1.0 }.turned(tied.anchor.middle);
        for (step, &scale) in self.scales.iter().enumerate() {
            if scale > tallest {
                break;
            }
            laid.at_scale(scale, tied.at(step), self.chance);
            for slide in 0..slides as usize {
                let at = wall.at((slide as f64 + 0.5) / slides * wall.length_m());
                let center = [0, 1].map(|k| at[k] - scale * anchor[k]);
                if self.prior.near.is_some_and(|disc| !disc.holds(center)) {
                    continue;
                }
                best.count += 1;
                if let Some(z) = self.z(at, laid, tied.at(step), best.least_z).filter(|z| *z > best.least_z) {
                    best.poses.push(ScoredPose { pose: PlanPose { center, heading_rad, scale }, z, tag: 0 });
                }
            }
        }
        if best.poses.len() > (SLACK - 1) * self.limits.keep {
            let kept = self.distinct(std::mem::take(&mut best.poses), self.limits.keep);
            if kept.len() == self.limits.keep {
                best.least_z = kept.last().map_or(best.least_z, |last| last.z);
            }
            best.poses.reserve(SLACK * self.limits.keep);
            best.poses.extend(kept);
        }
    }

    fn may_head(&self, heading_rad: f64) -> bool {
        let expected = self.prior.heading_of_level(&self.cloud.level_from_sfm.rotation);
        expected.is_none_or(|[at, within]| wrapped(heading_rad - at).abs() <= within)
    }

    /// The score of a pose that has the anchor's middle at a place; `None` where the first walls deny it, or where the others could not bring it
    /// above `least_z`.
    #[inline]
    fn z(&self, at: [f64; 2], laid: &Laid, step: StepOf, least_z: f64) -> Option<f64> {
        let [x, y] = [0, 1].map(|k| (at[k] - self.raster.low[k]) / CELL_M);
        let meets = |wall: usize, place: usize| {
            let [dx, dy] = laid.scaled[wall][place];
            let question = Question { classes: laid.classes[wall], height: step.heights[wall] };
            self.raster.answers(x + dx, y + dy, question)
        };
        let first = self.limits.looked_at_first.min(step.weights.len());
        let mut met = 0.0;
        for wall in 0..first {
            met += if meets(wall, 0) { step.weights[wall] } else { 0.0 };
        }
        if met < step.least_met {
            return None;
        }
        let places = PLACES.len() as f64;
        // A sum of places that is short of this by more than all that is left is of no use.
        let needed = (least_z / laid.per_sigma + laid.mean) * places;
        for wall in 0..first {
            let ends = u8::from(meets(wall, 1)) + u8::from(meets(wall, 2));
            met += f64::from(ends) * step.weights[wall];
        }
        for wall in first..step.weights.len() {
            if met + places * step.rest[wall] < needed {
                return None;
            }
            let places = u8::from(meets(wall, 0)) + u8::from(meets(wall, 1)) + u8::from(meets(wall, 2));
            met += f64::from(places) * step.weights[wall];
        }
        Some((met / places - laid.mean) * laid.per_sigma)
    }
}

/// What a block has found.
struct Best {
    poses: Vec<ScoredPose>,
    least_z: f64,
    count: u64,
}

/// A wall of the cloud that poses are tied to, the others, and what they weigh at each scale.
struct Tied {
    anchor: CloudWall,
    others: Vec<CloudWall>,
    /// Step by step.
    weights: Vec<f64>,
    /// Of each wall and all after it.
    rest: Vec<f64>,
    heights: Vec<u64>,
    /// For each step the weight that the walls that are looked at first must meet with their middles.
    least_met: Vec<f64>,
}

/// The part of a [`Tied`] that belongs to one scale.
#[derive(Clone, Copy)]
struct StepOf<'a> {
    weights: &'a [f64],
    rest: &'a [f64],
    heights: &'a [u64],
    least_met: f64,
}

impl Tied {
    fn new(scan: &Scan, anchor: usize) -> Tied {
        let (limits, walls) = (scan.limits, scan.cloud.strongest(scan.limits.most_walls));
        let mut others = walls.to_vec();
        others.remove(anchor);
        let of_step = |&scale: &f64| {
            // The anchor shares the looks of its line: what lies beside it on the same wall says little.
            let mut weights = weights(walls, scale, limits);
            weights.remove(anchor);
            weights
        };
        let weights: Vec<f64> = scan.scales.iter().flat_map(of_step).collect();
        let each = scan.scales.iter().flat_map(|&scale| others.iter().map(move |wall| wall.height() * scale));
        let heights = each.map(|height_m| height_code(height_m - limits.overshoot_m)).collect();
        let first = |of_step: &[f64]| of_step.iter().take(limits.looked_at_first).sum::<f64>();
        let least = |of_step: &[f64]| limits.least_share * first(of_step);
        let least_met = weights.chunks(others.len().max(1)).map(least).collect();
        let mut rest = weights.clone();
        for of_step in rest.chunks_mut(others.len().max(1)) {
            (1..of_step.len()).rev().for_each(|wall| of_step[wall - 1] += of_step[wall]);
        }
        Tied { anchor: walls[anchor], weights, rest, heights, least_met, others }
    }

    /// Both headings where the side is not known.
    fn turns(&self) -> impl Iterator<Item = f64> + use<> {
        [0.0, std::f64::consts::PI].into_iter().take(if self.anchor.sided { 1 } else { 2 })
    }

    fn at(&self, step: usize) -> StepOf<'_> {
        let range = step * self.others.len()..(step + 1) * self.others.len();
        StepOf {
            weights: &self.weights[range.clone()],
            rest: &self.rest[range.clone()],
            heights: &self.heights[range],
            least_met: self.least_met[step],
        }
    }
}

/// The other walls as they lie about the anchor's middle under a heading, and then a scale; kept from pose to pose.
#[derive(Default)]
struct Laid {
    /// Cells for each sfm unit.
    offsets: Vec<[[f64; 2]; 3]>,
    /// Cells.
    scaled: Vec<[[f64; 2]; 3]>,
    classes: Vec<u64>,
    mean: f64,
    per_sigma: f64,
}

impl Laid {
    fn lay(&mut self, tied: &Tied, heading_rad: f64) {
        let turn = PlanPose { center: [0.0; 2], heading_rad, scale: 1.0 };
        self.offsets.clear();
        self.classes.clear();
        for wall in &tied.others {
            self.offsets.push(PLACES.map(|share| {
                let at = wall.at(share);
                turn.turned([0, 1].map(|k| (at[k] - tied.anchor.middle[k]) / CELL_M))
            }));
            self.classes.push(classes_asked(wall.azimuth() + heading_rad, wall.sided));
        }
        self.scaled.resize(self.offsets.len(), [[0.0; 2]; 3]);
    }

    fn at_scale(&mut self, scale: f64, step: StepOf, chance: &Chance) {
        for (scaled, offset) in self.scaled.iter_mut().zip(&self.offsets) {
            *scaled = offset.map(|place| place.map(|c| c * scale));
        }
        let (mut mean, mut variance) = (0.0, 1.0);
        for ((weight, height), classes) in step.weights.iter().zip(step.heights).zip(&self.classes) {
            let p = chance.of(Question { classes: *classes, height: *height });
            mean += weight * p;
            variance += weight * weight * p * (1.0 - p);
        }
        (self.mean, self.per_sigma) = (mean, 1.0 / f64::sqrt(variance));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::place_search::chance::CellCounts;
    use crate::place_search::city_walls::city_walls;
    use crate::place_search::views::views;
    use crate::planes::{PreparedCity, patches, up_without_start};
    use crate::random::Random;
    use crate::synthetic::{Block, CaptureOptions, Ring};

    #[test]
    fn a_score_is_given_up_only_where_it_could_not_come_above_the_least() {
        let (town, limits) = (Block::town(3, 2, 5), Limits::default());
        let seen = Block::new(town.houses[..6].to_vec());
        let survey = seen.capture(&Ring::street(24).stations(&seen), &CaptureOptions::default());
        let patches = patches(&survey.sfm, None, &limits.patches);
        let uprights = up_without_start(&patches, &limits);
        let cloud = &views(&patches, &uprights, &limits).ok().unwrap()[0].cloud;
        let own = &limits.place_search;
        let walls = city_walls(&PreparedCity::new(town.city().unwrap()), None, &limits);
        let raster = Raster::new(&walls, own);
        let chance = CellCounts::of(&raster, &walls, own).chance();
        let (scales, prior) = ([survey.city_from_sfm.scale], PlacePrior::default());
        let scan = Scan {
            walls: &walls,
            raster: &raster,
            chance: &chance,
            cloud,
            scales: &scales,
            prior: &prior,
            limits: own,
        };
        let tied = Tied::new(&scan, 0);
        let (mut random, mut laid, mut given_up, mut told) = (Random::stream(4, 0), Laid::default(), 0, 0);
        for wall in walls.iter().cycle().take(4000) {
            laid.lay(&tied, angle(wall.normal) - tied.anchor.azimuth());
            laid.at_scale(scales[0], tied.at(0), &chance);
            let at = wall.at(random.unit());
            let whole = scan.z(at, &laid, tied.at(0), f64::NEG_INFINITY);
            for least_z in [0.0, 1.0, 2.0, 4.0] {
                let bounded = scan.z(at, &laid, tied.at(0), least_z);
                assert!(bounded == whole || (bounded.is_none() && whole.is_none_or(|z| z <= least_z + 1e-9)));
                given_up += usize::from(bounded != whole);
                told += usize::from(bounded.is_some_and(|z| z > least_z));
            }
        }
        assert!(given_up > 100 && told > 100, "{given_up} {told}");
    }
}
