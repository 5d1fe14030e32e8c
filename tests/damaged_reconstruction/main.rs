//! Damaged, lying and odd reconstructions: each is met with one clear error, or tolerated with a counted warning.
//! `tests/data/reconstruction/make_damaged.py` makes the files and says what is wrong in each.

mod chance;
mod clouds;

use std::fs;
use std::path::{Path, PathBuf};

use cityweld::internals::{Encoding, WarningKind};
use cityweld::types::PointIndex;
use cityweld::{Reconstruction, read_reconstruction, write_colmap, write_ply};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reconstruction")
}

fn files_of(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// The model `name`: the files of its folder, the others as in `sound` or `sound_framed`.
fn model(kind: &str, name: &str) -> tempfile::TempDir {
    let folder = data().join(kind);
    let own = files_of(&folder.join(name));
    let is_framed = own.iter().any(|path| ["rigs", "frames"].contains(&path.file_stem().unwrap().to_str().unwrap()));
    let base = files_of(&folder.join(if is_framed { "sound_framed" } else { "sound" }));
    let made = tempfile::tempdir().unwrap();
    for path in base.iter().chain(&own) {
        fs::copy(path, made.path().join(path.file_name().unwrap())).unwrap();
    }
    made
}

/// (folder below tests/data/reconstruction, what the message says beside the path)
const REFUSED_MODELS: [(&str, &[&str]); 48] = [
    ("binary/cameras_cut", &["cameras.bin", "byte 56", "camera record 1 of 1", "8 more bytes", "after 5"]),
    ("binary/images_cut", &["images.bin", "image 11", "at most 2 observations", "a count of 3"]),
    ("binary/points_cut", &["points3D.bin", "point record 3 of 3", "51 more bytes", "after 49"]),
    ("binary/cameras_count_lies", &["cameras.bin", "byte 8", "count of cameras", "a count of 4000000000"]),
    ("binary/images_count_lies", &["images.bin", "byte 8", "count of images", "a count of 4000000000"]),
    ("binary/points_count_lies", &["points3D.bin", "byte 8", "count of points", "at most 3 points in", "4000000000"]),
    ("binary/points_count_overflows", &["points3D.bin", "count of points", "a count of 18446744073709551615"]),
    ("binary/points_count_too_low", &["points3D.bin", "after 2 points", "the end of the file", "59 bytes more"]),
    ("binary/keypoint_count_lies", &["images.bin", "image 10", "observations", "a count of 4000000000"]),
    ("binary/track_length_lies", &["points3D.bin", "point 5", "track elements", "a count of 4000000000"]),
    ("binary/name_without_end", &["images.bin", "image 10", "a name that ends with a zero byte", "none"]),
    ("binary/camera_model_unknown", &["cameras.bin", "camera 1", "a camera model id from 0 to 17", "got 99"]),
    ("binary/camera_nan", &["cameras.bin", "camera 1", "finite parameters", "NaN"]),
    ("binary/camera_without_focal_length", &["cameras.bin", "camera 1", "a focal length above zero"]),
    ("binary/camera_without_size", &["cameras.bin", "camera 1", "at least one pixel", "0 x 480 pixels"]),
    ("binary/camera_id_twice", &["cameras.bin", "camera 1", "ids that differ", "this id twice"]),
    ("binary/image_id_twice", &["images.bin", "image 10", "ids that differ", "this id twice"]),
    ("binary/image_of_missing_camera", &["images.bin", "image 10", "a camera of the model", "camera 3"]),
    ("binary/keypoint_nan", &["images.bin", "keypoint 0 of image 10", "a finite position"]),
    ("binary/point_id_twice", &["points3D.bin", "point 5", "ids that differ", "this id twice"]),
    ("binary/no_points", &["the reconstruction has no points"]),
    ("binary/empty_files", &["cameras.bin", "byte 0", "count of cameras", "8 more bytes", "the end of the file"]),
    ("binary/frames_cut", &["frames.bin", "frame record 2 of 2"]),
    ("binary/frames_data_count_lies", &["frames.bin", "frame record 1 of 1", "data ids", "a count of 4294967295"]),
    ("binary/frame_id_twice", &["frames.bin", "frame 1", "ids that differ"]),
    ("binary/frame_of_missing_rig", &["frames.bin", "frame 1", "a rig of the model", "rig 4"]),
    ("binary/frame_position_nan", &["frames.bin", "frame 1", "a finite translation"]),
    ("binary/rig_flag_unknown", &["rigs.bin", "rig record 1 of 1", "0 or 1 for a sensor's pose", "got 7"]),
    ("text/camera_model_unknown", &["cameras.txt", "line 2", "camera 1", "SIMPLE_PINHOLE, PINHOLE", "`FANCY`"]),
    ("text/camera_parameter_missing", &["line 2", "camera 1", "4 parameters of SIMPLE_RADIAL", "end of the line"]),
    ("text/camera_parameter_extra", &["cameras.txt", "line 2", "camera 1", "the end of the line", "`7`"]),
    ("text/image_line_cut", &["images.txt", "line 2", "image 10", "a translation TX TY TZ", "the end of the line"]),
    ("text/image_of_missing_camera", &["images.txt", "image 11", "a camera of the model", "camera 3"]),
    ("text/keypoints_cut", &["images.txt", "line 5", "image 11", "a keypoint X Y POINT3D_ID", "the end of the line"]),
    ("text/keypoint_no_number", &["images.txt", "line 3", "image 10", "a keypoint X Y POINT3D_ID", "`11O.5`"]),
    ("text/keypoint_nan", &["images.txt", "keypoint 1 of image 10", "a finite position"]),
    ("text/keypoint_of_negative_point", &["images.txt", "line 3", "image 10", "a point id or -1", "`-7`"]),
    ("text/keypoint_line_missing", &["images.txt", "line 3", "image 10", "second line"]),
    ("text/point_position_word", &["points3D.txt", "line 3", "point 7", "a position X Y Z", "`far`"]),
    ("text/point_color_300", &["points3D.txt", "line 2", "point 5", "from 0 to 255", "`300`"]),
    ("text/point_line_cut", &["points3D.txt", "line 4", "point 9", "a colour", "the end of the line"]),
    ("text/point_id_twice", &["points3D.txt", "point 5", "ids that differ"]),
    ("text/track_cut", &["points3D.txt", "line 4", "point 9", "an observation's index", "the end of the line"]),
    ("text/track_image_beyond_u32", &["points3D.txt", "line 4", "point 9", "below 2^32", "`99999999999`"]),
    ("text/no_points", &["the reconstruction has no points"]),
    ("text/rig_sensor_unknown", &["rigs.txt", "line 2", "rig 1", "a sensor type, CAMERA or IMU", "`LIDAR`"]),
    ("text/rig_cut", &["rigs.txt", "line 2", "rig 1", "a sensor type", "the end of the line"]),
    ("text/frame_cut", &["frames.txt", "line 2", "frame 1", "the end of the line"]),
];

#[test]
fn every_damaged_model_is_refused_with_place_and_object() {
    let mut failures = Vec::new();
    for (name, fragments) in REFUSED_MODELS {
        let (kind, name) = name.rsplit_once('/').unwrap();
        let folder = model(kind, name);
        let message = read_reconstruction(folder.path()).expect_err(name).to_string();
        println!("{kind}/{name}: {message}");
        assert!(message.starts_with(folder.path().to_str().unwrap()), "{name}: {message}");
        let absent = fragments.iter().filter(|fragment| !message.contains(**fragment));
        failures.extend(absent.map(|fragment| format!("{name}: `{fragment}` is not in: {message}")));
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn every_damaged_model_file_has_an_expectation() {
    for kind in ["binary", "text"] {
        for folder in files_of(&data().join(kind)) {
            let name = folder.file_name().unwrap().to_str().unwrap();
            let listed = REFUSED_MODELS.iter().any(|(listed, _)| *listed == format!("{kind}/{name}"));
            assert!(listed || name.starts_with("sound") || name.starts_with("odd_"), "{kind}/{name}");
        }
    }
}

fn check_sound(r: &Reconstruction) {
    assert!(r.warnings.is_empty(), "{:?}", r.warnings);
    assert_eq!(r.point_ids, [5, 7, 9]);
    assert_eq!(r.points[1].coords.as_slice(), [0.25, -0.5, 0.875]);
    assert_eq!((r.colors[2], r.point_errors_px[2]), ([10, 20, 30], 0.5));
    let names: Vec<_> = r.images.iter().map(|image| (image.id, image.name.as_str())).collect();
    assert_eq!(names, [(10, "a b/first photo.jpg"), (11, "second.jpg")]);
    let seen: Vec<_> = r.images[0].observations.iter().map(|o| o.point).collect();
    assert_eq!(seen, [Some(PointIndex(0)), Some(PointIndex(1)), None]);
    let track: Vec<_> = r.track(PointIndex(1)).iter().map(|(image, keypoint)| (image.0, *keypoint)).collect();
    assert_eq!(track, [(0, 1), (1, 1)]);
    assert_eq!(r.cameras[0].params, [500.0, 320.0, 240.0, -0.05]);
}

#[test]
fn sound_models_say_the_same_in_binary_and_text() {
    for name in ["sound", "sound_framed"] {
        for kind in ["binary", "text"] {
            let read = read_reconstruction(model(kind, name).path()).unwrap();
            assert_eq!(read.colmap.as_ref().unwrap().frames.is_some(), name == "sound_framed");
            check_sound(&read);
        }
    }
}

#[test]
fn a_model_is_found_in_the_folders_where_tools_put_it_and_by_its_files() {
    for sub in ["", "sparse/0", "sparse", "0", "colmap/sparse/0", "dense/sparse"] {
        let top = tempfile::tempdir().unwrap();
        let folder = top.path().join(sub);
        fs::create_dir_all(&folder).unwrap();
        for path in files_of(&data().join("text/sound")) {
            fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
        check_sound(&read_reconstruction(top.path()).unwrap());
        check_sound(&read_reconstruction(&folder.join("points3D.txt")).unwrap());
    }
}

#[test]
fn further_models_beside_the_one_read_are_told() {
    let top = tempfile::tempdir().unwrap();
    for number in ["0", "1", "2"] {
        let folder = top.path().join("sparse").join(number);
        fs::create_dir_all(&folder).unwrap();
        for path in files_of(&data().join("binary/sound")) {
            fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
    }
    let warnings = read_reconstruction(top.path()).unwrap().warnings;
    assert_eq!((warnings.len(), warnings[0].kind, warnings[0].count), (1, WarningKind::FurtherModels, 2));
    assert!(warnings[0].to_string().contains("sparse/1"), "{}", warnings[0]);
}

#[test]
fn content_decides_between_binary_and_text_whatever_the_name() {
    let top = tempfile::tempdir().unwrap();
    for path in files_of(&data().join("text/sound")) {
        fs::copy(&path, top.path().join(path.file_name().unwrap()).with_extension("bin")).unwrap();
    }
    let read = read_reconstruction(top.path()).unwrap();
    check_sound(&read);
    assert_eq!(read.colmap.unwrap().encoding, Encoding::Text);
}

#[test]
fn binary_files_count_where_a_folder_holds_both() {
    let folder = model("text", "sound_framed");
    for path in files_of(&data().join("binary/sound")) {
        fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
    }
    let colmap = read_reconstruction(folder.path()).unwrap().colmap.unwrap();
    assert_eq!((colmap.encoding, colmap.rigs, colmap.frames), (Encoding::Binary, None, None));
}

#[test]
fn what_is_no_reconstruction_is_told_from_what_is_not_there() {
    let top = tempfile::tempdir().unwrap();
    let message = |path: &Path| read_reconstruction(path).unwrap_err().to_string();
    assert!(message(top.path()).contains("cameras, images and points3D"), "{}", message(top.path()));
    assert!(message(&top.path().join("none")).starts_with("cannot read"), "{}", message(&top.path().join("none")));
    let stray = top.path().join("cloud.ply");
    fs::write(&stray, "solid cube\n").unwrap();
    assert!(message(&stray).contains("another kind of file"), "{}", message(&stray));
    fs::copy(data().join("binary/sound/images.bin"), top.path().join("images.bin")).unwrap();
    assert!(message(top.path()).contains("without cameras and points3D"), "{}", message(top.path()));
}

#[test]
fn what_is_not_a_number_or_not_there_is_left_out_and_counted() {
    // Kind of file, name, warnings with their counts, images and points that are left.
    type Odd = (&'static str, &'static [(WarningKind, usize)], usize, usize);
    let expected: [Odd; 9] = [
        (
            "binary/odd_image_position_nan",
            &[(WarningKind::ImagesWithoutPose, 1), (WarningKind::TracksOfMissingImages, 2)],
            1,
            3,
        ),
        (
            "binary/odd_image_rotation_zero",
            &[(WarningKind::ImagesWithoutPose, 1), (WarningKind::TracksOfMissingImages, 2)],
            1,
            3,
        ),
        (
            "binary/odd_point_nan",
            &[(WarningKind::PointsWithoutPosition, 1), (WarningKind::ObservationsOfMissingPoints, 2)],
            2,
            2,
        ),
        ("binary/odd_point_error_nan", &[(WarningKind::ErrorsNotFinite, 1)], 2, 3),
        (
            "binary/odd_track_of_missing_image",
            &[(WarningKind::TracksOfMissingImages, 1), (WarningKind::TracksThatImagesContradict, 1)],
            2,
            3,
        ),
        ("binary/odd_track_of_missing_keypoint", &[(WarningKind::TracksThatImagesContradict, 2)], 2, 3),
        (
            "text/odd_point_position_infinite",
            &[(WarningKind::PointsWithoutPosition, 1), (WarningKind::ObservationsOfMissingPoints, 2)],
            2,
            2,
        ),
        (
            "text/odd_track_of_missing_image",
            &[
                (WarningKind::TracksOfMissingImages, 1),
                (WarningKind::TracksThatImagesContradict, 1),
                (WarningKind::PointsWithoutTrack, 1),
            ],
            2,
            3,
        ),
        (
            "text/odd_track_of_missing_keypoint",
            &[(WarningKind::TracksThatImagesContradict, 2), (WarningKind::PointsWithoutTrack, 1)],
            2,
            3,
        ),
    ];
    for (name, warnings, images, points) in expected {
        let (kind, folder) = name.split_once('/').unwrap();
        let read = read_reconstruction(model(kind, folder).path()).unwrap();
        let found: Vec<_> = read.warnings.iter().map(|w| (w.kind, w.count)).collect();
        assert_eq!((found.as_slice(), read.images.len(), read.points.len()), (warnings, images, points), "{name}");
        for (index, _) in read.points.iter().enumerate() {
            for (image, keypoint) in read.track(PointIndex(index as u32)) {
                let seen = read.images[image.0 as usize].observations[*keypoint as usize].point;
                assert_eq!(seen, Some(PointIndex(index as u32)), "{name}");
            }
        }
        let out = tempfile::tempdir().unwrap();
        write_colmap(out.path(), &read).unwrap();
        let again = read_reconstruction(out.path()).unwrap();
        assert_eq!((again.points, again.track_elements), (read.points, read.track_elements), "{name}");
    }
}

/// A small model in text, with the files given in place of the sound ones.
fn text_model(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = model("text", "sound");
    files.iter().for_each(|(name, content)| fs::write(folder.path().join(name), content).unwrap());
    folder
}

#[test]
fn commas_between_values_and_whole_numbers_with_a_point_are_read() {
    let sound = model("text", "sound");
    let rewrite = |name: &str, change: &dyn Fn(&str) -> String| {
        let text = fs::read_to_string(sound.path().join(name)).unwrap();
        text.lines()
            .map(|line| if line.starts_with('#') { line.to_string() } else { change(line) } + "\n")
            .collect::<String>()
    };
    // The names of images hold blanks.
    let images = rewrite("images.txt", &|line| line.replacen(' ', ", ", 9));
    let points = rewrite("points3D.txt", &|line| line.replace(' ', ","));
    let cameras = rewrite("cameras.txt", &|line| line.replace(" 640 480 ", " 640.0 480. "));
    let files =
        [("images.txt", images.as_bytes()), ("points3D.txt", points.as_bytes()), ("cameras.txt", cameras.as_bytes())];
    check_sound(&read_reconstruction(text_model(&files).path()).unwrap());
}

#[test]
fn decimal_commas_are_named() {
    let folder = text_model(&[("points3D.txt", b"5 0,5 1,25 3 1 2 3 0,5 10 0 11 0\n")]);
    let message = read_reconstruction(folder.path()).unwrap_err().to_string();
    assert!(["decimal point", "line 1", "`0,5`"].iter().all(|word| message.contains(word)), "{message}");
    assert!(!message.contains("from COLMAP"), "{message}");
}

#[test]
fn text_of_sixteen_bits_is_named() {
    for mark in [[0xFF, 0xFE], [0xFE, 0xFF]] {
        let folder = text_model(&[("cameras.txt", &[mark.as_slice(), &[b'1', 0, b' ', 0]].concat())]);
        let message = read_reconstruction(folder.path()).unwrap_err().to_string();
        assert!(message.contains("UTF-16") && message.contains("cameras.txt"), "{message}");
    }
}

#[test]
fn what_colmap_wrote_is_to_be_exported_again_and_the_rest_written_again() {
    let head = "# 3D point list with one line of data per point:\n";
    for (head, remedy) in [(head, "export the model again from COLMAP"), ("", "with the program that made it")] {
        let folder = text_model(&[("points3D.txt", format!("{head}5 far 1 2 1 2 3 0\n").as_bytes())]);
        let message = read_reconstruction(folder.path()).unwrap_err().to_string();
        assert!(message.contains(remedy), "{message}");
    }
}

#[test]
fn a_file_that_was_cut_at_the_end_of_a_line_is_told_by_its_own_count() {
    let text = fs::read_to_string(model("text", "sound").path().join("points3D.txt")).unwrap();
    let records: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    let head = "# 3D point list with one line of data per point:\n# Number of points: 3, mean track length: 2\n";
    let cut = format!("{head}{}\n{}\n", records[0], records[1]);
    let read = read_reconstruction(text_model(&[("points3D.txt", cut.as_bytes())]).path()).unwrap();
    let warning = read.warnings.iter().find(|w| w.kind == WarningKind::FewerThanAnnounced).unwrap();
    assert!(warning.count == 1 && warning.to_string().contains("points3D.txt says 3 and holds 2"), "{warning}");
    let whole = format!("{head}{}\n", records.join("\n"));
    check_sound(&read_reconstruction(text_model(&[("points3D.txt", whole.as_bytes())]).path()).unwrap());
}

#[test]
fn a_model_without_images_is_a_cloud() {
    let read = read_reconstruction(text_model(&[("images.txt", b"")]).path()).unwrap();
    assert_eq!((read.images.len(), read.points.len(), read.track_elements.len()), (0, 3, 0));
    let kinds: Vec<_> = read.warnings.iter().map(|w| w.kind).collect();
    assert_eq!(kinds, [WarningKind::NoImages, WarningKind::TracksOfMissingImages]);
}

#[test]
fn points_may_stand_in_a_ply_file_beside_cameras_and_images() {
    let folder = model("text", "sound");
    fs::remove_file(folder.path().join("points3D.txt")).unwrap();
    fs::copy(data().join("ply/sound_ascii.ply"), folder.path().join("points3D.ply")).unwrap();
    let read = read_reconstruction(folder.path()).unwrap();
    assert_eq!((read.images.len(), read.points.len(), read.point_ids.as_slice()), (2, 3, [1, 2, 3].as_slice()));
    assert!(read.warnings.iter().any(|w| w.kind == WarningKind::PointsFromPly && w.count == 3));
    let out = tempfile::tempdir().unwrap();
    write_colmap(out.path(), &read).unwrap();
    assert_eq!(read_reconstruction(out.path()).unwrap().points, read.points);
}

#[test]
fn a_model_alone_somewhere_below_is_found_and_two_are_named() {
    let top = tempfile::tempdir().unwrap();
    let place = |sub: &str| {
        let folder = top.path().join(sub);
        fs::create_dir_all(&folder).unwrap();
        for path in files_of(&data().join("text/sound")) {
            fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
        }
    };
    place("job/west/sparse/0");
    check_sound(&read_reconstruction(top.path()).unwrap());
    place("job/east/sparse/0");
    let message = read_reconstruction(top.path()).unwrap_err().to_string();
    assert!(message.contains("east") && message.contains("west") && message.contains("name one"), "{message}");
}

#[test]
fn odd_models_are_read_with_one_warning_of_each_kind() {
    let expected = [
        ("odd_keypoint_of_missing_point", WarningKind::ObservationsOfMissingPoints, 1),
        // The image links keypoint 1 to point 9, the track of point 7 lists it.
        ("odd_track_contradicted", WarningKind::TracksThatImagesContradict, 2),
        ("odd_point_without_track", WarningKind::PointsWithoutTrack, 1),
        ("odd_image_without_keypoints", WarningKind::ImagesWithoutObservations, 1),
        ("odd_name_latin1", WarningKind::NamesNotUtf8, 1),
        ("odd_rotation_of_length_two", WarningKind::UnnormalizedQuaternions, 1),
        ("odd_pose_of_frame_differs", WarningKind::PosesThatFramesContradict, 1),
    ];
    for (name, kind, count) in expected {
        let read = read_reconstruction(model("binary", name).path()).unwrap();
        let found: Vec<_> = read.warnings.iter().map(|w| (w.kind, w.count)).collect();
        assert_eq!(found, [(kind, count)], "{name}");
        println!("{}", read.warnings[0]);
        match kind {
            WarningKind::NamesNotUtf8 => assert_eq!(read.images[0].name, "Stra\u{df}e.jpg"),
            WarningKind::PosesThatFramesContradict => {
                assert_eq!(read.images[0].cam_from_sfm_translation.as_slice(), [1.0, 2.0, 3.0]);
            }
            WarningKind::ObservationsOfMissingPoints => assert_eq!(read.images[0].observations[2].point, None),
            _ => {}
        }
    }
}
