//! Known vertical: four points on planes for a rigid pose, five for a similarity.
//!
//! ```text
//! Problem     pose of a sensor whose vertical is known, from points that lie on planes
//! Given       upright_se3_4pt: 4 rows (2,1,1) or (1,1,1,1); upright_sim3_5pt: 5 rows (2,1,1,1) or (1,1,1,1,1)
//! Unknowns    heading theta, translation 3, and scale s for a similarity: 4 or 5; as many rows
//! Equations   n . (s R p + t) + d = 0, R = Rot(up_object, theta) R0 with R0 up_sensor = up_object
//! Method      1. axes with the vertical as third in either frame: y = coordinates of p - p_1, v = coordinates of n;
//!                there R is a turn about the third axis (turn.rs)
//!             2. with T the image of p_1, each row is  v . T + d + s (a cos + b sin + g) = 0, linear in T and d
//!             3. Reflections remove T (and d for a similarity) from the last row: a line and the circle. Substitution gives s, T.
//! Solutions   2 or 0; of a similarity those with s > 0 (the others are mirror images): 1.53 of 2 on random scenes
//! Degenerate  fewer than three directions of normals, normals in one plane (walls alone), a = b = 0 (heading free),
//!             similarity: planes through one point (scale free). Dependent normals, or r = 0: no pose is returned
//! Scaling     differences to p_1; the solver is equivariant, offsets should be taken about a near origin
//! Source      mathematics.md section 8; derived here
//! Cost        0.13 us, similarity 0.18 us (benches/solvers, shared 2-core EPYC, 2026-11-25)
//! Tests       tests/solver_accuracy.rs; golden/gravity.json
//! ```

use crate::geometry::Vector3;
use crate::solvers::elimination::{Eliminated, Scale};
use crate::solvers::poses::Poses;
use crate::solvers::row::Row;
use crate::solvers::turn::{Sense, Turn, line};
use crate::solvers::up::Up;

/// Columns of a row: the normal, the offset, then the line.
type Columns = [f64; 7];

/// Rigid poses from four points on planes, vertical known.
pub fn upright_se3_4pt(rows: &[Row; 4], up: &Up) -> Poses {
    upright(rows, up, Scale::Given)
}

/// Similarities from five points on planes, vertical known.
pub fn upright_sim3_5pt(rows: &[Row; 5], up: &Up) -> Poses {
    upright(rows, up, Scale::Sought)
}

#[inline(always)]
fn upright<const M: usize>(rows: &[Row; M], up: &Up, scale: Scale) -> Poses {
    let mut poses = Poses::none();
    let pivot = rows[0].point;
    let columns = rows.map(|row| columns(&row, up, &pivot));
    let Some(eliminated) = Eliminated::<3, M, 7>::new(columns, scale) else { return poses };
    let [&[_, _, _, d, a, b, g]] = eliminated.equations();
    for turn in Turn::on([a, b, g + d], Sense::Along, spread_sq(rows)) {
        let along = |row: &Columns| turn.cos * row[4] + turn.sin * row[5] + row[6];
        if let Some((scale, [x, y, z])) = eliminated.scale_and_translation(along) {
            let image = up.axis().object.vector(x, y, z);
            poses.push_about(&pivot, &image, scale, up.axis().rotation(&turn));
        }
    }
    poses
}

#[inline]
fn columns(row: &Row, up: &Up, pivot: &Vector3<f64>) -> Columns {
    let axis = up.axis();
    let v = axis.object.coordinates(&row.normal);
    let parts = axis.parts(&v, &axis.sensor.coordinates(&(row.point - pivot)));
    let [a, b, g] = line(&parts, 0.0, Sense::Along);
    [v[0], v[1], v[2], row.offset, a, b, g]
}

/// Sum of squared distances to the first point: the size that a and b have in general.
#[inline]
fn spread_sq(rows: &[Row]) -> f64 {
    rows[1..].iter().map(|row| (row.point - rows[0].point).norm_squared()).sum()
}
