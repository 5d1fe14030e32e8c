use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

#[test]
fn the_form_of_a_row_is_n_r_p() {
    let q = [0.5, -0.1, 0.7, 0.5];
    let (n, p) = (Vector3::new(0.2, -0.5, 1.1), Vector3::new(3.0, 0.4, -2.0));
    assert!((value(&form(&n, &p), &q) - n.dot(&(rotation(&q) * p))).abs() < 1e-15);
}

#[test]
fn the_product_of_quaternions_is_the_product_of_rotations() {
    let (a, b) = ([0.5, -0.1, 0.7, 0.5], [0.1, 0.9, -0.3, 0.2]);
    assert!((rotation(&product(&a, &b)) - rotation(&a) * rotation(&b)).norm() < 1e-15);
}

fn quaternion() -> impl Strategy<Value = Quaternion> {
    prop::array::uniform4(-1.0..1.0f64)
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(23), failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn rotations_are_those_of_the_textbook(q in quaternion(), p in prop::array::uniform3(-2.0..2.0f64)) {
        let size = q.iter().map(|v| v * v).sum::<f64>();
        prop_assume!(size > 1e-2);
        let unit = nalgebra::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]));
        let p = Vector3::from(p);
        prop_assert!((rotation(&q) * p - size * (unit * p)).norm() < 1e-12);
    }

    #[test]
    fn monomials_stand_where_their_places_say(q in quaternion()) {
        let mono = monomials(&q);
        for i in 0..4 {
            for j in 0..4 {
                prop_assert_eq!(mono[PLACE[i][j]], q[i] * q[j]);
            }
        }
        for (at, (i, j)) in MONOMIALS.iter().enumerate() {
            prop_assert_eq!(PLACE[*i][*j], at);
        }
    }

    #[test]
    fn a_form_of_a_sum_is_the_sum_of_the_forms(
        q in quaternion(),
        [n, m] in prop::array::uniform2(prop::array::uniform3(-2.0..2.0f64)),
        [p, r] in prop::array::uniform2(prop::array::uniform3(-2.0..2.0f64)),
    ) {
        let [n, m, p, r] = [n, m, p, r].map(Vector3::from);
        let both = form_of(&(n * p.transpose() + m * r.transpose()));
        let expected = value(&form(&n, &p), &q) + value(&form(&m, &r), &q);
        prop_assert!((value(&both, &q) - expected).abs() < 1e-11);
    }

    #[test]
    fn sizes_multiply_in_a_product(a in quaternion(), b in quaternion()) {
        let size = |q: &Quaternion| q.iter().map(|v| v * v).sum::<f64>();
        prop_assert!((size(&product(&a, &b)) - size(&a) * size(&b)).abs() < 1e-12);
    }
}
