use super::*;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn at(x_px: f64, y_px: f64) -> Observation {
    Observation { x_px, y_px, point: None }
}

#[test]
fn links_each_keypoint_to_its_nearest_once() {
    let a = [at(10.0, 10.0), at(50.0, 50.0)];
    let b = [at(5.2, 5.0), at(5.4, 5.1), at(25.0, 25.0), at(90.0, 1.0)];
    let pixels = PixelMap { scale: [2.0, 2.0], shift: [0.0, 0.0], tolerance: 1.4 };
    assert_eq!(pixels.same_keypoints(&a, &b, &|_| true), [(0, 0), (1, 2)]);
    let shifted = PixelMap { shift: [9.0, 0.0], ..pixels };
    assert!(shifted.same_keypoints(&a, &b, &|_| true).is_empty());
}

/// Of all keypoints of `b` whose nearest in `a` is within the tolerance, for each of `a` the nearest one.
fn naive(pixels: &PixelMap, a: &[Observation], b: &[Observation]) -> Vec<(u32, u32)> {
    let off = |i: usize, j: usize| {
        let [x, y] = pixels.carried(&b[j]);
        (a[i].x_px - x).hypot(a[i].y_px - y)
    };
    let nearest_of_a = |j: usize| (0..a.len()).min_by(|&p, &q| off(p, j).total_cmp(&off(q, j)));
    let mut found = Vec::new();
    for i in 0..a.len() {
        let suitors = (0..b.len()).filter(|&j| nearest_of_a(j) == Some(i) && off(i, j) <= pixels.tolerance);
        found.extend(suitors.min_by(|&p, &q| off(i, p).total_cmp(&off(i, q))).map(|j| (i as u32, j as u32)));
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(45), failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn keypoints_are_those_of_comparing_all_with_all(
        a in prop::collection::vec((0.0..40.0f64, 0.0..30.0f64), 0..40),
        b in prop::collection::vec((0.0..20.0f64, 0.0..15.0f64), 0..40),
        shift in prop::array::uniform2(-5.0..5.0f64),
    ) {
        let keypoints = |places: &[(f64, f64)]| places.iter().map(|(x, y)| at(*x, *y)).collect::<Vec<_>>();
        let (a, b) = (keypoints(&a), keypoints(&b));
        let pixels = PixelMap { scale: [2.0, 2.0], shift, tolerance: 2.5 };
        prop_assert_eq!(pixels.same_keypoints(&a, &b, &|_| true), naive(&pixels, &a, &b));
    }
}

#[test]
fn photographs_are_shared_by_name_each_once_in_the_order_of_names() {
    let named = |names: &[&str]| Reconstruction {
        images: names
            .iter()
            .map(|name| crate::reconstruction::Image { name: (*name).into(), ..Default::default() })
            .collect(),
        ..Reconstruction::default()
    };
    let (a, b) = (named(&["c", "a", "x", "a"]), named(&["a", "b", "c", "c"]));
    let found: Vec<(String, u32, u32)> =
        shared_photos(&a, &b).into_iter().map(|p| (p.name, p.in_a.0, p.in_b.0)).collect();
    assert_eq!(found, [("a".into(), 1, 0), ("c".into(), 0, 2)]);
    assert!(shared_photos(&a, &named(&[])).is_empty());
}
