//! Imperfect captures: what a structure-from-motion tool makes of photographs of a world with relief and clutter.
//!
//! Question     what points does a reconstruction hold, each where, and what is the truth about them?
//! Method       lines of sight through random pixels find points; those that two or three photographs show, at like angles, are
//!              reconstructed: bent as a whole, off along and across the line of sight, with errors that neighbours in a photograph share
//! Truth        the similarity that takes the bent points without noise nearest to their true places

use std::f64::consts::TAU;

use super::bend::{Bend, best_similarity};
use super::capture::{Station, add_point, image};
use super::draws::{between, log_between, stream, whole};
use super::levels::Levels;
use super::survey::Survey;
use super::world::{Met, World};
use crate::geometry::{Camera, CameraModel, Point3, Rotation3, Similarity, Vector3};
use crate::reconstruction::{Image, Reconstruction};
use crate::solvers::scene::Random;

/// Focal length and size of a photograph, pixels: 67 degrees across.
const FOCAL_PX: f64 = 720.0;
const SIZE_PX: [f64; 2] = [960.0, 720.0];

/// Points are matched so far from the ground, and so far from the air, metres.
const FAR_M: f64 = 70.0;
const FAR_FROM_AIR_M: f64 = 160.0;

/// A place is recognised in another photograph up to this angle between the two views (cosine of 35 degrees), this often.
const SAME_VIEW_COS: f64 = 0.82;
const RECOGNISED: f64 = 0.6;

/// What is nearer to a point than this does not hide it: relief stands before its wall, metres.
const SURROUNDINGS_M: f64 = 0.6;

/// Lines of sight for each point that is wanted: most find too little contrast, or are in one photograph only.
const SIGHTS_PER_POINT: usize = 8;

/// Fewer points are no reconstruction.
const FEWEST_POINTS: usize = 60;

/// An airborne scan flies so high, looks so far aside (tangent) and errs by so much a pixel of noise, metres.
const FLIGHT_M: f64 = 500.0;
const ASIDE: f64 = 0.3;
const SCAN_NOISE_M: f64 = 0.05;

/// A capture, and what of it is wrong.
#[derive(Clone, Debug)]
pub struct Imperfect {
    pub survey: Survey,
    /// Points at a wrong place; all others, those on trees and cars too, are where something is.
    pub is_wrong: Vec<bool>,
}

/// A point as it is found.
struct Found {
    face: Option<usize>,
    at: Point3<f64>,
    eye: Point3<f64>,
    /// The photographs that show it, the one that found it first.
    seen: Vec<usize>,
}

/// A point of the reconstruction, before it gets the frame.
struct Made {
    at: Point3<f64>,
    face: Option<usize>,
    is_wrong: bool,
    seen: Vec<usize>,
}

/// Photographs; `keeps` tells which points are left. `None` where too little is seen.
pub(super) fn photographed(
    world: &World,
    stations: &[Station],
    levels: &Levels,
    seed: u64,
    keeps: impl Fn(&Met, &mut Random) -> bool,
) -> Option<Imperfect> {
    let mut random = stream(seed, 0);
    let camera = camera();
    let images: Vec<Image> = stations.iter().zip(1..).map(|(s, id)| rolled(image(s, id), &mut random)).collect();
    let is_high = stations.iter().any(|station| station.center.z > 5.0);
    let reach_m = if is_high { FAR_FROM_AIR_M } else { FAR_M };
    let fewest_views = if random.unit() < 0.4 { 2 } else { 3 };
    let sights = SIGHTS_PER_POINT * levels.points / stations.len().max(1) + 100;
    let mut found = Vec::new();
    for (i, photo) in images.iter().enumerate() {
        let eye = stations[i].center;
        for _ in 0..sights {
            let [u, v] = [0, 1].map(|k| SIZE_PX[k] * (random.unit() - 0.5) / FOCAL_PX);
            let direction = (photo.cam_from_sfm_rotation.inverse() * Vector3::new(u, v, 1.0)).normalize();
            let leaves = random.normal_vector();
            let Some(met) = world.meet(&eye, &direction, reach_m, leaves) else { continue };
            if !(random.unit() < met.found && keeps(&met, &mut random)) {
                continue;
            }
            let mut seen = vec![i];
            let shows = |j: &usize| *j != i && shows(&images[*j], &camera, world, &eye, &met.at, reach_m);
            let others: Vec<usize> = (0..images.len()).filter(shows).collect();
            seen.extend(others.into_iter().filter(|_| random.unit() < RECOGNISED));
            if seen.len() >= fewest_views {
                found.push(Found { face: met.face, at: met.at, eye, seen });
            }
        }
    }
    thin(&mut found, levels.points, &mut random);
    (found.len() >= FEWEST_POINTS).then(|| reconstructed(&found, images, levels, seed))
}

/// A scan from the air over a disc: no cameras, roofs and ground and little of the walls.
pub(super) fn scanned(
    world: &World,
    middle: &Point3<f64>,
    radius_m: f64,
    levels: &Levels,
    seed: u64,
) -> Option<Imperfect> {
    let mut random = stream(seed, 0);
    let wanted = 2 * levels.points;
    let mut found = Vec::new();
    for _ in 0..3 * wanted {
        let (angle, part) = (TAU * random.unit(), random.unit().sqrt());
        let below = middle + radius_m * part * Vector3::new(angle.cos(), angle.sin(), 0.0);
        let aside = Vector3::new(between(&mut random, -ASIDE, ASIDE), between(&mut random, -ASIDE, ASIDE), 1.0);
        let eye = below + FLIGHT_M * aside;
        let leaves = random.normal_vector();
        if let Some(met) = world.meet(&eye, &-aside.normalize(), 2.0 * FLIGHT_M, leaves) {
            found.push(Found { face: met.face, at: met.at, eye, seen: Vec::new() });
        }
    }
    thin(&mut found, wanted, &mut random);
    (found.len() >= FEWEST_POINTS).then(|| reconstructed(&found, Vec::new(), levels, seed))
}

fn camera() -> Camera {
    Camera {
        model: CameraModel::SimplePinhole,
        width_px: SIZE_PX[0] as u64,
        height_px: SIZE_PX[1] as u64,
        params: vec![FOCAL_PX, 0.5 * SIZE_PX[0], 0.5 * SIZE_PX[1]],
    }
}

/// No camera is held level.
fn rolled(image: Image, random: &mut Random) -> Image {
    let roll = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.03 * random.normal());
    Image {
        cam_from_sfm_rotation: roll * image.cam_from_sfm_rotation,
        cam_from_sfm_translation: roll * image.cam_from_sfm_translation,
        ..image
    }
}

/// Whether a photograph shows a point so that it would be taken for the one that `eye` sees.
fn shows(image: &Image, camera: &Camera, world: &World, eye: &Point3<f64>, at: &Point3<f64>, reach_m: f64) -> bool {
    let center = image.center();
    let (line, other) = (at - center, at - eye);
    let distance = line.norm();
    let like = line.dot(&other) > SAME_VIEW_COS * distance * other.norm();
    let inside = |pixel: [f64; 2]| (0..2).all(|k| (0.0..SIZE_PX[k]).contains(&pixel[k]));
    like && (1.0..reach_m).contains(&distance)
        && camera.project(&image.cam_from_sfm(at)).is_some_and(inside)
        && world.rays.first_hit(&center, &(line / distance), distance - SURROUNDINGS_M).is_none()
}

/// In random order, no more than wanted.
fn thin(found: &mut Vec<Found>, wanted: usize, random: &mut Random) {
    for i in 0..found.len().min(wanted) {
        let other = whole(random, i, found.len());
        found.swap(i, other);
    }
    found.truncate(wanted);
}

fn reconstructed(found: &[Found], images: Vec<Image>, levels: &Levels, seed: u64) -> Imperfect {
    let (mut noise, mut frame) = (stream(seed, 1), stream(seed, 2));
    let places: Vec<Point3<f64>> = found.iter().map(|f| f.at).collect();
    let bend = Bend::new(&places, levels.bend, &mut frame);
    let bent: Vec<Point3<f64>> = places.iter().map(|x| bend.apply(x)).collect();
    let pairs: Vec<_> = bent.iter().copied().zip(places.iter().copied()).collect();
    let plan_from_bent = best_similarity(&pairs);
    let images: Vec<Image> = images.into_iter().map(|image| moved(image, &bend)).collect();
    let fields: Vec<Field> = images.iter().map(|_| Field::new(&mut noise)).collect();
    let off = |f: &Found, noise: &mut Random| {
        let line = f.at - f.eye;
        let Some(first) = f.seen.first() else { return levels.noise_px * SCAN_NOISE_M * noise.normal_vector() };
        let nearest = f.seen.iter().map(|i| (f.at - images[*i].center()).norm()).fold(f64::INFINITY, f64::min);
        let across = levels.noise_px * nearest / FOCAL_PX;
        let along = across * between(noise, 2.0, 6.0) / (0.5 * f.seen.len() as f64).sqrt();
        let shared = fields[*first].at(&images[*first].cam_from_sfm(&f.at));
        // Half of the variance along the line of sight is shared with neighbours.
        let along = along * std::f64::consts::FRAC_1_SQRT_2 * (noise.normal() + shared);
        across * noise.normal_vector() + along * line.normalize()
    };
    let mut points: Vec<Made> = Vec::new();
    for (f, at) in found.iter().zip(&bent) {
        points.push(Made { at: at + off(f, &mut noise), face: f.face, is_wrong: false, seen: f.seen.clone() });
    }
    points.extend(wrong_points(found, &bent, &images, levels, &mut noise));
    for i in 0..points.len() {
        let other = whole(&mut noise, i, points.len());
        points.swap(i, other);
    }
    let sfm_from_bent = any_frame(&bent, &mut frame);
    let mut sfm = Reconstruction::default();
    if levels.cameras && !images.is_empty() {
        sfm = Reconstruction { cameras: vec![camera()], camera_ids: vec![1], images, track_starts: vec![0], ..sfm };
        for Made { at, seen, .. } in &points {
            let pixels: Vec<(usize, [f64; 2])> =
                seen.iter().map(|i| (*i, keypoint(&sfm, *i, at, levels, &mut noise))).collect();
            add_point(&mut sfm, *at, &pixels);
        }
    } else {
        sfm.points = points.iter().map(|made| made.at).collect();
    }
    sfm.transform(&sfm_from_bent);
    let survey = Survey {
        sfm,
        city_from_sfm: plan_from_bent * sfm_from_bent.inverse(),
        face_of_point: points.iter().map(|made| made.face).collect(),
    };
    Imperfect { survey, is_wrong: points.iter().map(|made| made.is_wrong).collect() }
}

/// Half anywhere about the cloud, half along a line of sight at a wrong depth.
fn wrong_points(
    found: &[Found],
    bent: &[Point3<f64>],
    images: &[Image],
    levels: &Levels,
    noise: &mut Random,
) -> Vec<Made> {
    let count = (bent.len() as f64 * levels.outliers / (1.0 - levels.outliers)) as usize;
    let (low, high) = bent.iter().fold((bent[0], bent[0]), |(low, high), x| (low.inf(x), high.sup(x)));
    let wrong = |noise: &mut Random| {
        let i = whole(noise, 0, bent.len());
        let anywhere = low + (high - low).map(|side| side * noise.unit());
        let astray = found[i].eye + (bent[i] - found[i].eye) * (0.4 * noise.normal()).exp();
        let is_anywhere = found[i].seen.is_empty() || noise.unit() < 0.5;
        let mut seen: Vec<usize> = found[i].seen.iter().take(1).copied().collect();
        if let Some(first) = seen.first()
            && images.len() > 1
        {
            seen.push((first + whole(noise, 1, images.len())) % images.len());
        }
        Made { at: if is_anywhere { anywhere } else { astray }, face: None, is_wrong: true, seen }
    };
    (0..count).map(|_| wrong(noise)).collect()
}

/// A photograph where the bend puts it.
fn moved(image: Image, bend: &Bend) -> Image {
    let center = bend.apply(&image.center());
    Image { cam_from_sfm_translation: -(image.cam_from_sfm_rotation * center.coords), ..image }
}

/// Where a photograph shows a point, within its frame.
fn keypoint(sfm: &Reconstruction, image: usize, at: &Point3<f64>, levels: &Levels, noise: &mut Random) -> [f64; 2] {
    let pixel = sfm.cameras[0].project(&sfm.images[image].cam_from_sfm(at)).unwrap_or([0.0, 0.0]);
    [0, 1].map(|k| (pixel[k] + 0.5 * levels.noise_px * noise.normal()).clamp(0.0, SIZE_PX[k] - 1.0))
}

/// Some frame of 1.5 to 40 m to the unit.
fn any_frame(points: &[Point3<f64>], frame: &mut Random) -> Similarity {
    let middle = points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64;
    let scale = log_between(frame, 1.5, 40.0).recip();
    let rotation = frame.rotation();
    Similarity::about(&Point3::from(middle), &Point3::from(20.0 * frame.normal_vector()), scale, rotation)
}

/// A smooth error over a photograph, of variance one.
struct Field([(f64, f64, f64); 4]);

impl Field {
    fn new(noise: &mut Random) -> Field {
        // Some four waves across the picture.
        Field(std::array::from_fn(|_| (6.0 * noise.normal(), 6.0 * noise.normal(), TAU * noise.unit())))
    }

    fn at(&self, x_in_cam: &Point3<f64>) -> f64 {
        let (u, v) = (x_in_cam.x / x_in_cam.z, x_in_cam.y / x_in_cam.z);
        let wave = |(a, b, phase): &(f64, f64, f64)| (a * u + b * v + phase).sin();
        self.0.iter().map(wave).sum::<f64>() * std::f64::consts::FRAC_1_SQRT_2
    }
}
