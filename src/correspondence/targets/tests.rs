use super::*;
use crate::city::ObjectId;
use crate::geometry::{Plane, Point3};
use crate::robust::Random;

/// Walls that face the azimuths, degrees, and a floor; a square metre each.
fn targets(azimuths_deg: &[f64]) -> Targets {
    let plane = |normal: Vector3<f64>| CityPlane {
        plane: Plane { normal, offset: 0.0 },
        facets: Vec::new(),
        area_m2: 1.0,
        low: Point3::origin(),
        high: Point3::origin(),
        object: ObjectId(0),
    };
    let walls = azimuths_deg.iter().map(|deg| deg.to_radians().sin_cos());
    let mut planes: Vec<CityPlane> = walls.map(|(sin, cos)| plane(Vector3::new(cos, sin, 0.0))).collect();
    planes.push(plane(Vector3::z()));
    let named: Vec<PlaneId> = (0..planes.len() as u32).map(PlaneId).collect();
    Targets::new(&CityPlanes { planes, plane_of_facet: Vec::new() }, &named, 0.5)
}

#[test]
fn finds_the_walls_that_face_an_azimuth_across_the_half_turn_too() {
    let targets = targets(&[0.0, 90.0, 175.0, -175.0, -90.0]);
    let facing = |deg: f64, reach: f64| -> Vec<u32> {
        let mut ids: Vec<u32> = Vec::new();
        targets.each_facing(f64::to_radians(deg), reach.to_radians(), |t| ids.push(t.id.0));
        ids.sort();
        ids
    };
    assert_eq!(facing(0.0, 10.0), [0]);
    assert_eq!(facing(180.0, 10.0), [2, 3]);
    assert_eq!(facing(-179.0, 10.0), [2, 3]);
    assert_eq!(facing(450.0, 1.0), [1]);
    assert_eq!(facing(30.0, 180.0), [0, 1, 2, 3, 4]);
}

#[test]
fn level_planes_stand_apart_and_small_ones_are_not_offered() {
    let all = targets(&[0.0, 90.0]);
    assert_eq!((all.all().count(), all.level.targets.len()), (3, 1));
    let planes = CityPlanes::default();
    assert_eq!(Targets::new(&planes, &[], 0.5).all().count(), 0);
}

#[test]
fn all_that_face_a_direction_and_stand_at_a_place_are_found_once_among_thousands() {
    let mut random = Random::stream(2, 0);
    let mut any = |extent: f64| extent * (random.unit() - 0.5);
    let mut plane = || {
        let (sin, cos) = any(7.0).sin_cos();
        let low = Point3::new(any(400.0), any(300.0), any(10.0));
        let normal = Vector3::new(cos, sin, any(8.0)).normalize();
        let high = low + Vector3::new(any(20.0).abs(), any(20.0).abs(), 5.0);
        let plane = Plane { normal, offset: 0.0 };
        CityPlane { plane, facets: Vec::new(), area_m2: 9.0, low, high, object: ObjectId(0) }
    };
    let planes: Vec<CityPlane> = (0..3000).map(|_| plane()).collect();
    let named: Vec<PlaneId> = (0..3000).map(PlaneId).collect();
    let targets = Targets::new(&CityPlanes { planes, plane_of_facet: Vec::new() }, &named, 0.5);
    assert_eq!(targets.all().count(), 3000);
    let mut found = 0;
    for _ in 0..200 {
        let (azimuth, reach) = (any(7.0), any(1.0).abs());
        let low = Vector3::new(any(400.0), any(300.0), any(10.0));
        let bounds = Bounds::in_space(&low, &(low + Vector3::new(any(100.0).abs(), any(100.0).abs(), 6.0)));
        let ids = |level: bool| {
            let mut ids = Vec::new();
            let visit = |t: &Target| ids.push(t.id);
            if level {
                targets.each_level(&bounds, visit);
            } else {
                targets.each_facing_within(azimuth, reach, &bounds, visit);
            }
            ids.sort();
            ids
        };
        let expected = |level: bool| {
            let is_level = |t: &&Target| !has_azimuth(&t.normal());
            let faces = |t: &&Target| level || wrapped(t.azimuth() - azimuth).abs() <= reach;
            let within = |t: &&Target| is_level(t) == level && faces(t) && t.bounds.meets(&bounds);
            let mut ids: Vec<PlaneId> = targets.all().filter(within).map(|t| t.id).collect();
            ids.sort();
            ids
        };
        for level in [false, true] {
            assert_eq!(ids(level), expected(level));
            found += ids(level).len();
        }
    }
    assert!(found > 500, "{found}");
}
