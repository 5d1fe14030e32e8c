use super::*;
use crate::random::Random;

#[test]
fn parts_say_what_the_rotation_does() {
    let known = KnownAxis {
        sensor: Axes::about(&Vector3::new(0.6, 0.0, -0.8)),
        object: Axes::about(&Vector3::new(0.36, 0.48, 0.8)),
    };
    let (normal, point) = (Vector3::new(0.2, -0.5, 1.1), Vector3::new(3.0, 0.4, -2.0));
    for sense in Sense::BOTH {
        let turn = Turn { cos: 0.28, sin: -0.96, sense };
        let rotation = known.rotation(&turn);
        assert!((rotation.determinant() - 1.0).abs() < 1e-15);
        assert!((rotation * known.sensor.z - known.object.z * sense.sigma()).norm() < 1e-15);
        let expected = normal.dot(&(rotation * point));
        let parts = known.parts(&known.object.coordinates(&normal), &known.sensor.coordinates(&point));
        assert!((turn.along(&parts) - expected).abs() < 1e-14);
        assert!((turn.along(&known.parts_of(&(normal * point.transpose()))) - expected).abs() < 1e-14);
    }
}

fn axis(random: &mut Random) -> KnownAxis {
    KnownAxis { sensor: Axes::about(&random.direction()), object: Axes::about(&random.direction()) }
}

#[test]
fn every_turn_is_a_rotation_that_lays_the_axes_onto_each_other() {
    let mut random = Random::stream(105, 0);
    for _ in 0..50 {
        let axis = axis(&mut random);
        for sense in Sense::BOTH {
            let (sin, cos) = (6.3 * random.unit()).sin_cos();
            let r = axis.rotation(&Turn { cos, sin, sense });
            assert!((r * r.transpose()).is_identity(1e-12) && (r.determinant() - 1.0).abs() < 1e-12);
            assert!((r * axis.sensor.z - axis.object.z * sense.sigma()).norm() < 1e-12);
        }
    }
}

#[test]
fn turns_on_a_line_satisfy_it_and_parts_of_sums_are_sums_of_parts() {
    let mut random = Random::stream(106, 0);
    let mut met = 0;
    for _ in 0..200 {
        let axis = axis(&mut random);
        let (n, p, m, q) = (random.direction(), random.normal_vector(), random.direction(), random.normal_vector());
        let both = n * p.transpose() + m * q.transpose();
        let parts = axis.parts_of(&both);
        let constant = random.normal();
        for sense in Sense::BOTH {
            for turn in Turn::on(line_with(&parts, constant, sense), sense, 1.0) {
                let r = axis.rotation(&turn);
                let value = n.dot(&(r * p)) + m.dot(&(r * q)) + constant;
                assert!(value.abs() < 1e-9, "{value}");
                assert!((turn.along(&parts) + constant).abs() < 1e-9);
                met += 1;
            }
        }
    }
    assert!(met > 200, "{met}");
}
