//! Time per sample of every minimal solver: all poses, one thread, random scenes of the paper's section 5.
//!
//! `cargo bench --bench solvers`

use cityweld::solvers::scene::{Chance, sample, up};
use cityweld::solvers::{Row, Sought, Up, solve_minimal};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use std::hint::black_box;

/// Samples that a measurement goes round, so that no branch is learned by heart.
const SAMPLES: usize = 1000;

fn bench(criterion: &mut Criterion) {
    for points in cityweld::solvers::RIGID {
        measure(criterion, "rigid", points, |_| Sought::Rigid);
    }
    for points in cityweld::solvers::SIMILARITY {
        measure(criterion, "similarity", points, |_| Sought::Similarity);
    }
    for points in cityweld::solvers::UPRIGHT_RIGID {
        measure(criterion, "upright rigid", points, |up| Sought::UprightRigid(*up));
    }
    for points in cityweld::solvers::UPRIGHT_SIMILARITY {
        measure(criterion, "upright similarity", points, |up| Sought::UprightSimilarity(*up));
    }
}

fn measure(criterion: &mut Criterion, name: &str, points_per_plane: &[usize], sought: fn(&Up) -> Sought) {
    let mut chance = Chance::new(1);
    let vertical = up(&mut chance);
    let sought = sought(&vertical);
    let samples: Vec<Vec<Row>> = (0..SAMPLES).map(|_| sample(&mut chance, &sought, points_per_plane).rows).collect();
    let mut next = 0;
    criterion.bench_function(&format!("{name} {points_per_plane:?}"), |bencher| {
        bencher.iter_batched_ref(
            || {
                next = (next + 1) % SAMPLES;
                next
            },
            |at| solve_minimal(&sought, points_per_plane, black_box(&samples[*at])).len(),
            BatchSize::SmallInput,
        );
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(700)).sample_size(40);
    targets = bench
}
criterion_main!(benches);
