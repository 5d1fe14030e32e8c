use super::*;
use crate::format::colmap::{Encoding, RigRecord, SensorRecord};
use crate::geometry::CameraModel;
use crate::reconstruction::ColmapParts;

fn camera(focal: f64) -> Camera {
    Camera { model: CameraModel::SimplePinhole, width_px: 640, height_px: 480, params: vec![focal, 320.0, 240.0] }
}

fn with(cameras: &[f64]) -> Reconstruction {
    Reconstruction {
        cameras: cameras.iter().map(|focal| camera(*focal)).collect(),
        camera_ids: (1..=cameras.len() as u32).collect(),
        ..Reconstruction::default()
    }
}

/// Cameras 1 and 2 are in one rig.
fn in_a_rig(mut r: Reconstruction) -> Reconstruction {
    let sensor = |id: u32| SensorRecord { kind: SENSOR_CAMERA, id };
    let rig = RigRecord { id: 1, reference: Some(sensor(1)), others: vec![(sensor(2), None)] };
    r.colmap = Some(ColmapParts { encoding: Encoding::Binary, rigs: Some(vec![rig]), frames: None });
    r
}

#[test]
fn cameras_of_the_same_numbers_are_one_and_all_others_are_kept() {
    let parts = [with(&[500.0, 600.0]), with(&[600.0, 500.0, 700.0])];
    let moved: Vec<Moved<'_>> = parts.iter().map(|part| Moved::of(part, None)).collect();
    let found = Cameras::of(&moved);
    assert_eq!(found.cameras.iter().map(|c| c.params[0]).collect::<Vec<_>>(), [500.0, 600.0, 700.0]);
    assert_eq!(found.index, [vec![0, 1], vec![1, 0, 2]]);
    assert!(found.alone.iter().flatten().all(|alone| *alone));
}

#[test]
fn cameras_of_a_rig_stay_their_own() {
    let parts = [with(&[500.0, 600.0]), in_a_rig(with(&[500.0, 600.0]))];
    let moved: Vec<Moved<'_>> = parts.iter().map(|part| Moved::of(part, None)).collect();
    let found = Cameras::of(&moved);
    assert_eq!((found.cameras.len(), &found.index[1]), (4, &vec![2, 3]));
    assert_eq!(found.alone, [vec![true; 2], vec![false; 2]]);
}
