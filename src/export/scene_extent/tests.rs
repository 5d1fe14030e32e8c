use super::*;

#[test]
fn a_few_points_far_away_do_not_widen_a_scene() {
    let mut points: Vec<Point3<f64>> = (0..100).map(|k| Point3::new(f64::from(k), 2.0 * f64::from(k), 5.0)).collect();
    points.push(Point3::new(1e9, -1e9, 1e9));
    let extent = Extent::of_points(&points).unwrap();
    assert!(extent.low.x >= 0.0 && extent.high.x <= 99.0 && extent.high.y <= 198.0 && extent.high.z == 5.0);
    assert!((extent.diagonal() - (extent.high - extent.low).norm()).abs() < 1e-12);
    assert!(Extent::of_points(&[]).is_none());
}

#[test]
fn a_floor_whose_corners_are_all_far_off_is_near_where_it_lies_under_the_scene() {
    let extent = Extent { low: Vector3::zeros(), high: Vector3::new(10.0, 10.0, 10.0) };
    let square = |middle: [f64; 2], half: f64| {
        [[-half, -half], [half, -half], [half, half], [-half, half]]
            .map(|[x, y]| Point3::new(middle[0] + x, middle[1] + y, 0.0))
    };
    assert!(extent.is_near(square([0.0, 0.0], 1e5).iter()));
    assert!(extent.is_near(square([10.0 + CITY_MARGIN_M, 0.0], 1.0).iter()));
    assert!(!extent.is_near(square([12.0 + CITY_MARGIN_M, 0.0], 1.0).iter()));
}

#[test]
fn light_rises_with_its_number_and_ends_at_black_and_white() {
    let of = |v: u8| linear([v, v, v])[0];
    assert_eq!((of(0), of(255), linear([1, 2, 3])[3]), (0, 65535, 65535));
    for v in 0..255 {
        assert!(of(v) < of(v + 1), "{v}");
    }
}

#[test]
fn up_becomes_the_second_axis() {
    assert_eq!(turned(&Point3::new(1.0, 2.0, 3.0)), [1.0, 3.0, -2.0]);
}
