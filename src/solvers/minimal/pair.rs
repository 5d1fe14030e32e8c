//! Two points on one plane: two angles and one octic, for rigid poses and similarities.
//!
//! ```text
//! Problem     pose of a sensor from points that lie on planes, two of them on the first plane
//! Given       se3_pair_4pt: 6 rows, the first two on one plane: (2,2,2) (2,2,1,1) (2,1,1,1,1);
//!             sim3_pair_5pt: 7 rows, the first two on one plane: (2,2,2,1) (2,2,1,1,1) (2,1,1,1,1,1)
//! Unknowns    rotation 3, translation 3, and scale s for a similarity: 6 or 7; as many rows
//! Equations   n . (s R p + t) + d = 0
//! Method      1. Axes (a, b, e) in the sensor, e along the pair; axes (c, f, n1) in the object, n1 the pair's plane. The
//!                pair's two rows say that n1 . X = -d1 for X the image of p_1, and n1 . R e = 0. Every such rotation is
//!                R = Rot_z(alpha) P Rot_z(beta), P the cyclic exchange of axes that lays e onto c: in these axes
//!                    [ -sin alpha cos beta   sin alpha sin beta   cos alpha ]
//!                R = [  cos alpha cos beta  -cos alpha sin beta   sin alpha ]
//!                    [  sin beta             cos beta             0         ]
//!             2. With X = (u, w, -d1) each further row is linear in u, w, delta = d - n1.n d1, and bilinear in
//!                (cos alpha, sin alpha, 1) and (cos beta, sin beta, 1). Reflections remove u, w (and delta for a similarity):
//!                two bilinear equations remain (two_circles.rs).
//!             3. Substitution gives s, u, w.
//! Solutions   8 at most, 3 to 5 on average; similarities: those with s > 0, 2.5 to 2.6 on average
//! Degenerate  where the octic is blind (axis-aligned boxes) or solutions are missing the three quadrics (any.rs) take over, in
//!             all their charts. Normals that do not span space, coinciding points: no pose is returned
//! Scaling     differences to p_1; all tests are relative
//! Source      mathematics.md section 5; derived here
//! Cost        1.20 to 1.68 us (benches/solvers, shared 2-core EPYC, 2026-11-25); worst residual of 100,000 1.5e-15 of the scene
//! Tests       tests/solver_accuracy.rs; tests/solver_problems/; golden/rigid.json, similarity.json, hard.json
//! ```

use crate::geometry::{Axes, Matrix3, Vector3};
use crate::solvers::algebra::common_points::Point;
use crate::solvers::algebra::two_circles::{Bilinear, bilinear, two_circles};
use crate::solvers::elimination::{Eliminated, Scale};
use crate::solvers::minimal::any::in_all_charts;
use crate::solvers::poses::Poses;
use crate::solvers::row::Row;

/// Columns of a row: u, w, delta, then the bilinear form.
type Columns = [f64; 12];

/// Rigid poses from six rows, the first two on one plane.
pub fn se3_pair_4pt(rows: &[Row; 6]) -> Poses {
    from_two_angles::<4>(rows, Scale::Given).unwrap_or_else(|| in_all_charts(rows, Scale::Given))
}

/// Similarities from seven rows, the first two on one plane.
pub fn sim3_pair_5pt(rows: &[Row; 7]) -> Poses {
    from_two_angles::<5>(rows, Scale::Sought).unwrap_or_else(|| in_all_charts(rows, Scale::Sought))
}

/// `None` where the octic is blind.
#[inline(always)]
fn from_two_angles<const M: usize>(rows: &[Row], scale: Scale) -> Option<Poses> {
    let mut poses = Poses::none();
    let Some(pair) = Pair::new(rows) else { return Some(poses) };
    let further: [Columns; M] = std::array::from_fn(|i| pair.columns(&rows[2 + i]));
    let Some(eliminated) = Eliminated::<2, M, 12>::new(further, scale) else { return Some(poses) };
    let [first, second] = eliminated.equations().map(form);
    for angles in two_circles(&first, &second)?.iter() {
        if let Some((scale, [u, w])) = eliminated.scale_and_translation(|row| bilinear(&tail(row), angles)) {
            let image = pair.object.vector(u, w, -pair.height);
            poses.push_about(&pair.pivot, &image, scale, pair.rotation(angles));
        }
    }
    Some(poses)
}

#[inline]
fn tail(row: &Columns) -> Bilinear {
    std::array::from_fn(|j| row[3 + j])
}

/// What is left of a rigid problem's offset is a constant of the form.
#[inline]
fn form(row: &Columns) -> Bilinear {
    let mut form = tail(row);
    form[8] += row[2];
    form
}

/// The plane with two points: axes in either frame.
struct Pair {
    sensor: Axes,
    object: Axes,
    pivot: Vector3<f64>,
    /// Offset of the first plane.
    height: f64,
}

impl Pair {
    #[inline]
    fn new(rows: &[Row]) -> Option<Pair> {
        let pivot = rows[0].point;
        let difference = rows[1].point - pivot;
        let length = difference.norm();
        // Also false for NaN.
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let sensor = Axes::about(&(difference / length));
        Some(Pair { sensor, object: Axes::about(&rows[0].normal), pivot, height: rows[0].offset })
    }

    #[inline]
    fn columns(&self, row: &Row) -> Columns {
        let [px, py, pz] = self.sensor.coordinates(&(row.point - self.pivot));
        let [nx, ny, nz] = self.object.coordinates(&row.normal);
        let delta = row.offset - nz * self.height;
        [nx, ny, delta, ny * px, -ny * py, nx * pz, -nx * px, nx * py, ny * pz, nz * py, nz * px, 0.0]
    }

    #[inline]
    fn rotation(&self, [ca, sa, cb, sb]: &Point) -> Matrix3<f64> {
        self.object.vector(-sa * cb, ca * cb, *sb) * self.sensor.x.transpose()
            + self.object.vector(sa * sb, -ca * sb, *cb) * self.sensor.y.transpose()
            + self.object.vector(*ca, *sa, 0.0) * self.sensor.z.transpose()
    }
}
