//! The equations that are left of a problem once translation and scale are gone, and their real solutions.
//!
//! Nothing here knows of rows, planes or poses.
//!
//! | file | what it solves |
//! |---|---|
//! | `circle` | one line and the unit circle: one angle |
//! | `two_circles` | two bilinear equations in two angles, by an octic |
//! | `three_quadrics` | three quadrics in a quaternion, by an octic (`chart`, `resultant`) |
//! | `common_points` | what both octics share: roots, Newton's method, which points are new, whether one is missing |
//! | `octic`, `bernstein` | all real roots of a polynomial of degree eight |
//! | `quaternion` | rotations as quadratic forms |
//! | `dual` | three vectors' dual basis: the inverse of a 3 x 3 matrix |
//! | `macaulay` | whether three quadrics share a curve |
//! | `singular` | singular values and least squares of small matrices |

mod bernstein;
mod chart;
pub mod circle;
pub mod common_points;
pub mod dual;
pub mod macaulay;
mod octic;
pub mod quaternion;
mod resultant;
pub mod singular;
pub mod three_quadrics;
pub mod tolerance;
pub mod two_circles;
