//! Three points on one plane, the others on planes of their own: (3,1,1,1), and (3,1,1,1,1) for a similarity.
//!
//! ```text
//! Problem     pose of a sensor from points that lie on planes, three of them on the first plane
//! Given       se3_3111: 6 rows (3,1,1,1); sim3_31111: 7 rows (3,1,1,1,1); grouped by plane in this order
//! Unknowns    rotation 3, translation 3, and scale s for a similarity: 6 or 7; as many rows
//! Equations   n . (s R p + t) + d = 0
//! Method      1. The triple leaves one angle for each sense of its normal (triple.rs).
//!             2. Reflections remove u, w (and the offset for a similarity) from the last further row: a line and the circle.
//!             3. Substitution gives s, u, w.
//! Solutions   4 at most. (3,1,1,1): 0, 2 or 4, 2.745 on average; similarities: those with s > 0, 2.06 on average
//! Degenerate  collinear triple, normals that do not span space: no pose is returned
//! Scaling     differences to p_1; every test is relative to lengths in the data
//! Source      Ramalingam et al. 2010, section 3.1, in axes of our own; mathematics.md 4.1, 4.3 and 7
//! Cost        se3_3111 0.25 us, sim3_31111 0.29 us (benches/solvers, shared 2-core EPYC, 2026-11-25); residual 1e-15 of the
//!             scene as a rule, 1.3e-12 the worst of 100,000
//! Tests       tests/solver_accuracy.rs; golden/rigid.json, similarity.json
//! ```

use crate::solvers::elimination::{Eliminated, Scale};
use crate::solvers::minimal::triple::{Columns, Triple};
use crate::solvers::poses::Poses;
use crate::solvers::row::Row;

/// Rigid poses from rows (3,1,1,1).
pub fn se3_3111(rows: &[Row; 6]) -> Poses {
    three_and_singles::<3>(rows, Scale::Given)
}

/// Similarities from rows (3,1,1,1,1).
pub fn sim3_31111(rows: &[Row; 7]) -> Poses {
    three_and_singles::<4>(rows, Scale::Sought)
}

#[inline(always)]
fn three_and_singles<const M: usize>(rows: &[Row], scale: Scale) -> Poses {
    let Some(triple) = Triple::new(rows) else { return Poses::none() };
    let further: [Columns; M] = std::array::from_fn(|i| triple.columns(&rows[3 + i]));
    // Reflections do not change the size that the coefficients have in general.
    let size_sq = further.iter().flat_map(|row| &row[3..]).map(|v| v * v).sum();
    let Some(eliminated) = Eliminated::new(further, scale) else { return Poses::none() };
    let [equation] = eliminated.equations();
    triple.poses(&eliminated, equation, size_sq)
}
