use super::*;
use crate::geometry::{Similarity, StartSigmas};
use crate::planes::patches;
use crate::synthetic::{Block, CloudOptions};

#[test]
fn lengths_are_told_as_a_person_says_them() {
    assert_eq!(["0 m", "9999 m", "12 km", "5,780 km"], [0.2, 9999.0, 12_345.0, 5.78e6].map(length));
}

/// What stands in the way of a cloud of four houses from a start that is changed.
fn met(change: impl FnOnce(&mut Similarity, &mut StartSigmas)) -> Option<Obstacle> {
    let block = Block::four_houses().with_ground();
    let (city, survey) = (block.city().unwrap(), block.cloud(&CloudOptions::default()));
    let limits = Limits::default();
    let patches = patches(&survey.sfm, None, &limits.patches);
    let mut pose = survey.city_from_sfm.relative_to(&city.origin);
    let mut sigmas = StartSigmas::default();
    change(&mut pose, &mut sigmas);
    of_inputs(&city, &survey.sfm, &patches)
        .or_else(|| of_start(&city, &patches, &Start::new(pose, sigmas).unwrap(), &limits))
}

#[test]
fn nothing_stands_in_the_way_of_a_start_near_the_city() {
    assert_eq!(met(|_, _| ()), None);
    assert_eq!(met(|pose, _| pose.translation.x += 60.0), None);
}

#[test]
fn a_start_from_which_no_point_reaches_the_city_is_named_with_both_places() {
    let far = met(|pose, _| pose.translation.y += 5000.0).unwrap();
    assert!(
        matches!(far, Obstacle::FarFromTheCity { distance_m, .. } if (4800.0..5100.0).contains(&distance_m)),
        "{far}"
    );
    assert!(far.to_string().contains("check that start and city are in the same frame"));
    // The same start with sigmas that reach so far is none.
    assert_eq!(
        met(|pose, sigmas| (pose.translation.y, sigmas.position_m) = (pose.translation.y + 5000.0, 3000.0)),
        None
    );
}

#[test]
fn a_scale_of_no_place_is_named() {
    for factor in [1e-6, 1e9] {
        let odd = met(|pose, _| pose.scale *= factor).unwrap();
        assert!(matches!(odd, Obstacle::OddSize { .. }) && odd.to_string().contains("check the scale"), "{odd}");
    }
}

#[test]
fn a_city_without_facets_and_a_cloud_without_points_or_planes_are_named() {
    let empty = CityModel::default();
    let nothing = Reconstruction::default();
    let none = Patches::default();
    assert_eq!(of_inputs(&empty, &nothing, &none), Some(Obstacle::EmptyCity));
    let city = Block::four_houses().city().unwrap();
    assert_eq!(of_inputs(&city, &nothing, &none), Some(Obstacle::NoPoints { images: 0 }));
    let alone = Reconstruction { points: vec![Point3::origin()], ..Reconstruction::default() };
    let found = of_inputs(&city, &alone, &none).unwrap();
    assert!(matches!(found, Obstacle::NoPatches { points: 1, .. }), "{found}");
}
