//! Poses from points that lie on planes: the minimal solvers.
//!
//! A sensor measured points, an object consists of planes, and it is known which point lies on which plane. Sought is the
//! pose `x = s R p + t` that satisfies `n . x + d = 0` for every such pair (a [`Row`]). A minimal sample has as many rows as
//! the pose has unknowns; all its real poses with det R = +1 and s > 0 are returned, in a list without heap. An empty list
//! means that there is none, or that the sample is degenerate.
//!
//! All solvers follow one idea:
//!
//! 1. A pair of point and plane is a row, `n . (s R p + t) + d = 0` (`row`).
//! 2. Translation and scale are linear in it. They are eliminated, and equations of the rotation remain (`elimination`).
//! 3. Where the sample tells an axis of the rotation, an equation is a line that meets the unit circle (`turn`). Where it tells less,
//!    the equations are quadratic, and an octic has their solutions (`algebra`).
//! 4. Newton's method makes each solution exact; more rows than unknowns are polished by Gauss and Newton (`general`).
//! 5. Substitution gives scale and translation.
//!
//! `minimal` holds the solvers, one file for each kind of sample; `general` takes any rows and tells why a pose is not determined.
//!
//! Names tell the sample: first what is sought (`se3` rotation and translation, `sim3` a scale besides, `upright_` with
//! known vertical), then the points on each plane where these matter (`321` for (3,2,1); `pair_4pt`: two points on one
//! plane and four anywhere), else their number (`6pt`).
//!
//! | solver | points per plane | poses at most | on average |
//! |---|---|---|---|
//! | [`se3_321`] | (3,2,1) | 4 | 4 |
//! | [`se3_3111`] | (3,1,1,1) | 4 | 2.75 |
//! | [`se3_pair_4pt`] | (2,2,2), (2,2,1,1), (2,1,1,1,1) | 8 | 4.61, 3.47, 3.14 |
//! | [`se3_6pt`] | (1,1,1,1,1,1) and any other | 8 | 3.03 |
//! | [`se3_331`] | (3,3,1) | 4 | 2 |
//! | [`se3_322`], [`se3_332`], [`se3_333`] | (3,2,2), (3,3,2), (3,3,3) | 4 | 1 |
//! | [`sim3_3211`] | (3,2,1,1) | 4 | 2.15 |
//! | [`sim3_31111`] | (3,1,1,1,1) | 4 | 2.06 |
//! | [`sim3_pair_5pt`] | (2,2,2,1), (2,2,1,1,1), (2,1,1,1,1,1) | 8 | 2.60, 2.52, 2.59 |
//! | [`sim3_7pt`] | (1,1,1,1,1,1,1) and any other | 8 | 2.72 |
//! | [`upright_se3_4pt`] | (2,1,1), (1,1,1,1) | 2 | 2 |
//! | [`upright_sim3_5pt`] | (2,1,1,1), (1,1,1,1,1) | 2 | 1.53, 1.57 |
//!
//! [`solve_minimal`] picks by the points per plane; [`Configuration`] tells what each costs. [`solve`] takes rows in any number and
//! distribution, tells why a pose is not determined, and is what `cityweld solve` runs; [`primitives`] turns points,
//! lines and planes on either side into rows. [`refine`] polishes on any number of rows.

// `!(a > b)` is meant: it refuses NaN. Loops over matrix indices read like the formulas that they are.
#![allow(clippy::neg_cmp_op_on_partial_ord, clippy::needless_range_loop)]

mod algebra;
mod elimination;
mod family;
mod linear;
mod minimal;
mod poses;
pub mod primitives;
mod row;
pub mod scene;
mod sought;
mod general;
mod turn;
mod up;

pub use family::{Configuration, RIGID, SIMILARITY, UPRIGHT_RIGID, UPRIGHT_SIMILARITY, solve_minimal};
pub use general::{Degeneracy, NOT_ISOLATED, Solution, WEAK, condition_at, refine, solve};
pub use linear::{LinearFit, linear_least_squares};
pub use minimal::{
    se3_6pt, se3_321, se3_322, se3_331, se3_332, se3_333, se3_3111, se3_pair_4pt, sim3_7pt, sim3_3211, sim3_31111,
    sim3_pair_5pt, upright_se3_4pt, upright_sim3_5pt,
};
pub use poses::{MOST_POSES, Poses};
pub use row::Row;
pub use sought::Sought;
pub use up::Up;
