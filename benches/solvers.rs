//! Time per sample of every minimal solver: all poses, one thread, random scenes of the paper's section 5.
//!
//! `cargo bench --bench solvers`

use cityweld::solvers::scene::{Random, sample, up};
use cityweld::solvers::{Row, Sought, solve_minimal};
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;

/// Samples that a measurement goes round, so that no branch is learned by heart.
const SAMPLES: usize = 1000;

fn bench(criterion: &mut Criterion) {
    let up = up(&mut Random::stream(2, 0));
    let families = [
        ("rigid", Sought::Rigid),
        ("similarity", Sought::Similarity),
        ("upright rigid", Sought::UprightRigid(up)),
        ("upright similarity", Sought::UprightSimilarity(up)),
    ];
    for (name, sought) in families {
        for configuration in sought.configurations() {
            measure(criterion, name, configuration.points_per_plane, &sought);
        }
    }
}

fn measure(criterion: &mut Criterion, name: &str, points_per_plane: &[usize], sought: &Sought) {
    let mut random = Random::stream(1, 0);
    let samples: Vec<Vec<Row>> = (0..SAMPLES).map(|_| sample(&mut random, sought, points_per_plane).rows).collect();
    let mut next = 0;
    criterion.bench_function(&format!("{name} {points_per_plane:?}"), |bencher| {
        bencher.iter(|| {
            next = (next + 1) % SAMPLES;
            solve_minimal(sought, points_per_plane, black_box(&samples[next]))
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(700)).sample_size(40);
    targets = bench
}
criterion_main!(benches);
