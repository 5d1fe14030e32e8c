//! Cameras: every model of COLMAP 4.2, from the camera frame to pixels and back.
//!
//! A lens model works on a plane of its own: the image plane at z = 1 for perspective lenses, the plane whose radius
//! is the angle from the axis for fisheyes. Distortion moves points within that plane; focal lengths and the principal
//! point lead on to pixels. Sources: Brown 1966 and Weng et al. 1992 (radial, tangential, thin prism), Kannala and
//! Brandt 2006 (fisheye polynomial), Devernay and Faugeras 2001 (field of view), Fitzgibbon 2001 (division),
//! Khomutenko et al. 2016 (enhanced unified model).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Matrix2, Point3, Unit, Vector2, Vector3};

/// A camera's calibration. Pixels: x right, y down, the centre of the first pixel is (0.5, 0.5).
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub model: CameraModel,
    pub width_px: u64,
    pub height_px: u64,
    /// In the order of COLMAP's documentation, as many as the model has.
    pub params: Vec<f64>,
}

/// Every model of COLMAP 4.2, in the order of its ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraModel {
    SimplePinhole,
    Pinhole,
    SimpleRadial,
    Radial,
    Opencv,
    OpencvFisheye,
    FullOpencv,
    Fov,
    SimpleRadialFisheye,
    RadialFisheye,
    ThinPrismFisheye,
    RadTanThinPrismFisheye,
    SimpleDivision,
    Division,
    SimpleFisheye,
    Fisheye,
    Eucm,
    Equirectangular,
}

/// What a camera's numbers mean.
enum Lens {
    Flat { focal_px: Vector2<f64>, center_px: Vector2<f64>, optics: Optics },
    Sphere { size_px: Vector2<f64> },
}

enum Optics {
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

/// `q = radial * p`, then tangential and thin-prism shifts, taken at `p` or, where `shifts_after_radial`, at `q`.
#[derive(Clone, Copy, Default)]
struct Distortion {
    /// Coefficients of r^2, r^4, ... above and below the fraction line.
    numerator: [f64; 6],
    denominator: [f64; 3],
    tangential: [f64; 2],
    /// Of r^2 and r^4 for x, then for y.
    prism: [f64; 4],
    shifts_after_radial: bool,
}

impl Distortion {
    fn radial(coefficients: &[f64]) -> Distortion {
        let mut numerator = [0.0; 6];
        numerator[..coefficients.len()].copy_from_slice(coefficients);
        Distortion { numerator, ..Distortion::default() }
    }

    /// The distorted point with the derivative of it; `None` beyond the fold, where a polynomial turns back and
    /// would set points far off the axis into the picture.
    fn apply(&self, p: Vector2<f64>) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        let r_sq = p.norm_squared();
        let (above, above_slope) = polynomial(&self.numerator, r_sq);
        let (below, below_slope) = polynomial(&self.denominator, r_sq);
        let factor = above / below;
        // By r^2.
        let slope = (above_slope - factor * below_slope) / below;
        let q = factor * p;
        let q_by_p = factor * Matrix2::identity() + 2.0 * slope * p * p.transpose();
        let (distorted, derivative) = if self.shifts_after_radial {
            let (shift, shift_by_q) = self.shift(q);
            (q + shift, q_by_p + shift_by_q * q_by_p)
        } else {
            let (shift, shift_by_p) = self.shift(p);
            (q + shift, q_by_p + shift_by_p)
        };
        (factor > 0.0 && below > 0.0 && derivative.determinant() > 0.0).then_some((distorted, derivative))
    }

    /// The tangential and thin-prism shifts at `p`, and the derivative of them.
    fn shift(&self, p: Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let [p1, p2] = self.tangential;
        let [sx1, sx2, sy1, sy2] = self.prism;
        let (x, y, r_sq) = (p.x, p.y, p.norm_squared());
        let shift = Vector2::new(
            2.0 * p1 * x * y + p2 * (r_sq + 2.0 * x * x) + (sx1 + sx2 * r_sq) * r_sq,
            2.0 * p2 * x * y + p1 * (r_sq + 2.0 * y * y) + (sy1 + sy2 * r_sq) * r_sq,
        );
        let (prism_x, prism_y) = (2.0 * (sx1 + 2.0 * sx2 * r_sq), 2.0 * (sy1 + 2.0 * sy2 * r_sq));
        let derivative = Matrix2::new(
            2.0 * p1 * y + 6.0 * p2 * x + prism_x * x,
            2.0 * p1 * x + 2.0 * p2 * y + prism_x * y,
            2.0 * p2 * y + 2.0 * p1 * x + prism_y * x,
            2.0 * p2 * x + 6.0 * p1 * y + prism_y * y,
        );
        (shift, derivative)
    }

    /// The point that distortion moves to `target`: Newton's method, steps halved where they would lead away.
    fn invert(&self, target: Vector2<f64>) -> Option<Vector2<f64>> {
        let residual_at = |p| self.apply(p).map(|(q, derivative)| (q - target, derivative));
        let mut p = target;
        // The fold may lie between the axis and the distorted point: start nearer to the axis then.
        let mut found = residual_at(p);
        while found.is_none() && p.norm() > START_RADIUS {
            p *= 0.5;
            found = residual_at(p);
        }
        let (mut residual, mut derivative) = found?;
        let size = 1.0 + target.norm();
        for _ in 0..NEWTON_STEPS {
            if residual.norm() <= f64::EPSILON * size {
                break;
            }
            let full_step = derivative.try_inverse()? * residual;
            let tries = (0..NEWTON_HALVINGS).map(|halvings| p - full_step * 0.5f64.powi(halvings));
            let better =
                |next| residual_at(next).filter(|(r, _)| r.norm() < residual.norm()).map(|found| (next, found));
            // Without a better point nearby, rounding is reached, or the fold.
            let Some(step) = tries.filter_map(better).next() else { break };
            (p, (residual, derivative)) = step;
        }
        (residual.norm() <= PLANE_TOLERANCE * size).then_some(p)
    }
}

/// Distance from the distorted point, in units of the lens's plane (about focal lengths), that inversion may leave: a
/// millionth of a pixel at a focal length of 10^4 pixels. What rounding leaves is far below it.
const PLANE_TOLERANCE: f64 = 1e-10;
/// Quadratic convergence needs about six steps within a photograph.
const NEWTON_STEPS: usize = 50;
const NEWTON_HALVINGS: i32 = 30;
/// Radius in the lens's plane at which no distortion that a real lens has folds.
const START_RADIUS: f64 = 1e-3;

/// `1 + c0 t + c1 t^2 + ...` and its derivative by `t`.
fn polynomial(coefficients: &[f64], t: f64) -> (f64, f64) {
    let (value, slope) = coefficients.iter().rev().fold((0.0, 0.0), |(value, slope), c| {
        let value_times_t = (value + c) * t;
        (value_times_t, slope * t + value + c)
    });
    (1.0 + value, slope)
}

impl CameraModel {
    #[rustfmt::skip]
    pub const ALL: [CameraModel; 18] = [
        CameraModel::SimplePinhole, CameraModel::Pinhole, CameraModel::SimpleRadial, CameraModel::Radial,
        CameraModel::Opencv, CameraModel::OpencvFisheye, CameraModel::FullOpencv, CameraModel::Fov,
        CameraModel::SimpleRadialFisheye, CameraModel::RadialFisheye, CameraModel::ThinPrismFisheye,
        CameraModel::RadTanThinPrismFisheye, CameraModel::SimpleDivision, CameraModel::Division,
        CameraModel::SimpleFisheye, CameraModel::Fisheye, CameraModel::Eucm, CameraModel::Equirectangular,
    ];

    /// COLMAP's number for the model: its place in [`CameraModel::ALL`].
    pub fn colmap_id(self) -> i32 {
        self as i32
    }

    pub fn from_colmap_id(id: i32) -> Option<CameraModel> {
        CameraModel::ALL.get(usize::try_from(id).ok()?).copied()
    }
}

impl Camera {
    /// The pixel in which a point of the camera frame appears (within the picture or not); `None` behind the camera,
    /// and where the lens shows nothing. A panorama shows everything.
    pub fn project(&self, x_in_cam: &Point3<f64>) -> Option<[f64; 2]> {
        let x = x_in_cam.coords;
        let pixel = match self.lens()? {
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
        let ray = match self.lens()? {
            Lens::Sphere { size_px } => sphere_ray(pixel, size_px),
            Lens::Flat { focal_px, center_px, optics } => {
                optics.cam_from_plane((pixel - center_px).component_div(&focal_px))?
            }
        };
        ray.iter().all(|v| v.is_finite()).then(|| Unit::try_new(ray, f64::MIN_POSITIVE)).flatten()
    }

    /// Mean of the focal lengths; for a panorama that of the picture whose pixels are as wide at the horizon.
    pub fn focal_px(&self) -> Option<f64> {
        match self.lens()? {
            Lens::Flat { focal_px, .. } => Some(0.5 * (focal_px.x + focal_px.y)),
            Lens::Sphere { size_px } => Some(size_px.x / TAU),
        }
    }

    /// Sorts the parameters; `None` if there are not as many as the model has.
    fn lens(&self) -> Option<Lens> {
        use CameraModel as M;
        let one = |f, cx, cy, optics| (Vector2::new(f, f), Vector2::new(cx, cy), optics);
        let two = |fx, fy, cx, cy, optics| (Vector2::new(fx, fy), Vector2::new(cx, cy), optics);
        let plain = Distortion::default();
        let radial = Distortion::radial;
        let (focal_px, center_px, optics) = match (self.model, self.params.as_slice()) {
            (M::SimplePinhole, &[f, cx, cy]) => one(f, cx, cy, Optics::Perspective(plain)),
            (M::SimpleFisheye, &[f, cx, cy]) => one(f, cx, cy, Optics::Fisheye(plain)),
            (M::SimpleRadial | M::Radial, [f, cx, cy, k @ ..]) if k.len() == self.model.single_focal_coefficients() => {
                one(*f, *cx, *cy, Optics::Perspective(radial(k)))
            }
            (M::SimpleRadialFisheye | M::RadialFisheye, [f, cx, cy, k @ ..])
                if k.len() == self.model.single_focal_coefficients() =>
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

impl CameraModel {
    /// Radial coefficients of the models with one focal length.
    fn single_focal_coefficients(self) -> usize {
        if matches!(self, CameraModel::Radial | CameraModel::RadialFisheye) { 2 } else { 1 }
    }
}

impl Optics {
    /// From a point ahead of the camera to the lens's plane, distorted.
    fn plane_from_cam(&self, x: Vector3<f64>) -> Option<Vector2<f64>> {
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
    fn cam_from_plane(&self, p: Vector2<f64>) -> Option<Vector3<f64>> {
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
fn sphere_pixel(x: Vector3<f64>, size_px: Vector2<f64>) -> Option<Vector2<f64>> {
    let level = x.x.hypot(x.z);
    if level == 0.0 && x.y == 0.0 {
        return None;
    }
    Some(Vector2::new((x.x.atan2(x.z) / TAU + 0.5) * size_px.x, (x.y.atan2(level) / PI + 0.5) * size_px.y))
}

fn sphere_ray(pixel: Vector2<f64>, size_px: Vector2<f64>) -> Vector3<f64> {
    let azimuth = TAU * (pixel.x / size_px.x - 0.5);
    let down = PI * (pixel.y / size_px.y - 0.5);
    Vector3::new(down.cos() * azimuth.sin(), down.sin(), down.cos() * azimuth.cos())
}

#[cfg(test)]
mod tests;
