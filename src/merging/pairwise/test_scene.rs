//! Two parts of a yard with walls, floor and roofs, for tests: what superpixels say of it.

use super::planes::{PlaneGroup, PlaneOf, SharedPlanes};
use crate::geometry::{Camera, CameraModel, Matrix3, Point3, Rotation3, Similarity, Vector3};
use crate::merging::limits::MergeLimits;
use crate::merging::part::Part;
use crate::merging::point_covariance::KnownPoint;
use crate::reconstruction::{Image, ImageIndex, Reconstruction};

/// The radius of part a's points.
pub(in crate::merging) const RADIUS: f64 = 6.0;
const SUPERPIXELS: usize = 60;
const POINTS: usize = 8;

/// `a_from_b`
pub(in crate::merging) fn truth() -> Similarity {
    Similarity {
        scale: 1.7,
        rotation: Rotation3::from_euler_angles(0.4, 2.0, -1.0),
        translation: Vector3::new(3.0, -8.0, 1.0),
    }
}

/// A sequence in -1..1 that fills evenly.
fn wave(k: usize, step: f64) -> f64 {
    2.0 * (k as f64 * step).fract() - 1.0
}

/// Points of superpixel `k` as one part has them, in a's frame.
fn spots(k: usize, part: usize, noise: f64) -> Vec<Point3<f64>> {
    let normals = [
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(0.0, 1.0, 0.0),
        Vector3::new(0.0, 0.0, 1.0),
        Vector3::new(0.6, 0.0, 0.8),
        Vector3::new(0.0, -0.6, 0.8),
    ];
    let normal = normals[k % normals.len()];
    let u = normal.cross(&Vector3::new(0.3, 0.5, -0.8)).normalize();
    let v = normal.cross(&u);
    let center = normal * -3.0 + u * 4.0 * wave(k, 0.754_877_666) + v * 3.0 * wave(k, 0.569_840_291);
    let spot = |i: usize| {
        let j = 1 + i + 31 * k + 7000 * part;
        let across = noise * (wave(j, 0.414_213_562) + wave(j, 0.236_067_977) + wave(j, 0.645_751_311));
        center + u * 0.3 * wave(j, 0.618_033_989) + v * 0.3 * wave(j, 0.324_717_957) + normal * across
    };
    (0..POINTS).map(|i| Point3::from(spot(i))).collect()
}

/// `noise`: one sigma across the planes, a's units; `distort`: what part b has done to the world.
pub(in crate::merging) fn scene(noise: f64, distort: impl Fn(&Point3<f64>) -> Point3<f64>) -> SharedPlanes {
    let known = |at: Point3<f64>, sigma: f64| KnownPoint { at, covariance: Matrix3::identity() * (sigma * sigma) };
    let b_from_a = truth().inverse();
    let (mut groups, limits) = (Vec::new(), MergeLimits::default());
    for k in 0..SUPERPIXELS {
        let in_a: Vec<_> = spots(k, 0, noise).into_iter().map(|x| known(x, noise)).collect();
        let in_b = spots(k, 1, noise).into_iter().map(|x| b_from_a.apply(&distort(&x)));
        let in_b: Vec<_> = in_b.map(|x| known(x, noise * b_from_a.scale)).collect();
        let eye = Point3::new(0.4, 0.3, 0.2);
        let forth = PlaneGroup::of(PlaneOf::A, &in_a, &in_b, &eye, &limits).unwrap();
        let back = PlaneGroup::of(PlaneOf::B, &in_b, &in_a, &b_from_a.apply(&distort(&eye)), &limits).unwrap();
        groups.extend([forth, back].map(|g| PlaneGroup { share: 0.5, ..g }));
    }
    SharedPlanes { groups, radius: [RADIUS, RADIUS * b_from_a.scale] }
}

/// Corner, two edges and the side that was seen: a floor and two walls, which both parts have, and a roof.
const SURFACES: [[[f64; 3]; 4]; 4] = [
    [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 1.0]],
    [[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [0.0, 0.0, 4.0], [0.0, 1.0, 0.0]],
    [[0.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 4.0], [1.0, 0.0, 0.0]],
    [[0.0, 0.0, 9.0], [6.0, 0.0, 0.0], [0.0, 6.0, 3.0], [0.0, -0.447_213_595, 0.894_427_191]],
];
pub(in crate::merging) const ROWS: u32 = 20;

/// Half the width of the noise across the surfaces.
pub(in crate::merging) const ACROSS: f64 = 0.002;

/// Three cameras in the yard; every point is seen by all.
const EYES: [[f64; 3]; 3] = [[5.0, 5.0, 7.0], [8.0, 3.0, 6.0], [3.0, 8.0, 6.0]];

/// Points on the first surfaces in an even grid, shifted by a share of its step, with noise that repeats nowhere.
pub(in crate::merging) fn part(surfaces: usize, shift: f64, part_from_world: &Similarity) -> Part {
    let camera = Camera {
        model: CameraModel::SimplePinhole,
        width_px: 1000,
        height_px: 1000,
        params: vec![800.0, 500.0, 500.0],
    };
    let mut sfm = Reconstruction { cameras: vec![camera], ..Reconstruction::default() };
    for eye in EYES {
        let center = part_from_world.apply(&Point3::from(eye));
        sfm.images.push(Image { cam_from_sfm_translation: -center.coords, ..Image::default() });
    }
    for [corner, u, v, normal] in SURFACES[..surfaces].iter().map(|s| s.map(Vector3::from)) {
        for i in 0..ROWS * ROWS {
            let at = |k: u32| (f64::from(k) + 0.1 + shift) / f64::from(ROWS);
            let across = ACROSS * ((f64::from(i) * 0.618_033_989 + shift).fract() * 2.0 - 1.0);
            let x = Point3::from(corner + u * at(i % ROWS) + v * at(i / ROWS) + normal * across);
            sfm.points.push(part_from_world.apply(&x));
            sfm.track_starts.push(sfm.track_elements.len() as u32);
            sfm.track_elements.extend((0..EYES.len() as u32).map(|image| (ImageIndex(image), i)));
        }
    }
    sfm.track_starts.push(sfm.track_elements.len() as u32);
    Part { name: String::new(), sfm, superpixels: None, anchor: None }
}
