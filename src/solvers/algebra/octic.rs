//! The real roots of an octic, without heap and without losing any.
//!
//! ```text
//! Problem     all real roots of c_0 w^8 + c_1 x w^7 + .. + c_8 x^8, as points (x : w) of the projective line
//! Method      1. Two charts, |x| <= |w| with t = x/w and |w| <= |x| with t = w/x, each over t in [-1, 1]: no root is
//!                near infinity, whatever the leading coefficient.
//!             2. Bernstein form over [-1, 1]. The number of sign changes in its coefficients exceeds the number of
//!                roots in the interval by an even number (Descartes). 0: no root, leave it. 1: exactly one root.
//!                More: halve the interval (de Casteljau: eight rounds of averages) and ask again.
//!             3. One root in a bracket: Newton, started where the control polygon crosses zero, held by the bracket.
//!             4. An interval of width NEAREST with two or more changes holds a (nearly) double root or a pair of
//!                complex roots next to the real line: both its ends are handed up, and Newton on the original
//!                equations decides.
//! Solutions   8 real roots at most; up to MOST_ROOTS candidates, since nearly double ones come twice
//! Why         A Sturm chain divides by remainders that may vanish; averages cannot blow up. Rounding in the averages is
//!             below that in the coefficients themselves.
//! Source      Lane and Riesenfeld, "Bounds on a polynomial" (BIT 1981); the conversion is derived below
//! Tests       below
//! ```

use super::bernstein::{Interval, halves, sign_changes};

/// Most candidates handed up: eight roots, and room for nearly double ones given twice.
pub const MOST_ROOTS: usize = 16;

/// Width of an interval that is halved no further. Coefficients carry a relative error of some 1e-15, and a double root
/// splits by its square root, 3e-8, into two real ones or two complex ones; an interval must be wide beside that for its
/// sign changes to show the complex ones.
const NEAREST: f64 = 2e-6;

/// Intervals looked at before a polynomial counts as noise: 8 roots, each halved 21 times, and as many empty halves.
const MOST_INTERVALS: usize = 400;

/// Newton steps on one bracketed root; a bad start is halved as often.
const MOST_STEPS: usize = 60;

/// A step in t below which the root is handed up: Newton's next error is its square.
const CLOSE: f64 = 1e-8;

/// One of the two charts of the projective line.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    /// `|x| <= |w|`, t = x / w.
    Inner,
    /// `|w| <= |x|`, t = w / x.
    Outer,
}

/// Candidates `(x, w)` for the roots, the larger of the two being 1.
#[derive(Clone, Copy, Debug)]
pub struct Roots {
    roots: [[f64; 2]; MOST_ROOTS],
    len: usize,
}

impl Roots {
    fn push(&mut self, side: Side, t: f64) {
        if self.len < MOST_ROOTS {
            self.roots[self.len] = match side {
                Side::Inner => [t, 1.0],
                Side::Outer => [1.0, t],
            };
            self.len += 1;
        }
    }
}

impl std::ops::Deref for Roots {
    type Target = [[f64; 2]];

    fn deref(&self) -> &[[f64; 2]] {
        &self.roots[..self.len]
    }
}

/// Real roots of the binary octic with coefficients `c[i]` of `x^i w^(8-i)`.
pub fn real_roots(c: &[f64; 9]) -> Roots {
    let mut roots = Roots { roots: [[0.0; 2]; MOST_ROOTS], len: 0 };
    let sum: f64 = c.iter().sum();
    if sum.is_finite() {
        on_side(c, Side::Inner, &mut roots);
        let reversed = std::array::from_fn(|i| c[8 - i]);
        on_side(&reversed, Side::Outer, &mut roots);
    }
    roots
}

fn on_side(c: &[f64; 9], side: Side, roots: &mut Roots) {
    // Depth first; each halving leaves one interval waiting, and there are at most 21 halvings.
    let mut waiting = [Interval { bernstein: [0.0; 9], at: 0.0, width: 0.0 }; 32];
    waiting[0] = Interval::whole(c);
    let mut len = 1;
    // A root at an end belongs to the chart |x| <= |w| alone. Axis-aligned boxes have double roots there.
    let whole = waiting[0];
    for (end, outward) in [(-1.0, whole), (1.0, whole.mirrored())] {
        for _ in 0..if side == Side::Inner { roots_at_start(&outward) } else { 0 } {
            roots.push(side, end);
        }
    }
    for _ in 0..MOST_INTERVALS {
        if len == 0 {
            return;
        }
        len -= 1;
        let interval = waiting[len];
        match sign_changes(&interval.bernstein) {
            0 => {}
            1 => roots.push(side, bracketed_root(c, &interval)),
            _ if interval.width < NEAREST => {
                roots.push(side, interval.at);
                roots.push(side, interval.at + interval.width);
            }
            _ => {
                let (left, right) = halves(&interval);
                for _ in 0..roots_at_start(&right) {
                    roots.push(side, right.at);
                }
                waiting[len] = right;
                waiting[len + 1] = left;
                len += 2;
            }
        }
    }
}

/// Roots at the very start of an interval: one where the polynomial vanishes there, two where it hardly changes besides or
/// where a complex pair stands hardly beside it. At the border of two halves such a pair may show in the sign changes of neither.
/// Near it p = (p'' / 2) ((t - at)^2 + k^2), so k^2 = 2 p / p'', where p' is 8 times the first difference of the coefficients over
/// the width and p'' 56 times the second over its square; from a root at the start the next one is 2 p' / p'' away.
#[inline]
fn roots_at_start(interval: &Interval) -> usize {
    let b = &interval.bernstein;
    let curvature = 56.0 * (b[0] - 2.0 * b[1] + b[2]);
    if b[0] == 0.0 {
        let next = 16.0 * b[1].abs() * interval.width;
        return if next <= NEAREST * curvature.abs() { 2 } else { 1 };
    }
    let value = 2.0 * b[0] * interval.width * interval.width;
    if value * curvature > 0.0 && value.abs() < NEAREST * NEAREST * curvature.abs() { 2 } else { 0 }
}

/// The root of an interval whose coefficients change sign once.
fn bracketed_root(c: &[f64; 9], interval: &Interval) -> f64 {
    let b = &interval.bernstein;
    // The sign left of the root is that of the first coefficient that is not zero.
    let change = (1..9).find(|&i| b[i] * b[0].signum() < 0.0).unwrap_or(8);
    let negative_left = b.iter().find(|&&v| v != 0.0).is_some_and(|&v| v < 0.0);
    let (mut low, mut high) = (interval.at, interval.at + interval.width);
    let share = (change as f64 - b[change] / (b[change] - b[change - 1])) / 8.0;
    let mut t = low + interval.width * if share > 0.0 && share < 1.0 { share } else { 0.5 };
    for _ in 0..MOST_STEPS {
        let (value, slope) = value_and_slope(c, t);
        if (value < 0.0) == negative_left {
            low = t;
        } else {
            high = t;
        }
        let next = t - value / slope;
        // Also false for NaN and infinity.
        let inside = next >= low && next <= high;
        let step = (next - t).abs();
        t = if inside { next } else { 0.5 * (low + high) };
        if (inside && step < CLOSE) || high - low < CLOSE * CLOSE {
            break;
        }
    }
    t
}

/// Horner for the value and its derivative.
#[inline]
fn value_and_slope(c: &[f64; 9], t: f64) -> (f64, f64) {
    let mut value = c[8];
    let mut slope = 0.0;
    for i in (0..8).rev() {
        slope = slope * t + value;
        value = value * t + c[i];
    }
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, SMatrix};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    /// Coefficients of the product of (w_i x - x_i w) over the given roots, times (x^2 + k^2 w^2) up to degree 8.
    fn with_roots(roots: &[[f64; 2]], k: f64) -> [f64; 9] {
        let mut c = [0.0; 9];
        c[0] = 1.0;
        let mut times = |low: f64, middle: f64, high: f64| {
            let old = c;
            for i in 0..9 {
                c[i] = low * old[i]
                    + middle * if i > 0 { old[i - 1] } else { 0.0 }
                    + high * if i > 1 { old[i - 2] } else { 0.0 };
            }
        };
        for r in roots {
            times(-r[0], r[1], 0.0);
        }
        for _ in 0..(8 - roots.len()) / 2 {
            times(k * k, 0.0, 1.0);
        }
        c
    }

    fn angle(r: &[f64; 2]) -> f64 {
        r[0].atan2(r[1]).rem_euclid(std::f64::consts::PI)
    }

    #[test]
    fn finds_every_root_of_octics_with_known_roots() {
        let mut random = crate::solvers::scene::Random::stream(7, 0);
        let mut uniform = || random.unit();
        for case in 0..20_000 {
            let number = [0, 2, 4, 6, 8][case % 5];
            let known: Vec<[f64; 2]> =
                (0..number).map(|_| (std::f64::consts::PI * uniform()).sin_cos().into()).collect();
            let mut gap = 1.0f64;
            for i in 0..number {
                for j in 0..i {
                    gap = gap.min((known[i][0] * known[j][1] - known[i][1] * known[j][0]).abs());
                }
            }
            if gap < 1e-3 {
                continue;
            }
            let found = real_roots(&with_roots(&known, 0.5 + uniform()));
            assert_eq!(found.len(), number, "case {case}: {known:?}");
            for k in &known {
                let miss = found.iter().map(|f| (angle(f) - angle(k)).abs()).fold(9.0, f64::min);
                assert!(miss < 1e-7 || (miss - std::f64::consts::PI).abs() < 1e-7, "case {case}: {miss}");
            }
        }
    }

    #[test]
    fn finds_roots_at_zero_at_infinity_and_on_the_border_of_the_charts() {
        let known = [[0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]];
        let found = real_roots(&with_roots(&known, 1.0));
        assert_eq!(found.len(), 4, "{found:?}");
    }

    #[test]
    fn a_double_root_is_handed_up() {
        for k in 0..1000 {
            let double = [-0.9995 + 0.002 * f64::from(k), 1.0];
            let known = [double, double, [-2.0, 1.0], [0.9, 0.3]];
            let found = real_roots(&with_roots(&known, 1.0));
            assert!(found.iter().any(|r| (r[0] - double[0] * r[1]).abs() < 1e-5), "{double:?}: {found:?}");
        }
    }

    #[test]
    fn a_double_root_on_the_border_of_the_charts_is_handed_up_twice() {
        for double in [[1.0, 1.0], [-1.0, 1.0], [0.0, 1.0]] {
            for off in [0.0, 3e-17, -3e-17] {
                let mut octic = with_roots(&[double, double], 1.0);
                octic[0] += off;
                let found = real_roots(&octic);
                let near = found.iter().filter(|r| (r[0] - double[0] * r[1]).abs() < 1e-5).count();
                assert!(near >= 2, "{double:?} {off}: {found:?}");
            }
        }
    }

    #[test]
    fn noise_and_nan_end_without_roots_beyond_the_limit() {
        assert!(real_roots(&[f64::NAN; 9]).is_empty());
        assert!(real_roots(&[0.0; 9]).len() <= MOST_ROOTS);
    }

    /// Roots of `c[0] + c[1] t + .. + c[8] t^8` over the complex numbers: eigenvalues of the companion matrix.
    fn by_companion_matrix(c: &[f64; 9]) -> Vec<Complex<f64>> {
        let companion = SMatrix::<f64, 8, 8>::from_fn(|i, j| match (i, j) {
            (i, 7) => -c[i] / c[8],
            (i, j) if i == j + 1 => 1.0,
            _ => 0.0,
        });
        companion.complex_eigenvalues().iter().copied().collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

        #[test]
        fn the_real_roots_are_the_real_eigenvalues_of_the_companion_matrix(c in prop::array::uniform9(-1.0..1.0f64)) {
            prop_assume!(c[8].abs() > 0.05);
            let all = by_companion_matrix(&c);
            // A root that is nearly double is real or complex as rounding will have it.
            let clear = |k: usize| {
                let apart = (0..8).filter(|&i| i != k).all(|i| (all[i] - all[k]).norm() > 1e-3 * (1.0 + all[k].norm()));
                apart && (all[k].im.abs() < 1e-9 || all[k].im.abs() > 1e-4)
            };
            prop_assume!((0..8).all(clear));
            let real: Vec<f64> = all.iter().filter(|root| root.im.abs() < 1e-9).map(|root| root.re).collect();
            let found = real_roots(&c);
            prop_assert_eq!(found.len(), real.len());
            for root in real {
                let miss = found.iter().map(|&[x, w]| (x - root * w).abs() / root.hypot(1.0)).fold(f64::INFINITY, f64::min);
                prop_assert!(miss < 1e-6, "{} is missed by {}", root, miss);
            }
        }
    }
}
