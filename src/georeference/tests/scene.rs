//! A capture: cameras on a path about a block, held level or not, in a frame of their own; and a city of one wall.

use crate::city::CityModel;
use crate::format::positions::{Frame, PositionsFile, StoredPosition};
use crate::geometry::{Camera, CameraModel, Matrix3, Point3, Rotation3, Similarity, Vector3};
use crate::reconstruction::{CameraIndex, Image, Reconstruction};
use crate::robust::Random;

pub const ORIGIN: [f64; 3] = [90_800.0, 435_600.0, 0.0];

/// How cameras are held.
#[derive(Clone, Copy)]
pub enum Held {
    Level,
    /// Turned a quarter about the line of sight, every second of them.
    QuarterTurned,
    /// Turned by as much, radians, all alike.
    Rolled(f64),
}

pub struct Capture {
    pub sfm: Reconstruction,
    pub city: CityModel,
    /// To absolute coordinates.
    pub truth: Similarity,
    /// Of the cameras, absolute.
    pub centers: Vec<Point3<f64>>,
}

pub fn truth() -> Similarity {
    Similarity {
        scale: 7.5,
        rotation: Rotation3::from_euler_angles(2.1, -0.7, 0.4),
        translation: Vector3::new(ORIGIN[0] + 90.0, ORIGIN[1] + 60.0, 12.0),
    }
}

/// Cameras round a block, 40 m from its middle.
pub fn ring(held: Held) -> Capture {
    let center = |i: usize| {
        let angle = i as f64 * 0.3;
        Vector3::new(40.0 * angle.cos(), 40.0 * angle.sin(), 25.0 + 6.0 * (i % 2) as f64)
    };
    capture((0..21).map(|i| (center(i), -center(i))), held)
}

/// Cameras along a street, looking at its fronts.
pub fn street(held: Held) -> Capture {
    let place = |i: usize| Vector3::new(3.5 * i as f64 - 35.0, 0.4 * (i % 3) as f64, 1.7);
    let view = |i: usize| Vector3::new(0.5 * (i % 3) as f64 - 0.5, 1.0, 0.05);
    capture((0..21).map(|i| (place(i), view(i))), held)
}

fn capture(cameras: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>, held: Held) -> Capture {
    let (truth, origin) = (truth(), Vector3::from(ORIGIN));
    let sfm_from_city = truth.inverse();
    let (mut images, mut centers) = (Vec::new(), Vec::new());
    for (i, (place, view)) in cameras.enumerate() {
        let in_city = Point3::from(origin + place);
        let forward = view.normalize();
        let right = forward.cross(&Vector3::z()).normalize();
        let cam_from_city = Matrix3::from_rows(&[right, forward.cross(&right), forward].map(|v| v.transpose()));
        let roll = match held {
            Held::Level => 0.0,
            Held::QuarterTurned => (i % 2) as f64 * std::f64::consts::FRAC_PI_2,
            Held::Rolled(angle) => angle,
        };
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), roll)
            * Rotation3::from_matrix_unchecked(cam_from_city)
            * truth.rotation;
        let center = sfm_from_city.apply(&in_city);
        images.push(Image {
            id: i as u32 + 1,
            camera: CameraIndex(0),
            name: format!("flight/p{i:03}.jpg"),
            cam_from_sfm_rotation: rotation,
            cam_from_sfm_translation: -(rotation * center.coords),
            ..Image::default()
        });
        centers.push(in_city);
    }
    let points = (0..300).map(|i| {
        let t = i as f64;
        sfm_from_city
            .apply(&Point3::from(origin + Vector3::new(20.0 * (t * 0.7).sin(), 15.0 * (t * 1.3).cos(), t % 9.0)))
    });
    let camera =
        Camera { model: CameraModel::SimplePinhole, width_px: 960, height_px: 720, params: vec![800.0, 480.0, 360.0] };
    let sfm = Reconstruction {
        cameras: vec![camera],
        camera_ids: vec![1],
        points: points.collect(),
        images,
        ..Reconstruction::default()
    };
    Capture { sfm, city: wall(), truth, centers }
}

/// A wall of 40 by 9 metres that stands on a height of 0.
fn wall() -> CityModel {
    let corner = |x: f64, z: f64| Point3::new(x, 0.0, z);
    CityModel {
        origin: Vector3::from(ORIGIN),
        vertices: vec![corner(-20.0, 0.0), corner(20.0, 0.0), corner(20.0, 9.0), corner(-20.0, 9.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..CityModel::default()
    }
}

impl Capture {
    /// Measured with this noise of each axis, metres, and an error that all share.
    pub fn positions(&self, noise_m: f64, shared: Vector3<f64>, seed: u64) -> PositionsFile {
        let mut random = Random::stream(seed, 0);
        let mut gaussian =
            || (-2.0 * (1.0 - random.unit()).ln()).sqrt() * (std::f64::consts::TAU * random.unit()).cos();
        let names = self.sfm.images.iter().map(|image| image.name.rsplit('/').next().unwrap().to_owned());
        let position = |(name, center): (String, &Point3<f64>)| {
            let p = center + shared + Vector3::new(gaussian(), gaussian(), gaussian()) * noise_m;
            StoredPosition { name, east_north: Some([p.x, p.y]), height_m: Some(p.z), ..StoredPosition::default() }
        };
        let positions = names.zip(&self.centers).map(position).collect();
        PositionsFile { format: "name X Y Z", frame: Frame::OfTheCity, positions, warnings: Vec::new() }
    }
}
