//! What is written is read again as it was, whatever it was; and what is cut off is an error, wherever it is cut.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use cityweld::types::{Camera, CameraIndex, CameraModel, CloudField, FieldKind, ImageIndex, PointIndex};
use cityweld::{
    Image, Observation, Point3, Reconstruction, Rotation3, Similarity, Vector3, read_reconstruction, read_start,
    write_colmap, write_ply,
};
use proptest::prelude::*;

/// Numbers with all their digits, on both sides of zero.
fn coordinate(most: f64) -> impl Strategy<Value = f64> {
    -most..most
}

fn place(most: f64) -> impl Strategy<Value = [f64; 3]> {
    [coordinate(most), coordinate(most), coordinate(most)]
}

fn similarity() -> impl Strategy<Value = Similarity> {
    (1e-3..1e3_f64, place(3.0), place(1e6)).prop_map(|(scale, turn, shift)| Similarity {
        scale,
        rotation: Rotation3::new(Vector3::from(turn)),
        translation: Vector3::from(shift),
    })
}

/// A folder with the repository's model in that encoding, whose parts beside cameras, images and points are taken over.
fn encoded(folder: &str) -> Reconstruction {
    read_reconstruction(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reconstruction").join(folder)).unwrap()
}

/// Points near the origin, seen by cameras that stand around them.
#[derive(Clone, Debug)]
struct Sketch {
    points: Vec<[f64; 3]>,
    bearings: Vec<f64>,
    names: BTreeSet<String>,
    /// Which image sees which point: a bit for each pair.
    seen: u64,
    first_id: u32,
    focal: f64,
    bend: f64,
    is_binary: bool,
}

fn sketch() -> impl Strategy<Value = Sketch> {
    let names = prop::collection::btree_set("[a-zA-Zäé_][a-zA-Z0-9 ./_-]{0,12}\\.(jpg|PNG)", 4);
    let points = prop::collection::vec(place(1.0), 3..12);
    let bearings = prop::collection::vec(0.0..std::f64::consts::TAU, 2..5);
    let lens = (300.0..3000.0_f64, -0.05..0.05_f64);
    (points, bearings, names, any::<u64>(), 1..1_000_000_u32, lens, any::<bool>()).prop_map(
        |(points, bearings, names, seen, first_id, (focal, bend), is_binary)| Sketch {
            points,
            bearings,
            names,
            seen,
            first_id,
            focal,
            bend,
            is_binary,
        },
    )
}

impl Sketch {
    fn model(&self) -> Reconstruction {
        let camera = Camera {
            model: CameraModel::SimpleRadial,
            width_px: 4000,
            height_px: 3000,
            params: vec![self.focal, 2000.0, 1500.0, self.bend],
        };
        let points: Vec<Point3<f64>> = self.points.iter().map(|&place| Point3::from(place)).collect();
        let mut tracks: Vec<Vec<(ImageIndex, u32)>> = vec![Vec::new(); points.len()];
        let mut images = Vec::new();
        for ((at, bearing), name) in (0..).zip(&self.bearings).zip(&self.names) {
            let rotation = Rotation3::from_axis_angle(&Vector3::y_axis(), *bearing);
            let mut image = Image {
                id: self.first_id + 7 * at,
                camera: CameraIndex(0),
                name: name.clone(),
                cam_from_sfm_rotation: rotation,
                cam_from_sfm_translation: Vector3::new(0.0, 0.0, 6.0),
                ..Image::default()
            };
            for (p, x) in points.iter().enumerate() {
                if self.seen >> (p * 5 + at as usize) & 1 == 0 {
                    continue;
                }
                let [x_px, y_px] = camera.project(&image.cam_from_sfm(x)).unwrap();
                tracks[p].push((ImageIndex(at), image.observations.len() as u32));
                image.observations.push(Observation { x_px, y_px, point: Some(PointIndex(p as u32)) });
            }
            image.observations.push(Observation { x_px: 17.25, y_px: 1e-3 * f64::from(at), point: None });
            images.push(image);
        }
        let mut colmap = encoded(if self.is_binary { "rig_bin" } else { "rig_txt" }).colmap.unwrap();
        (colmap.rigs, colmap.frames) = (None, None);
        let mut r = Reconstruction {
            cameras: vec![camera],
            camera_ids: vec![self.first_id],
            images,
            point_ids: (0..points.len() as u64).map(|p| 3 * p + u64::from(self.first_id)).collect(),
            point_errors_px: points.iter().map(|x| x.x.abs()).collect(),
            colors: points.iter().map(|x| [(100.0 * x.y.abs()) as u8, 0, 255]).collect(),
            points,
            track_starts: vec![0],
            colmap: Some(colmap),
            ..Reconstruction::default()
        };
        for track in tracks {
            r.track_elements.extend(track);
            r.track_starts.push(r.track_elements.len() as u32);
        }
        r
    }
}

/// Everything of two models but rotations, which are stored as quaternions.
fn assert_same(a: &Reconstruction, b: &Reconstruction) {
    assert_eq!((&a.cameras, &a.camera_ids), (&b.cameras, &b.camera_ids));
    assert_eq!((&a.points, &a.point_ids, &a.colors), (&b.points, &b.point_ids, &b.colors));
    assert_eq!(a.point_errors_px, b.point_errors_px);
    assert_eq!((&a.track_starts, &a.track_elements), (&b.track_starts, &b.track_elements));
    assert_eq!(a.images.len(), b.images.len());
    for (a, b) in a.images.iter().zip(&b.images) {
        assert_eq!((a.id, a.camera, &a.name, &a.observations), (b.id, b.camera, &b.name, &b.observations));
        assert_eq!(a.cam_from_sfm_translation, b.cam_from_sfm_translation);
        assert!((a.cam_from_sfm_rotation.matrix() - b.cam_from_sfm_rotation.matrix()).abs().max() < 1e-14);
    }
}

fn written(model: &Reconstruction) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_colmap(folder.path(), model).unwrap();
    folder
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_colmap_model_is_read_as_it_was_written(sketch in sketch()) {
        let model = sketch.model();
        let folder = written(&model);
        let read = read_reconstruction(folder.path()).unwrap();
        assert_same(&model, &read);
        let is_there = |name: &str| folder.path().join(name).exists();
        assert_eq!((is_there("images.bin"), is_there("images.txt")), (sketch.is_binary, !sketch.is_binary));
        // What was read is written to the bit.
        let again = written(&read);
        for entry in fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap()) {
            let bytes = fs::read(entry.path()).unwrap();
            assert_eq!(bytes, fs::read(again.path().join(entry.file_name())).unwrap(), "{:?}", entry.file_name());
        }
    }

    #[test]
    fn both_encodings_hold_the_same_model(sketch in sketch()) {
        let read = |is_binary| read_reconstruction(written(&Sketch { is_binary, ..sketch.clone() }.model()).path()).unwrap();
        assert_same(&read(true), &read(false));
    }

    #[test]
    fn a_model_that_is_moved_and_written_projects_as_before(sketch in sketch(), city_from_sfm in similarity()) {
        let model = sketch.model();
        let moved = read_reconstruction(written(&model.transformed(&city_from_sfm)).path()).unwrap();
        for ((before, after), x) in model.points.iter().zip(&moved.points).zip(0..) {
            assert!((city_from_sfm.apply(before) - after).norm() < 1e-9, "point {x}");
            for &(image, _) in model.track(PointIndex(x)) {
                let pixel = |r: &Reconstruction, x: &Point3<f64>| {
                    r.camera_of(image).project(&r.images[image.0 as usize].cam_from_sfm(x)).unwrap()
                };
                let ([u, v], [moved_u, moved_v]) = (pixel(&model, before), pixel(&moved, after));
                // Rounding at coordinates of a million, beside distances of at least 5e-3 and focal lengths of 3000 pixels.
                assert!((u - moved_u).hypot(v - moved_v) < 1e-3, "point {x}: {u}, {v} to {moved_u}, {moved_v}");
            }
        }
    }
}

fn small_model(is_binary: bool) -> Reconstruction {
    Sketch {
        points: vec![[0.1, 0.2, 0.3], [-0.5, 0.25, 0.125], [0.75, -0.5, 0.0]],
        bearings: vec![0.0, 1.0],
        names: ["a b.jpg", "b.jpg"].map(str::to_owned).into(),
        seen: u64::MAX,
        first_id: 5,
        focal: 1000.0,
        bend: 0.0,
        is_binary,
    }
    .model()
}

/// A cut within the last number of a file cannot be seen; what comes of it is still a model.
#[test]
fn a_text_model_that_is_cut_anywhere_is_refused_or_sound() {
    let folder = written(&small_model(false));
    let whole = small_model(false);
    for name in ["cameras.txt", "images.txt", "points3D.txt"] {
        let path = folder.path().join(name);
        let bytes = fs::read(&path).unwrap();
        for length in 0..bytes.len() {
            fs::write(&path, &bytes[..length]).unwrap();
            match read_reconstruction(folder.path()) {
                Err(error) => assert!(error.to_string().contains(&folder.path().display().to_string()), "{error}"),
                Ok(read) => {
                    assert!(read.points.iter().all(|x| x.iter().all(|value| value.is_finite())));
                    let elements = &read.track_elements;
                    assert!(elements.iter().all(|(image, _)| (image.0 as usize) < read.images.len()));
                    let is_less = read.points.len() < whole.points.len()
                        || read.images.len() < whole.images.len()
                        || elements.len() < whole.track_elements.len();
                    assert!(
                        !is_less || !read.warnings.is_empty(),
                        "{name} of {length} bytes lost something in silence"
                    );
                    written(&read);
                }
            }
        }
        fs::write(&path, &bytes).unwrap();
    }
}

#[derive(Clone, Debug)]
struct Cloud {
    points: Vec<[f64; 3]>,
    has_colors: bool,
    has_normals: bool,
    kinds: Vec<FieldKind>,
}

fn cloud() -> impl Strategy<Value = Cloud> {
    let kinds = [FieldKind::U8, FieldKind::I16, FieldKind::U32, FieldKind::F32, FieldKind::F64];
    let points = prop::collection::vec(place(1e7), 1..20);
    (points, any::<bool>(), any::<bool>(), prop::collection::vec(prop::sample::select(kinds.to_vec()), 0..4))
        .prop_map(|(points, has_colors, has_normals, kinds)| Cloud { points, has_colors, has_normals, kinds })
}

impl Cloud {
    fn reconstruction(&self) -> Reconstruction {
        let count = self.points.len();
        let field = |(number, kind): (usize, &FieldKind)| {
            let mut field = CloudField::new(format!("scalar_{number}"), *kind);
            (0..count).for_each(|at| field.push((7 * at + number) as f64));
            field
        };
        let points: Vec<_> = self.points.iter().map(|&place| Point3::from(place)).collect();
        Reconstruction {
            colors: if self.has_colors { (0..count).map(|at| [at as u8, 255, 0]).collect() } else { Vec::new() },
            normals: if self.has_normals { points.iter().map(|x| x.coords.normalize()).collect() } else { Vec::new() },
            fields: self.kinds.iter().enumerate().map(field).collect(),
            points,
            ..Reconstruction::default()
        }
    }

    /// As text, and with the bytes of each number turned round.
    fn in_other_encodings(&self) -> [Vec<u8>; 2] {
        let header = |format: &str| {
            let axes = ["x", "y", "z"].map(|axis| format!("property double {axis}\n")).concat();
            format!("ply\nformat {format} 1.0\nelement vertex {}\n{axes}end_header\n", self.points.len())
        };
        let lines = self.points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n"));
        let text = header("ascii") + &lines.collect::<String>();
        let mut turned = header("binary_big_endian").into_bytes();
        turned.extend(self.points.iter().flatten().flat_map(|value| value.to_be_bytes()));
        [text.into_bytes(), turned]
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_cloud_is_read_as_it_was_written(cloud in cloud()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.ply");
        let written = cloud.reconstruction();
        write_ply(&path, &written).unwrap();
        let read = read_reconstruction(&path).unwrap();
        assert_eq!((&read.points, &read.colors, &read.fields), (&written.points, &written.colors, &written.fields));
        assert_eq!(read.normals, written.normals);
    }

    #[test]
    fn a_cloud_is_the_same_in_every_encoding(cloud in cloud()) {
        let folder = tempfile::tempdir().unwrap();
        for bytes in cloud.in_other_encodings() {
            let path = folder.path().join("cloud.ply");
            fs::write(&path, bytes).unwrap();
            assert_eq!(read_reconstruction(&path).unwrap().points, cloud.reconstruction().points);
        }
    }
}

#[test]
fn a_cloud_that_is_cut_anywhere_is_refused_with_the_file() {
    let cloud = Cloud {
        points: vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
        has_colors: true,
        has_normals: true,
        kinds: vec![FieldKind::U8, FieldKind::F64],
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.ply");
    write_ply(&path, &cloud.reconstruction()).unwrap();
    let bytes = fs::read(&path).unwrap();
    for length in 0..bytes.len() {
        fs::write(&path, &bytes[..length]).unwrap();
        let error = read_reconstruction(&path).expect_err(&format!("{length} bytes")).to_string();
        assert!(error.contains("cloud.ply"), "{length} bytes: {error}");
    }
}

#[test]
fn elements_without_bytes_are_not_counted_to_the_end_of_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cloud.ply");
    for format in ["ascii", "binary_little_endian"] {
        let header = format!(
            "ply\nformat {format} 1.0\nelement nothing 18446744073709551615\nelement vertex 18446744073709551615\nend_header\n"
        );
        fs::write(&path, header).unwrap();
        let error = read_reconstruction(&path).unwrap_err().to_string();
        assert!(error.contains("cloud.ply"), "{error}");
    }
}

/// Starts in each spelling.
fn spellings(pose: &Similarity) -> [String; 4] {
    let turn = pose.rotation.matrix();
    let row = |k: usize| format!("[{:?}, {:?}, {:?}]", turn[(k, 0)], turn[(k, 1)], turn[(k, 2)]);
    let rows = [0, 1, 2].map(row).join(", ");
    let [x, y, z] = <[f64; 3]>::from(pose.translation);
    let similarity =
        format!(r#"{{"scale": {:?}, "rotation": [{rows}], "translation": [{x:?}, {y:?}, {z:?}]}}"#, pose.scale);
    let linear = turn * pose.scale;
    let line = |k: usize| {
        format!("{:?} {:?} {:?} {:?}\n", linear[(k, 0)], linear[(k, 1)], linear[(k, 2)], pose.translation[k])
    };
    [
        format!(r#"{{"verdict": "aligned", "transform": {similarity}, "best_candidate": null}}"#),
        format!(r#"{{"verdict": "ambiguous", "transform": null, "best_candidate": {similarity}}}"#),
        [0, 1, 2].map(line).concat() + "0 0 0 1\n",
        similarity,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_place_is_the_same_in_every_spelling(pose in similarity()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("start");
        for text in spellings(&pose) {
            fs::write(&path, &text).unwrap();
            let read = *read_start(&path).unwrap_or_else(|error| panic!("{error}: {text}")).city_from_sfm();
            assert!((read.scale / pose.scale - 1.0).abs() < 1e-13, "{text}");
            assert!((read.rotation.matrix() - pose.rotation.matrix()).abs().max() < 1e-13, "{text}");
            assert_eq!(read.translation, pose.translation, "{text}");
        }
    }

    #[test]
    fn a_place_and_its_inverse_undo_each_other(pose in similarity(), x in place(1e3)) {
        let x = Point3::from(x);
        let back = pose.inverse().apply(&pose.apply(&x));
        // Rounding at a translation of two million, seen through a scale of a thousandth.
        assert!((back - x).norm() < 1e-5, "{x} came back as {back}");
    }
}

#[test]
fn a_start_that_is_cut_anywhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("start");
    let pose = Similarity { scale: 2.0, rotation: Rotation3::identity(), translation: Vector3::new(1.5, 2.5, 3.5) };
    for text in spellings(&pose) {
        // Without the end of the last line a matrix is whole.
        for length in 0..text.trim_end().len() {
            fs::write(&path, &text[..length]).unwrap();
            assert!(read_start(&path).is_err(), "{}", &text[..length]);
        }
    }
}
