//! `a cos + b sin + g = 0`: a line meets the unit circle (mathematics.md 4.1).

use super::tolerance::RANK_TOLERANCE;

/// By how much, relative to the radius, the line may pass beside the circle and still count as tangent. Rounding in
/// the coefficients is some 1e-15; a tangent is hit to the square root of it.
const TANGENT: f64 = 1e-13;

/// The points `(cos, sin)` on the line, two of them unless the line is a tangent; none where it passes by.
///
/// With `r^2 = a^2 + b^2` the foot of the origin on the line is `-g (a, b) / r^2`, and the points lie
/// `h = sqrt((r - g)(r + g)) / r` from it along the line. No angle is formed: `acos` would lose half the digits near
/// a tangent. `size_sq` is the square of the size that `a` and `b` have in general: where both vanish beside it, every
/// angle fits or none, and nothing is returned.
#[inline]
pub fn on_circle(a: f64, b: f64, g: f64, size_sq: f64) -> ([[f64; 2]; 2], usize) {
    let square = a * a + b * b;
    let r = square.sqrt();
    let inside = (r - g) * (r + g);
    // Written so that NaN ends here too.
    if !(square > RANK_TOLERANCE * RANK_TOLERANCE * size_sq && inside >= -TANGENT * square) {
        return ([[0.0; 2]; 2], 0);
    }
    let inverse = square.recip();
    if inside <= 0.0 {
        let sign = if g > 0.0 { -1.0 } else { 1.0 };
        return ([[sign * a / r, sign * b / r], [0.0; 2]], 1);
    }
    let h = inside.sqrt();
    let (x, y) = (-g * a * inverse, -g * b * inverse);
    let (dx, dy) = (-h * b * inverse, h * a * inverse);
    ([[x + dx, y + dy], [x - dx, y - dy]], 2)
}

#[cfg(test)]
mod tests;
