use super::*;
use crate::city::ObjectId;
use crate::geometry::{Similarity, Start};
use crate::planes::{CityPlane, PlaneId};
use crate::robust::Motion;

fn belief(motion: Motion) -> ScaleTranslationEstimate {
    let (start, limits) = (Start::with_default_sigmas(Similarity::identity()), Limits::default());
    let prior = Prior::new(&start, Point3::origin(), 40.0, motion, Vertical::Free, None, &limits);
    ScaleTranslationEstimate::new(&prior, Matrix3::identity(), RowErrors::new(&limits, 40.0))
}

fn wall(low: f64, offset: f64) -> Target {
    let plane = CityPlane {
        plane: Plane { normal: Vector3::x(), offset },
        facets: Vec::new(),
        area_m2: 1.0,
        low: Point3::new(5.0, 30.0, low),
        high: Point3::new(5.0, 50.0, low + 5.0),
        object: ObjectId(0),
    };
    Target::new(PlaneId(0), &plane)
}

#[test]
fn an_open_spin_moves_a_patch_within_its_plane_and_not_across() {
    let belief = belief(Motion::Similarity);
    let spinning = belief.spinning(Vector3::x() * 0.5);
    let place = Point3::new(5.0, 40.0, 0.0);
    // The wall stands 45 m higher: out of reach, but for a spin of some sigmas about the wall's own normal.
    assert!(belief.predict(&place).likelihood(&wall(0.0, -5.0)).is_some());
    assert!(belief.predict(&place).likelihood(&wall(45.0, -5.0)).is_none());
    assert_eq!(
        spinning.predict(&place).likelihood(&wall(45.0, -5.0)),
        belief.predict(&place).likelihood(&wall(0.0, -5.0))
    );
    assert!(spinning.predict(&place).likelihood(&wall(45.0, -80.0)).is_none());
}

#[test]
fn a_pair_narrows_what_is_known_across_its_plane_and_along_it_nothing() {
    let mut belief = belief(Motion::Rigid);
    let place = Point3::new(0.0, 0.0, 0.0);
    let before = [Vector3::x(), Vector3::y()].map(|n| belief.variance(&place, &n));
    belief.learn(&place, &Plane { normal: Vector3::x(), offset: -4.0 });
    let after = [Vector3::x(), Vector3::y()].map(|n| belief.variance(&place, &n));
    assert!(after[0] < 0.1 && before[0] > 99.0 && after[1] == before[1], "{before:?} {after:?}");
    // The wall at x = 4 pulls the place there.
    assert!((belief.mean[1] - 4.0).abs() < 0.01, "{}", belief.mean);
}

#[test]
fn a_completion_meets_the_least_known_direction_and_says_with_which_chance() {
    let mut belief = belief(Motion::Rigid);
    for normal in [Vector3::x(), Vector3::y()] {
        belief.learn(&Point3::origin(), &Plane { normal, offset: 0.0 });
    }
    let (rows, chance) = belief.completion(1, &mut Random::stream(1, 0)).unwrap();
    assert!(rows[0].normal.z.abs() > 0.999, "{:?}", rows[0]);
    // Three sigmas of height are 9 m to either side, and a metre is near enough.
    assert!((chance - 1.0 / 9.0).abs() < 0.01 && rows[0].offset.abs() <= 9.0, "{chance}");
}

#[test]
fn what_is_least_known_does_not_depend_on_the_unit_of_the_reconstruction() {
    // 15 % of scale move the rim of a scene of 40 m by 6 m, more than the height's 3 m and less than the place's 10.
    let belief = belief(Motion::Similarity);
    let (rows, _) = belief.completion(2, &mut Random::stream(1, 0)).unwrap();
    assert!(rows.iter().all(|row| row.normal.z.abs() < 1e-9), "{rows:?}");
    assert!(belief.completion(3, &mut Random::stream(1, 0)).is_none(), "the third is the scale alone");
}
