//! Singular values by one-sided Jacobi rotations: slow for large matrices, accurate for the smallest value of small ones.

/// Sweeps over all pairs of columns; eight usually suffice.
const MOST_SWEEPS: usize = 40;

/// Columns whose cosine is below this count as orthogonal.
const ORTHOGONAL: f64 = 1e-15;

/// `A V = U S`: the rotated columns `u_j s_j`, and V.
pub struct Singular {
    columns: Vec<Vec<f64>>,
    turned: Vec<Vec<f64>>,
    /// Lengths of the columns, in their order (not sorted).
    values: Vec<f64>,
}

impl Singular {
    /// Of a matrix, row by row; all rows have one length.
    pub fn of<R: AsRef<[f64]>>(rows: &[R]) -> Singular {
        let width = rows.first().map_or(0, |row| row.as_ref().len());
        let mut columns: Vec<Vec<f64>> = (0..width).map(|j| rows.iter().map(|row| row.as_ref()[j]).collect()).collect();
        let mut turned: Vec<Vec<f64>> =
            (0..width).map(|i| (0..width).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        for _ in 0..MOST_SWEEPS {
            let mut rotated = false;
            for p in 0..width {
                for q in p + 1..width {
                    rotated |= rotate(&mut columns, &mut turned, p, q);
                }
            }
            if !rotated {
                break;
            }
        }
        let values = columns.iter().map(|column| dot(column, column).sqrt()).collect();
        Singular { columns, turned, values }
    }

    pub fn largest(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }

    pub fn smallest(&self) -> f64 {
        self.values.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Descending.
    pub fn sorted(&self) -> Vec<f64> {
        let mut sorted = self.values.clone();
        sorted.sort_by(|a, b| b.total_cmp(a));
        sorted
    }

    /// The shortest x with least `|A x - b|`, directions with a singular value below `tolerance` times the largest left out.
    pub fn least_squares(&self, b: &[f64], tolerance: f64) -> Vec<f64> {
        let floor = tolerance * self.largest();
        let mut x = vec![0.0; self.values.len()];
        for j in 0..x.len() {
            if self.values[j] > floor && self.values[j] > 0.0 {
                let share = dot(&self.columns[j], b) / self.values[j] / self.values[j];
                for i in 0..x.len() {
                    x[i] += self.turned[j][i] * share;
                }
            }
        }
        x
    }
}

/// Makes two columns orthogonal; false where they are.
fn rotate(columns: &mut [Vec<f64>], turned: &mut [Vec<f64>], p: usize, q: usize) -> bool {
    let (pp, qq) = (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]));
    let pq = dot(&columns[p], &columns[q]);
    if pq == 0.0 || pq.abs() <= ORTHOGONAL * (pp * qq).sqrt() {
        return false;
    }
    let zeta = (qq - pp) / (2.0 * pq);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cos = 1.0 / tangent.hypot(1.0);
    let sin = cos * tangent;
    for matrix in [columns, turned] {
        let (left, right) = matrix.split_at_mut(q);
        for (a, b) in left[p].iter_mut().zip(&mut right[0]) {
            (*a, *b) = (cos * *a - sin * *b, sin * *a + cos * *b);
        }
    }
    true
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests;
