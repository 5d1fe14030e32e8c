//! Bounded losses: what lies far off must not pull.

/// Tukey's biweight (Beaton and Tukey 1974): the weight of a residual, 1 at zero, 0 from `width` on; `residual_sq` and `width`
/// in the same unit (squared). `w = (1 - r^2 / c^2)^2`.
#[inline]
pub fn tukey_weight(residual_sq: f64, width: f64) -> f64 {
    let rest = 1.0 - residual_sq / (width * width);
    if rest > 0.0 { rest * rest } else { 0.0 }
}

/// What a residual adds to an inlier share: `1 - r^2 / c^2`, at least 0. Source: the truncated quadratic of MSAC (Torr and Zisserman 2000).
#[inline]
pub fn truncated_quadratic(residual_sq: f64, width: f64) -> f64 {
    (1.0 - residual_sq / (width * width)).max(0.0)
}

#[cfg(test)]
mod tests;
