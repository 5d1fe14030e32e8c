//! Estimation among wrong correspondences: random streams, the sampling loop, losses, normal equations.

mod gauss_newton;
mod loss;
mod random;
mod ransac;

pub use gauss_newton::{Chart, Direction, Matrix7, Motion, NormalEquations, Spectrum, Vector7};
pub use loss::{tukey_weight, vote};
pub use random::Random;
pub use ransac::{Problem, Ranked, RansacOptions, ransac};
