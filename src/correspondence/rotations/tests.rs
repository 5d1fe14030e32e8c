use super::*;
use crate::random::Random;

#[test]
fn a_turn_about_up_leads_one_azimuth_to_the_other_and_keeps_heights() {
    let mut random = Random::stream(61, 0);
    for _ in 0..200 {
        let (from, to) = (random.direction(), random.direction());
        if from.xy().norm().min(to.xy().norm()) < 0.05 {
            continue;
        }
        let turned = about_up_from(&from, &to) * from;
        assert!((turned.z - from.z).abs() < 1e-14 && (turned.norm() - 1.0).abs() < 1e-12);
        assert!(turned.xy().perp(&to.xy()).abs() < 1e-12 && turned.xy().dot(&to.xy()) > 0.0);
        let heading = to.y.atan2(to.x) - from.y.atan2(from.x);
        assert!((about_up(heading) - about_up_from(&from, &to)).norm() < 1e-12);
    }
}

#[test]
fn bisectors_lay_a_pair_of_directions_onto_another_of_the_same_angle() {
    let mut random = Random::stream(62, 0);
    for _ in 0..200 {
        let (a, b, rotation) = (random.direction(), random.direction(), random.rotation());
        let (Some(before), Some(after)) = (bisectors(&a, &b), bisectors(&(rotation * a), &(rotation * b))) else {
            continue;
        };
        assert!((before * before.transpose()).is_identity(1e-9));
        assert!((after * before.transpose() - rotation.matrix()).norm() < 1e-9);
    }
    assert!(bisectors(&Vector3::x(), &Vector3::x()).is_none() && bisectors(&Vector3::x(), &-Vector3::x()).is_none());
}

#[test]
fn what_two_angles_differ_by_is_divided_evenly() {
    let (sin, cos) = 0.6f64.sin_cos();
    let (sin_wider, cos_wider) = 0.7f64.sin_cos();
    let (a, b) = (Vector3::x(), Vector3::new(cos, sin, 0.0));
    let (c, d) = (Vector3::x(), Vector3::new(cos_wider, sin_wider, 0.0));
    let rotation = bisectors(&c, &d).unwrap() * bisectors(&a, &b).unwrap().transpose();
    assert!(((rotation * a).angle(&c) - 0.05).abs() < 1e-9 && ((rotation * b).angle(&d) - 0.05).abs() < 1e-9);
}
