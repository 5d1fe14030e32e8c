use super::*;
use crate::geometry::{Point3, Similarity};
use crate::random::Random;
use crate::solvers::scene::sample;
use crate::solvers::{Sought, refine};

/// Rows of a random scene whose points are off by some noise.
fn noisy(random: &mut Random, sought: &Sought, noise: f64) -> (Vec<crate::solvers::Row>, Similarity) {
    let mut case = sample(random, sought, &[4, 4, 4, 3, 3]);
    case.rows.iter_mut().for_each(|row| row.point += noise * random.normal_vector());
    (case.rows, case.truth)
}

fn loss(rows: &[crate::solvers::Row], pose: &Similarity) -> f64 {
    rows.iter().map(|r| (r.normal.dot(&pose.apply(&Point3::from(r.point)).coords) + r.offset).powi(2)).sum()
}

#[test]
fn no_pose_beside_the_refined_one_leaves_less() {
    let mut random = Random::stream(141, 0);
    for sought in [Sought::Rigid, Sought::Similarity] {
        for _ in 0..10 {
            let (rows, truth) = noisy(&mut random, &sought, 0.3);
            let found = refine(&sought, &rows, &truth).unwrap();
            let least = loss(&rows, &found);
            assert!(least < loss(&rows, &truth));
            for _ in 0..60 {
                let stretch = if sought.is_similarity() { (1e-4 * random.normal()).exp() } else { 1.0 };
                let other = Similarity {
                    scale: found.scale * stretch,
                    rotation: Rotation3::new(1e-4 * random.normal_vector()) * found.rotation,
                    translation: found.translation + 1e-3 * random.normal_vector(),
                };
                assert!(loss(&rows, &other) >= least * (1.0 - 1e-9));
            }
        }
    }
}

#[test]
fn a_rigid_pose_keeps_its_scale_and_exact_rows_lead_back_to_the_truth() {
    let mut random = Random::stream(142, 0);
    for sought in [Sought::Rigid, Sought::Similarity] {
        let (rows, truth) = noisy(&mut random, &sought, 0.0);
        let start = Similarity { rotation: Rotation3::new(0.02 * random.normal_vector()) * truth.rotation, ..truth };
        let found = refine(&sought, &rows, &start).unwrap();
        assert!((found.rotation.matrix() - truth.rotation.matrix()).norm() < 1e-9);
        assert!((found.translation - truth.translation).norm() < 1e-6);
        assert!(sought.is_similarity() || found.scale == 1.0);
    }
}
