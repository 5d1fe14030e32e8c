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
//! Source      Lane and Riesenfeld 1981; the conversion is derived below
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
mod tests;
