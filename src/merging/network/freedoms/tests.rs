use super::*;
use crate::geometry::Point3;
use crate::robust::MotionParameters;

/// So well held in each of the seven unknowns, one sigma as a share of the radius.
fn held(sigmas: [f64; 7]) -> Held {
    let radius = 4.0;
    let information = Matrix7::from_diagonal(&sigmas.map(|s| (s * radius).powi(-2)).into());
    Held { parameters: MotionParameters::of_similarity(Point3::origin(), radius), information }
}

#[test]
fn the_loosest_freedom_comes_first_and_each_is_named() {
    let limits = MergeLimits::default();
    let found = in_a_parts_frame(&held([1e-3, 2e-3, 2.5e-3, 0.1, 5e-3, 6e-3, 7e-3]), &limits);
    assert_eq!(found.len(), 7);
    assert_eq!((found[0].kind, found[1].kind), (FreedomKind::Shift, FreedomKind::Scale));
    assert!((found[0].direction - Vector3::x()).norm() < 1e-9);
    assert_eq!(found.iter().filter(|f| f.kind == FreedomKind::Turn).count(), 3);
    // The bend of parts is in every sigma.
    let floor = limits.network.edge_floor;
    assert!((found[0].sigma - 0.1f64.hypot(floor) * 4.0).abs() < 1e-9);
    assert!((found[1].sigma - 7e-3f64.hypot(floor)).abs() < 1e-9);
    let determined: Vec<bool> = found.iter().map(|f| f.determined).collect();
    assert_eq!(determined, [false, false, false, false, true, true, true], "3 in a thousand of the radius");
}

#[test]
fn what_nothing_holds_is_known_as_well_as_the_scene_is_large() {
    let mut free = held([1e-3; 7]);
    free.information[(5, 5)] = 0.0;
    let found = in_a_parts_frame(&free, &MergeLimits::default());
    assert!((found[0].sigma - 4.0).abs() < 1e-3 && !found[0].determined && found[0].kind == FreedomKind::Shift);
    assert!(found[1..].iter().all(|f| f.determined));
}

#[test]
fn in_the_city_freedoms_have_metres_and_names() {
    let found = in_the_city(&held([1e-3; 7]), &MergeLimits::default().verdict);
    assert_eq!(found.len(), 7);
    assert!(found.iter().all(|f| f.determined && !f.name.is_empty()), "{found:?}");
    assert!(found.iter().any(|f| f.unit == FreedomUnit::Metre));
}

#[test]
fn directions_have_one_sense() {
    for v in [Vector3::new(1.0, -3.0, 2.0), Vector3::new(-1.0, 0.2, 0.1), Vector3::z()] {
        assert_eq!(positive(&v), positive(&-v));
        let unit = positive(&v);
        assert!(unit[unit.iamax()] > 0.0 && (unit.norm() - 1.0).abs() < 1e-12);
    }
}
