//! The similarity that sources agree on, refined from a start.
//!
//! Method       Gauss-Newton on the rows of all sources, along the directions that they hold. The bend of a source is what makes its median
//!              whitened residual what it should be; it is found by bisection, in turn with the pose

use super::design_effect::design_effect;
use super::rows::{Rows, Source};
use crate::geometry::Similarity;
use crate::merging::pair_limits::FitLimits;
use crate::robust::{Matrix7, MotionParameters, NormalEquations, median};

/// Steps of Gauss-Newton, and turns of pose and bend.
const ROUNDS: usize = 25;
const TURNS: usize = 4;
/// A step smaller than this share of the radius is none.
const CONVERGED: f64 = 1e-10;
/// Halvings of the bend's range, which spans 19 powers of two: to a ten-thousandth per cent.
const HALVINGS: usize = 25;

/// Where a part stands in another, and how far that is known.
#[derive(Clone, Debug)]
pub(in crate::merging) struct Fit {
    pub a_from_b: Similarity,
    pub parameters: MotionParameters,
    /// In the motion's unknowns, a's units.
    pub information: Matrix7,
    /// The leading source's bend, a share of the radius.
    pub bend: f64,
    /// Which observations of the leading source lie within the gate.
    pub inliers: Vec<bool>,
    /// Root mean square distance of the inliers, a's units.
    pub rms: f64,
}

impl Fit {
    pub fn inlier_count(&self) -> usize {
        self.inliers.iter().filter(|i| **i).count()
    }
}

/// A source's answer by itself.
#[derive(Clone, Debug)]
pub(in crate::merging) struct OwnFit {
    /// Its information is less by the design effect.
    pub fit: Fit,
    /// How much more the estimate scatters, as a variance, than its rows say.
    pub design_effect: f64,
}

/// Rows beside those of the leading source.
#[derive(Clone, Copy)]
pub(super) struct Term<'a> {
    pub rows: &'a dyn Rows,
    /// Times the weight that the rows have by themselves.
    pub factor: f64,
}

/// What a pose is fitted to: the leading source gives the middle, the inliers and what is told of them.
#[derive(Clone, Copy)]
pub(super) struct Sources<'a> {
    pub lead: &'a dyn Source,
    pub others: &'a [Term<'a>],
}

impl Sources<'_> {
    fn equations(&self, pose: &Similarity, parameters: &MotionParameters) -> NormalEquations {
        let mut sums = NormalEquations::default();
        self.lead.add_rows(pose, parameters, 1.0, &mut sums);
        self.others.iter().for_each(|term| term.rows.add_rows(pose, parameters, term.factor, &mut sums));
        sums
    }

    /// The optimum beside a start.
    pub fn refine(&self, start: &Similarity) -> Similarity {
        let mut pose = *start;
        for _ in 0..ROUNDS {
            let parameters = self.lead.parameters(&pose);
            let step = parameters.step(&self.equations(&pose, &parameters), parameters.radius);
            pose = parameters.moved(&pose, &step);
            if step.norm() < CONVERGED * parameters.radius {
                break;
            }
        }
        pose
    }

    /// What is to be told of an optimum.
    pub fn finish(&self, a_from_b: Similarity, limits: &FitLimits) -> Fit {
        let parameters = self.lead.parameters(&a_from_b);
        let mut information = self.equations(&a_from_b, &parameters).full();
        let own = Term { rows: self.lead, factor: 1.0 };
        for term in [own].iter().chain(self.others) {
            if let Some(noise) = term.rows.noise(&a_from_b, &parameters) {
                information = without(&information, &(noise * term.factor));
            }
        }
        let gate_sq = limits.gate_sigmas.powi(2);
        let misses = self.lead.misses(&a_from_b);
        let inliers: Vec<bool> = misses.iter().map(|m| m.whitened_sq < gate_sq).collect();
        let inside = misses.iter().filter(|m| m.whitened_sq < gate_sq);
        let (sum, count) = inside.fold((0.0, 0usize), |(sum, count), m| (sum + m.distance_sq, count + 1));
        let rms = (sum / count.max(1) as f64).sqrt();
        Fit { a_from_b, parameters, information, bend: self.lead.bend(), inliers, rms }
    }
}

/// Settles a source by itself: its pose and its bend in turn, from the bend that it has.
pub(super) fn settle(source: &mut impl Source, start: &Similarity, limits: &FitLimits) -> Similarity {
    let mut pose = *start;
    for _ in 0..TURNS {
        pose = Sources { lead: source, others: &[] }.refine(&pose);
        find_bend(source, &pose, limits);
    }
    Sources { lead: source, others: &[] }.refine(&pose)
}

/// The same from a pose that is known well enough to tell the bend.
pub(super) fn settle_near(source: &mut impl Source, start: &Similarity, limits: &FitLimits) -> OwnFit {
    find_bend(source, start, limits);
    let pose = settle(source, start, limits);
    own_fit(source, pose, limits)
}

/// What a source says by itself at its optimum.
pub(super) fn own_fit(source: &dyn Source, pose: Similarity, limits: &FitLimits) -> OwnFit {
    let mut fit = Sources { lead: source, others: &[] }.finish(pose, limits);
    let design_effect = design_effect(&source.placed(&pose, &fit.parameters), limits.least_effect);
    fit.information /= design_effect;
    OwnFit { fit, design_effect }
}

fn find_bend(source: &mut impl Source, pose: &Similarity, limits: &FitLimits) {
    let (mut low, mut high) = (limits.least_bend, limits.most_bend);
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        source.set_bend(middle);
        let mut sizes: Vec<f64> = source.misses(pose).iter().map(|m| m.whitened_sq.sqrt()).collect();
        if median(&mut sizes).is_some_and(|m| m > source.median_size()) {
            low = middle;
        } else {
            high = middle;
        }
    }
    source.set_bend(high);
}

/// Information less what is noise; nothing where less than nothing is left. Many nearly parallel planes would otherwise seem to hold
/// what they leave free.
fn without(information: &Matrix7, noise: &Matrix7) -> Matrix7 {
    let eigen = (information - noise).symmetric_eigen();
    let kept = Matrix7::from_diagonal(&eigen.eigenvalues.map(|v| v.max(0.0)));
    let rest = eigen.eigenvectors * kept * eigen.eigenvectors.transpose();
    (rest + rest.transpose()) * 0.5
}
