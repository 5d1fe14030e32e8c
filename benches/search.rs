//! Time of what a search does most: a draw of a minimal sample and the score of a pose, on one thread, in a town of 96 houses of which
//! two blocks were seen.
//!
//! `cargo bench --bench search`; [`SearchLimits::pair_us`] (a draw by its planes) and [`SearchLimits::score_us`] are told by it.
//!
//! [`SearchLimits::pair_us`]: cityweld::internals::SearchLimits::pair_us
//! [`SearchLimits::score_us`]: cityweld::internals::SearchLimits::score_us

use cityweld::internals::{Limits, Motion, PoseSearch, Problem, Random, Sampler, Scene, Upright, patches};
use cityweld::solvers::{Sought, Up};
use cityweld::synthetic::{Block, CloudOptions, Offset};
use cityweld::{PreparedCity, Similarity, Start, StartSigmas, Vector3};
use criterion::{Criterion, criterion_group, criterion_main};

/// Poses that a measurement goes round, so that no branch is learned by heart.
const POSES: usize = 1000;

fn bench(criterion: &mut Criterion) {
    let town = Block::town(4, 4, 3).with_ground();
    let seen = CloudOptions { points_per_roof: 100, seed: 5, ..CloudOptions::default() };
    let survey = Block::new(town.houses[..12].to_vec()).with_ground().cloud(&seen);
    let city = PreparedCity::new(town.city().expect("a town of houses is a city"));
    let limits = Limits::default();
    let patches = patches(&survey.sfm, None, &limits.patches);
    let off = Offset { shift_m: [6.0, -5.0, 1.5], heading_rad: 0.15, scale: 1.1, ..Offset::default() };
    let pose = (town.off(&off) * survey.city_from_sfm).relative_to(&city.model.origin);
    let start = Start::new(pose, StartSigmas::default()).expect("sigmas by default are a start's");
    let vertical = survey.city_from_sfm.rotation.inverse() * Vector3::z();
    let upright = Upright { up: vertical, sigma_rad: 0.0, known: true };
    let scene = Scene::new(&city, &patches, &start, Motion::Similarity, &upright, &limits);
    let sampler = Sampler::new(&scene);
    let up = Up::new(&Vector3::z(), &Vector3::z()).expect("up is up");
    let sought = Sought::UprightSimilarity(up);
    let point_subset = scene.level_cloud.point_subset(limits.search.ranking_points);
    let search = PoseSearch {
        scene: &scene,
        sampler: &sampler,
        sought,
        configuration: &sought.configurations()[0],
        point_subset: &point_subset,
    };
    let mut random = Random::stream(1, 0);
    criterion.bench_function("draw of four pairs", |bencher| bencher.iter(|| sampler.draw(4, &mut random)));
    let mut poses: Vec<Similarity> = Vec::new();
    while poses.len() < POSES {
        search.hypothesize(&mut random, &mut poses);
    }
    let mut next = 0;
    criterion.bench_function("score on 100 probes", |bencher| {
        bencher.iter(|| {
            next = (next + 1) % POSES;
            search.score(&poses[next])
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().warm_up_time(std::time::Duration::from_millis(500))
        .measurement_time(std::time::Duration::from_secs(2)).sample_size(40);
    targets = bench
}
criterion_main!(benches);
