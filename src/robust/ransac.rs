//! The robust loop: hypotheses from minimal samples, ranked by a score, distinct to the end.
//!
//! Question     which poses explain the data best, given that most correspondences are wrong?
//! Input        a [`Problem`]: it draws a sample and solves it, scores a pose, improves it, and tells two poses apart
//! Output       the best distinct poses, best first, and how often each was found
//! Method       random consensus (Fischler and Bolles 1981) in blocks with a random stream each; blocks run in parallel and are
//!              merged in their order, so that the number of threads changes nothing. The best of a block are improved, and ranked
//!              by what they score then (local optimisation: Chum, Matas and Kittler 2003). Instead of an inlier ratio, which
//!              symmetric cities make meaningless, it stops when the leader has been found from enough independent samples.

use rayon::prelude::*;

use crate::random::Random;

/// What the loop has to know of a problem.
pub trait Problem: Sync {
    type Pose: Clone + Send + Sync;

    /// Draws one minimal sample and appends the poses that solve it, if any.
    fn hypothesize(&self, random: &mut Random, poses: &mut Vec<Self::Pose>);

    /// How well a pose explains the data; greater is better.
    fn score(&self, pose: &Self::Pose) -> f64;

    /// The score, if it is `least` or more: what is less may be given up as soon as that is known.
    fn score_from(&self, pose: &Self::Pose, least: f64) -> Option<f64> {
        Some(self.score(pose)).filter(|score| *score >= least)
    }

    /// A pose moved to where it explains the data best, and its score there, by which poses are ranked.
    fn improve(&self, score: f64, pose: Self::Pose) -> (f64, Self::Pose) {
        (score, pose)
    }

    /// True where two poses are one place of the search, for which one attempt at improvement is enough.
    fn same(&self, a: &Self::Pose, b: &Self::Pose) -> bool;
}

/// How long to search and what to keep.
#[derive(Clone, Copy, Debug)]
pub struct RansacOptions {
    pub seed: u64,
    /// Distinct poses kept.
    pub keep: usize,
    /// Poses of each block of 64 samples that are improved and go on.
    pub best_of_block: usize,
    /// Samples drawn at least and at most; rounded up to whole rounds.
    pub fewest_samples: usize,
    pub most_samples: usize,
    /// The search ends once the leader has been found this often.
    pub enough_hits: usize,
}

/// A pose with its score.
#[derive(Clone, Debug)]
pub struct Ranked<P> {
    pub pose: P,
    pub score: f64,
    /// Samples that led to the same place with at least `HIT_SHARE` of the score.
    pub hits: usize,
}

/// Samples of one random stream.
const BLOCK: usize = 64;
/// Blocks between two looks at the stopping rule; fixed, so that threads do not change it.
const ROUND: usize = 32;
/// A hypothesis confirms a better one when it scores at least this share of it.
const HIT_SHARE: f64 = 0.7;

/// Runs the loop. The result is sorted by falling score. `should_continue` is told how many samples were drawn, and whether
/// the loop goes on is for it to say.
pub fn ransac<P: Problem>(
    problem: &P,
    options: &RansacOptions,
    mut should_continue: impl FnMut(usize) -> bool,
) -> (Vec<Ranked<P::Pose>>, usize) {
    let mut kept: Vec<Ranked<P::Pose>> = Vec::new();
    let mut samples = 0;
    let mut block = 0u64;
    while samples < options.most_samples {
        let found: Vec<Vec<(f64, P::Pose)>> =
            (0..ROUND as u64).into_par_iter().map(|b| best_of_block(problem, options, block + b)).collect();
        block += ROUND as u64;
        samples += ROUND * BLOCK;
        for (score, pose) in found.into_iter().flatten() {
            insert(problem, &mut kept, options.keep, pose, score);
        }
        let is_sure = kept.first().is_some_and(|k| k.hits >= options.enough_hits);
        if !should_continue(samples) || samples >= options.fewest_samples && is_sure {
            break;
        }
    }
    (kept, samples)
}

/// The best poses of a block of samples, improved.
fn best_of_block<P: Problem>(problem: &P, options: &RansacOptions, block: u64) -> Vec<(f64, P::Pose)> {
    let mut random = Random::stream(options.seed, block);
    let mut poses = Vec::new();
    let mut best: Vec<(f64, P::Pose)> = Vec::with_capacity(options.best_of_block + 1);
    for _ in 0..BLOCK {
        poses.clear();
        problem.hypothesize(&mut random, &mut poses);
        for pose in poses.drain(..) {
            let is_full = best.len() == options.best_of_block;
            let least = best.last().filter(|_| is_full).map_or(f64::NEG_INFINITY, |(score, _)| *score);
            if let Some(score) = problem.score_from(&pose, least).filter(|score| score.is_finite()) {
                best.insert(best.partition_point(|(better, _)| *better >= score), (score, pose));
                best.truncate(options.best_of_block);
            }
        }
    }
    best.into_iter().map(|(score, pose)| problem.improve(score, pose)).collect()
}

/// Puts a pose in its place by score, unless it is one of those that are there.
fn insert<P: Problem>(problem: &P, kept: &mut Vec<Ranked<P::Pose>>, keep: usize, pose: P::Pose, score: f64) {
    let mut hits = 1;
    if let Some(i) = kept.iter().position(|k| problem.same(&k.pose, &pose)) {
        if score <= kept[i].score {
            kept[i].hits += usize::from(score >= HIT_SHARE * kept[i].score);
            return;
        }
        hits += if kept[i].score >= HIT_SHARE * score { kept[i].hits } else { 0 };
        kept.remove(i);
    }
    let place = kept.partition_point(|k| k.score >= score);
    if place < keep {
        kept.insert(place, Ranked { pose, score, hits });
        kept.truncate(keep);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best integer near 500, hit by one sample in ten.
    struct Guess;

    impl Problem for Guess {
        type Pose = i64;

        fn hypothesize(&self, random: &mut Random, poses: &mut Vec<i64>) {
            poses.push(random.below(1000) as i64);
        }

        fn score(&self, pose: &i64) -> f64 {
            1000.0 - (pose - 500).abs() as f64
        }

        fn same(&self, a: &i64, b: &i64) -> bool {
            (a - b).abs() < 5
        }
    }

    const OPTIONS: RansacOptions = RansacOptions {
        seed: 3,
        keep: 10,
        best_of_block: 10,
        fewest_samples: 1000,
        most_samples: 20_000,
        enough_hits: usize::MAX,
    };

    #[test]
    fn ranks_distinct_poses() {
        let (found, samples) = ransac(&Guess, &OPTIONS, |_| true);
        assert!(samples >= 20_000 && found[0].pose == 500);
        assert!(found.windows(2).all(|w| w[0].score >= w[1].score));
        assert!(found.iter().skip(1).all(|k| (k.pose - 500).abs() >= 5));
    }

    /// A guess whose score is told in full, whatever counts.
    struct Patient;

    impl Problem for Patient {
        type Pose = i64;

        fn hypothesize(&self, random: &mut Random, poses: &mut Vec<i64>) {
            Guess.hypothesize(random, poses);
        }

        fn score(&self, pose: &i64) -> f64 {
            Guess.score(pose)
        }

        fn score_from(&self, pose: &i64, _: f64) -> Option<f64> {
            Some(self.score(pose))
        }

        fn same(&self, a: &i64, b: &i64) -> bool {
            Guess.same(a, b)
        }
    }

    #[test]
    fn scores_that_are_given_up_early_change_nothing() {
        let told = |found: Vec<Ranked<i64>>| found.iter().map(|k| (k.pose, k.score, k.hits)).collect::<Vec<_>>();
        assert_eq!(told(ransac(&Guess, &OPTIONS, |_| true).0), told(ransac(&Patient, &OPTIONS, |_| true).0));
    }

    #[test]
    fn gives_the_same_for_any_number_of_threads() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| ransac(&Guess, &OPTIONS, |_| true).0.iter().map(|k| k.pose).collect::<Vec<_>>())
        };
        assert_eq!(run(1), run(3));
    }
}
