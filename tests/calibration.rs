//! A short calibration: few captures of the long run's kind (`docs/calibration.md`), always the same, with bounds that can fail.

#[path = "../examples/calibration/runs.rs"]
mod runs;

use cityweld::Verdict;
use cityweld::synthetic::{Errand, Outcome, Setting};
use rayon::prelude::*;
use std::sync::OnceLock;

use runs::{Questions, Run, runs_of};

const SEED: u64 = 20;
const CAPTURES: u64 = 40;

// Where the program stands; where it should stand is in `docs/calibration.md`. Evidence in bits took wrong poses away, and right ones
// of few planes with them; honest sigmas made one that was `aligned` `undetermined`.
/// Of 103 runs, 31 of them at the right place.
const FEWEST_ALIGNED: usize = 11;
const MOST_WITHHELD: usize = 13;
const LEAST_PERCENT_INSIDE: usize = 50;

/// All runs, made once.
fn all() -> &'static [Run] {
    static RUNS: OnceLock<Vec<Run>> = OnceLock::new();
    RUNS.get_or_init(|| {
        let made: Vec<Vec<Run>> =
            (0..CAPTURES).into_par_iter().map(|index| runs_of(SEED, index, Questions::ALL)).collect();
        made.into_iter().flatten().collect()
    })
}

/// Those of an outcome, told by name.
fn of(outcomes: &[Outcome], among: impl Fn(&Run) -> bool) -> Vec<String> {
    let counts = |run: &&Run| outcomes.contains(&run.assessment.outcome()) && among(run);
    all().iter().filter(counts).map(Run::line).collect()
}

fn at_right_place(run: &Run) -> bool {
    run.errand == Errand::RightPlace && Setting::TOLD_APART.contains(&run.setting)
}

#[test]
fn nothing_that_is_grossly_wrong_is_called_aligned() {
    let gross = of(&[Outcome::AlignedGross], |_| true);
    assert!(gross.is_empty(), "{gross:#?}");
}

#[test]
fn no_aligned_pose_is_wrong_and_some_are_aligned() {
    let wrong = of(&[Outcome::AlignedWrong, Outcome::AlignedGross], |_| true);
    let aligned = all().iter().filter(|run| run.assessment.verdict == Verdict::Aligned).count();
    assert!(aligned >= FEWEST_ALIGNED, "{aligned}");
    assert!(wrong.is_empty(), "of {aligned}: {wrong:#?}");
}

#[test]
fn most_right_poses_are_not_withheld() {
    let withheld = of(&[Outcome::AmbiguousRight, Outcome::FailedRight], at_right_place);
    let given = of(&[Outcome::AlignedRight, Outcome::UndeterminedRight], at_right_place);
    assert!(withheld.len() <= MOST_WITHHELD, "beside {} given: {withheld:#?}", given.len());
}

#[test]
fn what_is_said_to_be_held_is_held() {
    let wrong = of(&[Outcome::UndeterminedWrong], |_| true);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn errors_lie_within_their_sigmas() {
    let told: Vec<&Run> = all().iter().filter(|run| at_right_place(run) && run.assessment.tells_sigmas()).collect();
    let inside = told.iter().filter(|run| run.assessment.band().is_eq()).count();
    let above: Vec<String> = told.iter().filter(|run| run.assessment.band().is_gt()).map(|run| run.line()).collect();
    assert!(inside * 100 >= LEAST_PERCENT_INSIDE * told.len(), "{inside} of {}; above: {above:#?}", told.len());
}
