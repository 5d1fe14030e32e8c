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
//!             3. rigid: four normals have one linear relation, its weights the volumes of the other three; summed with
//!                them the rows lose T: a line and the circle. The three normals that span most give T
//!             4. similarity: three normals that span an ample volume take T off the other two rows; crosswise these lose d
//!                and give the line, along d they give s, the three rows T
//!             Volumes in place of the reflections of elimination.rs: these take twice the time for so few rows
//! Solutions   2 or 0; of a similarity those with s > 0 (the others are mirror images): 1.53 of 2 on random scenes
//! Degenerate  fewer than three directions of normals, normals in one plane (walls alone), a = b = 0 (heading free),
//!             similarity: planes through one point (scale free). A vanishing volume, or r = 0: no pose is returned
//! Scaling     differences to p_1; the solver is equivariant, offsets should be taken about a near origin
//! Source      mathematics.md section 8; derived here
//! Cost        0.13 us, similarity 0.18 us (benches/solvers, shared 2-core EPYC, 2026-11-25)
//! Tests       tests/solver_accuracy.rs; golden/gravity.json
//! ```

use crate::geometry::Vector3;
use crate::solvers::algebra::dual::{dual_basis, volume};
use crate::solvers::algebra::tolerance::RANK_TOLERANCE;
use crate::solvers::poses::Poses;
use crate::solvers::row::Row;
use crate::solvers::turn::{Line, Sense, Turn, line};
use crate::solvers::up::Up;

/// Volume that three unit normals must span to be a basis without a look at the others.
const AMPLE_VOLUME: f64 = 0.05;

/// Rigid poses from four points on planes, vertical known.
pub fn upright_se3_4pt(rows: &[Row; 4], up: &Up) -> Poses {
    let pivot = rows[0].point;
    let mut v = [Vector3::zeros(); 4];
    let mut m = [Vector3::zeros(); 4];
    for (i, row) in rows.iter().enumerate() {
        let (normal, [a, b, g]) = coefficients(row, up, &pivot);
        (v[i], m[i]) = (normal, Vector3::new(a, b, g + row.offset));
    }
    let z = relation(&v);
    let size_sq: f64 = z.iter().map(|z| z * z).sum();
    let mut poses = Poses::none();
    if !(size_sq > RANK_TOLERANCE * RANK_TOLERANCE) {
        return poses;
    }
    let equation = m[0] * z[0] + m[1] * z[1] + m[2] * z[2] + m[3] * z[3];
    let basis = OTHERS[largest(&z)];
    let [i, j, k] = basis;
    let normals = [v[i], v[j], v[k]];
    let dual = dual_basis(&normals, volume(&normals));
    for turn in Turn::on(equation.into(), Sense::Along, spread_sq(rows) * size_sq) {
        let at = Vector3::new(turn.cos, turn.sin, 1.0);
        let [x, y, z] = [-m[i].dot(&at), -m[j].dot(&at), -m[k].dot(&at)];
        push(&mut poses, up, &pivot, &turn, 1.0, dual[0] * x + dual[1] * y + dual[2] * z);
    }
    poses
}

/// Similarities from five points on planes, vertical known.
pub fn upright_sim3_5pt(rows: &[Row; 5], up: &Up) -> Poses {
    let pivot = rows[0].point;
    let mut v = [Vector3::zeros(); 5];
    let mut m = [[0.0; 4]; 5];
    for (i, row) in rows.iter().enumerate() {
        let (normal, [a, b, g]) = coefficients(row, up, &pivot);
        (v[i], m[i]) = (normal, [row.offset, a, b, g]);
    }
    let mut poses = Poses::none();
    let Some((basis, rest)) = basis_of(&v) else { return poses };
    let [i, j, k] = basis;
    let normals = basis.map(|i| v[i]);
    let dual = dual_basis(&normals, volume(&normals));
    // A further normal is n = sum (n . dual) basis normal: that much of the basis rows taken off, its row loses T.
    let [first, second] = rest.map(|r| -> [f64; 4] {
        let share = dual.map(|column| column.dot(&v[r]));
        std::array::from_fn(|c| m[r][c] - share[0] * m[i][c] - share[1] * m[j][c] - share[2] * m[k][c])
    });
    // Two rows d + s (a cos + b sin + g) = 0 are left. Crosswise they lose d; along (d, d') they give s.
    let [_, a, b, g]: [f64; 4] = std::array::from_fn(|c| second[0] * first[c] - first[0] * second[c]);
    let scale_row: [f64; 4] = std::array::from_fn(|c| first[0] * first[c] + second[0] * second[c]);
    for turn in Turn::on([a, b, g], Sense::Along, spread_sq(rows) * scale_row[0]) {
        let along = |row: &[f64; 4]| row[1] * turn.cos + row[2] * turn.sin + row[3];
        let scale = -scale_row[0] / along(&scale_row);
        if scale > 0.0 {
            let [x, y, z] = basis.map(|r| -(m[r][0] + scale * along(&m[r])));
            push(&mut poses, up, &pivot, &turn, scale, dual[0] * x + dual[1] * y + dual[2] * z);
        }
    }
    poses
}

/// Coordinates of the normal in the object's axes, and the line of `n . R (p - pivot)`.
#[inline]
fn coefficients(row: &Row, up: &Up, pivot: &Vector3<f64>) -> (Vector3<f64>, Line) {
    let axis = up.axis();
    let v = axis.object.coordinates(&row.normal);
    let parts = axis.parts(&v, &axis.sensor.coordinates(&(row.point - pivot)));
    (v.into(), line(&parts, Sense::Along))
}

/// Adds the pose that sends the pivot to `image`, given in the object's axes.
#[inline]
fn push(poses: &mut Poses, up: &Up, pivot: &Vector3<f64>, turn: &Turn, scale: f64, image: Vector3<f64>) {
    let image = up.axis().object.vector(image.x, image.y, image.z);
    poses.push_about(pivot, &image, scale, up.axis().rotation(turn));
}

/// The three of four rows without one.
const OTHERS: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

/// The weights z of the linear relation among four vectors, each the volume of the other three:
/// a (b . c x d) - b (a . c x d) + c (d . a x b) - d (c . a x b) = 0.
#[inline]
fn relation([a, b, c, d]: &[Vector3<f64>; 4]) -> [f64; 4] {
    let (first, last) = (a.cross(b), c.cross(d));
    [b.dot(&last), -a.dot(&last), d.dot(&first), -c.dot(&first)]
}

/// The vector without which the others span most.
#[inline]
fn largest(z: &[f64; 4]) -> usize {
    (1..4).fold(0, |k, i| if z[i].abs() > z[k].abs() { i } else { k })
}

/// Three of five normals that span a volume, the largest one where no ample one is found at once, and the other two.
#[inline]
fn basis_of(v: &[Vector3<f64>; 5]) -> Option<([usize; 3], [usize; 2])> {
    let z = relation(&[v[0], v[1], v[2], v[3]]);
    let dropped = largest(&z);
    if z[dropped].abs() > AMPLE_VOLUME {
        return Some((OTHERS[dropped], [dropped, 4]));
    }
    let mut best = (RANK_TOLERANCE, None);
    for first in 0..5 {
        for second in 0..first {
            let mut basis = (0..5).filter(|&i| i != first && i != second);
            let basis: [usize; 3] = std::array::from_fn(|_| basis.next().unwrap_or_default());
            let volume = v[basis[0]].cross(&v[basis[1]]).dot(&v[basis[2]]).abs();
            if volume > best.0 {
                best = (volume, Some((basis, [second, first])));
            }
        }
    }
    best.1
}

/// Sum of squared distances to the first point: the size that a and b have in general.
#[inline]
fn spread_sq(rows: &[Row]) -> f64 {
    rows[1..].iter().map(|row| (row.point - rows[0].point).norm_squared()).sum()
}
