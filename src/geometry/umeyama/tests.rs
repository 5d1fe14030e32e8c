use super::*;
use crate::random::Random;
use crate::robust::{MotionParameters, Vector7};

#[test]
fn three_couples_fix_a_similarity() {
    let truth = Similarity {
        scale: 1.7,
        rotation: Rotation3::from_euler_angles(0.4, 2.0, -1.0),
        translation: Vector3::new(3.0, -8.0, 1.0),
    };
    let couples = [0.0, 3.0, 7.0].map(|t: f64| {
        let in_b = Point3::new((t * 0.7).sin() * 4.0, (t * 1.3).cos() * 3.0, (t * 0.31).sin() * 2.0);
        (truth.apply(&in_b), in_b)
    });
    let found = umeyama(&couples).unwrap();
    assert!((found.scale - 1.7).abs() < 1e-12 && (found.translation - truth.translation).norm() < 1e-11);
    assert!(umeyama(&[couples[0], couples[0], couples[1]]).is_none());
}

fn miss(pose: &Similarity, couples: &[(Point3<f64>, Point3<f64>)]) -> f64 {
    couples.iter().map(|(a, b)| (pose.apply(b) - a).norm_squared()).sum()
}

fn noisy(random: &mut Random, count: usize, noise: f64) -> Vec<(Point3<f64>, Point3<f64>)> {
    let truth = Similarity {
        scale: 0.3 + 2.0 * random.unit(),
        rotation: random.rotation(),
        translation: 9.0 * random.normal_vector(),
    };
    let couple = |_| {
        let in_b = Point3::from(4.0 * random.normal_vector());
        (truth.apply(&in_b) + noise * random.normal_vector(), in_b)
    };
    (0..count).map(couple).collect()
}

#[test]
fn no_similarity_beside_it_misses_by_less() {
    let mut random = Random::stream(31, 0);
    for case in 0..60 {
        let couples = noisy(&mut random, 3 + case % 12, 0.5);
        let found = umeyama(&couples).unwrap();
        let least = miss(&found, &couples);
        let parameters = MotionParameters::of_similarity(found.apply(&couples[0].1), 5.0);
        for _ in 0..40 {
            for size in [1e-3, 0.1, 2.0] {
                let unknowns = Vector7::from_fn(|_, _| size * random.normal());
                assert!(miss(&parameters.moved(&found, &unknowns), &couples) >= least * (1.0 - 1e-12));
            }
        }
    }
}

#[test]
fn a_mirror_image_is_answered_by_a_rotation() {
    let mut random = Random::stream(32, 0);
    let couples: Vec<_> = noisy(&mut random, 20, 0.0).into_iter().map(|(a, b)| (a, Point3::from(-b.coords))).collect();
    let found = umeyama(&couples).unwrap();
    assert!((found.rotation.matrix().determinant() - 1.0).abs() < 1e-12);
    assert!(miss(&found, &couples) > 1.0);
}

#[test]
fn couples_on_a_line_or_in_a_point_fix_nothing() {
    let on_line = |t: f64| (Point3::new(t, 2.0 * t, 1.0), Point3::new(3.0 * t, -t, 0.5));
    assert!(umeyama(&[0.0, 1.0, 2.0, 5.0].map(on_line)).is_none());
    assert!(umeyama(&[on_line(1.0); 4]).is_none());
    assert!(umeyama(&[]).is_none());
}
