//! A polynomial of degree eight over an interval, by its Bernstein coefficients.
//!
//! The number of their sign changes exceeds the number of roots in the interval by an even number (Descartes), and the averages
//! that halve an interval (de Casteljau) cannot blow up.

/// An interval `[at, at + width]` in t with the polynomial's Bernstein coefficients over it.
#[derive(Clone, Copy)]
pub struct Interval {
    pub bernstein: [f64; 9],
    pub at: f64,
    pub width: f64,
}

impl Interval {
    /// [-1, 1], for the polynomial with coefficients `c[i]` of `t^i`.
    #[inline]
    pub fn whole(c: &[f64; 9]) -> Interval {
        Interval { bernstein: bernstein(c), at: -1.0, width: 2.0 }
    }

    /// Seen from its other end.
    #[inline]
    pub fn mirrored(mut self) -> Interval {
        self.bernstein.reverse();
        self
    }
}

/// Sign changes among the coefficients that are not zero.
#[inline]
pub fn sign_changes(b: &[f64; 9]) -> u32 {
    let mut changes = 0;
    let mut last = 0.0;
    for &v in b {
        changes += u32::from(v * last < 0.0);
        if v != 0.0 {
            // The sign alone: a product of two small coefficients must not underflow to zero.
            last = v.signum();
        }
    }
    changes
}

/// De Casteljau at the middle: the first entries of the rounds are the left half, the last ones the right half.
#[inline]
pub fn halves(interval: &Interval) -> (Interval, Interval) {
    let mut b = interval.bernstein;
    let mut left = [0.0; 9];
    left[0] = b[0];
    for round in 1..9 {
        for i in 0..9 - round {
            b[i] = 0.5 * (b[i] + b[i + 1]);
        }
        left[round] = b[0];
    }
    let width = 0.5 * interval.width;
    (Interval { bernstein: left, at: interval.at, width }, Interval { bernstein: b, at: interval.at + width, width })
}

/// Bernstein coefficients over [-1, 1]. With u + v = 1 and t = u - v, t^i = (u - v)^i (u + v)^(8-i); its coefficient
/// of u^j v^(8-j) divided by the binomial (8 over j) is the j-th Bernstein coefficient.
#[inline]
fn bernstein(c: &[f64; 9]) -> [f64; 9] {
    let mut b = [0.0; 9];
    for i in 0..9 {
        for j in 0..9 {
            b[j] += c[i] * FROM_POWERS[i][j];
        }
    }
    b
}

const FROM_POWERS: [[f64; 9]; 9] = from_powers();

const fn from_powers() -> [[f64; 9]; 9] {
    let binomial = [1.0, 8.0, 28.0, 56.0, 70.0, 56.0, 28.0, 8.0, 1.0];
    let mut table = [[0.0; 9]; 9];
    let mut i = 0;
    while i < 9 {
        // Multiply 1 by (u - v) i times and by (u + v) the rest of the times.
        let mut product = [0.0; 9];
        product[0] = 1.0;
        let mut factor = 0;
        while factor < 8 {
            let v = if factor < i { -1.0 } else { 1.0 };
            let mut j = factor + 1;
            while j > 0 {
                product[j] = product[j - 1] + v * product[j];
                j -= 1;
            }
            product[0] *= v;
            factor += 1;
        }
        let mut j = 0;
        while j < 9 {
            table[i][j] = product[j] / binomial[j];
            j += 1;
        }
        i += 1;
    }
    table
}

#[cfg(test)]
mod tests;
