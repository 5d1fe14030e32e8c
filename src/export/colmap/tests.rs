use super::*;
use crate::geometry::Similarity;
use crate::reconstruction::read_reconstruction;
use crate::synthetic::{Block, CaptureOptions, Ring};

fn made() -> Reconstruction {
    let block = Block::four_houses();
    let options = CaptureOptions { places: 200, ..CaptureOptions::default() };
    block.capture(&Ring::street(6).stations(&block), &options).sfm
}

#[test]
fn a_model_that_was_written_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    for encoding in [Encoding::Binary, Encoding::Text] {
        let mut given = made();
        given.colmap = Some(ColmapParts { encoding, rigs: None, frames: None });
        let path = folder.path().join(encoding.extension());
        write_colmap(&path, &given).unwrap();
        let read = read_reconstruction(&path).unwrap();
        assert_eq!((&read.points, &read.point_ids, &read.colors), (&given.points, &given.point_ids, &given.colors));
        assert_eq!((&read.track_starts, &read.track_elements), (&given.track_starts, &given.track_elements));
        assert_eq!(read.cameras, given.cameras);
        assert!(read.warnings.is_empty(), "{:?}", read.warnings);
        for (a, b) in read.images.iter().zip(&given.images) {
            assert_eq!((&a.name, &a.observations), (&b.name, &b.observations));
            assert!((a.cam_from_sfm_rotation.matrix() - b.cam_from_sfm_rotation.matrix()).norm() < 1e-14);
            assert!((a.cam_from_sfm_translation - b.cam_from_sfm_translation).norm() < 1e-12);
        }
    }
}

#[test]
fn what_a_hand_made_reconstruction_lacks_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model");
    type Spoil = fn(&mut Reconstruction);
    let cases: [(Spoil, &str); 6] = [
        (|r| r.point_ids.truncate(3), "an id for every point"),
        (|r| r.images[1].camera.0 = 9, "a camera for every image"),
        (|r| r.images[0].observations[0].point = Some(PointIndex(1_000_000)), "keypoints of points that are there"),
        (|r| r.track_elements[0].0.0 = 77, "tracks over images that are there"),
        (|r| r.points[2].z = f64::NAN, "finite coordinates"),
        (|r| r.transform(&Similarity { scale: 1e308, ..Similarity::identity() }), "finite coordinates"),
    ];
    for (spoil, expected) in cases {
        let mut given = made();
        spoil(&mut given);
        let error = write_colmap(&path, &given).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
        assert!(!path.exists());
    }
}
