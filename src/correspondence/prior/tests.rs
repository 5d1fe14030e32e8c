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
