use super::*;
use crate::correspondence::test_scene::Made;
use crate::synthetic::Offset;

/// Samples on four planes of four houses, from a start that is off by a sigma or so.
fn samples(scene: &Scene) -> Vec<MinimalSample> {
    let sampler = Sampler::new(scene);
    (0..2000).filter_map(|stream| sampler.draw(4, &mut Random::stream(7, stream))).collect()
}

const OFF: Offset = Offset { shift_m: [6.0, -5.0, 1.5], heading_rad: 0.15, tilt_rad: [0.0; 2], scale: 1.1 };

#[test]
fn a_sample_pairs_patches_with_planes_in_sight_that_face_their_way() {
    let made = Made::four_houses();
    for scene in [made.scene(&OFF, Motion::Similarity), made.leaning_scene(&OFF, Motion::Similarity)] {
        let in_sight = scene.city.planes_in_sight(&scene.reach.low, &scene.reach.high);
        // The turn of the start, a tilt where it may lean, and what patch normals are off.
        let most_rad = scene.prior.most_heading_rad() + scene.prior.most_tilt_rad() + 2.0 * 0.12;
        let drawn = samples(&scene);
        assert!(drawn.len() > 100, "{}", drawn.len());
        for sample in &drawn {
            assert_eq!(sample.pairs.len() + sample.completion.len(), 4);
            assert!(sample.chance > 0.0 && sample.chance <= 1.0, "{}", sample.chance);
            for pair in &sample.pairs {
                assert!(in_sight.contains(&pair.plane));
                let plane = &made.city.planes().planes[pair.plane.0 as usize].plane;
                assert_eq!(pair.target, *plane);
                assert!(pair.normal.angle(&plane.normal) < most_rad, "{pair:?}");
            }
        }
    }
}

#[test]
fn the_right_planes_are_drawn_about_as_often_as_the_samples_say() {
    let made = Made::four_houses();
    let scene = made.scene(&OFF, Motion::Similarity);
    let truth = made.truth(&scene);
    // A pair is right where the truth puts the patch into its plane.
    let is_right = |pair: &PatchPlanePair| {
        let center = truth.apply(&scene.level_cloud.patches[pair.patch as usize].center);
        pair.target.signed_distance(&center).abs() < 0.3
            && (truth.rotation * pair.normal).dot(&pair.target.normal) > 0.95
    };
    let drawn = samples(&scene);
    let right = drawn.iter().filter(|sample| sample.pairs.iter().all(is_right)).count();
    let said: f64 = drawn.iter().map(|sample| sample.chance).sum();
    // The likelihoods are those of a Gaussian that knows nothing of the block: right to a factor of five.
    let ratio = right as f64 / said;
    assert!(right > 5 && ratio > 0.2 && ratio < 5.0, "{right} right, {said} said, {}", drawn.len());
}

#[test]
fn bisectors_lay_one_pair_of_normals_onto_another() {
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.0).into_inner();
    let (a, b) = (Vector3::new(0.6, 0.0, 0.8), Vector3::new(0.0, 1.0, 0.0));
    let found = bisectors(&(turn * a), &(turn * b)).unwrap() * bisectors(&a, &b).unwrap().transpose();
    assert!((found - turn).norm() < 1e-12 && (found.determinant() - 1.0).abs() < 1e-12);
    assert!(bisectors(&a, &a).is_none() && bisectors(&a, &-a).is_none());
}

#[test]
fn the_chance_of_a_draw_is_that_of_taking_the_right_offer() {
    let drawn = |weights: &[f64]| {
        let mut choice = Choice::default();
        let mut random = Random::stream(1, 0);
        weights.iter().for_each(|w| choice.offer(*w, *w, &mut random));
        choice.drawn().map(|drawn| drawn.chance)
    };
    assert_eq!(drawn(&[]), None);
    assert_eq!(drawn(&[0.3]), Some(1.0));
    // Two offers alike: right every other time. Three quarters and a quarter: 9/16 + 1/16.
    assert_eq!(drawn(&[2.0, 2.0]), Some(0.5));
    assert_eq!(drawn(&[3.0, 1.0]), Some(0.625));
}

#[test]
fn offers_are_drawn_as_often_as_they_weigh() {
    let weights = [1.0, 0.0, 5.0, 0.5, 2.5, 1.0];
    let mut counts = [0; 6];
    for stream in 0..20_000 {
        let mut random = Random::stream(3, stream);
        let mut choice = Choice::default();
        (0..).zip(weights).for_each(|(i, w)| choice.offer(w, i, &mut random));
        let taken: usize = choice.drawn().map(|drawn| drawn.what).unwrap();
        counts[taken] += 1;
    }
    for (count, weight) in counts.into_iter().zip(weights) {
        let expected = 2000.0 * weight;
        // Five standard deviations.
        assert!((f64::from(count) - expected).abs() <= 5.0 * expected.sqrt(), "{counts:?}");
    }
}

#[test]
fn offers_that_are_not_kept_are_the_same() {
    let made = Made::four_houses();
    for scene in [made.scene(&OFF, Motion::Similarity), made.leaning_scene(&OFF, Motion::Similarity)] {
        let kept = samples(&scene);
        let forgetful = Sampler::new(&scene);
        forgetful.firsts.keep_no_more();
        let draw = |stream| forgetful.draw(4, &mut Random::stream(7, stream));
        let found: Vec<MinimalSample> = (0..2000).filter_map(draw).collect();
        assert_eq!(found.len(), kept.len());
        let told = |sample: &MinimalSample| sample.pairs.iter().map(|p| (p.patch, p.plane)).collect::<Vec<_>>();
        assert!(found.iter().zip(&kept).all(|(a, b)| told(a) == told(b) && a.chance == b.chance));
    }
}
