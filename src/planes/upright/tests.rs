use super::*;
use crate::geometry::{Point3, Rotation3};
use crate::planes::fit::fit_plane;
use crate::planes::patches::{Patch, patches};
use crate::reconstruction::{ImageIndex, PointIndex, Reconstruction, read_reconstruction};
use crate::robust::Random;

const DEGREE: f64 = PI / 180.0;

/// A scene of `turn`ed walls, floors and cameras; directions are told with z up.
struct Turned(Rotation3<f64>);

impl Turned {
    fn up(&self) -> Vector3<f64> {
        self.0 * Vector3::z()
    }

    fn scene(&self, normals: &[[f64; 3]], cameras: &[Rotation3<f64>]) -> Patches {
        let patch = |&[x, y, z]: &[f64; 3]| facing(self.0 * Vector3::new(x, y, z).normalize());
        Patches {
            patches: normals.iter().map(patch).collect(),
            cam_from_sfm_rotations: cameras.iter().map(|r| r * self.0.inverse()).collect(),
            ..Patches::default()
        }
    }

    fn off(&self, candidate: &Vector3<f64>) -> f64 {
        candidate.angle(&self.up()) / DEGREE
    }
}

fn facing(normal: Vector3<f64>) -> Patch {
    let [a, b] = Tangent::across(&normal, &Matrix3::zeros()).axes;
    let corners = [a, b, -a, -b, 0.5 * a, 0.5 * b, -0.5 * a, -0.5 * b];
    let mut fit = fit_plane(corners.iter().map(|c| Point3::from(*c))).unwrap();
    fit.plane.normal = normal;
    Patch { members: (0..8).collect(), fit, sided: true }
}

/// A camera that looks along a heading (degrees from y to the right), up by `pitch` and turned about its view by `roll`.
fn held(heading: f64, pitch: f64, roll: f64) -> Rotation3<f64> {
    let level = Rotation3::from_axis_angle(&Vector3::x_axis(), PI / 2.0);
    let turn = |axis, degrees: f64| Rotation3::from_axis_angle(&axis, degrees * DEGREE);
    turn(Vector3::z_axis(), roll) * turn(Vector3::x_axis(), -pitch) * level * turn(Vector3::z_axis(), heading)
}

fn start(up: Vector3<f64>, sigma_deg: f64) -> Upright {
    Upright { up, sigma_rad: sigma_deg * DEGREE, known: false }
}

const BLOCK: [[f64; 3]; 6] =
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.2, 0.0], [0.0, 0.0, 1.0], [0.7, 0.0, 0.7], [0.0, -0.6, 0.8]];

#[test]
fn finds_up_among_walls_floors_and_roofs() {
    let turned = Turned(Rotation3::from_euler_angles(0.05, -0.04, 0.3));
    let found = up_candidates(&turned.scene(&BLOCK, &[]), &start(Vector3::z(), 2.0), &Limits::default());
    assert_eq!(found.len(), 1);
    let sigma_deg = found[0].sigma_rad / DEGREE;
    assert!(turned.off(&found[0].up) < sigma_deg && sigma_deg < 1.2, "{} of {sigma_deg}", turned.off(&found[0].up));
}

#[test]
fn walls_of_one_direction_leave_up_along_them_to_the_start() {
    let turned = Turned(Rotation3::from_euler_angles(0.4, -1.1, 2.0));
    let street = [[1.0, 0.0, 0.0], [1.0, 0.01, 0.02], [-1.0, 0.01, 0.0], [1.0, 0.02, -0.01], [-1.0, 0.0, 0.01]];
    let said = Rotation3::from_axis_angle(&Vector3::x_axis(), 3.0 * DEGREE) * Vector3::z();
    let found = up_candidates(&turned.scene(&street, &[]), &start(turned.0 * said, 2.0), &Limits::default());
    assert_eq!(found.len(), 1);
    assert!((turned.off(&found[0].up) - 3.0).abs() < 0.3, "{} degrees off", turned.off(&found[0].up));
    assert!((found[0].sigma_rad - 2.0 * DEGREE).abs() < 0.2 * DEGREE, "{} degrees", found[0].sigma_rad / DEGREE);
}

#[test]
fn cameras_on_a_street_hold_the_axis_that_its_walls_do_not() {
    let turned = Turned(Rotation3::from_euler_angles(-2.0, 0.3, 1.0));
    let street = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.01], [1.0, 0.02, 0.0]];
    let facing_walls = [85.0, 92.0, 97.0, 88.0, -90.0].map(|heading| held(heading, 5.0, heading % 2.0));
    let start = start(turned.0 * Vector3::new(0.1, -0.2, 1.0).normalize(), 10.0);
    let alone = up_candidates(&turned.scene(&street, &[]), &start, &Limits::default());
    assert!(alone[0].sigma_rad > Limits::default().up.known_sigma_rad);
    let UpChoice::Known(found) = choose_up(&turned.scene(&street, &facing_walls), &start, &Limits::default()) else {
        panic!("not known")
    };
    assert!(turned.off(&found[0].up) < 3.0 * found[0].sigma_rad / DEGREE);
}

#[test]
fn level_cameras_tell_up_to_a_start_that_knows_nothing_of_tilt() {
    let turned = Turned(Rotation3::from_euler_angles(1.9, 0.8, -0.6));
    let mut chance = Random::stream(7, 0);
    let mut askew = |sigma: f64| sigma * (0..12).map(|_| chance.unit() - 0.5).sum::<f64>();
    let portrait_too = |k: i32, roll: f64| if k % 4 == 0 { roll + 90.0 } else { roll };
    let cameras: Vec<_> =
        (0..12).map(|k| held(f64::from(k) * 30.0, 10.0 + askew(8.0), portrait_too(k, askew(1.5)))).collect();
    let UpChoice::Known(found) =
        choose_up(&turned.scene(&[], &cameras), &start(Vector3::z(), 60.0), &Limits::default())
    else {
        panic!("not known")
    };
    assert_eq!(found.len(), 1);
    assert!(turned.off(&found[0].up) < 3.0 * found[0].sigma_rad / DEGREE, "{}", turned.off(&found[0].up));
}

#[test]
fn tells_every_up_of_a_box_when_only_the_box_is_known() {
    let turned = Turned(Rotation3::from_euler_angles(0.7, 0.1, 0.2));
    let mut scene = turned.scene(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], &[]);
    scene.patches.iter_mut().for_each(|p| p.sided = false);
    assert_eq!(up_candidates(&scene, &start(Vector3::z(), 90.0), &Limits::default()).len(), 6);
    assert!(matches!(choose_up(&scene, &start(Vector3::z(), 90.0), &Limits::default()), UpChoice::Free(_)));
    let near = start(turned.0 * Vector3::new(0.1, 0.1, 1.0).normalize(), 5.0);
    assert!(
        matches!(choose_up(&scene, &near, &Limits::default()), UpChoice::Known(found) if turned.off(&found[0].up) < 0.5)
    );
}

#[test]
fn keeps_the_start_where_nothing_votes() {
    for sigma_deg in [0.0, 0.5, 17.0, 1e9] {
        let start = start(Vector3::new(0.0, 0.6, 0.8), sigma_deg);
        let found = up_candidates(&Patches::default(), &start, &Limits::default());
        assert_eq!(found.len(), 1);
        assert!(found[0].up.angle(&start.up) < 1e-6);
        assert!((found[0].sigma_rad - start.sigma_rad.max(SMALLEST_SIGMA_RAD)).abs() <= 1e-6 * found[0].sigma_rad);
    }
}

#[test]
fn photographs_of_the_sample_tell_up_whatever_the_start_knows() {
    let sample = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample/sfm");
    let whole = read_reconstruction(&sample).unwrap();
    // From the alignment of the whole sample.
    let up = Vector3::new(-0.4583, -0.8572, 0.2349).normalize();
    for (first, count) in [(0, whole.images.len()), (0, 5), (0, 8), (3, 3)] {
        let scene = patches(&of_images(&whole, first..first + count), None, &Limits::default().patches);
        for sigma_deg in [2.0, 10.0, 60.0] {
            let lean = Rotation3::from_axis_angle(&Vector3::z_axis(), sigma_deg * DEGREE);
            let found = up_candidates(&scene, &start(lean * up, sigma_deg), &Limits::default());
            let nearest = found.iter().min_by(|a, b| a.up.angle(&up).total_cmp(&b.up.angle(&up))).unwrap();
            let off = nearest.up.angle(&up);
            assert!(
                off < 3.0 * nearest.sigma_rad && nearest.sigma_rad < Limits::default().up.known_sigma_rad,
                "{count}: {off} {nearest:?}"
            );
        }
    }
}

/// What the images of a range alone would have made of the scene: the points that two of them saw.
fn of_images(r: &Reconstruction, range: std::ops::Range<usize>) -> Reconstruction {
    let mut cut = Reconstruction {
        cameras: r.cameras.clone(),
        images: r.images[range.clone()].to_vec(),
        track_starts: vec![0],
        ..Reconstruction::default()
    };
    for (i, point) in r.points.iter().enumerate() {
        let seen = r.track(PointIndex(i as u32)).iter().filter(|(image, _)| range.contains(&(image.0 as usize)));
        let track: Vec<_> = seen.map(|&(image, o)| (ImageIndex(image.0 - range.start as u32), o)).collect();
        if track.len() > 1 {
            cut.points.push(*point);
            cut.track_elements.extend(track);
            cut.track_starts.push(cut.track_elements.len() as u32);
        }
    }
    cut
}

#[test]
fn tells_an_up_that_the_start_rules_out() {
    let turned = Turned(Rotation3::from_euler_angles(0.5, 0.0, 0.0));
    let cameras: Vec<_> = (0..8).map(|k| held(f64::from(k) * 45.0, 5.0, 0.0)).collect();
    let scene = turned.scene(&BLOCK, &cameras);
    let beyond = up_beyond_start(&scene, &start(Vector3::z(), 2.0), &Limits::default()).unwrap();
    assert!(turned.off(&beyond.up) < 1.0 && beyond.off_start > 3.0);
    assert!(up_beyond_start(&scene, &start(Vector3::z(), 20.0), &Limits::default()).is_none());
}
