//! How large the sum of squared standard normal errors gets by chance.
//!
//! Method       the regularised lower incomplete gamma function by its series,
//!              P(a, y) = y^a e^-y / Gamma(a + 1) (1 + y / (a + 1) + y^2 / ((a + 1) (a + 2)) + ...), a half the freedoms and y half the
//!              sum, turned round by bisection
//! Source       Abramowitz and Stegun 1964, 6.5.29 and 26.4.1

/// The sum of squares of so many freedoms that chance exceeds in a share `tail` of all cases.
pub fn chi_square_beyond(freedoms: u32, tail: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while 1.0 - share_below(freedoms, high) > tail && high < MOST {
        high *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if 1.0 - share_below(freedoms, middle) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Beyond this the tail is lost in rounding.
const MOST: f64 = 1e3;
/// As many as a double has bits.
const HALVINGS: u32 = 53;

/// P(freedoms / 2, sum / 2).
fn share_below(freedoms: u32, sum: f64) -> f64 {
    let (a, y) = (0.5 * f64::from(freedoms), 0.5 * sum);
    let (mut term, mut series, mut k) = (1.0, 1.0, a);
    while term > f64::EPSILON * series {
        k += 1.0;
        term *= y / k;
        series += term;
    }
    series * (a * y.ln() - y - ln_gamma_of_half(freedoms + 2)).exp()
}

/// Logarithm of Gamma(n / 2), from Gamma(1 / 2) or Gamma(1) upwards.
fn ln_gamma_of_half(n: u32) -> f64 {
    let (first, ln_first) = if n.is_multiple_of(2) { (2, 0.0) } else { (1, 0.5 * std::f64::consts::PI.ln()) };
    (first..n).step_by(2).map(|k| (0.5 * f64::from(k)).ln()).fold(ln_first, |sum, ln| sum + ln)
}

#[cfg(test)]
mod tests;
