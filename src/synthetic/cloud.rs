//! Clouds: points on the faces of a block, without cameras.

use super::block::Block;
use super::house::{Face, Surface};
use super::survey::{Survey, sfm_from_city};
use crate::geometry::{Point3, RayCaster, Similarity, Vector3};
use crate::reconstruction::Reconstruction;
use crate::solvers::scene::Random;

/// How far around the houses the ground is seen, metres.
pub(super) const SEEN_GROUND_M: f64 = 8.0;

/// Draws for each wanted point on a face that is partly hidden; a face of which less can be seen gets fewer points.
const DRAWS: usize = 20;

/// Lines of sight begin this far before a face, metres, so that the face itself is not met.
const BEFORE_FACE_M: f64 = 1e-3;

/// What a cloud holds. Walls and roofs have as many points each, whatever their size: keypoints go by contrast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudOptions {
    pub points_per_wall: usize,
    /// 0 where nothing was seen from above.
    pub points_per_roof: usize,
    /// Near the houses, whether the city has ground or not.
    pub points_on_ground: usize,
    /// Standard deviation along each axis.
    pub noise_m: f64,
    /// Points that are no part of the city, anywhere in and above the block, for each point that is.
    pub outlier_share: f64,
    pub sfm_from_city: Similarity,
    pub seed: u64,
}

impl Default for CloudOptions {
    /// Seen from the street, 2 cm of noise, one in ten wrong.
    fn default() -> CloudOptions {
        CloudOptions {
            points_per_wall: 150,
            points_per_roof: 0,
            points_on_ground: 500,
            noise_m: 0.02,
            outlier_share: 0.1,
            sfm_from_city: sfm_from_city(),
            seed: 0,
        }
    }
}

impl Block {
    /// Points all over the outside of the block, and what is wrong among them.
    pub fn cloud(&self, options: &CloudOptions) -> Survey {
        let mut random = Random::stream(options.seed, 0);
        let rays = self.rays();
        let mut points = Vec::new();
        let mut face_of_point = Vec::new();
        for (number, face) in self.seen_faces().enumerate() {
            let count = match face.surface {
                Surface::Wall => options.points_per_wall,
                Surface::Roof => options.points_per_roof,
                Surface::Ground => options.points_on_ground,
            };
            let open = |x: &Point3<f64>| is_open(&rays, x, &face.normal());
            let draws = (0..DRAWS * count).map(|_| point_on(&face, &mut random));
            let on_face: Vec<Point3<f64>> = draws.filter(open).take(count).collect();
            points.extend(on_face.iter().map(|x| x + options.noise_m * random.normal_vector()));
            face_of_point.resize(points.len(), Some(number));
        }
        let wrong = (options.outlier_share * points.len() as f64) as usize;
        points.extend((0..wrong).map(|_| self.point_anywhere(&mut random)));
        face_of_point.resize(points.len(), None);
        points.iter_mut().for_each(|x| *x = options.sfm_from_city.apply(x));
        let sfm = Reconstruction { points, ..Reconstruction::default() };
        Survey { sfm, city_from_sfm: options.sfm_from_city.inverse(), face_of_point }
    }

    /// The faces of the houses, then the ground near them, modelled or not.
    pub(super) fn seen_faces(&self) -> impl Iterator<Item = Face> + '_ {
        let of_houses = self.houses.iter().flat_map(|house| &house.faces).cloned();
        of_houses.chain([self.ground_within(SEEN_GROUND_M)])
    }

    /// A point of the box around what is seen.
    pub(super) fn point_anywhere(&self, random: &mut Random) -> Point3<f64> {
        let (low, high) = self.bounds();
        let around = Vector3::new(SEEN_GROUND_M, SEEN_GROUND_M, 0.0);
        let (low, high) = (low - around, high + around);
        low + (high - low).map(|side| side * random.unit())
    }
}

/// A uniform point of a face.
pub(super) fn point_on(face: &Face, random: &mut Random) -> Point3<f64> {
    let mut left = face.area() * random.unit();
    let (mut u, mut v) = (random.unit(), random.unit());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    let mut at = face.corners[0];
    for [a, b, c] in face.triangles() {
        at = a + (b - a) * u + (c - a) * v;
        left -= 0.5 * (b - a).cross(&(c - a)).norm();
        if left <= 0.0 {
            break;
        }
    }
    at
}

/// Whether somebody outside could see a point of a face: one of some lines, level to steep, leads away from the block.
fn is_open(rays: &RayCaster, x: &Point3<f64>, normal: &Vector3<f64>) -> bool {
    let from = x + BEFORE_FACE_M * normal;
    [0.2, 0.6, 1.5, 4.0].iter().any(|steep| {
        let direction = (normal + Vector3::new(0.0, 0.0, *steep)).normalize();
        rays.first_hit(&from, &direction, f64::MAX).is_none()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::House;

    #[test]
    fn points_lie_on_their_faces_within_the_noise() {
        let block = Block::mixed_houses();
        let options = CloudOptions { points_per_roof: 50, ..CloudOptions::default() };
        let survey = block.cloud(&options);
        let faces: Vec<Face> = block.seen_faces().collect();
        let mut off = Vec::new();
        for (x, face) in survey.sfm.points.iter().zip(&survey.face_of_point) {
            let Some(face) = face.map(|f| &faces[f]) else { continue };
            off.push(face.normal().dot(&(survey.city_from_sfm.apply(x) - face.corners[0])));
        }
        let rms = (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt();
        assert!((rms / options.noise_m - 1.0).abs() < 0.05, "{rms}");
        let wrong = survey.face_of_point.iter().filter(|f| f.is_none()).count();
        assert_eq!(wrong, off.len() / 10);
    }

    #[test]
    fn nothing_is_seen_between_houses_that_touch_or_under_them() {
        let row = Block::row(&House::flat([6.0, 9.0, 7.0]), 3, 6.0);
        let survey = row.cloud(&CloudOptions { noise_m: 0.0, outlier_share: 0.0, ..CloudOptions::default() });
        for x in survey.sfm.points.iter().map(|x| survey.city_from_sfm.apply(x)) {
            let inside = x.x > 0.01 && x.x < 17.99 && x.y > 0.01 && x.y < 8.99;
            assert!(!inside, "{x}");
        }
    }

    #[test]
    fn a_seed_gives_one_cloud() {
        let cloud = |seed| Block::four_houses().cloud(&CloudOptions { seed, ..CloudOptions::default() }).sfm.points;
        assert_eq!(cloud(3), cloud(3));
        assert_ne!(cloud(3), cloud(4));
    }
}
