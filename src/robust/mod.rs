//! Estimation among wrong correspondences: random streams, the sampling loop, losses, order statistics, normal equations.

mod chi_square;
mod gauss_newton;
mod loss;
mod quantile;
mod ransac;

pub use crate::random::Random;
pub use chi_square::chi_square_beyond;
pub use gauss_newton::{Direction, Matrix7, Motion, MotionParameters, NormalEquations, Spectrum, Vector7};
pub use loss::{truncated_quadratic, tukey_weight};
pub use quantile::{median, quantile};
pub use ransac::{Problem, Ranked, RansacOptions, ransac};
