//! The paper's Table 1 beside ours: solutions, average number of real poses, time per sample.
//!
//! `cargo run --release --example table1 [INSTANCES]`

use cityweld::solvers::scene::{Random, angle_between_rad, sample, up};
use cityweld::solvers::{Row, Sought, solve_minimal};
use std::hint::black_box;
use std::time::Instant;

/// The paper's figures: solutions, and average number of real ones where it gives one; blank where it has no row.
fn paper(points_per_plane: &[usize]) -> (&'static str, &'static str) {
    match points_per_plane {
        [3, 2, 1] => ("4", "4"),
        [3, 1, 1, 1] => ("4", "2.8"),
        [2, 2, 2] => ("8", "4.4"),
        [2, 2, 1, 1] => ("8", "3.6"),
        [2, 1, 1, 1, 1] | [1, 1, 1, 1, 1, 1] => ("16", "5.8"),
        [3, 3, _] | [3, 2, 2] => ("2", ""),
        _ => ("", ""),
    }
}

struct Line {
    most: usize,
    average: f64,
    missed: usize,
    median_rad: f64,
    microseconds: f64,
}

fn main() {
    let instances = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(20_000);
    let up = up(&mut Random::stream(2, 0));
    let families = [
        ("rigid", Sought::Rigid),
        ("similarity", Sought::Similarity),
        ("rigid, vertical known", Sought::UprightRigid(up)),
        ("similarity, vertical known", Sought::UprightSimilarity(up)),
    ];
    println!(
        "| points per plane | paper: solutions | real | ours: most | real | truth missed | median error, rad | µs |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, sought) in families {
        for configuration in sought.configurations() {
            let points = configuration.points_per_plane;
            let line = measure(points, &sought, instances);
            let (solutions, real) = paper(points);
            println!(
                "| {name} {points:?} | {solutions} | {real} | {} | {:.3} | {} of {instances} | {:.1e} | {:.3} |",
                line.most, line.average, line.missed, line.median_rad, line.microseconds
            );
        }
    }
}

fn measure(points_per_plane: &[usize], sought: &Sought, instances: usize) -> Line {
    let mut random = Random::stream(1, 0);
    let mut errors = Vec::with_capacity(instances);
    let (mut most, mut total) = (0, 0);
    let mut timed = Vec::new();
    for _ in 0..instances {
        let case = sample(&mut random, sought, points_per_plane);
        let poses = solve_minimal(sought, points_per_plane, &case.rows);
        most = most.max(poses.len());
        total += poses.len();
        let error = poses.iter().map(|pose| angle_between_rad(&pose.rotation, &case.truth.rotation));
        errors.push(error.fold(f64::INFINITY, f64::min));
        if timed.len() < 1000 {
            timed.push(case.rows);
        }
    }
    errors.sort_by(f64::total_cmp);
    Line {
        most,
        average: total as f64 / instances as f64,
        missed: errors.iter().filter(|&&e| e > 1e-5).count(),
        median_rad: errors[instances / 2],
        microseconds: microseconds(sought, points_per_plane, &timed),
    }
}

/// Time per sample: the fastest of many rounds, so that other work on the machine does not count.
fn microseconds(sought: &Sought, points_per_plane: &[usize], samples: &[Vec<Row>]) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..200 {
        let start = Instant::now();
        for rows in samples {
            black_box(solve_minimal(sought, points_per_plane, black_box(rows)));
        }
        best = best.min(start.elapsed().as_secs_f64() * 1e6 / samples.len() as f64);
    }
    best
}
