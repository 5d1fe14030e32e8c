//! Rates with the interval in which the true rate lies, and quantiles.

/// Standard normal, 97.5 %.
const Z: f64 = 1.959_964;

/// So many of so many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    pub hits: usize,
    pub of: usize,
}

impl Rate {
    pub fn new<T>(all: &[T], hit: impl Fn(&T) -> bool) -> Rate {
        Rate { hits: all.iter().filter(|one| hit(one)).count(), of: all.len() }
    }

    /// 95 % interval (Wilson 1927): sound for few and for none.
    pub fn interval(&self) -> (f64, f64) {
        if self.of == 0 {
            return (0.0, 1.0);
        }
        let (n, p) = (self.of as f64, self.hits as f64 / self.of as f64);
        let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
        let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt() / (1.0 + Z * Z / n);
        ((middle - half).max(0.0), (middle + half).min(1.0))
    }
}

impl std::fmt::Display for Rate {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        if self.of == 0 {
            return write!(f, "-");
        }
        let (low, high) = self.interval();
        let percent = 100.0 * self.hits as f64 / self.of as f64;
        let text = format!("{} of {}: {percent:.1} % ({:.1} to {:.1})", self.hits, self.of, 100.0 * low, 100.0 * high);
        f.pad(&text)
    }
}

/// The value that a share of all stays below; NaN of none.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get((share * sorted.len() as f64) as usize).or(sorted.last()).copied().unwrap_or(f64::NAN)
}
