//! Which way is up in the reconstruction: what the start, walls and floors, and the cameras say of it together.
//!
//! Question     the directions that up may have in the sfm frame, and how surely
//! Input        patches, the cameras' rotations, the start's up and how far it may be off
//! Output       [`UpChoice`]: the directions to search under, or that nothing but the start is known
//! Method       1. the share of patches and cameras that are for it grades a grid of directions within the start's reach;
//!              2. the best are polished by reweighted least squares, all voters and the start together; the start stays a
//!                 Gaussian about what it said, wherever the polish has come to;
//!              3. all distinct optima of comparable support are told: a facade that is seen from the street is the same
//!                 geometry as a floor seen from the air, and the sides of a box are alike.
//!              The sigma is that of the worse held axis, of voters and start together: walls of one direction leave the lean
//!              along them to the cameras, and these the lean in which they look to the walls.
//! Fails when   there are neither walls, floors nor cameras: then the start's up comes back with its own sigma

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use super::patches::Patches;
use super::up_votes::UpSupport;
use crate::geometry::{Matrix3, Rotation3, Vector3};
use crate::limits::Limits;

/// Up in the sfm frame.
#[derive(Clone, Copy, Debug)]
pub struct Upright {
    pub up: Vector3<f64>,
    /// About the worse held of the horizontal axes.
    pub sigma_rad: f64,
    /// Whether a search may take it for granted.
    pub known: bool,
}

/// A direction that up may have, and who is for it.
#[derive(Clone, Copy, Debug)]
pub struct UpCandidate {
    pub up: Vector3<f64>,
    /// About the worse held of the horizontal axes; of walls, floors, cameras and start together.
    pub sigma_rad: f64,
    /// Share of the walls and floors that are for it, 0 to 1.
    pub patches: f64,
    /// Share of the cameras that are for it, 0 to 1.
    pub cameras: f64,
    /// How far it is from the start's up, in sigmas of the start.
    pub off_start: f64,
}

/// How to search.
#[derive(Clone, Debug)]
pub enum UpChoice {
    /// Under each of these, the best supported first; one at least.
    Known(Vec<Upright>),
    /// Free to turn as far as the start may lean.
    Free(Upright),
}

/// A start that claims to be exact is still only as good as this.
const SMALLEST_SIGMA_RAD: f64 = 1e-4;
/// Directions of the grid are this far apart: one of them lies within half a kernel of every optimum.
const STEP_RAD: f64 = 0.03;
/// Nearer than this one polish serves for both.
const SEEDS_APART_RAD: f64 = 0.09;
/// An optimum that holds one axis only is a great circle, of 35 seeds; there is room for others beside it.
const MOST_SEEDS: usize = 60;
const MOST_STEPS: usize = 15;
/// What lies further off no kernel has seen.
const LONGEST_STEP_RAD: f64 = 0.2;
/// Decides how to search, from the start's up and its sigma on.
pub fn choose_up(patches: &Patches, start: &Upright, limits: &Limits) -> UpChoice {
    let candidates = up_candidates(patches, start, limits);
    // To search under some would leave out others that are as likely.
    let all_known = candidates.iter().all(|c| c.sigma_rad <= limits.up.known_sigma_rad);
    if candidates.is_empty() || candidates.len() > limits.up.most_known || !all_known {
        return UpChoice::Free(Upright { known: false, ..*start });
    }
    let upright = |c: UpCandidate| Upright { up: c.up, sigma_rad: c.sigma_rad, known: true };
    UpChoice::Known(candidates.into_iter().map(upright).collect())
}

/// The up that walls, floors and cameras are for, where it lies beyond the start's reach and nothing within is comparable.
pub fn up_beyond_start(patches: &Patches, start: &Upright, limits: &Limits) -> Option<UpCandidate> {
    let anywhere = Upright { sigma_rad: PI, ..*start };
    let best = up_candidates(patches, &anywhere, limits).into_iter().next()?;
    let support = |c: &UpCandidate| c.patches + c.cameras;
    let within = up_candidates(patches, start, limits).iter().map(support).fold(0.0, f64::max);
    let off_start = start.up.angle(&best.up) / start.sigma_rad.max(SMALLEST_SIGMA_RAD);
    let is_beyond = off_start > limits.reach_sigmas && within < limits.up.comparable_share * support(&best);
    is_beyond.then_some(UpCandidate { off_start, ..best })
}

/// The directions that walls, floors, cameras and start together allow, the best supported first.
pub fn up_candidates(patches: &Patches, start: &Upright, limits: &Limits) -> Vec<UpCandidate> {
    let evidence = Evidence {
        patches: UpSupport::of_patches(patches, &limits.up),
        cameras: UpSupport::of_cameras(&patches.cam_from_sfm_rotations, &limits.up),
        start: Upright { sigma_rad: start.sigma_rad.max(SMALLEST_SIGMA_RAD), ..*start },
        limits: *limits,
    };
    let polished: Vec<Optimum> = evidence.seeds().into_par_iter().map(|up| evidence.polished(up)).collect();
    let within_reach = |o: &Optimum| evidence.off_start(&o.up) <= limits.reach_sigmas;
    let mut optima: Vec<Optimum> = polished.into_iter().filter(within_reach).collect();
    optima.sort_by(|a, b| b.support.total_cmp(&a.support));
    let mut distinct: Vec<Optimum> = Vec::new();
    for optimum in optima {
        let least = distinct.first().map_or(f64::NEG_INFINITY, |best| limits.up.comparable_share * best.support);
        if optimum.support >= least && distinct.iter().all(|d| d.differs_from(&optimum, limits.up.distinct_sigmas)) {
            distinct.push(optimum);
        }
    }
    let told = |o: Optimum| UpCandidate {
        up: o.up,
        sigma_rad: o.tangent().worst_variance().sqrt(),
        patches: evidence.patches.share(&o.up),
        cameras: evidence.cameras.share(&o.up),
        off_start: evidence.off_start(&o.up),
    };
    distinct.into_iter().map(told).collect()
}

/// The directions that cameras alone allow, from how they were held; the best supported first.
pub fn up_of_cameras(cam_from_sfm: &[Rotation3<f64>], limits: &Limits) -> Vec<UpCandidate> {
    let held = cam_from_sfm.iter().map(|r| -r.matrix().row(1).transpose()).sum::<Vector3<f64>>();
    let guess = Upright { up: held.try_normalize(0.0).unwrap_or_else(Vector3::z), sigma_rad: PI, known: false };
    let patches = Patches { cam_from_sfm_rotations: cam_from_sfm.to_vec(), ..Patches::default() };
    up_candidates(&patches, &guess, limits)
}

struct Evidence {
    patches: UpSupport,
    cameras: UpSupport,
    start: Upright,
    limits: Limits,
}

impl Evidence {
    fn off_start(&self, up: &Vector3<f64>) -> f64 {
        self.start.up.angle(up) / self.start.sigma_rad
    }

    fn support(&self, up: &Vector3<f64>) -> f64 {
        self.patches.share(up) + self.cameras.share(up) - self.limits.up.cost_of_leaving * self.off_start(up).powi(2)
    }

    /// Directions to polish, the best supported first.
    fn seeds(&self) -> Vec<Vector3<f64>> {
        let mut graded: Vec<(f64, Vector3<f64>)> =
            self.grid().into_par_iter().map(|up| (self.support(&up), up)).collect();
        graded.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut seeds: Vec<Vector3<f64>> = Vec::new();
        for (_, up) in graded {
            if seeds.len() < MOST_SEEDS && seeds.iter().all(|s| s.angle(&up) > SEEDS_APART_RAD) {
                seeds.push(up);
            }
        }
        seeds
    }

    /// Directions within the start's reach, evenly on rings about its up.
    fn grid(&self) -> Vec<Vector3<f64>> {
        let at_start = Tangent::across(&self.start.up, &Matrix3::zeros());
        let reach = (self.limits.reach_sigmas * self.start.sigma_rad).min(PI);
        let mut grid = Vec::new();
        for ring in 0..=(reach / STEP_RAD).ceil() as usize {
            let (sin, cos) = (ring as f64 * STEP_RAD).min(reach).sin_cos();
            let count = (TAU * sin / STEP_RAD).ceil().max(1.0) as usize;
            for k in 0..count {
                let (s, c) = (TAU * k as f64 / count as f64).sin_cos();
                grid.push(cos * self.start.up + sin * (c * at_start.axes[0] + s * at_start.axes[1]));
            }
        }
        grid
    }

    /// Reweighted least squares of all voters and the start, from `up` on.
    fn polished(&self, mut up: Vector3<f64>) -> Optimum {
        let prior = self.start.sigma_rad.powi(-2);
        let mut information = Matrix3::zeros();
        for _ in 0..MOST_STEPS {
            let of_voters = self.patches.information(&up) + self.cameras.information(&up);
            information = of_voters + Matrix3::identity() * prior;
            // Along the arc to the start's up, so that a far start pulls by its distance.
            let arc = (self.start.up - up * up.dot(&self.start.up)).try_normalize(0.0).unwrap_or_default();
            let pull = arc * self.start.up.angle(&up) * prior - of_voters * up;
            let step = Tangent::across(&up, &information).solved(&pull);
            let step = step * (LONGEST_STEP_RAD / step.norm()).min(1.0);
            up = (up + step).normalize();
            if step.norm() < 1e-9 {
                break;
            }
        }
        Optimum { up, information, support: self.support(&up) }
    }
}

/// An up that those about it do not better.
struct Optimum {
    up: Vector3<f64>,
    /// Of voters and start, 1 / rad^2.
    information: Matrix3<f64>,
    support: f64,
}

impl Optimum {
    fn tangent(&self) -> Tangent {
        Tangent::across(&self.up, &self.information)
    }

    fn differs_from(&self, other: &Optimum, sigmas: f64) -> bool {
        let Some(along) = (other.up - self.up).try_normalize(0.0) else { return false };
        let variance = |o: &Optimum| along.dot(&o.tangent().solved(&along));
        self.up.angle(&other.up) > sigmas * (variance(self) + variance(other)).sqrt()
    }
}

/// A quadratic form restricted to the plane across up.
struct Tangent {
    axes: [Vector3<f64>; 2],
    /// h11, h12, h22.
    form: [f64; 3],
}

impl Tangent {
    fn across(up: &Vector3<f64>, form: &Matrix3<f64>) -> Tangent {
        let mut axis = Vector3::zeros();
        axis[up.iamin()] = 1.0;
        let e1 = up.cross(&axis).normalize();
        let e2 = up.cross(&e1);
        Tangent { axes: [e1, e2], form: [e1.dot(&(form * e1)), e1.dot(&(form * e2)), e2.dot(&(form * e2))] }
    }

    /// The vector across up that the form maps to `b`.
    fn solved(&self, b: &Vector3<f64>) -> Vector3<f64> {
        let ([e1, e2], [h11, h12, h22]) = (self.axes, self.form);
        let (b1, b2) = (e1.dot(b), e2.dot(b));
        let det = (h11 * h22 - h12 * h12).max(f64::MIN_POSITIVE);
        e1 * ((h22 * b1 - h12 * b2) / det) + e2 * ((h11 * b2 - h12 * b1) / det)
    }

    /// The variance about the worse held axis, where the form is information.
    fn worst_variance(&self) -> f64 {
        let [h11, h12, h22] = self.form;
        let least = (h11 + h22) / 2.0 - ((h11 - h22) / 2.0).hypot(h12);
        1.0 / least.max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests;
