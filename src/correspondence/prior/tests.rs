use super::*;
use crate::geometry::Rotation3;

fn prior(change: impl FnOnce(&mut StartSigmas), motion: Motion) -> Prior {
    let mut sigmas = StartSigmas::default();
    change(&mut sigmas);
    let start = Start::new(Similarity::identity(), sigmas).unwrap();
    let city = (Point3::new(-50.0, -50.0, 0.0), Point3::new(250.0, 50.0, 20.0));
    Prior::new(&start, Point3::new(100.0, 0.0, 5.0), 20.0, motion, Vertical::Known, Some(city), &Limits::default())
}

fn usual() -> Prior {
    prior(|_| (), Motion::Similarity)
}

fn moved(prior: &Prior, shift: [f64; 3], heading: f64, scale: f64) -> Similarity {
    let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), heading);
    Similarity { scale, rotation, translation: prior.center_in_city.coords + Vector3::from(shift) }
}

#[test]
fn reaches_three_sigmas_in_every_freedom_and_not_beyond() {
    let p = usual();
    let degree = 1f64.to_radians();
    for (pose, expected) in [
        (p.expected(), true),
        (moved(&p, [29.9, -29.9, 8.9], 29.9 * degree, 0.44f64.exp()), true),
        (moved(&p, [30.1, 0.0, 0.0], 0.0, 1.0), false),
        (moved(&p, [0.0, 0.0, 9.1], 0.0, 1.0), false),
        (moved(&p, [0.0; 3], 30.1 * degree, 1.0), false),
        (moved(&p, [0.0; 3], 0.0, 0.46f64.exp()), false),
    ] {
        assert_eq!(p.reaches(&pose), expected, "{pose:?}");
    }
}

#[test]
fn the_cost_grows_with_the_square_of_the_sigmas_and_an_open_heading_is_free() {
    let p = usual();
    let once = p.cost(&moved(&p, [10.0, 0.0, 0.0], 0.0, 1.0));
    assert!((p.cost(&moved(&p, [20.0, 0.0, 0.0], 0.0, 1.0)) - 4.0 * once).abs() < 1e-12);
    let open = prior(|s| s.heading_rad = std::f64::consts::PI, Motion::Similarity);
    assert_eq!(open.cost(&moved(&open, [0.0; 3], 3.0, 1.0)), 0.0);
    assert!(open.reaches(&moved(&open, [0.0; 3], 3.0, 1.0)));
}

#[test]
fn a_sigma_beyond_the_city_says_no_more_than_the_city() {
    let vast = prior(|s| (s.position_m, s.height_m) = (1e7, 1e7), Motion::Similarity);
    let reach = vast.reach(&Extent { radius_m: 20.0, bottom_m: -5.0, top_m: 5.0 });
    assert!((reach.high - reach.low).norm() < 3000.0, "{reach:?}");
    assert!(reach.low.x < -50.0 && reach.high.x > 250.0);
}

#[test]
fn a_given_scale_is_no_unknown_of_the_prior() {
    let rigid = prior(|_| (), Motion::Rigid);
    let (mean, covariance) = rigid.scale_and_place();
    assert_eq!((mean[0], covariance[(0, 0)], rigid.most_scale()), (1.0, 0.0, 1.0));
}

fn about(center: [f64; 3], vertical: Vertical) -> Prior {
    let start = Start::with_default_sigmas(Similarity::identity());
    Prior::new(&start, Point3::from(center), 20.0, Motion::Similarity, vertical, None, &Limits::default())
}

/// A pose so many sigmas off in heading, log scale and place.
fn off(prior: &Prior, sigmas: [f64; 5]) -> Similarity {
    let s = &prior.sigmas;
    let shift = Vector3::new(sigmas[2] * s.position_m, sigmas[3] * s.position_m, sigmas[4] * s.height_m);
    Similarity {
        scale: (sigmas[1] * s.log_scale).exp(),
        rotation: crate::geometry::Rotation3::from_euler_angles(0.0, 0.0, sigmas[0] * s.heading_rad),
        translation: prior.center_in_city.coords + shift,
    }
}

#[test]
fn the_cost_and_the_bits_are_those_of_the_squared_sigmas() {
    let (prior, limits) = (about([3.0, 4.0, 5.0], Vertical::Known), Limits::default());
    for sigmas in [[0.0; 5], [1.0, 0.0, 0.0, 0.0, 0.0], [0.0, -2.0, 0.0, 0.0, 0.0], [0.5, 1.0, -1.5, 2.0, -0.3]] {
        let squares: f64 = sigmas.iter().map(|s| s * s).sum();
        let pose = off(&prior, sigmas);
        assert!((prior.cost(&pose) - limits.prior_cost * squares).abs() < 1e-12);
        // exp(-squares / 2) as a power of two.
        assert!((prior.bits(&pose).exp2() - (-0.5 * squares).exp()).abs() < 1e-12);
    }
}

#[test]
fn poses_within_three_sigmas_of_every_freedom_are_reached_and_others_are_not() {
    let prior = about([3.0, 4.0, 5.0], Vertical::Known);
    assert!(prior.reaches(&prior.expected()));
    for k in 0..5 {
        for sign in [-1.0, 1.0] {
            let mut sigmas = [0.0; 5];
            sigmas[k] = sign * 2.99;
            assert!(prior.reaches(&off(&prior, sigmas)), "{k}");
            sigmas[k] = sign * 3.01;
            assert!(!prior.reaches(&off(&prior, sigmas)), "{k}");
        }
    }
    let tilt = prior.reach_sigmas * prior.sigmas.tilt_rad.max(prior.least_tilt_rad);
    for (share, is_reached) in [(0.99, true), (1.01, false)] {
        let rotation = crate::geometry::Rotation3::from_euler_angles(share * tilt, 0.0, 0.0);
        assert_eq!(prior.reaches(&Similarity { rotation, ..prior.expected() }), is_reached);
    }
}

#[test]
fn every_pose_within_reach_keeps_the_cloud_inside_the_box() {
    let mut random = crate::random::Random::stream(66, 0);
    for vertical in [Vertical::Known, Vertical::Free] {
        let prior = about([30.0, -40.0, 5.0], vertical);
        let cloud = Extent { radius_m: 20.0, bottom_m: -6.0, top_m: 11.0 };
        let reach = prior.reach(&cloud);
        for _ in 0..3000 {
            let sigmas = std::array::from_fn(|_| 6.0 * random.unit() - 3.0);
            let mut pose = off(&prior, sigmas);
            if vertical == Vertical::Free {
                let lean = prior.most_tilt_rad() * random.unit();
                let (sin, cos) = (std::f64::consts::TAU * random.unit()).sin_cos();
                pose.rotation = crate::geometry::Rotation3::new(Vector3::new(cos, sin, 0.0) * lean) * pose.rotation;
            }
            let (sin, cos) = (std::f64::consts::TAU * random.unit()).sin_cos();
            let height = if random.unit() < 0.5 { cloud.bottom_m } else { cloud.top_m };
            let x = pose.apply(&Point3::new(20.0 * cos, 20.0 * sin, height));
            assert!(reach.contains(&x), "{x} {reach:?}");
        }
    }
}

#[test]
fn the_heading_of_a_turn_about_up_is_its_angle() {
    for k in -30..=30 {
        let heading = 0.1 * f64::from(k);
        let turned = crate::geometry::Rotation3::from_euler_angles(0.0, 0.0, heading);
        assert!((heading_of(turned.matrix()) - heading).abs() < 1e-12);
    }
}

#[test]
fn no_start_is_surer_than_a_model_stands_in_its_own_coordinate_system() {
    let sure = prior(
        |s| *s = StartSigmas { position_m: 0.0, height_m: 0.0, heading_rad: 0.0, tilt_rad: 0.0, log_scale: 0.0 },
        Motion::Similarity,
    );
    assert!(sure.reaches(&moved(&sure, [1.0, -1.0, 1.0], 0.0, 1.0)));
    assert!(!sure.reaches(&moved(&sure, [1.1, 0.0, 0.0], 0.0, 1.0)));
}

#[test]
fn where_no_start_was_given_no_pose_within_reach_is_likelier_and_none_is_ruled_out() {
    let (gaussian, uniform) = (usual(), usual().uniform());
    for pose in [off(&gaussian, [0.5, 1.0, -1.5, 2.0, -0.3]), off(&gaussian, [0.0, 0.0, 9.0, 0.0, 0.0])] {
        assert_eq!((uniform.cost(&pose), uniform.bits(&pose), uniform.rules_out(&pose)), (0.0, 0.0, false));
        assert_eq!(uniform.reaches(&pose), gaussian.reaches(&pose));
        assert_eq!(gaussian.rules_out(&pose), !gaussian.reaches(&pose));
    }
}
