use super::*;
use crate::geometry::Vector3;
use crate::random::Random;

fn cloud(random: &mut Random, count: usize) -> Vec<Point3<f64>> {
    (0..count).map(|_| Point3::new(100.0 + 5.0 * random.normal(), 3.0 * random.normal(), random.normal())).collect()
}

#[test]
fn the_radius_holds_all_but_two_in_a_hundred() {
    let points = cloud(&mut Random::stream(41, 0), 1000);
    let Extent { center, radius } = Extent::of(&points);
    let inside = points.iter().filter(|p| (*p - center).norm() <= radius).count();
    assert!((978..=982).contains(&inside), "{inside}");
}

#[test]
fn a_few_points_in_the_sky_change_little() {
    let points = cloud(&mut Random::stream(42, 0), 1000);
    let mut with_sky = points.clone();
    with_sky.extend((0..10).map(|k| Point3::new(0.0, 0.0, 1e6 + f64::from(k))));
    let (one, other) = (Extent::of(&points), Extent::of(&with_sky));
    assert!((one.center - other.center).norm() < 0.3 && (one.radius / other.radius - 1.0).abs() < 0.2);
}

#[test]
fn moved_and_scaled_points_have_the_moved_and_scaled_extent() {
    let points = cloud(&mut Random::stream(43, 0), 301);
    let moved: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(p.coords * 3.0) + Vector3::repeat(7.0)).collect();
    let (one, other) = (Extent::of(&points), Extent::of(&moved));
    assert!((other.center - (one.center * 3.0 + Vector3::repeat(7.0))).norm() < 1e-9);
    assert!((other.radius - 3.0 * one.radius).abs() < 1e-9);
}

#[test]
fn no_points_and_one_place_have_a_radius_too() {
    assert_eq!(Extent::of(&[]).radius, 1.0);
    let one = Extent::of(&[Point3::new(4.0, 5.0, 6.0); 3]);
    assert_eq!((one.center, one.radius), (Point3::new(4.0, 5.0, 6.0), 1.0));
}
