//! Progress that a caller is told, and work that a caller ends.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use cityweld::steps::{JoinOptions, Part, join};
use cityweld::synthetic::{Block, CloudOptions, Offset, Survey, sfm_from_city};
use cityweld::types::MergeError;
use cityweld::{AlignOptions, Alignment, Cancelled, Error, Observer, PreparedCity, Stage, Start, Up, Verdict, align};

fn block() -> Block {
    Block::four_houses().with_ground()
}

fn survey() -> Survey {
    block().cloud(&CloudOptions { points_on_ground: 500, seed: 5, ..CloudOptions::default() })
}

fn start() -> Start {
    let off = Offset { shift_m: [5.0, -5.0, 1.5], ..Offset::default() };
    Start::with_default_sigmas(block().off(&off) * sfm_from_city().inverse())
}

fn run(start: Start, observer: &dyn Observer) -> Result<Alignment, Cancelled> {
    let city = PreparedCity::new(block().city().unwrap());
    align(&city, &survey().sfm, None, &AlignOptions::new(start).with_up(Up::Auto), observer)
}

/// Notes the stages, and asks for the end at one of them.
#[derive(Default)]
struct Watch {
    seen: Mutex<Vec<(Stage, usize, usize)>>,
    end_at: Option<Stage>,
    asked: AtomicUsize,
}

impl Observer for Watch {
    fn progress(&self, stage: Stage, done: usize, all: usize) {
        self.seen.lock().unwrap().push((stage, done, all));
    }

    fn is_cancelled(&self) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed);
        let seen = self.seen.lock().unwrap();
        self.end_at.is_some_and(|stage| seen.iter().any(|(seen, ..)| *seen == stage))
    }
}

impl Watch {
    fn stages(&self) -> Vec<Stage> {
        let mut stages: Vec<Stage> = self.seen.lock().unwrap().iter().map(|(stage, ..)| *stage).collect();
        stages.dedup();
        stages
    }
}

#[test]
fn an_observer_is_told_the_stages_in_their_order_and_how_far_the_search_is() {
    let watch = Watch::default();
    let alignment = run(start(), &watch).unwrap();
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    assert_eq!(watch.stages(), [Stage::Patches, Stage::City, Stage::Search, Stage::Evidence]);
    let seen = watch.seen.lock().unwrap();
    let samples: Vec<usize> = seen.iter().filter(|(s, ..)| *s == Stage::Search).map(|(_, done, _)| *done).collect();
    assert!(!samples.is_empty() && samples.is_sorted(), "{samples:?}");
    assert!(seen.iter().all(|(_, done, all)| done <= all), "{seen:?}");
}

#[test]
fn work_ends_at_whatever_stage_an_observer_asks_for_it() {
    for end_at in [Stage::Patches, Stage::Search, Stage::Evidence] {
        let watch = Watch { end_at: Some(end_at), ..Watch::default() };
        let error = run(start(), &watch).unwrap_err();
        assert_eq!((error, watch.stages().last()), (Cancelled, Some(&end_at)));
        assert!(watch.asked.load(Ordering::Relaxed) > 0);
        assert!(matches!(Error::from(error), Error::Cancelled(_)));
    }
}

#[test]
fn a_search_that_is_ended_draws_no_more_than_a_round_of_samples() {
    let watch = Watch { end_at: Some(Stage::Search), ..Watch::default() };
    run(start(), &watch).unwrap_err();
    let seen = watch.seen.lock().unwrap();
    assert_eq!(seen.iter().filter(|(stage, ..)| *stage == Stage::Search).count(), 1, "{seen:?}");
}

#[test]
fn there_is_a_transform_only_where_the_verdict_is_aligned() {
    let aligned = run(start(), &()).unwrap();
    assert_eq!(aligned.transform(), aligned.best_candidate.as_ref());
    assert!(aligned.transform().is_some());
    // Somewhere else: whatever is found there is no transform.
    let far = Offset { shift_m: [300.0, 0.0, 0.0], ..Offset::default() };
    let start = Start::with_default_sigmas(block().off(&far) * sfm_from_city().inverse());
    let failed = run(start, &()).unwrap();
    assert_eq!((failed.verdict, failed.transform()), (Verdict::Failed, None));
}

#[test]
fn joining_ends_when_an_observer_asks_for_it() {
    let part = |name: &str| Part { name: name.to_owned(), sfm: survey().sfm, superpixels: None, anchor: None };
    let watch = Watch { end_at: Some(Stage::ComparingParts), ..Watch::default() };
    let error = join(&[part("one"), part("other")], &JoinOptions::default(), &watch).unwrap_err();
    assert!(matches!(error, MergeError::Cancelled(_)), "{error}");
    assert_eq!(watch.stages(), [Stage::ComparingParts]);
}
