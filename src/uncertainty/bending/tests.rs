use super::*;
use crate::robust::Random;

fn cloud() -> (Vec<Point3<f64>>, MotionParameters) {
    let mut random = Random::stream(3, 0);
    let mut draw = |reach: f64| reach * (2.0 * random.unit() - 1.0);
    let places = (0..300).map(|_| Point3::new(100.0 + draw(30.0), 50.0 + draw(20.0), draw(8.0))).collect();
    (places, MotionParameters::of_similarity(Point3::new(100.0, 50.0, 0.0), 30.0))
}

#[test]
fn no_similarity_undoes_any_part_of_a_bend_and_each_moves_the_cloud_by_one() {
    let (places, parameters) = cloud();
    let bending = Bending::over(&places, &parameters);
    assert_eq!(bending.count(), FIELDS);
    let at: Vec<Vec<Vector3<f64>>> = places.iter().map(|p| bending.at(p, &parameters)).collect();
    let mean = |of: &dyn Fn(usize) -> f64| (0..places.len()).map(of).sum::<f64>() / places.len() as f64;
    for k in 0..bending.count() {
        for l in 0..=k {
            let product = mean(&|i| at[i][k].dot(&at[i][l]));
            assert!((product - f64::from(u8::from(k == l))).abs() < 1e-6, "{k} {l}: {product}");
        }
        for similarity in 0..SIMILARITIES {
            let product = mean(&|i| at[i][k].dot(&raw_fields(&places[i], &parameters)[similarity]));
            assert!(product.abs() < 1e-6, "{k}: {product}");
        }
    }
}

#[test]
fn a_cloud_in_one_line_bends_in_fewer_ways() {
    let parameters = MotionParameters::of_similarity(Point3::origin(), 10.0);
    let line: Vec<Point3<f64>> = (-10..=10).map(|k| Point3::new(f64::from(k), 0.0, 0.0)).collect();
    let bending = Bending::over(&line, &parameters);
    assert!(bending.count() > 0 && bending.count() < 10, "{}", bending.count());
    assert_eq!(Bending::over(&[], &parameters).count(), 0);
}

#[test]
fn a_moved_and_scaled_cloud_bends_in_the_same_way() {
    let (places, parameters) = cloud();
    let bending = Bending::over(&places, &parameters);
    let grow = |p: &Point3<f64>| Point3::from(p.coords * 3.0 + Vector3::new(5.0, -7.0, 100.0));
    let moved: Vec<Point3<f64>> = places.iter().map(grow).collect();
    let parameters_there = MotionParameters::of_similarity(grow(&parameters.center), 3.0 * parameters.radius);
    let there = Bending::over(&moved, &parameters_there);
    assert_eq!(there.count(), bending.count());
    for (x, y) in places.iter().zip(&moved).step_by(17) {
        for (one, other) in bending.at(x, &parameters).iter().zip(there.at(y, &parameters_there)) {
            assert!((one - other).norm() < 1e-9);
        }
    }
}

#[test]
fn far_beyond_the_scene_a_bend_grows_no_further() {
    let (places, parameters) = cloud();
    let bending = Bending::over(&places, &parameters);
    let at = |reach: f64| bending.at(&(parameters.center + Vector3::new(reach, 0.3 * reach, 0.0)), &parameters);
    let (near, far) = (at(10.0 * parameters.radius), at(1000.0 * parameters.radius));
    for (one, other) in near.iter().zip(&far) {
        assert!((one - other).norm() < 1e-9);
    }
}
