//! A point seen in photographs, as the place nearest to its rays.
//!
//! Question     where is, in the sfm frame, what is seen at these pixels?
//! Method       least squares of the distances across the rays, each over its distance from the camera (so nearly of angles), twice; a sight
//!              that is far off from where the others put the point is left out, one after another
//! Fails when   fewer than two rays are left, or they are nearly parallel

use crate::geometry::{Camera, Matrix3, Point3, Vector3};
use crate::reconstruction::Image;

/// A line of sight in the sfm frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sightline {
    origin: Point3<f64>,
    /// Unit.
    direction: Vector3<f64>,
    /// Of the camera, pixels per radian.
    focal_px: f64,
}

/// Where rays meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Intersection {
    pub point: Point3<f64>,
    /// One sigma along the worst direction, sfm units.
    pub sigma: f64,
    /// Sights that were left out.
    pub left_out: usize,
}

/// A pixel that somebody clicked, and a camera that is not quite where it was, pixels. Chosen.
const SIGHT_PX: f64 = 2.0;
/// Sights further off than this are of another point, pixels. Chosen: a click goes wrong by a window or a corner, not by less.
const LARGEST_MISS_PX: f64 = 20.0;
/// Rays of a smaller angle between them tell no distance, radians. Chosen: half a degree.
const SMALLEST_ANGLE_RAD: f64 = 0.009;
const ROUNDS: usize = 3;

impl Sightline {
    /// `None` where the lens shows nothing at the pixel.
    pub fn new(image: &Image, camera: &Camera, pixel: [f64; 2]) -> Option<Sightline> {
        let direction = image.cam_from_sfm_rotation.inverse() * camera.ray(pixel)?.into_inner();
        Some(Sightline { origin: image.center(), direction, focal_px: camera.focal_px()? })
    }

    /// The vector from the ray to a point, across it; `None` behind the camera.
    fn across(&self, point: &Point3<f64>) -> Option<(Vector3<f64>, f64)> {
        let offset = point - self.origin;
        let depth = offset.dot(&self.direction);
        (depth > 0.0).then(|| (offset - self.direction * depth, depth))
    }

    fn miss_px(&self, point: &Point3<f64>) -> f64 {
        self.across(point).map_or(f64::INFINITY, |(across, depth)| self.focal_px * across.norm() / depth)
    }
}

/// The place nearest to all rays but those that do not fit.
pub(super) fn intersection(rays: &[Sightline]) -> Option<Intersection> {
    let mut believed = rays.to_vec();
    loop {
        let (point, sigma) = nearest(&believed)?;
        let worst =
            (0..believed.len()).max_by(|&a, &b| believed[a].miss_px(&point).total_cmp(&believed[b].miss_px(&point)))?;
        if believed[worst].miss_px(&point) <= LARGEST_MISS_PX {
            return Some(Intersection { point, sigma, left_out: rays.len() - believed.len() });
        }
        // One wrong ray pulls the point away from all: the one without which the others fit best goes.
        let without = |skip: usize| -> Vec<Sightline> {
            believed.iter().enumerate().filter(|(i, _)| *i != skip).map(|(_, ray)| *ray).collect()
        };
        let misfit = |skip: usize| {
            let others = without(skip);
            nearest(&others)
                .map_or(f64::INFINITY, |(point, _)| others.iter().map(|r| r.miss_px(&point)).fold(0.0, f64::max))
        };
        let misfits: Vec<f64> = (0..believed.len()).map(misfit).collect();
        let skip = (0..believed.len()).min_by(|&a, &b| misfits[a].total_cmp(&misfits[b]))?;
        // Of two rays that do not meet nobody knows which is wrong.
        if believed.len() <= 2 || !misfits[skip].is_finite() {
            return None;
        }
        believed = without(skip);
    }
}

fn nearest(rays: &[Sightline]) -> Option<(Point3<f64>, f64)> {
    let widest = rays.iter().flat_map(|a| rays.iter().map(|b| a.direction.angle(&b.direction))).fold(0.0, f64::max);
    if rays.len() < 2 || widest < SMALLEST_ANGLE_RAD {
        return None;
    }
    let mut depths = vec![1.0; rays.len()];
    let mut found = None;
    for _ in 0..ROUNDS {
        let (mut information, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (ray, depth) in rays.iter().zip(&depths) {
            let across = Matrix3::identity() - ray.direction * ray.direction.transpose();
            let weight = (ray.focal_px / (SIGHT_PX * depth)).powi(2);
            information += across * weight;
            right += across * ray.origin.coords * weight;
        }
        let covariance = information.try_inverse()?;
        let point = Point3::from(covariance * right);
        for (depth, ray) in depths.iter_mut().zip(rays) {
            *depth = ray.across(&point)?.1;
        }
        let sigma = covariance.symmetric_eigenvalues().max().max(0.0).sqrt();
        found = Some((point, sigma)).filter(|(point, sigma)| sigma.is_finite() && point.iter().all(|v| v.is_finite()));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(origin: [f64; 3], to: [f64; 3]) -> Sightline {
        let origin = Point3::from(origin);
        Sightline { origin, direction: (Point3::from(to) - origin).normalize(), focal_px: 800.0 }
    }

    const PLACE: [f64; 3] = [1.0, 2.0, 3.0];

    #[test]
    fn rays_that_meet_give_their_place_and_more_of_them_a_smaller_sigma() {
        let two = [ray([0.0; 3], PLACE), ray([9.0, 0.0, 0.0], PLACE)];
        let found = intersection(&two).unwrap();
        assert!((found.point - Point3::from(PLACE)).norm() < 1e-12 && found.left_out == 0);
        let four = [two[0], two[1], ray([0.0, 9.0, 0.0], PLACE), ray([9.0, 9.0, 0.0], PLACE)];
        assert!(intersection(&four).unwrap().sigma < found.sigma);
    }

    #[test]
    fn a_ray_to_another_place_is_left_out_where_others_agree() {
        let mut rays = vec![
            ray([0.0; 3], PLACE),
            ray([9.0, 0.0, 0.0], PLACE),
            ray([0.0, 9.0, 0.0], PLACE),
            ray([5.0, -5.0, 0.0], [2.0, 2.0, 3.0]),
        ];
        let found = intersection(&rays).unwrap();
        assert!((found.point - Point3::from(PLACE)).norm() < 1e-9 && found.left_out == 1);
        // Of two that do not meet nobody knows which is wrong.
        rays.drain(1..3);
        assert!(intersection(&rays).is_none());
    }

    #[test]
    fn nearly_parallel_rays_and_places_behind_a_camera_meet_nowhere() {
        assert!(intersection(&[ray([0.0; 3], PLACE), ray([0.001, 0.0, 0.0], PLACE)]).is_none());
        assert!(intersection(&[ray([0.0; 3], PLACE)]).is_none() && intersection(&[]).is_none());
        let away = |origin: [f64; 3]| {
            let towards = ray(origin, PLACE);
            Sightline { direction: -towards.direction, ..towards }
        };
        assert!(intersection(&[away([0.0; 3]), away([9.0, 0.0, 0.0])]).is_none());
    }
}
