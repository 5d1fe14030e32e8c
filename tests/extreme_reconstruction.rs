//! Reconstructions at the limits of numbers, names and ids: what is read and written is read again, or refused by name.

use std::fs;
use std::path::Path;

use cityweld::{Reconstruction, Rotation3, Similarity, Vector3, read_reconstruction, write_colmap, write_ply};
use proptest::prelude::*;

/// What the files of a text model say, in words that may be any.
#[derive(Clone, Debug)]
struct Words {
    name: String,
    quaternion: [f64; 4],
    frame_quaternion: [f64; 4],
    translation: [f64; 3],
    position: [f64; 3],
    keypoint: [f64; 2],
    focal: f64,
    error: f64,
    point_id: u64,
    camera_id: u32,
    image_id: u32,
}

impl Words {
    fn plain() -> Words {
        Words {
            name: "a b/photo.jpg".into(),
            quaternion: [1.0, 0.0, 0.0, 0.0],
            frame_quaternion: [1.0, 0.0, 0.0, 0.0],
            translation: [0.0, 0.0, 5.0],
            position: [0.25, -0.5, 0.625],
            keypoint: [100.5, 200.25],
            focal: 500.0,
            error: 0.5,
            point_id: 5,
            camera_id: 1,
            image_id: 10,
        }
    }

    /// Writes the model as text.
    fn write(&self, folder: &Path) {
        let Words { name, focal, error, point_id, camera_id, image_id, .. } = self;
        let all = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let (q, t, fq) = (all(&self.quaternion), all(&self.translation), all(&self.frame_quaternion));
        let (x, k) = (all(&self.position), all(&self.keypoint));
        let file = |stem: &str, text: String| fs::write(folder.join(format!("{stem}.txt")), text).unwrap();
        file("cameras", format!("{camera_id} SIMPLE_PINHOLE 640 480 {focal} 320 240\n"));
        file("rigs", format!("1 2 CAMERA {camera_id} IMU 7 1 {fq} {t}\n"));
        file("frames", format!("1 1 {fq} {t} 1 CAMERA {camera_id} {image_id}\n"));
        file("images", format!("{image_id} {q} {t} {camera_id} {name}\n{k} {point_id}\n"));
        file("points3D", format!("{point_id} {x} 10 20 30 {error} {image_id} 0\n"));
    }

    fn read(&self) -> Result<Reconstruction, String> {
        let folder = tempfile::tempdir().unwrap();
        self.write(folder.path());
        read_reconstruction(folder.path()).map_err(|error| error.to_string())
    }
}

/// Any finite number, the largest, the smallest, and both zeros among them.
fn number() -> impl Strategy<Value = f64> {
    let special = [0.0, -0.0, 1.0, 1e308, -1e308, f64::MAX, 5e-324, 1e-320, 1e300, 1e154, -1e-154];
    prop_oneof![prop::sample::select(special.to_vec()), -1e3..1e3, prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL]
}

fn words() -> impl Strategy<Value = Words> {
    let name = prop_oneof!["\\PC{0,12}", "[a-c \\x01-\\x09\\x0b-\\x1f\\x7f]{0,12}", Just("x".repeat(70_000))];
    let id = || prop_oneof![Just(u32::MAX), Just(u32::MAX - 1), Just(0), 0..100_u32];
    let point_id = prop_oneof![Just(u64::MAX), Just(u64::MAX - 1), Just(1 << 63), Just(0), 0..100_u64];
    let vectors = (prop::array::uniform4(number()), prop::array::uniform4(number()), prop::array::uniform3(number()));
    let more = (prop::array::uniform3(number()), prop::array::uniform2(number()), number(), number());
    (name, vectors, more, point_id, id(), id()).prop_map(|(name, vectors, more, point_id, camera_id, image_id)| {
        let (quaternion, frame_quaternion, translation) = vectors;
        let (position, keypoint, focal, error) = more;
        let focal = focal.abs();
        Words {
            name,
            quaternion,
            frame_quaternion,
            translation,
            position,
            keypoint,
            focal,
            error,
            point_id,
            camera_id,
            image_id,
        }
    })
}

fn move_by(scale: f64) -> Similarity {
    let rotation = Rotation3::from_euler_angles(0.3, -0.4, 1.9);
    Similarity { scale, rotation, translation: Vector3::new(5e5, -6e6, 40.0) }
}

proptest! {
    #[test]
    fn what_is_read_and_written_is_read_again(words in words(), scale in prop_oneof![Just(1.0), Just(1e10), Just(1e-300), Just(1e300)]) {
        let Ok(read) = words.read() else { return Ok(()) };
        for moved in [read.clone(), read.transformed(&move_by(scale))] {
            let out = tempfile::tempdir().unwrap();
            if let Err(error) = write_colmap(out.path(), &moved) {
                prop_assert!(error.to_string().contains("at infinity"), "{}", error);
                continue;
            }
            let again = read_reconstruction(out.path());
            prop_assert!(again.is_ok(), "{}", again.unwrap_err());
            let again = again.unwrap();
            prop_assert_eq!(&again.points, &moved.points);
            // An image whose quaternion vanishes in numbers of this size has no pose, and is left out when it is read first.
            prop_assert_eq!(again.images.len(), moved.images.len());
            for (again, moved) in again.images.iter().zip(&moved.images) {
                prop_assert_eq!(&again.name, &moved.name);
                prop_assert_eq!(again.cam_from_sfm_translation, moved.cam_from_sfm_translation);
                let turned = again.cam_from_sfm_rotation.matrix() - moved.cam_from_sfm_rotation.matrix();
                prop_assert!(turned.amax() < 1e-12);
            }
        }
    }
}

#[test]
fn the_id_that_marks_no_point_is_refused_in_text_and_binary() {
    let message = Words { point_id: u64::MAX, ..Words::plain() }.read().unwrap_err();
    assert!(message.contains("18446744073709551615, which marks keypoints without a point"), "{message}");
    let words = Words { point_id: u64::MAX - 1, ..Words::plain() };
    let mut read = words.read().unwrap();
    read.colmap.as_mut().unwrap().encoding = cityweld::internals::Encoding::Binary;
    let folder = tempfile::tempdir().unwrap();
    write_colmap(folder.path(), &read).unwrap();
    assert_eq!(read_reconstruction(folder.path()).unwrap().point_ids, [u64::MAX - 1]);
    let path = folder.path().join("points3D.bin");
    let mut bytes = fs::read(&path).unwrap();
    bytes[8..16].fill(0xFF);
    fs::write(&path, bytes).unwrap();
    let message = read_reconstruction(folder.path()).unwrap_err().to_string();
    assert!(message.contains("marks keypoints without a point"), "{message}");
}

#[test]
fn quaternions_of_any_length_are_normalised_and_written_as_rotations() {
    for length in [1e-6, 1.0, 1e150, 1e200, 1e308] {
        let quaternion = [0.8 * length, 0.0, 0.6 * length, 0.0];
        let words = Words { quaternion, frame_quaternion: quaternion, ..Words::plain() };
        let moved = words.read().unwrap().transformed(&move_by(2.0));
        let frames = moved.colmap.as_ref().unwrap().frames.as_ref().unwrap();
        let norm = frames[0].rig_from_world.quaternion_wxyz.iter().map(|v| v * v).sum::<f64>().sqrt();
        assert!((norm - 1.0).abs() < 1e-12, "{length}: {norm}");
    }
    for quaternion in [[1e-320; 4], [0.0; 4]] {
        let message = Words { frame_quaternion: quaternion, ..Words::plain() }.read().unwrap_err();
        assert!(message.contains("a finite quaternion other than zero"), "{message}");
        let read = Words { quaternion, ..Words::plain() }.read().unwrap();
        assert!(read.images.is_empty(), "{quaternion:?}");
        let warnings: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
        assert!(warnings.iter().any(|warning| warning.contains("images without a pose")), "{warnings:?}");
    }
}

#[test]
fn a_move_beyond_the_largest_numbers_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let far_point = Words { position: [1e300, 0.0, 0.0], ..Words::plain() }.read().unwrap();
    let message = write_colmap(folder.path(), &far_point.transformed(&move_by(1e10))).unwrap_err().to_string();
    assert!(message.contains("point 5 at infinity") && message.contains("the scale"), "{message}");
    let message = write_ply(&folder.path().join("p.ply"), &far_point.transformed(&move_by(1e10))).unwrap_err();
    assert!(message.to_string().contains("point 5 at infinity"), "{message}");
    let far_camera = Words { translation: [0.0, 0.0, 1e300], ..Words::plain() }.read().unwrap();
    let message = write_colmap(folder.path(), &far_camera.transformed(&move_by(1e10))).unwrap_err().to_string();
    assert!(message.contains("image 10 at infinity"), "{message}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is written");
}

#[test]
fn names_that_an_encoding_cannot_hold_are_not_written() {
    use cityweld::internals::Encoding;
    let read = Words::plain().read().unwrap();
    for (encoding, name) in [
        (Encoding::Text, "a\nb.jpg".to_owned()),
        (Encoding::Text, " a.jpg".to_owned()),
        (Encoding::Binary, "a\0b.jpg".to_owned()),
        (Encoding::Binary, "a".repeat(1 << 17)),
    ] {
        let mut renamed = read.clone();
        renamed.images[0].name = name;
        renamed.colmap.as_mut().unwrap().encoding = encoding;
        let folder = tempfile::tempdir().unwrap();
        let message = write_colmap(folder.path(), &renamed).unwrap_err().to_string();
        assert!(message.contains("of image 10") && !message.contains(['\n', '\0']), "{message}");
    }
}

#[test]
fn focal_lengths_beyond_the_finite_are_refused_and_errors_are_taken_as_not_computed() {
    let read = Words { error: f64::INFINITY, ..Words::plain() }.read().unwrap();
    assert!(read.point_errors_px == [-1.0] && !read.warnings.is_empty(), "{:?}", read.point_errors_px);
    assert!(Words { error: -1.0, ..Words::plain() }.read().is_ok());
    assert!(Words { focal: f64::INFINITY, ..Words::plain() }.read().unwrap_err().contains("finite parameters"));
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_in_the_place_of_files_are_refused() {
    let pipe = |path: &Path| assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
    for stem in ["cameras", "images", "points3D", "rigs", "frames"] {
        let folder = tempfile::tempdir().unwrap();
        Words::plain().write(folder.path());
        let path = folder.path().join(format!("{stem}.txt"));
        fs::remove_file(&path).unwrap();
        pipe(&path);
        let message = read_reconstruction(folder.path()).unwrap_err().to_string();
        assert!(message.contains("it is a pipe") && message.contains(stem), "{message}");
    }
    let folder = tempfile::tempdir().unwrap();
    pipe(&folder.path().join("cloud.ply"));
    let message = read_reconstruction(&folder.path().join("cloud.ply")).unwrap_err().to_string();
    assert!(message.contains("it is a pipe"), "{message}");
    let message = read_reconstruction(Path::new("/dev/zero")).unwrap_err().to_string();
    assert!(message.contains("it is a device"), "{message}");
}

#[test]
fn what_would_steer_a_terminal_is_written_out_in_messages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.ply");
    for header in [
        "element vertex 1\nproperty float x\nproperty float x\x1b[2J\u{9b}2J\nproperty float x\x1b[2J\u{9b}2J\n",
        "element vertex 1\nproperty float x\x1b[2J\n",
        "element vertex\x1b[2J 1\nproperty float x\n",
        "element a\x1b[2J 1\nelement a\x1b[2J 1\n",
        "property \x1b[2J x\n",
    ] {
        fs::write(&path, format!("ply\nformat ascii 1.0\n{header}end_header\n")).unwrap();
        let message = read_reconstruction(&path).unwrap_err().to_string();
        assert!(!message.contains(char::is_control), "{message:?}");
    }
    let words = Words::plain();
    words.write(folder.path());
    fs::write(folder.path().join("cameras.txt"), "# cameras\n1 PIN\x1b[2J\u{9b} 640 480 1 1 1 1\n").unwrap();
    let message = read_reconstruction(folder.path()).unwrap_err().to_string();
    assert!(message.contains("PIN\\u{1b}[2J\\u{9b}"), "{message:?}");
}
