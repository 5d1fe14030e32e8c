//! Lenses: what a camera's parameters mean, and how each model leads from a direction to its own plane and back.
//!
//! Source       fisheye polynomial: Kannala and Brandt 2006; field of view: Devernay and Faugeras 2001; division: Fitzgibbon 2001;
//!              enhanced unified model: Khomutenko, Garcia and Martinet 2016

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Vector2, Vector3};

use super::camera_model::CameraModel;
use super::distortion::Distortion;

/// What a camera's numbers mean.
pub(super) enum Lens {
    Flat { focal_px: Vector2<f64>, center_px: Vector2<f64>, optics: Optics },
    Sphere { size_px: Vector2<f64> },
}

pub(super) enum Optics {
    Perspective(Distortion),
    Fisheye(Distortion),
    /// Field of view parameter in radians.
    Fov(f64),
    Division(f64),
    Eucm {
        alpha: f64,
        beta: f64,
    },
}

impl Lens {
    /// Sorts a camera's parameters; `None` if there are not as many as the model has.
    pub fn of(model: CameraModel, params: &[f64]) -> Option<Lens> {
        use CameraModel as M;
        let one = |f, cx, cy, optics| (Vector2::new(f, f), Vector2::new(cx, cy), optics);
        let two = |fx, fy, cx, cy, optics| (Vector2::new(fx, fy), Vector2::new(cx, cy), optics);
        let plain = Distortion::default();
        let radial = Distortion::radial;
        let (focal_px, center_px, optics) = match (model, params) {
            (M::SimplePinhole, &[f, cx, cy]) => one(f, cx, cy, Optics::Perspective(plain)),
            (M::SimpleFisheye, &[f, cx, cy]) => one(f, cx, cy, Optics::Fisheye(plain)),
            (M::SimpleRadial | M::Radial, [f, cx, cy, k @ ..]) if k.len() == single_focal_coefficients(model) => {
                one(*f, *cx, *cy, Optics::Perspective(radial(k)))
            }
            (M::SimpleRadialFisheye | M::RadialFisheye, [f, cx, cy, k @ ..])
                if k.len() == single_focal_coefficients(model) =>
            {
                one(*f, *cx, *cy, Optics::Fisheye(radial(k)))
            }
            (M::SimpleDivision, &[f, cx, cy, k]) => one(f, cx, cy, Optics::Division(k)),
            (M::Pinhole, &[fx, fy, cx, cy]) => two(fx, fy, cx, cy, Optics::Perspective(plain)),
            (M::Fisheye, &[fx, fy, cx, cy]) => two(fx, fy, cx, cy, Optics::Fisheye(plain)),
            (M::Division, &[fx, fy, cx, cy, k]) => two(fx, fy, cx, cy, Optics::Division(k)),
            (M::Fov, &[fx, fy, cx, cy, omega]) => two(fx, fy, cx, cy, Optics::Fov(omega)),
            (M::Eucm, &[fx, fy, cx, cy, alpha, beta]) => two(fx, fy, cx, cy, Optics::Eucm { alpha, beta }),
            (M::Opencv, &[fx, fy, cx, cy, k1, k2, p1, p2]) => {
                let distortion = Distortion { tangential: [p1, p2], ..radial(&[k1, k2]) };
                two(fx, fy, cx, cy, Optics::Perspective(distortion))
            }
            (M::FullOpencv, &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6]) => {
                let distortion =
                    Distortion { tangential: [p1, p2], denominator: [k4, k5, k6], ..radial(&[k1, k2, k3]) };
                two(fx, fy, cx, cy, Optics::Perspective(distortion))
            }
            (M::OpencvFisheye, &[fx, fy, cx, cy, k1, k2, k3, k4]) => {
                two(fx, fy, cx, cy, Optics::Fisheye(radial(&[k1, k2, k3, k4])))
            }
            (M::ThinPrismFisheye, &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx1, sy1]) => {
                let prism = [sx1, 0.0, sy1, 0.0];
                let distortion = Distortion { tangential: [p1, p2], prism, ..radial(&[k1, k2, k3, k4]) };
                two(fx, fy, cx, cy, Optics::Fisheye(distortion))
            }
            (M::RadTanThinPrismFisheye, &[fx, fy, cx, cy, k0, k1, k2, k3, k4, k5, p0, p1, s0, s1, s2, s3]) => {
                let distortion = Distortion {
                    // The source of this model counts the two the other way round.
                    tangential: [p1, p0],
                    prism: [s0, s1, s2, s3],
                    shifts_after_radial: true,
                    ..radial(&[k0, k1, k2, k3, k4, k5])
                };
                two(fx, fy, cx, cy, Optics::Fisheye(distortion))
            }
            (M::Equirectangular, &[width, height]) => {
                return Some(Lens::Sphere { size_px: Vector2::new(width, height) });
            }
            _ => return None,
        };
        Some(Lens::Flat { focal_px, center_px, optics })
    }
}

/// Radial coefficients of the models with one focal length.
fn single_focal_coefficients(model: CameraModel) -> usize {
    if matches!(model, CameraModel::Radial | CameraModel::RadialFisheye) { 2 } else { 1 }
}

impl Optics {
    /// From a point ahead of the camera to the lens's plane, distorted.
    pub fn plane_from_cam(&self, x: Vector3<f64>) -> Option<Vector2<f64>> {
        let flat = x.xy() / x.z;
        match self {
            Optics::Perspective(distortion) => Some(distortion.apply(flat)?.0),
            Optics::Fisheye(distortion) => {
                let radius = x.xy().norm();
                let angle_per_radius = if radius > 0.0 { radius.atan2(x.z) / radius } else { x.z.recip() };
                Some(distortion.apply(x.xy() * angle_per_radius)?.0)
            }
            Optics::Fov(omega) => Some(flat * fov_factor(flat.norm(), *omega)),
            Optics::Division(k) => {
                // x_undistorted = x_distorted / (1 + k r_distorted^2), solved for the distorted point.
                let root_sq = x.z * x.z - 4.0 * k * x.xy().norm_squared();
                (root_sq >= 0.0).then(|| x.xy() * (2.0 / (x.z + root_sq.sqrt())))
            }
            Optics::Eucm { alpha, beta } => {
                let depth = (beta * x.xy().norm_squared() + x.z * x.z).sqrt();
                let divisor = alpha * depth + (1.0 - alpha) * x.z;
                (divisor > f64::EPSILON).then(|| x.xy() / divisor)
            }
        }
    }

    /// A direction (of any length) whose points appear at `p` of the lens's plane, distorted.
    pub fn cam_from_plane(&self, p: Vector2<f64>) -> Option<Vector3<f64>> {
        match self {
            Optics::Perspective(distortion) => Some(distortion.invert(p)?.push(1.0)),
            Optics::Fisheye(distortion) => {
                let undistorted = distortion.invert(p)?;
                let angle = undistorted.norm();
                let sine_per_angle = if angle > 0.0 { angle.sin() / angle } else { 1.0 };
                (angle < FRAC_PI_2).then(|| (undistorted * sine_per_angle).push(angle.cos()))
            }
            Optics::Fov(omega) => {
                let radius = p.norm();
                ((radius * omega).abs() < FRAC_PI_2).then(|| (p * inverse_fov_factor(radius, *omega)).push(1.0))
            }
            Optics::Division(k) => {
                let divisor = 1.0 + k * p.norm_squared();
                // Beyond |k| r^2 = 1 the other solution of the quadratic equation is the one that is seen.
                (divisor > 0.0 && k * p.norm_squared() <= 1.0).then(|| p.push(divisor))
            }
            Optics::Eucm { alpha, beta } => {
                let r_sq = p.norm_squared();
                let radicand = 1.0 - (2.0 * alpha - 1.0) * beta * r_sq;
                let depth = (1.0 - alpha * alpha * beta * r_sq) / (alpha * radicand.sqrt() + 1.0 - alpha);
                (radicand >= 0.0 && depth > f64::EPSILON).then(|| p.push(depth))
            }
        }
    }
}

/// `atan(2 r tan(omega / 2)) / (r omega)`, with its limits at zero.
fn fov_factor(radius: f64, omega: f64) -> f64 {
    let twice_tangent = 2.0 * (0.5 * omega).tan();
    if omega == 0.0 {
        1.0
    } else if radius == 0.0 {
        twice_tangent / omega
    } else {
        (radius * twice_tangent).atan() / (radius * omega)
    }
}

/// `tan(r omega) / (2 r tan(omega / 2))`, with its limits at zero.
fn inverse_fov_factor(radius: f64, omega: f64) -> f64 {
    let twice_tangent = 2.0 * (0.5 * omega).tan();
    if omega == 0.0 {
        1.0
    } else if radius == 0.0 {
        omega / twice_tangent
    } else {
        (radius * omega).tan() / (radius * twice_tangent)
    }
}

/// Azimuth from the z axis over the width, elevation over the height.
pub(super) fn sphere_pixel(x: Vector3<f64>, size_px: Vector2<f64>) -> Option<Vector2<f64>> {
    let level = x.x.hypot(x.z);
    if level == 0.0 && x.y == 0.0 {
        return None;
    }
    Some(Vector2::new((x.x.atan2(x.z) / TAU + 0.5) * size_px.x, (x.y.atan2(level) / PI + 0.5) * size_px.y))
}

pub(super) fn sphere_ray(pixel: Vector2<f64>, size_px: Vector2<f64>) -> Vector3<f64> {
    let azimuth = TAU * (pixel.x / size_px.x - 0.5);
    let down = PI * (pixel.y / size_px.y - 0.5);
    Vector3::new(down.cos() * azimuth.sin(), down.sin(), down.cos() * azimuth.cos())
}
