//! Six or seven points on planes in any distribution: three quadrics and their octic.
//!
//! ```text
//! Problem     pose of a sensor from points that lie on planes, however they are distributed
//! Given       se3_6pt: 6 rows; sim3_7pt: 7 rows; no row is special
//! Unknowns    rotation 3, translation 3, and scale s for a similarity: 6 or 7; as many rows
//! Equations   n . (s R(q) p + t) + d = 0 with the unit quaternion q = (w, x, y, z)
//! Method      1. n . R(q) p is a quadratic form in q. With p taken from the centroid and X the centroid's image, a row is
//!                n . X + d + s form(q) = 0.
//!             2. Reflections remove X (and d for a similarity) from the last three rows: three homogeneous quadrics
//!                q^T K_k q = 0 (a rigid problem's offset joins as d |q|^2, since |q| = 1). By Bezout they meet in 8 points, q
//!                and -q being one (three_quadrics.rs).
//!             3. Substitution gives s and X.
//! Solutions   8 at most, 3.03 on average for six planes; similarities: those with s > 0, 2.72 on average for seven planes
//! Degenerate  normals that do not span space, planes through one point (similarity), dependent quadrics: no pose.
//!             A curve of solutions: whatever is returned satisfies the rows but is one of many; general/degeneracy.rs tells
//! Scaling     equivariant in both frames; offsets should be taken about a near origin
//! Source      Kukelova, Heller and Fitzgibbon 2016; mathematics.md sections 3, 6, 7
//! Cost        1.87 us rigid, 2.39 us similarity (benches/solvers, shared 2-core EPYC, 2026-11-25); worst residual of 100,000
//!             1.2e-15 of the scene
//! Tests       tests/solver_accuracy.rs; tests/solver_problems/; golden/*.json
//! ```

use crate::geometry::Vector3;
use crate::solvers::algebra::quaternion::{Quadric, form, monomials, rotation};
use crate::solvers::algebra::three_quadrics::{Charts, three_quadrics};
use crate::solvers::elimination::{Eliminated, Scale};
use crate::solvers::poses::Poses;
use crate::solvers::row::{Row, centroid};

/// Columns of a row: the normal, the offset, then the quadratic form.
type Columns = [f64; 14];

/// Rigid poses from six points on planes.
pub fn se3_6pt(rows: &[Row; 6]) -> Poses {
    from_quadrics(rows, Scale::Given, Charts::AsNeeded)
}

/// Similarities from seven points on planes.
pub fn sim3_7pt(rows: &[Row; 7]) -> Poses {
    from_quadrics(rows, Scale::Sought, Charts::AsNeeded)
}

/// The same with all charts asked: for rows on which another solver has found that solutions share a root.
#[cold]
#[inline(never)]
pub fn in_all_charts<const M: usize>(rows: &[Row; M], scale: Scale) -> Poses {
    from_quadrics(rows, scale, Charts::All)
}

#[inline(always)]
fn from_quadrics<const M: usize>(rows: &[Row; M], scale: Scale, charts: Charts) -> Poses {
    let mut poses = Poses::none();
    let pivot = centroid(rows);
    let columns = rows.map(|row| columns(&row, &pivot));
    let Some(eliminated) = Eliminated::<3, M, 14>::new(columns, scale) else { return poses };
    for q in three_quadrics(&eliminated.equations().map(quadric), charts).iter() {
        let mono = monomials(q);
        let along = |row: &Columns| (0..10).map(|j| row[4 + j] * mono[j]).sum::<f64>();
        if let Some((scale, image)) = eliminated.scale_and_translation(along) {
            poses.push_about(&pivot, &image.into(), scale, rotation(q));
        }
    }
    poses
}

#[inline]
fn columns(row: &Row, pivot: &Vector3<f64>) -> Columns {
    let n = row.normal;
    let f = form(&n, &(row.point - pivot));
    [n.x, n.y, n.z, row.offset, f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8], f[9]]
}

/// What is left of a rigid problem's offset d is the form d |q|^2.
#[inline]
fn quadric(row: &Columns) -> Quadric {
    std::array::from_fn(|j| if j < 4 { row[4 + j] + row[3] } else { row[4 + j] })
}
