//! Captures: photographs of a block from stated places, with keypoints and tracks.

use std::f64::consts::TAU;

use super::block::Block;
use super::cloud::point_on;
use super::house::Face;
use super::survey::{Survey, sfm_from_city};
use crate::geometry::{Camera, CameraModel, Matrix3, Point3, RayCaster, Rotation3, Similarity, Vector3};
use crate::reconstruction::{CameraIndex, Image, ImageIndex, Observation, PointIndex, Reconstruction};
use crate::solvers::scene::Random;

/// A line of sight may end this far before its point, metres: the point's own face.
const AT_FACE_M: f64 = 1e-3;

/// No keypoints are found where a face is seen more obliquely than by this cosine, 78 degrees off its normal.
const GRAZING_COS: f64 = 0.2;

/// Depths of points that were matched wrongly, in parts of the right one.
const WRONG_DEPTH: [f64; 2] = [0.4, 1.6];

/// Where a photograph is taken from, city frame, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// The photograph's file name.
    pub name: String,
    pub center: Point3<f64>,
    /// What the optical axis points at. Where that is straight up or down, east is to the right.
    pub target: Point3<f64>,
}

/// Photographs on a circle around a block that look at its middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    pub photos: usize,
    /// From the circle about the houses.
    pub distance_m: f64,
    /// Above their foot.
    pub height_m: f64,
    /// Part of the circle, counter-clockwise from east; photographs are spread over it evenly, its end left out.
    pub from_rad: f64,
    pub to_rad: f64,
    /// Names are `folder/000.jpg` and so on.
    pub folder: &'static str,
}

impl Ring {
    /// Eye height, 12 m before the houses.
    pub fn street(photos: usize) -> Ring {
        Ring { photos, distance_m: 12.0, height_m: 1.7, from_rad: 0.0, to_rad: TAU, folder: "street" }
    }

    /// 40 m high, 15 m before the houses: walls and roofs.
    pub fn drone(photos: usize) -> Ring {
        Ring { photos, distance_m: 15.0, height_m: 40.0, from_rad: 0.0, to_rad: TAU, folder: "drone" }
    }

    pub fn stations(&self, block: &Block) -> Vec<Station> {
        let (low, high) = block.bounds();
        let middle = block.middle();
        let radius = 0.5 * (high - low).xy().norm() + self.distance_m;
        let station = |i: usize| {
            let angle = self.from_rad + (self.to_rad - self.from_rad) * i as f64 / self.photos as f64;
            let center =
                Point3::new(middle.x + radius * angle.cos(), middle.y + radius * angle.sin(), low.z + self.height_m);
            Station { name: format!("{}/{i:03}.jpg", self.folder), center, target: middle }
        };
        (0..self.photos).map(station).collect()
    }
}

impl Station {
    /// Photographs along a line, evenly from end to end, that all look the same way.
    pub fn walk(from: [f64; 3], to: [f64; 3], looking: [f64; 3], photos: usize) -> Vec<Station> {
        let (from, to) = (Point3::from(from), Point3::from(to));
        let station = |i: usize| {
            let center = from + (to - from) * (i as f64 / (photos.max(2) - 1) as f64);
            Station { name: format!("walk/{i:03}.jpg"), center, target: center + Vector3::from(looking) }
        };
        (0..photos).map(station).collect()
    }

    /// Camera frame x right, y down, z forward.
    fn cam_from_city_rotation(&self) -> Rotation3<f64> {
        let forward = (self.target - self.center).try_normalize(0.0).unwrap_or(Vector3::y());
        let right = forward.cross(&Vector3::z()).try_normalize(1e-9).unwrap_or(Vector3::x());
        let down = forward.cross(&right);
        Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[
            right.transpose(),
            down.transpose(),
            forward.transpose(),
        ]))
    }
}

/// What photographs show, and how well.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureOptions {
    pub camera: Camera,
    /// Places on walls, roofs and near ground, spread by area, that are told apart; those that two photographs see become points.
    pub places: usize,
    /// Further places, in and above the block: trees, cars, cables.
    pub clutter: usize,
    /// Standard deviation of the points along each axis.
    pub noise_m: f64,
    /// Standard deviation of the keypoints along each axis.
    pub noise_px: f64,
    /// Share of points at a wrong depth from their first photograph.
    pub outlier_share: f64,
    pub sfm_from_city: Similarity,
    pub seed: u64,
}

impl Default for CaptureOptions {
    /// A wide lens (67 degrees across), 2 cm and half a pixel of noise, some clutter and wrong depths.
    fn default() -> CaptureOptions {
        let params = vec![1200.0, 800.0, 600.0];
        CaptureOptions {
            camera: Camera { model: CameraModel::SimplePinhole, width_px: 1600, height_px: 1200, params },
            places: 6000,
            clutter: 300,
            noise_m: 0.02,
            noise_px: 0.5,
            outlier_share: 0.03,
            sfm_from_city: sfm_from_city(),
            seed: 0,
        }
    }
}

/// A place that photographs may show.
struct Place {
    at: Point3<f64>,
    /// Number and normal of its face; `None` for clutter.
    face: Option<(usize, Vector3<f64>)>,
}

impl Block {
    /// Photographs from the stations, all by one camera, in their order. Points have at least two observations.
    pub fn capture(&self, stations: &[Station], options: &CaptureOptions) -> Survey {
        let mut random = Random::stream(options.seed, 0);
        let rays = self.rays();
        let mut sfm = Reconstruction {
            cameras: vec![options.camera.clone()],
            camera_ids: vec![1],
            images: stations.iter().zip(1..).map(|(station, id)| image(station, id)).collect(),
            track_starts: vec![0],
            ..Reconstruction::default()
        };
        let mut face_of_point = Vec::new();
        for place in self.places(options, &mut random) {
            let seen = sightings(&sfm.images, &options.camera, &rays, &place);
            if seen.len() < 2 {
                continue;
            }
            let is_wrong = random.unit() < options.outlier_share;
            let mut at = place.at + options.noise_m * random.normal_vector();
            if is_wrong {
                let eye = stations[seen[0].0].center;
                let [low, high] = WRONG_DEPTH;
                at = eye + (at - eye) * (low + (high - low) * random.unit());
            }
            let pixels = seen.iter().map(|(image, [x, y])| {
                (*image, [x + options.noise_px * random.normal(), y + options.noise_px * random.normal()])
            });
            add_point(&mut sfm, at, &pixels.collect::<Vec<_>>());
            face_of_point.push(place.face.filter(|_| !is_wrong).map(|(number, _)| number));
        }
        sfm.transform(&options.sfm_from_city);
        Survey { sfm, city_from_sfm: options.sfm_from_city.inverse(), face_of_point }
    }

    fn places(&self, options: &CaptureOptions, random: &mut Random) -> Vec<Place> {
        let faces: Vec<Face> = self.seen_faces().collect();
        let total: f64 = faces.iter().map(Face::area).sum();
        let mut places = Vec::with_capacity(options.places + options.clutter);
        let mut area = 0.0;
        for (number, face) in faces.iter().enumerate() {
            area += face.area();
            let face_so_far = (options.places as f64 * area / total).round() as usize;
            let normal = face.normal();
            while places.len() < face_so_far {
                places.push(Place { at: point_on(face, random), face: Some((number, normal)) });
            }
        }
        places.extend((0..options.clutter).map(|_| Place { at: self.point_anywhere(random), face: None }));
        places
    }
}

pub(super) fn image(station: &Station, id: u32) -> Image {
    let rotation = station.cam_from_city_rotation();
    Image {
        id,
        camera: CameraIndex(0),
        name: station.name.clone(),
        cam_from_sfm_rotation: rotation,
        cam_from_sfm_translation: -(rotation * station.center.coords),
        ..Image::default()
    }
}

/// The photographs that show a place, and where.
fn sightings(images: &[Image], camera: &Camera, rays: &RayCaster, place: &Place) -> Vec<(usize, [f64; 2])> {
    let size = [camera.width_px as f64, camera.height_px as f64];
    let shows = |image: &Image| {
        let pixel = camera.project(&image.cam_from_sfm(&place.at))?;
        let inside = (0..2).all(|k| (0.0..size[k]).contains(&pixel[k]));
        let eye = image.center();
        let (distance, direction) = ((place.at - eye).norm(), (place.at - eye).try_normalize(0.0)?);
        let faces_it = place.face.is_none_or(|(_, normal)| -normal.dot(&direction) > GRAZING_COS);
        let free = || rays.first_hit(&eye, &direction, distance - AT_FACE_M).is_none();
        (inside && faces_it && free()).then_some(pixel)
    };
    images.iter().enumerate().filter_map(|(i, image)| Some((i, shows(image)?))).collect()
}

pub(super) fn add_point(sfm: &mut Reconstruction, at: Point3<f64>, pixels: &[(usize, [f64; 2])]) {
    let point = PointIndex(sfm.points.len() as u32);
    let mut error_px = 0.0;
    for &(i, [x_px, y_px]) in pixels {
        let image = &mut sfm.images[i];
        let back = sfm.cameras[0].project(&image.cam_from_sfm(&at));
        error_px += back.map_or(0.0, |[x, y]| (x - x_px).hypot(y - y_px));
        sfm.track_elements.push((ImageIndex(i as u32), image.observations.len() as u32));
        image.observations.push(Observation { x_px, y_px, point: Some(point) });
    }
    sfm.points.push(at);
    sfm.point_ids.push(u64::from(point.0) + 1);
    sfm.point_errors_px.push(error_px / pixels.len() as f64);
    sfm.colors.push([128; 3]);
    sfm.track_starts.push(sfm.track_elements.len() as u32);
}

#[cfg(test)]
mod tests;
