//! Which of the seven freedoms the data fix, and how firmly.
//!
//! Input        the information that each plane of the city contributes at the pose (one plane is one vote of limited weight), and
//!              that of the start
//! Method       eigenvectors of the summed information are the freedoms; a freedom is determined when the data alone hold it to within
//!              a limit. Its sigma includes the start, so that it is finite
//! Source       mathematics of the normalised Jacobian: Gelfand et al. (3DIM 2003) for the slippable motions of a surface

use nalgebra::SymmetricEigen;

use super::{Freedom, words};
use crate::geometry::Vector3;
use crate::robust::{Chart, Matrix7, Vector7};

/// What holds a pose.
#[derive(Clone, Debug)]
pub struct Hold {
    pub chart: Chart,
    /// Information of each plane with points on it, 1 / m^2 in the chart's unknowns.
    pub by_plane: Vec<Matrix7>,
    /// Information of the start.
    pub start: Matrix7,
    /// True where the scale is given: then it is no freedom.
    pub scale_is_fixed: bool,
}

/// A freedom in numbers.
#[derive(Clone, Debug)]
pub struct Direction {
    /// Over (rotation, translation, log scale), each times the radius.
    pub unit: Vector7,
    /// With the start, metres at the radius.
    pub sigma_m: f64,
    pub determined: bool,
}

/// A freedom that the data hold worse than this is not determined, metres at the scene's radius: a shift of a window's width is what a
/// user would see.
const DETERMINED_M: f64 = 0.35;

impl Hold {
    /// The freedoms, the loosest first.
    pub fn directions(&self) -> Vec<Direction> {
        let data: Matrix7 = self.by_plane.iter().sum();
        let eigen = SymmetricEigen::new(data);
        let mut order: Vec<usize> = (0..7).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let direction = |k: usize| {
            let unit: Vector7 = eigen.eigenvectors.column(k).into_owned();
            let along = |m: &Matrix7| unit.dot(&(m * unit)).max(0.0);
            let sum: f64 = self.by_plane.iter().map(along).sum();
            let determined = sum * DETERMINED_M * DETERMINED_M >= 1.0;
            Direction { unit, sigma_m: (sum + along(&self.start)).sqrt().recip(), determined }
        };
        let given = |d: &Direction| self.scale_is_fixed && d.unit[6].abs() > 0.9;
        order.into_iter().map(direction).filter(|d| !given(d)).collect()
    }

    /// Covariance over (rotation vector about the centre, rad; translation of the centre, m; log scale).
    pub fn covariance(&self) -> [[f64; 7]; 7] {
        let mut information: Matrix7 = self.by_plane.iter().sum::<Matrix7>() + self.start;
        if self.scale_is_fixed {
            information[(6, 6)] += FIXED_INFORMATION;
        }
        let r = self.chart.radius;
        let unit = Vector7::from_column_slice(&[1.0 / r, 1.0 / r, 1.0 / r, 1.0, 1.0, 1.0, 1.0 / r]);
        let covariance = information.try_inverse().unwrap_or_else(Matrix7::zeros);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| unit[i] * (covariance[(i, j)] + covariance[(j, i)]) / 2.0 * unit[j])
        })
    }
}

/// Stands for certainty, 1 / m^2.
const FIXED_INFORMATION: f64 = 1e12;

/// The freedoms in words, the loosest first.
pub fn freedoms(hold: &Hold) -> Vec<Freedom> {
    let r = hold.chart.radius;
    let in_words = |d: Direction| {
        let part = |first: usize| Vector3::new(d.unit[first], d.unit[first + 1], d.unit[first + 2]);
        let (turn, shift, scale) = (part(0), part(3), d.unit[6]);
        let largest = turn.norm().max(shift.norm()).max(scale.abs());
        let (name, direction, sigma, unit) = if scale.abs() == largest {
            ("scale".to_owned(), Vector3::zeros(), d.sigma_m / r, "1")
        } else if shift.norm() == largest {
            (words::shift(&shift), upward(&shift), d.sigma_m, "m")
        } else {
            (words::turn(&turn), upward(&turn), (d.sigma_m / r).to_degrees(), "deg")
        };
        Freedom { name, direction, sigma, unit, determined: d.determined }
    };
    hold.directions().into_iter().map(in_words).collect()
}

/// The unit vector along `v` that points up, or east where level.
fn upward(v: &Vector3<f64>) -> Vector3<f64> {
    let unit = v.normalize();
    let sense = if unit.z.abs() > 1e-3 { unit.z } else { unit.x };
    if sense < 0.0 { -unit } else { unit }
}
