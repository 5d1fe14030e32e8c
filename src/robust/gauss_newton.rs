//! Normal equations of point-to-plane rows in the freedoms of a rigid motion or a similarity, and steps only along what
//! they hold.
//!
//! Row          r = n . x + d for the image x of a point; the motion x -> x + rho (omega x y + tau + sigma y) with y = (x - c) / rho
//!              changes it by rho J, J = (y x n, n, n . y); c the scene's centre and rho its radius, so that all seven
//!              unknowns are lengths in metres (mathematics.md 10.1, equation 14). A rigid motion has the first six.
//! Method       information H = sum w J J^T, gradient g = sum w J r; the step is -H^+ g over the eigenvectors of H whose
//!              sigma = 1 / sqrt(lambda) is below a limit: a direction that the data do not hold is not moved

use nalgebra::{SMatrix, SVector, SymmetricEigen};

use crate::geometry::{Point3, Rotation3, Similarity, Vector3, distance_derivative};

pub type Matrix7 = SMatrix<f64, 7, 7>;
pub type Vector7 = SVector<f64, 7>;

/// How a pose may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Rotation and translation; the scale is given.
    Rigid,
    /// Rotation, translation and scale.
    Similarity,
}

/// The unknowns of a motion about a scene: its centre and radius, which make all of them lengths, and which of them there are.
#[derive(Clone, Copy, Debug)]
pub struct MotionParameters {
    pub center: Point3<f64>,
    /// Metres.
    pub radius: f64,
    pub motion: Motion,
}

/// Sums over rows.
#[derive(Clone, Copy, Debug)]
pub struct NormalEquations {
    pub information: Matrix7,
    pub gradient: Vector7,
}

/// One of the independent ways in which a pose may move.
#[derive(Clone, Copy, Debug)]
pub struct Direction {
    /// Unit vector over (rotation, translation, log scale), each times the radius.
    pub unit: Vector7,
    /// Standard deviation along it, metres at the radius; infinite where nothing holds it.
    pub sigma_m: f64,
}

/// The directions that the data suggest, the loosest first: six of a rigid motion, seven of a similarity.
#[derive(Clone, Copy, Debug)]
pub struct Spectrum {
    directions: [Direction; 7],
    count: usize,
}

impl Motion {
    /// How many numbers a motion has.
    pub fn unknowns(self) -> usize {
        match self {
            Motion::Rigid => 6,
            Motion::Similarity => 7,
        }
    }
}

impl MotionParameters {
    /// The unknowns of a similarity.
    pub fn of_similarity(center: Point3<f64>, radius: f64) -> MotionParameters {
        MotionParameters { center, radius, motion: Motion::Similarity }
    }

    /// Derivative of the distance of a point `x` from a plane with normal `n`, per metre of each unknown.
    #[inline]
    pub fn row(&self, x: &Point3<f64>, n: &Vector3<f64>) -> Vector7 {
        let y = (x - self.center) / self.radius;
        Vector7::from(distance_derivative(&y, n))
    }

    /// `pose` followed by the motion with these unknowns (metres). A rigid motion leaves the scale as it is, to the bit.
    pub fn moved(&self, pose: &Similarity, unknowns: &Vector7) -> Similarity {
        let u = unknowns / self.radius;
        let rotation = Rotation3::new(Vector3::new(u[0], u[1], u[2]));
        let scale = match self.motion {
            Motion::Rigid => 1.0,
            // Steps are small; the bound keeps a wild one from turning the scale over.
            Motion::Similarity => u[6].clamp(-0.5, 0.5).exp(),
        };
        let shift = Vector3::new(unknowns[3], unknowns[4], unknowns[5]);
        Similarity::about(&self.center, &(self.center + shift), scale, rotation) * *pose
    }

    /// The unknowns of the motion that leads from one pose to another, to first order in the turn; metres.
    pub fn between(&self, from: &Similarity, to: &Similarity) -> Vector7 {
        let to_from = *to * from.inverse();
        let turn = to_from.rotation.scaled_axis() * self.radius;
        let shift = to_from.apply(&self.center) - self.center;
        let log_scale = to_from.scale.ln() * self.radius;
        Vector7::from_column_slice(&[turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, log_scale])
    }

    /// The directions of this information, 1 / m^2, as far as the motion has them.
    pub fn spectrum(&self, information: &Matrix7) -> Spectrum {
        match self.motion {
            Motion::Rigid => {
                let eigen = SymmetricEigen::new(information.fixed_view::<6, 6>(0, 0).into_owned());
                Spectrum::new(eigen.eigenvalues.as_slice(), eigen.eigenvectors.as_slice())
            }
            Motion::Similarity => {
                let eigen = SymmetricEigen::new(*information);
                Spectrum::new(eigen.eigenvalues.as_slice(), eigen.eigenvectors.as_slice())
            }
        }
    }

    /// The Gauss-Newton step along the directions whose sigma is below `limit_m`.
    pub fn step(&self, equations: &NormalEquations, limit_m: f64) -> Vector7 {
        let spectrum = self.spectrum(&equations.full());
        let held = spectrum.directions().iter().filter(|d| d.sigma_m < limit_m);
        held.map(|d| d.unit * (-d.unit.dot(&equations.gradient) * d.sigma_m * d.sigma_m)).sum()
    }
}

impl Spectrum {
    /// `vectors` one behind the other, as long as there are values.
    fn new(values: &[f64], vectors: &[f64]) -> Spectrum {
        let nothing = Direction { unit: Vector7::zeros(), sigma_m: f64::INFINITY };
        let mut spectrum = Spectrum { directions: [nothing; 7], count: values.len() };
        for ((direction, &value), vector) in
            spectrum.directions.iter_mut().zip(values).zip(vectors.chunks(values.len()))
        {
            direction.unit.as_mut_slice()[..vector.len()].copy_from_slice(vector);
            direction.sigma_m = if value > 0.0 { value.sqrt().recip() } else { f64::INFINITY };
        }
        spectrum.directions[..values.len()].sort_by(|a, b| b.sigma_m.total_cmp(&a.sigma_m));
        spectrum
    }

    /// The loosest first.
    pub fn directions(&self) -> &[Direction] {
        &self.directions[..self.count]
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
        // Only the lower triangle; `full` mirrors it.
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
}

#[cfg(test)]
mod tests;
