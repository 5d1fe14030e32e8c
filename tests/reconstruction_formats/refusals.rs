//! What is none of these formats, or a damaged one.

use super::*;

#[test]
fn what_is_none_of_these_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content, words) in [
        ("a.psx", "<document version=\"1.2.0\"/>", "Metashape"),
        ("b.xyz", "1 2 3\n", "text cloud"),
        ("c.sfm", "{\"featuresFolders\": []}", "Meshroom"),
        ("d.pcd", "# .PCD v0.7\n", "PCD"),
        ("e.json", "{\"type\": \"CityJSON\"}", "city"),
        ("f.json", "{}", "another kind of file"),
    ] {
        let message = read_reconstruction(&write(folder.path(), name, content)).unwrap_err().to_string();
        assert!(message.contains(words), "{name}: {message}");
    }
}

/// A small file of each format that is text, with two cameras and a point or two.
const SMALL_FILES: [(&str, &str); 5] = [
    (
        "scene.nvm",
        "NVM_V3\n\n2\na.jpg 500 1 0 0 0 0 0 0 -0.1 0\nb.jpg 510 0.9 0 0.1 0 1 2 3 0 0\n\n1\n0.5 -0.5 4 255 128 0 2 0 7 320 240 1 4 -3 7\n\n0\n",
    ),
    (
        "bundle.out",
        "# Bundle file v0.3\n2 1\n500 -0.1 0.01\n1 0 0\n0 1 0\n0 0 1\n0.5 0 -3\n500 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n1 2 -3\n255 128 0\n2 0 17 -3.5 40 1 0 5 6\n",
    ),
    (
        "reconstruction.json",
        r#"[{"cameras": {"c": {"projection_type": "brown", "width": 40, "height": 30, "focal_x": 0.9, "focal_y": 0.9,
        "k1": 0.1}}, "shots": {"a.jpg": {"rotation": [0.1, 0, 0], "translation": [1, 2, 3], "camera": "c", "gps_position": [4, 5, 6]}},
        "points": {"7": {"color": [1, 2, 3], "coordinates": [0, 0, 9]}}, "reference_lla": {"latitude": 52.5, "longitude": 13.4}}]"#,
    ),
    (
        "transforms.json",
        r#"{"w": 960, "h": 720, "fl_x": 700.5, "camera_model": "OPENCV", "k1": 0.1, "applied_transform":
        [[1,0,0,0],[0,0,1,0],[0,-1,0,0]], "frames": [{"file_path": "a.jpg", "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]}"#,
    ),
    (
        "sfm_data.json",
        r#"{"sfm_data_version": "0.3", "views": [{"key": 4, "value": {"polymorphic_id": 1073741824, "ptr_wrapper": {"id": 1,
        "data": {"filename": "b.jpg", "id_intrinsic": 0, "id_pose": 4}}}}], "intrinsics": [{"key": 0, "value": {"polymorphic_id":
        2147483649, "polymorphic_name": "pinhole_radial_k1", "ptr_wrapper": {"data": {"width": 8, "height": 6, "focal_length": 9,
        "principal_point": [4, 3], "disto_k1": [0.1]}}}}], "extrinsics": [{"key": 4, "value": {"rotation": [[1,0,0],[0,1,0],[0,0,1]],
        "center": [1,2,3]}}], "structure": [{"key": 0, "value": {"X": [0, 0, 9], "observations": [{"key": 4, "value": {"x": [4, 3]}}]}}]}"#,
    ),
];

#[test]
fn changed_and_cut_files_are_refused_or_read_with_finite_numbers() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in SMALL_FILES {
        let sound = read_reconstruction(&write(folder.path(), name, text)).unwrap_or_else(|error| panic!("{error}"));
        assert!(!sound.images.is_empty(), "{name}");
        for at in 0..text.len() {
            let mut changes = vec![text.as_bytes()[..at].to_vec()];
            for value in *b"9-e. ]\"\0" {
                let mut changed = text.as_bytes().to_vec();
                changed[at] = value;
                changes.push(changed);
            }
            for changed in changes {
                let path = folder.path().join(name);
                std::fs::write(&path, &changed).unwrap();
                let Ok(read) = read_reconstruction(&path) else { continue };
                assert!(read.points.iter().flat_map(|p| p.iter()).all(|v| v.is_finite()), "{name} {at}");
                let poses = read
                    .images
                    .iter()
                    .flat_map(|i| i.cam_from_sfm_translation.iter().chain(i.cam_from_sfm_rotation.matrix()));
                assert!(poses.into_iter().all(|v| v.is_finite()), "{name} {at}");
                assert!(read.images.iter().all(|image| (image.camera.0 as usize) < read.cameras.len()), "{name} {at}");
            }
        }
    }
}
