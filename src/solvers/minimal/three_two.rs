//! Three points on one plane and two on another: (3,2,1), and (3,2,1,1) for a similarity.
//!
//! ```text
//! Problem     pose of a sensor from points that lie on planes, three on the first and two on the second plane
//! Given       se3_321: 6 rows (3,2,1); sim3_3211: 7 rows (3,2,1,1); grouped by plane in this order
//! Unknowns    rotation 3, translation 3, and scale s for a similarity: 6 or 7; as many rows
//! Equations   n . (s R p + t) + d = 0
//! Method      1. The triple leaves one angle for each sense of its normal (triple.rs).
//!             2. The difference of the pair's two rows holds neither translation nor offset: a line and the circle.
//!             3. One row of each further plane, with the axes laid along the pair's plane, gives u, w, and s.
//! Solutions   4 at most. (3,2,1): 4 whenever a pose exists; similarities: those with s > 0, 2.15 on average
//! Degenerate  collinear triple, normals that do not span space, the pair along m: no pose is returned
//! Scaling     differences to p_1; every test is relative to lengths in the data
//! Source      Ramalingam et al. 2010, section 3.1, in axes of our own; mathematics.md 4.1, 4.2 and 7
//! Cost        se3_321 0.23 us, sim3_3211 0.24 us (benches/solvers, shared 2-core EPYC, 2026-11-25); residual 1e-15 of the
//!             scene as a rule, 1.3e-12 the worst of 100,000
//! Tests       tests/solver_accuracy.rs; golden/rigid.json, similarity.json
//! ```

use crate::solvers::elimination::{Eliminated, Scale};
use crate::solvers::minimal::triple::Triple;
use crate::solvers::poses::Poses;
use crate::solvers::row::Row;

/// Rigid poses from rows (3,2,1).
pub fn se3_321(rows: &[Row; 6]) -> Poses {
    let Some(triple) = Triple::towards(rows, &rows[3].normal) else { return Poses::none() };
    // The axes were laid along plane 2's own direction, so its row has no w: the two rows are triangular as they are.
    let further = [triple.columns(&rows[5]), triple.columns(&rows[3])];
    let Some(eliminated) = Eliminated::triangular(further, Scale::Given) else { return Poses::none() };
    triple.poses(&eliminated, &triple.difference(&rows[3], &rows[4]), length_sq(&rows[3], &rows[4]))
}

/// Similarities from rows (3,2,1,1).
pub fn sim3_3211(rows: &[Row; 7]) -> Poses {
    let Some(triple) = Triple::towards(rows, &rows[3].normal) else { return Poses::none() };
    let further = [&rows[5], &rows[6], &rows[3]].map(|row| triple.columns(row));
    let Some(eliminated) = Eliminated::new(further, Scale::Sought) else { return Poses::none() };
    triple.poses(&eliminated, &triple.difference(&rows[3], &rows[4]), length_sq(&rows[3], &rows[4]))
}

#[inline]
fn length_sq(from: &Row, to: &Row) -> f64 {
    (to.point - from.point).norm_squared()
}
