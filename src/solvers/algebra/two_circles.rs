//! Two bilinear equations in two angles: where two curves on the product of two circles meet.
//!
//! ```text
//! Problem     all (alpha, beta) with  a^T G_k b = 0, k = 1, 2,  a = (cos alpha, sin alpha, 1), b = (cos beta, sin beta, 1)
//! Method      1. For fixed alpha the equations are two lines, g_k = a^T G_k; they meet in h = g_1 x g_2, which must be on the
//!                circle: h_1^2 + h_2^2 = h_3^2.
//!             2. With cos alpha = (w^2 - x^2)/(w^2 + x^2), sin alpha = 2 x w/(w^2 + x^2) the g_k are quadratic in (x : w), h is
//!                quartic, and the condition is an octic. No chart can fail in alpha.
//!             3. A real root gives alpha, h gives beta; Newton on (alpha, beta).
//! Degenerate  where both lines coincide at some root (h = 0) the octic is blind to beta: `None`, as where a solution is missing
//! Source      mathematics.md section 5; derived here
//! ```

use crate::geometry::Vector3;

use super::common_points::{CommonPoints, Point, System};
use super::tolerance::RANK_TOLERANCE;

/// G row by row: the products of (cos alpha, sin alpha, 1) with (cos beta, sin beta, 1).
pub type Bilinear = [f64; 9];

/// Two lines that meet at less than this angle (squared sine) do not say where: the octic is blind there.
const BLIND_SQ: f64 = 1e-14;

/// Farthest that Newton travels from a root that stands for one solution, in cosines and sines.
const NEAR: f64 = 1e-3;

/// Cosine and sine of alpha, cosine and sine of beta, for every real solution; `None` where one may be missing.
#[inline]
pub fn two_circles(first: &Bilinear, second: &Bilinear) -> Option<CommonPoints> {
    let size = dot(first, first).sqrt();
    let first = first.map(|v| v / size);
    let overlap = dot(&first, second);
    let mut second: Bilinear = std::array::from_fn(|j| second[j] - overlap * first[j]);
    let rest = dot(&second, &second).sqrt();
    second = second.map(|v| v / rest);
    // Also false for NaN.
    if !(size > 0.0 && rest > RANK_TOLERANCE * (overlap.abs() + rest)) {
        return None;
    }
    let lines = [quadratic_lines(&first), quadratic_lines(&second)];
    let mut found = CommonPoints::none();
    found.add(&TwoCircles { equations: [first, second], lines }, &octic(&lines));
    found.is_complete().then_some(found)
}

/// The value of a bilinear equation.
#[inline]
pub fn bilinear(g: &Bilinear, [ca, sa, cb, sb]: &Point) -> f64 {
    ca * (g[0] * cb + g[1] * sb + g[2]) + sa * (g[3] * cb + g[4] * sb + g[5]) + (g[6] * cb + g[7] * sb + g[8])
}

/// For each equation the line in (cos beta, sin beta, 1), each entry quadratic in (x : w): coefficients of w^2, x w, x^2.
type Lines = [[[f64; 3]; 3]; 2];

struct TwoCircles {
    /// Orthonormal.
    equations: [Bilinear; 2],
    lines: Lines,
}

impl System for TwoCircles {
    #[inline]
    fn at_root(&self, &[x, w]: &[f64; 2]) -> Option<Point> {
        let [ww, xw, xx] = [w * w, x * w, x * x];
        let [g, k] = self.lines.map(|line| Vector3::from(line.map(|e| e[0] * ww + e[1] * xw + e[2] * xx)));
        let h = g.cross(&k);
        if !(h.norm_squared() > BLIND_SQ * g.norm_squared() * k.norm_squared()) {
            return None;
        }
        let radius = h.x.hypot(h.y) * h.z.signum();
        let turn = (ww + xx).recip();
        Some([(ww - xx) * turn, 2.0 * xw * turn, h.x / radius, h.y / radius])
    }

    /// In alpha and beta; there is no third freedom.
    #[inline]
    fn correction(&self, &[ca, sa, cb, sb]: &Point) -> Vector3<f64> {
        let [e, f] = self.equations.map(|g| {
            let by_cos = g[0] * cb + g[1] * sb + g[2];
            let by_sin = g[3] * cb + g[4] * sb + g[5];
            let value = ca * by_cos + sa * by_sin + (g[6] * cb + g[7] * sb + g[8]);
            let d_alpha = ca * by_sin - sa * by_cos;
            let d_beta = cb * (ca * g[1] + sa * g[4] + g[7]) - sb * (ca * g[0] + sa * g[3] + g[6]);
            [value, d_alpha, d_beta]
        });
        let determinant = e[1] * f[2] - e[2] * f[1];
        let alpha = (e[2] * f[0] - e[0] * f[2]) / determinant;
        let beta = (e[0] * f[1] - e[1] * f[0]) / determinant;
        Vector3::new(alpha, beta, 0.0)
    }

    #[inline]
    fn corrected(&self, &[ca, sa, cb, sb]: &Point, correction: &Vector3<f64>) -> Option<Point> {
        let (alpha, beta) = (correction.x, correction.y);
        let at = [ca - sa * alpha, sa + ca * alpha, cb - sb * beta, sb + cb * beta];
        let (a, b) = ((at[0] * at[0] + at[1] * at[1]).sqrt(), (at[2] * at[2] + at[3] * at[3]).sqrt());
        Some([at[0] / a, at[1] / a, at[2] / b, at[3] / b])
    }

    #[inline]
    fn misfit(&self, at: &Point) -> f64 {
        self.equations.iter().map(|g| bilinear(g, at).abs()).sum()
    }

    #[inline]
    fn distance_sq(a: &Point, b: &Point) -> f64 {
        (0..4).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum()
    }

    /// A root of the octic is as good as its digits. One from which Newton travels knew alpha but not beta: two solutions share
    /// that alpha, and the other one would be lost.
    #[inline]
    fn is_near(start: &Point, solution: &Point) -> bool {
        (0..4).all(|i| (start[i] - solution[i]).abs() < NEAR)
    }
}

#[inline]
fn dot(a: &Bilinear, b: &Bilinear) -> f64 {
    (0..9).map(|j| a[j] * b[j]).sum()
}

#[inline]
fn quadratic_lines(g: &Bilinear) -> [[f64; 3]; 3] {
    std::array::from_fn(|j| {
        let (cos, sin, one) = (g[j], g[3 + j], g[6 + j]);
        [one + cos, 2.0 * sin, one - cos]
    })
}

/// h_1^2 + h_2^2 - h_3^2 with h the cross product of the two lines.
#[inline]
fn octic([g, k]: &Lines) -> [f64; 9] {
    let h = [
        cross_entry(&g[1], &k[2], &g[2], &k[1]),
        cross_entry(&g[2], &k[0], &g[0], &k[2]),
        cross_entry(&g[0], &k[1], &g[1], &k[0]),
    ];
    let mut f = [0.0; 9];
    for i in 0..5 {
        for j in 0..5 {
            f[i + j] += h[0][i] * h[0][j] + h[1][i] * h[1][j] - h[2][i] * h[2][j];
        }
    }
    f
}

/// a b - c d of quadratics.
#[inline]
fn cross_entry(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> [f64; 5] {
    let mut out = [0.0; 5];
    for i in 0..3 {
        for j in 0..3 {
            out[i + j] += a[i] * b[j] - c[i] * d[j];
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;
    use std::f64::consts::{PI, TAU};

    /// Sign changes of the condition h_1^2 + h_2^2 = h_3^2 around the circle of alpha, sampled finely: a lower bound of the number
    /// of solutions, each of which changes the sign once.
    fn solutions_seen_by_sampling([first, second]: &[Bilinear; 2]) -> usize {
        let condition = |alpha: f64| {
            let (sin, cos) = alpha.sin_cos();
            let line = |g: &Bilinear| Vector3::from_fn(|j, _| cos * g[j] + sin * g[3 + j] + g[6 + j]);
            let h = line(first).cross(&line(second));
            h.x * h.x + h.y * h.y - h.z * h.z
        };
        let signs: Vec<bool> = (0..4000).map(|i| condition(TAU * f64::from(i) / 4000.0) > 0.0).collect();
        (0..4000).filter(|&i| signs[i] != signs[(i + 1) % 4000]).count()
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(3), failure_persistence: None, ..ProptestConfig::with_cases(500) })]

        #[test]
        fn planted_angles_are_found_and_no_solution_is_missing(
            random in prop::array::uniform2(prop::array::uniform9(-1.0..1.0f64)),
            (alpha, beta) in (-PI..PI, -PI..PI),
        ) {
            let planted = [alpha.cos(), alpha.sin(), beta.cos(), beta.sin()];
            let equations = random.map(|mut g| {
                g[8] -= bilinear(&g, &planted);
                g
            });
            // Where two solutions nearly share an angle the octic may hand the sample on.
            let Some(found) = two_circles(&equations[0], &equations[1]) else { return Ok(()) };
            prop_assert!(found.iter().all(|at| equations.iter().all(|g| bilinear(g, at).abs() < 1e-9)));
            prop_assert!(found.len() >= solutions_seen_by_sampling(&equations));
            let miss_sq = found.iter().map(|at| TwoCircles::distance_sq(at, &planted)).fold(f64::INFINITY, f64::min);
            prop_assert!(miss_sq < 1e-12, "missed by {}", miss_sq.sqrt());
        }
    }
}
