//! Accuracy of every minimal solver on random, unscreened instances: the truth is among the poses, every pose satisfies its
//! rows, none comes twice, and there are as many as `mathematics.md` counted.
//!
//! `cargo test --release --test solver_accuracy -- --ignored --nocapture` runs 100,000 instances each.

use cityweld::Similarity;
use cityweld::solvers::scene::{Random, angle_between_rad, relative_residual, sample, up};
use cityweld::solvers::{Row, Sought, Up, solve_minimal};

/// Error of the rotation, in rad, above which the truth counts as missed.
const MISSED_RAD: f64 = 1e-5;

/// Points per plane, average number of real poses on such scenes, and its standard error.
type Expected = (&'static [usize], f64, f64);

const RIGID: [Expected; 10] = [
    (&[3, 2, 1], 4.0, 1e-9),
    (&[3, 1, 1, 1], 2.745, 0.005),
    (&[2, 2, 2], 4.612, 0.007),
    (&[2, 2, 1, 1], 3.469, 0.007),
    (&[2, 1, 1, 1, 1], 3.135, 0.006),
    (&[1, 1, 1, 1, 1, 1], 3.026, 0.006),
    (&[3, 3, 1], 2.0, 1e-9),
    (&[3, 2, 2], 1.0, 1e-9),
    (&[3, 3, 2], 1.0, 1e-9),
    (&[3, 3, 3], 1.0, 1e-9),
];

const SIMILARITY: [Expected; 6] = [
    (&[3, 2, 1, 1], 2.152, 0.003),
    (&[3, 1, 1, 1, 1], 2.060, 0.002),
    (&[2, 2, 2, 1], 2.601, 0.005),
    (&[2, 2, 1, 1, 1], 2.524, 0.005),
    (&[2, 1, 1, 1, 1, 1], 2.585, 0.005),
    (&[1, 1, 1, 1, 1, 1, 1], 2.722, 0.005),
];

const UPRIGHT_RIGID: [Expected; 2] = [(&[2, 1, 1], 2.0, 1e-9), (&[1, 1, 1, 1], 2.0, 1e-9)];

const UPRIGHT_SIMILARITY: [Expected; 2] = [(&[2, 1, 1, 1], 1.526, 0.003), (&[1, 1, 1, 1, 1], 1.565, 0.003)];

fn run(instances: usize) {
    println!(
        "points per plane; poses on average (expected); truth missed; error median, 99.9 %; worst residual; worst |det - 1|; pairs closer than 1e-7"
    );
    for (expected, sought) in [
        (&RIGID[..], (|_| Sought::Rigid) as fn(&Up) -> Sought),
        (&SIMILARITY[..], |_| Sought::Similarity),
        (&UPRIGHT_RIGID[..], |up| Sought::UprightRigid(*up)),
        (&UPRIGHT_SIMILARITY[..], |up| Sought::UprightSimilarity(*up)),
    ] {
        for expected in expected {
            check(expected, sought, instances);
        }
    }
}

#[derive(Default)]
struct Tally {
    errors_rad: Vec<f64>,
    poses: usize,
    poses_sq: usize,
    worst_residual: f64,
    worst_determinant: f64,
    twice: usize,
}

impl Tally {
    fn add(&mut self, rows: &[Row], truth: &Similarity, poses: &[Similarity]) {
        self.poses += poses.len();
        self.poses_sq += poses.len() * poses.len();
        let errors = poses.iter().map(|pose| angle_between_rad(&pose.rotation, &truth.rotation));
        self.errors_rad.push(errors.fold(f64::INFINITY, f64::min));
        for (i, pose) in poses.iter().enumerate() {
            let entries = pose.rotation.matrix().iter().chain(pose.translation.iter());
            assert!(entries.chain([&pose.scale]).all(|v| v.is_finite()) && pose.scale > 0.0);
            self.worst_residual = self.worst_residual.max(relative_residual(rows, pose));
            self.worst_determinant = self.worst_determinant.max((pose.rotation.matrix().determinant() - 1.0).abs());
            let close = |other: &&Similarity| (pose.rotation.matrix() - other.rotation.matrix()).norm() < 1e-7;
            self.twice += poses[..i].iter().filter(close).count();
        }
    }
}

fn check((points, average, standard_error): &Expected, sought: fn(&Up) -> Sought, instances: usize) {
    let mut random = Random::stream(2026, 0);
    let mut tally = Tally::default();
    for _ in 0..instances {
        let sought = sought(&up(&mut random));
        let case = sample(&mut random, &sought, points);
        tally.add(&case.rows, &case.truth, &solve_minimal(&sought, points, &case.rows));
    }
    tally.errors_rad.sort_by(f64::total_cmp);
    let (median, tail) = (tally.errors_rad[instances / 2], tally.errors_rad[instances * 999 / 1000]);
    let missed = tally.errors_rad.iter().filter(|&&error| error > MISSED_RAD).count();
    let mean = tally.poses as f64 / instances as f64;
    let variance = tally.poses_sq as f64 / instances as f64 - mean * mean;
    let band = 3.0 * (variance / instances as f64 + standard_error * standard_error).sqrt();
    println!(
        "{points:?}: {mean:.4} ({average} +- {band:.4}); {missed}; {median:.1e}, {tail:.1e}; {:.1e}; {:.1e}; {}",
        tally.worst_residual, tally.worst_determinant, tally.twice
    );
    assert!(missed as f64 <= 1e-4 * instances as f64, "{points:?}: {missed} of {instances} missed");
    assert!(median < 1e-12 && tail < 1e-6, "{points:?}: {median:e}, {tail:e}");
    assert!(tally.worst_residual < 1e-9, "{points:?}: residual {:e}", tally.worst_residual);
    assert!(tally.worst_determinant < 1e-9 && tally.twice == 0, "{points:?}: {} twice", tally.twice);
    // A pose of a closed form that exists by construction may be lost to rounding at a tangent, once in thousands.
    let band = band.max(1e-3);
    assert!((mean - average).abs() <= band, "{points:?}: {mean} poses on average, expected {average} +- {band}");
}

#[test]
fn every_solver_gives_the_truth_back() {
    run(4_000);
}

#[test]
#[ignore = "a minute of computing; the figures of the README"]
fn every_solver_gives_the_truth_back_a_hundred_thousand_times() {
    run(100_000);
}
