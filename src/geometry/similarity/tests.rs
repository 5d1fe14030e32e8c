use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn example() -> Similarity {
    Similarity {
        scale: 2.5,
        rotation: Rotation3::from_euler_angles(0.3, -0.4, 1.9),
        translation: Vector3::new(5.0, -7.0, 0.5),
    }
}

#[test]
fn inverse_undoes() {
    let p = Point3::new(1.0, 2.0, 3.0);
    assert!((example().inverse().apply(&example().apply(&p)) - p).norm() < 1e-14);
    let both = example() * example().inverse();
    assert!((both.scale - 1.0).abs() < 1e-15 && both.translation.norm() < 1e-14);
}

#[test]
fn refuses_what_is_no_similarity() {
    let r = example().rotation.into_inner();
    let t = Vector3::zeros();
    assert!(matches!(Similarity::try_new(0.0, r, t), Err(NotASimilarity::Scale(_))));
    assert!(matches!(Similarity::try_new(f64::NAN, r, t), Err(NotASimilarity::Scale(_))));
    assert!(matches!(Similarity::try_new(1.0, 1.01 * r, t), Err(NotASimilarity::NotOrthonormal(_))));
    assert!(matches!(Similarity::try_new(1.0, -r, t), Err(NotASimilarity::Reflection)));
    assert!(matches!(
        Similarity::try_new(1.0, r, Vector3::new(f64::INFINITY, 0.0, 0.0)),
        Err(NotASimilarity::NotFinite)
    ));
}

#[test]
fn makes_a_rotation_of_few_digits_exact() {
    let rough = example().rotation.into_inner().map(|v| (v * 1e7).round() / 1e7);
    let made = Similarity::try_new(1.0, rough, Vector3::zeros()).unwrap();
    let m = made.rotation.into_inner();
    assert!((m * m.transpose() - Matrix3::identity()).amax() < 1e-15);
}

fn similarity() -> impl Strategy<Value = Similarity> {
    let numbers = prop::array::uniform3(-3.0..3.0f64);
    (-2.0..2.0f64, numbers, prop::array::uniform3(-50.0..50.0f64)).prop_map(|(log_scale, turn, shift)| Similarity {
        scale: log_scale.exp(),
        rotation: Rotation3::new(Vector3::from(turn)),
        translation: Vector3::from(shift),
    })
}

fn place() -> impl Strategy<Value = Point3<f64>> {
    prop::array::uniform3(-20.0..20.0f64).prop_map(Point3::from)
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(11), failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn a_product_is_one_after_the_other(a in similarity(), b in similarity(), x in place()) {
        prop_assert!(((a * b).apply(&x) - a.apply(&b.apply(&x))).norm() < 1e-9);
    }

    #[test]
    fn the_inverse_of_a_product_is_the_product_of_the_inverses_turned_round(a in similarity(), b in similarity(), x in place()) {
        let (one, other) = ((a * b).inverse(), b.inverse() * a.inverse());
        prop_assert!((one.apply(&x) - other.apply(&x)).norm() < 1e-8 * (1.0 + one.scale * 1e3));
    }

    #[test]
    fn distances_grow_by_the_scale_and_angles_stay(s in similarity(), x in place(), y in place(), z in place()) {
        let moved = [x, y, z].map(|p| s.apply(&p));
        prop_assert!(((moved[1] - moved[0]).norm() - s.scale * (y - x).norm()).abs() < 1e-9 * (1.0 + s.scale * 100.0));
        let (before, after) = ((y - x).dot(&(z - x)), (moved[1] - moved[0]).dot(&(moved[2] - moved[0])));
        prop_assert!((after - s.scale * s.scale * before).abs() < 1e-8 * (1.0 + s.scale * s.scale * 1e4));
    }

    #[test]
    fn turning_about_a_pivot_sends_it_to_its_image(s in similarity(), pivot in place(), image in place()) {
        let about = Similarity::about(&pivot, &image, s.scale, s.rotation);
        prop_assert!((about.apply(&pivot) - image).norm() < 1e-9 * (1.0 + s.scale * 100.0));
        prop_assert_eq!((about.scale, about.rotation), (s.scale, s.rotation));
    }

    #[test]
    fn relative_to_an_origin_all_images_are_less_by_it(s in similarity(), origin in place(), x in place()) {
        let moved = s.relative_to(&origin.coords).apply(&x);
        prop_assert!((moved + origin.coords - s.apply(&x)).norm() < 1e-9 * (1.0 + s.scale * 100.0));
    }

    #[test]
    fn what_a_similarity_is_made_of_makes_it_again(s in similarity()) {
        let made = Similarity::try_new(s.scale, s.rotation.into_inner(), s.translation).unwrap();
        prop_assert!(made.scale == s.scale && made.translation == s.translation);
        prop_assert!((made.rotation.matrix() - s.rotation.matrix()).norm() < 1e-14);
    }
}
