//! Cameras: every model of COLMAP 4.2, from the camera frame to pixels and back.
//!
//! A lens model works on a plane of its own: the image plane at z = 1 for perspective lenses, the plane whose radius
//! is the angle from the axis for fisheyes. Distortion moves points within that plane; focal lengths and the principal
//! point lead on to pixels (`lens.rs`, `distortion.rs`, with their sources).

use std::f64::consts::TAU;

use nalgebra::{Point3, Unit, Vector2, Vector3};

use super::camera_model::CameraModel;
use super::lens::{Lens, Optics, sphere_pixel, sphere_ray};

/// A camera's calibration. Pixels: x right, y down, the centre of the first pixel is (0.5, 0.5).
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub model: CameraModel,
    pub width_px: u64,
    pub height_px: u64,
    /// In the order of COLMAP's documentation, as many as the model has.
    pub params: Vec<f64>,
}

impl Camera {
    /// The pixel in which a point of the camera frame appears (within the picture or not); `None` behind the camera,
    /// and where the lens shows nothing. A panorama shows everything.
    pub fn project(&self, x_in_cam: &Point3<f64>) -> Option<[f64; 2]> {
        let x = x_in_cam.coords;
        let pixel = match Lens::of(self.model, &self.params)? {
            Lens::Sphere { size_px } => sphere_pixel(x, size_px)?,
            Lens::Flat { focal_px, center_px, optics } => {
                let ahead = x.z > f64::EPSILON || (matches!(optics, Optics::Division(_)) && x.z > 0.0);
                let plane = if ahead { optics.plane_from_cam(x)? } else { return None };
                plane.component_mul(&focal_px) + center_px
            }
        };
        pixel.iter().all(|v| v.is_finite()).then_some([pixel.x, pixel.y])
    }

    /// The direction, in the camera frame, of what appears at a pixel; `None` where no direction ahead of the camera
    /// does.
    pub fn ray(&self, pixel: [f64; 2]) -> Option<Unit<Vector3<f64>>> {
        let pixel = Vector2::from(pixel);
        let ray = match Lens::of(self.model, &self.params)? {
            Lens::Sphere { size_px } => sphere_ray(pixel, size_px),
            Lens::Flat { focal_px, center_px, optics } => {
                optics.cam_from_plane((pixel - center_px).component_div(&focal_px))?
            }
        };
        ray.iter().all(|v| v.is_finite()).then(|| Unit::try_new(ray, f64::MIN_POSITIVE)).flatten()
    }

    /// Mean of the focal lengths; for a panorama that of the picture whose pixels are as wide at the horizon.
    pub fn focal_px(&self) -> Option<f64> {
        match Lens::of(self.model, &self.params)? {
            Lens::Flat { focal_px, .. } => Some(0.5 * (focal_px.x + focal_px.y)),
            Lens::Sphere { size_px } => Some(size_px.x / TAU),
        }
    }
}

#[cfg(test)]
mod tests;
