//! Three points on each of two planes: the two normals give the rotation.
//!
//! ```text
//! Problem     rigid pose of a sensor from points that lie on planes, three on the first and three on the second plane
//! Given       se3_331: 7 rows (3,3,1); se3_332: 8 rows (3,3,2); se3_333: 9 rows (3,3,3); grouped by plane in this order
//! Unknowns    rotation 3, translation 3; 7 to 9 rows, of which one to three say nothing new about noiseless points
//! Equations   n . (R p + t) + d = 0
//! Method      1. The triples span planes of the sensor with unit normals m1, m2: R m1 = sigma1 n1, R m2 = sigma2 n2.
//!             2. The product pi = sigma1 sigma2 follows from m1 . m2 = pi n1 . n2, except at right angles. For each sign
//!                R lays the orthogonal directions m1 + m2, m1 - m2 onto sigma1 (n1 + pi n2), sigma1 (n1 - pi n2): exact for
//!                noiseless points, and dividing the error of the angle evenly for noisy ones.
//!             3. Of the (up to four) rotations those are kept that the further points tell from none better: misfit is
//!                the error of the angle, with (3,3,2) also n3 . R e for the pair's direction e, with (3,3,3) the sine between
//!                n3 and R m3. All that noise cannot tell from the best (undecided.rs) are returned.
//!             4. The three groups' centroids give t.
//! Solutions   (3,3,1): 2; (3,3,2), (3,3,3): 1; with planes at right angles the twins of mathematics.md 4.5: 2 or 4
//! Degenerate  collinear triples, parallel planes, normals in one plane: no pose is returned
//! Scaling     differences to centroids; all tests are relative
//! Source      Ramalingam et al. 2010, section 3.2; mathematics.md 4.4, 4.5
//! Cost        0.15 to 0.18 us (benches/solvers, shared 2-core EPYC, 2026-11-25); worst residual of 100,000 1.4e-11 of the scene
//! Tests       tests/solver_accuracy.rs; golden/rigid.json
//! ```

use crate::geometry::{Matrix3, Vector3};
use crate::solvers::algebra::dual::{dual_basis, volume};
use crate::solvers::algebra::tolerance::RANK_TOLERANCE;
use crate::solvers::minimal::undecided::undecided;
use crate::solvers::poses::Poses;
use crate::solvers::row::{Row, centroid};

/// Rotations by either sign of either normal, with what speaks against each.
struct Candidates {
    entries: [(Matrix3<f64>, f64); 4],
    len: usize,
}

impl Candidates {
    fn none() -> Candidates {
        Candidates { entries: [(Matrix3::zeros(), f64::INFINITY); 4], len: 0 }
    }

    fn push(&mut self, rotation: Matrix3<f64>, misfit: f64) {
        if self.len < self.entries.len() {
            self.entries[self.len] = (rotation, misfit);
            self.len += 1;
        }
    }

    /// Those that nothing tells from the best.
    fn undecided(&self) -> impl Iterator<Item = &Matrix3<f64>> {
        let entries = &self.entries[..self.len];
        let best = entries.iter().map(|entry| entry.1).fold(f64::INFINITY, f64::min);
        entries.iter().filter(move |entry| undecided(entry.1, best)).map(|entry| &entry.0)
    }
}

/// Rigid poses from rows (3,3,1).
pub fn se3_331(rows: &[Row; 7]) -> Poses {
    two_triples(rows, |_| 0.0)
}

/// Rigid poses from rows (3,3,2).
pub fn se3_332(rows: &[Row; 8]) -> Poses {
    let e = rows[7].point - rows[6].point;
    let e = e / e.norm();
    two_triples(rows, |rotation| rows[6].normal.dot(&(rotation * e)).abs())
}

/// Rigid poses from rows (3,3,3).
pub fn se3_333(rows: &[Row; 9]) -> Poses {
    match normal_of(&rows[6..9]) {
        Some(m) => two_triples(rows, |rotation| rows[6].normal.cross(&(rotation * m)).norm()),
        None => Poses::none(),
    }
}

fn two_triples(rows: &[Row], misfit: impl Fn(&Matrix3<f64>) -> f64) -> Poses {
    let mut poses = Poses::none();
    let (Some(m1), Some(m2)) = (normal_of(&rows[..3]), normal_of(&rows[3..6])) else { return poses };
    let (n1, n2) = (rows[0].normal, rows[3].normal);
    let (sensor_cos, object_cos) = (m1.dot(&m2), n1.dot(&n2));
    let mut candidates = Candidates::none();
    if let Some(sensor) = bisectors(&m1, &m2) {
        for pi in [1.0, -1.0] {
            let error = (sensor_cos - pi * object_cos).abs();
            // An angle that the other sign explains much better need not be looked at further.
            if !undecided(error, (sensor_cos + pi * object_cos).abs()) {
                continue;
            }
            let Some([plus, minus, both]) = bisectors(&n1, &(n2 * pi)) else { continue };
            let third = both * sensor[2].transpose();
            let turned = plus * sensor[0].transpose() + minus * sensor[1].transpose();
            for rotation in [third + turned, third - turned] {
                candidates.push(rotation, error + misfit(&rotation));
            }
        }
    }
    for rotation in candidates.undecided() {
        push_on_planes(&mut poses, rotation, &[&rows[..3], &rows[3..6], &rows[6..]]);
    }
    poses
}

/// Unit normal of the plane through three points; `None` where they are collinear.
#[inline]
fn normal_of(rows: &[Row]) -> Option<Vector3<f64>> {
    let (a, b) = (rows[1].point - rows[0].point, rows[2].point - rows[0].point);
    let m = a.cross(&b);
    let area_sq = m.norm_squared();
    let tolerance_sq = RANK_TOLERANCE * RANK_TOLERANCE * a.norm_squared() * b.norm_squared();
    (area_sq > tolerance_sq).then(|| m / area_sq.sqrt())
}

/// Unit vectors along a + b, a - b and their cross product; `None` where a and b are parallel.
#[inline]
fn bisectors(a: &Vector3<f64>, b: &Vector3<f64>) -> Option<[Vector3<f64>; 3]> {
    let (plus, minus) = (a + b, a - b);
    let (p, m) = (plus.norm(), minus.norm());
    if !(p > RANK_TOLERANCE && m > RANK_TOLERANCE) {
        return None;
    }
    let (plus, minus) = (plus / p, minus / m);
    Some([plus, minus, plus.cross(&minus)])
}

/// Adds the pose whose translation puts the centroid of each group onto its plane.
#[inline]
fn push_on_planes(poses: &mut Poses, rotation: &Matrix3<f64>, groups: &[&[Row]; 3]) {
    let normals = groups.map(|group| group[0].normal);
    let volume = volume(&normals);
    // Also false for NaN.
    if !(volume.abs() > RANK_TOLERANCE) {
        return;
    }
    let dual = dual_basis(&normals, volume);
    let pivot = centroid(groups[0]);
    let [a, b, c] = groups.map(|group| -group[0].offset - group[0].normal.dot(&(rotation * (centroid(group) - pivot))));
    poses.push_about(&pivot, &(dual[0] * a + dual[1] * b + dual[2] * c), 1.0, *rotation);
}
