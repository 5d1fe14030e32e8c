//! The minimal solvers, one file for each kind of sample; each opens with its card.
//!
//! | file | sample | rotation equation |
//! |---|---|---|
//! | `three_two` | (3,2,1), (3,2,1,1) | line and circle |
//! | `three_one` | (3,1,1,1), (3,1,1,1,1) | line and circle |
//! | `three_two_two` | (3,2,2) | two lines and the circle |
//! | `three_three` | (3,3,1), (3,3,2), (3,3,3) | the two normals give it |
//! | `pair` | (2, ..) | two angles: octic |
//! | `any` | any | three quadrics: octic |
//! | `upright` | known vertical | line and circle |
//!
//! `triple` is what three points on one plane have in common, `undecided` tells which of several candidates are returned.

mod any;
mod pair;
mod three_one;
mod three_three;
mod three_two;
mod three_two_two;
mod triple;
mod undecided;
mod upright;

pub use any::{se3_6pt, sim3_7pt};
pub use pair::{se3_pair_4pt, sim3_pair_5pt};
pub use three_one::{se3_3111, sim3_31111};
pub use three_three::{se3_331, se3_332, se3_333};
pub use three_two::{se3_321, sim3_3211};
pub use three_two_two::se3_322;
pub use upright::{upright_se3_4pt, upright_sim3_5pt};
