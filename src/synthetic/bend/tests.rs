use super::*;
use crate::synthetic::sfm_from_city;

fn points() -> Vec<Point3<f64>> {
    let mut random = Random::stream(4, 0);
    (0..500).map(|_| Point3::from(random.in_cube().component_mul(&Vector3::new(1.0, 0.6, 0.2)))).collect()
}

#[test]
fn the_best_similarity_is_the_one_that_made_the_pairs() {
    let truth = sfm_from_city();
    let pairs: Vec<_> = points().iter().map(|p| (*p, truth.apply(p))).collect();
    let found = best_similarity(&pairs);
    assert!(pairs.iter().all(|(a, b)| (found.apply(a) - b).norm() < 1e-10));
}

#[test]
fn a_bend_leaves_its_share_of_the_extent() {
    let points = points();
    for share in [0.0, 0.001, 0.005] {
        let bend = Bend::new(&points, share, &mut Random::stream(1, 0));
        let pairs: Vec<_> = points.iter().map(|p| (bend.apply(p), *p)).collect();
        let best = best_similarity(&pairs);
        let mut left: Vec<f64> = pairs.iter().map(|(a, b)| (best.apply(a) - b).norm()).collect();
        left.sort_by(f64::total_cmp);
        let expected = share * extent_of(&points);
        assert!((left[495] - expected).abs() < 0.02 * expected + 1e-9, "{} {expected}", left[495]);
    }
}

#[test]
fn no_similarity_beside_the_best_brings_the_pairs_nearer() {
    let mut random = Random::stream(121, 0);
    let pairs: Vec<(Point3<f64>, Point3<f64>)> = (0..40)
        .map(|_| {
            let x = Point3::from(5.0 * random.normal_vector());
            (x, sfm_from_city().apply(&x) + 0.05 * random.normal_vector())
        })
        .collect();
    let miss = |pose: &Similarity| pairs.iter().map(|(a, b)| (pose.apply(a) - b).norm_squared()).sum::<f64>();
    let best = best_similarity(&pairs);
    for _ in 0..200 {
        let turn = crate::geometry::Rotation3::new(0.01 * random.normal_vector());
        let other = Similarity {
            scale: best.scale * (0.01 * random.normal()).exp(),
            rotation: turn * best.rotation,
            translation: best.translation + 0.01 * random.normal_vector(),
        };
        assert!(miss(&other) >= miss(&best));
    }
}

#[test]
fn a_bend_of_nothing_moves_nothing_and_one_seed_bends_one_way() {
    let points: Vec<Point3<f64>> =
        (0..200).map(|k| Point3::new(f64::from(k % 20), f64::from(k / 20), f64::from(k % 7))).collect();
    let bent = |share: f64, seed: u64| -> Vec<Point3<f64>> {
        let bend = Bend::new(&points, share, &mut Random::stream(seed, 0));
        points.iter().map(|p| bend.apply(p)).collect()
    };
    assert!(bent(0.0, 1).iter().zip(&points).all(|(a, b)| (a - b).norm() < 1e-12));
    assert_eq!(bent(0.01, 1), bent(0.01, 1));
    assert_ne!(bent(0.01, 1), bent(0.01, 2));
    assert!(Bend::new(&[], 0.01, &mut Random::stream(1, 0)).apply(&Point3::origin()).coords.norm() < 1e9);
}
