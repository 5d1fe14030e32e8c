use super::*;
use crate::synthetic::{Block, CaptureOptions, Ring};

#[test]
fn a_camera_in_gltf_stands_and_looks_as_the_photograph_did() {
    let block = Block::four_houses();
    let survey = block.capture(&Ring::street(6).stations(&block), &CaptureOptions::default());
    for image in &survey.sfm.images {
        let (UnitQuaternion([x, y, z, w]), center) = camera_pose(image, &survey.city_from_sfm);
        let gltf_from_cam =
            crate::geometry::UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, x, y, z).cast());
        assert!((center - survey.city_from_sfm.apply(&image.center())).norm() < 1e-9);
        // A point ahead in the photograph is ahead of the frustum.
        let x_in_sfm =
            image.center() + image.cam_from_sfm_rotation.inverse() * crate::geometry::Vector3::new(0.1, 0.2, 1.0);
        let ahead = survey.city_from_sfm.apply(&x_in_sfm) - center;
        let turned = crate::geometry::Vector3::new(ahead.x, ahead.z, -ahead.y);
        let by_node = gltf_from_cam * crate::geometry::Vector3::new(0.1, 0.2, 1.0) * survey.city_from_sfm.scale;
        assert!((turned - by_node).norm() < 1e-5 * turned.norm(), "{turned} {by_node}");
    }
}

#[test]
fn frustums_have_their_limits_where_there_are_metres_only() {
    let extent =
        |size: f64| Extent { low: crate::geometry::Vector3::zeros(), high: crate::geometry::Vector3::repeat(size) };
    assert_eq!(frustum_depth(&extent(0.1), Some(FRUSTUM_LIMITS_M)), FRUSTUM_LIMITS_M.0);
    assert_eq!(frustum_depth(&extent(1e5), Some(FRUSTUM_LIMITS_M)), FRUSTUM_LIMITS_M.1);
    let free = frustum_depth(&extent(0.1), None);
    assert!((free - FRUSTUM_SHARE * 0.1 * 3f64.sqrt()).abs() < 1e-12);
}

#[test]
fn what_has_no_place_in_single_precision_is_left_out() {
    let block = Block::four_houses();
    let survey = block.capture(&Ring::street(4).stations(&block), &CaptureOptions::default());
    let far = Similarity { scale: 1e60, ..survey.city_from_sfm };
    let placed = Placed { reconstruction: &survey.sfm, point_colors: &[], city_from_sfm: far };
    assert!(points_node(&mut Glb::default(), &placed).is_none());
    assert!(cameras_node(&mut Glb::default(), &placed, f64::INFINITY).is_none());
    let near = Placed { city_from_sfm: survey.city_from_sfm, ..placed };
    assert!(
        points_node(&mut Glb::default(), &near).is_some() && cameras_node(&mut Glb::default(), &near, 1.0).is_some()
    );
}
