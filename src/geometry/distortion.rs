//! Distortion of a lens within its own plane: radial polynomials, then tangential and thin-prism shifts; and its inverse.
//!
//! Source       Brown 1966; Weng, Cohen and Herniou 1992

use nalgebra::{Matrix2, Vector2};

/// `q = radial * p`, then tangential and thin-prism shifts, taken at `p` or, where `shifts_after_radial`, at `q`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Distortion {
    /// Coefficients of r^2, r^4, ... above and below the fraction line.
    pub numerator: [f64; 6],
    pub denominator: [f64; 3],
    pub tangential: [f64; 2],
    /// Of r^2 and r^4 for x, then for y.
    pub prism: [f64; 4],
    pub shifts_after_radial: bool,
}

impl Distortion {
    pub fn radial(coefficients: &[f64]) -> Distortion {
        let mut numerator = [0.0; 6];
        numerator[..coefficients.len()].copy_from_slice(coefficients);
        Distortion { numerator, ..Distortion::default() }
    }

    /// The distorted point with the derivative of it; `None` beyond the fold, where a polynomial turns back and
    /// would set points far off the axis into the picture.
    pub fn apply(&self, p: Vector2<f64>) -> Option<(Vector2<f64>, Matrix2<f64>)> {
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
    pub fn invert(&self, target: Vector2<f64>) -> Option<Vector2<f64>> {
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

#[cfg(test)]
mod tests;
