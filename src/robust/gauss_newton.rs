//! Normal equations of point-to-plane rows in the seven freedoms of a similarity, and steps only along what they hold.
//!
//! Row          r = n . x + d for the image x of a point; the motion x -> x + rho (omega x y + tau + sigma y) with y = (x - c) / rho
//!              changes it by rho J, J = (y x n, n, n . y); c the scene's centre and rho its radius, so that all seven
//!              unknowns are lengths in metres (mathematics.md 10.1, equation 14)
//! Method       information H = sum w J J^T, gradient g = sum w J r; the step is -H^+ g over the eigenvectors of H whose
//!              sigma = 1 / sqrt(lambda) is below a limit: a direction that the data do not hold is not moved

use nalgebra::{SMatrix, SVector, SymmetricEigen};

use crate::geometry::{Point3, Rotation3, Similarity, Vector3};

pub type Matrix7 = SMatrix<f64, 7, 7>;
pub type Vector7 = SVector<f64, 7>;

/// Centre and radius that make the seven unknowns lengths.
#[derive(Clone, Copy, Debug)]
pub struct Chart {
    pub center: Point3<f64>,
    /// Metres.
    pub radius: f64,
}

/// Sums over rows.
#[derive(Clone, Copy, Debug)]
pub struct NormalEquations {
    pub information: Matrix7,
    pub gradient: Vector7,
}

/// The directions of the seven unknowns that the data suggest, and how firmly each is held.
#[derive(Clone, Copy, Debug)]
pub struct Spectrum {
    /// Columns are unit vectors over (rotation, translation, log scale), each times the radius: metres.
    pub directions: Matrix7,
    /// Standard deviation along each, metres at the radius; infinite where nothing holds it.
    pub sigmas_m: Vector7,
}

impl Chart {
    /// Derivative of the distance of a point `x` from a plane with normal `n`, per metre of each unknown.
    #[inline]
    pub fn row(&self, x: &Point3<f64>, n: &Vector3<f64>) -> Vector7 {
        let y = (x - self.center) / self.radius;
        let turn = y.cross(n);
        Vector7::from_column_slice(&[turn.x, turn.y, turn.z, n.x, n.y, n.z, n.dot(&y)])
    }

    /// `pose` followed by the motion with these unknowns (metres).
    pub fn moved(&self, pose: &Similarity, unknowns: &Vector7) -> Similarity {
        let u = unknowns / self.radius;
        let rotation = Rotation3::new(Vector3::new(u[0], u[1], u[2]));
        // Steps are small; the bound keeps a wild one from turning the scale over.
        let scale = u[6].clamp(-0.5, 0.5).exp();
        let shift = Vector3::new(unknowns[3], unknowns[4], unknowns[5]);
        let motion = Similarity::about(&self.center, &(self.center + shift), scale, rotation);
        motion * *pose
    }
}

impl Default for NormalEquations {
    fn default() -> Self {
        NormalEquations { information: Matrix7::zeros(), gradient: Vector7::zeros() }
    }
}

impl NormalEquations {
    #[inline]
    pub fn add(&mut self, row: &Vector7, residual_m: f64, weight: f64) {
        // Only the lower triangle; `spectrum` and `step` mirror it.
        for i in 0..7 {
            let wi = weight * row[i];
            self.gradient[i] += wi * residual_m;
            for j in 0..=i {
                self.information[(i, j)] += wi * row[j];
            }
        }
    }

    /// Adds another sum, times a factor.
    pub fn merge(&mut self, other: &NormalEquations, factor: f64) {
        self.information += other.information * factor;
        self.gradient += other.gradient * factor;
    }

    /// The information matrix with both triangles.
    pub fn full(&self) -> Matrix7 {
        let mut full = self.information;
        full.fill_upper_triangle_with_lower_triangle();
        full
    }

    pub fn spectrum(&self) -> Spectrum {
        let eigen = SymmetricEigen::new(self.full());
        let sigma = |lambda: f64| if lambda > 0.0 { lambda.sqrt().recip() } else { f64::INFINITY };
        Spectrum { directions: eigen.eigenvectors, sigmas_m: eigen.eigenvalues.map(sigma) }
    }

    /// The Gauss-Newton step along the directions whose sigma is below `limit_m`.
    pub fn step(&self, limit_m: f64) -> Vector7 {
        let spectrum = self.spectrum();
        let mut step = Vector7::zeros();
        for k in 0..7 {
            let sigma = spectrum.sigmas_m[k];
            if sigma < limit_m {
                let direction = spectrum.directions.column(k);
                step -= direction * (direction.dot(&self.gradient) * sigma * sigma);
            }
        }
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHART: Chart = Chart { center: Point3::new(3.0, -2.0, 1.0), radius: 10.0 };

    #[test]
    fn row_is_the_derivative_of_the_distance() {
        let x = Point3::new(7.0, 4.0, -3.0);
        let n = Vector3::new(0.48, -0.6, 0.64);
        let row = CHART.row(&x, &n);
        for k in 0..7 {
            let mut unknowns = Vector7::zeros();
            unknowns[k] = 1e-6;
            let moved = CHART.moved(&Similarity::identity(), &unknowns).apply(&x);
            assert!((n.dot(&(moved - x)) / 1e-6 - row[k]).abs() < 1e-6, "unknown {k}");
        }
    }

    #[test]
    fn moves_only_what_is_held() {
        let mut sums = NormalEquations::default();
        let normal = Vector3::z();
        for (x, y) in [(0.0, 0.0), (5.0, 1.0), (-3.0, 4.0), (2.0, -6.0)] {
            let p = CHART.center + Vector3::new(x, y, 0.0);
            sums.add(&CHART.row(&p, &normal), 0.5, 100.0);
        }
        let step = sums.step(1.0);
        assert!((step[5] + 0.5).abs() < 1e-9, "{step}");
        assert!(step.iter().enumerate().all(|(k, v)| k == 5 || v.abs() < 1e-9), "{step}");
    }
}
