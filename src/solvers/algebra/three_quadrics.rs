//! The real common points of three quadrics q^T K_k q = 0 in a unit quaternion q, q and -q being one.
//!
//! ```text
//! Method      1. The quadrics are made orthonormal, so that sizes mean something.
//!             2. Call two of the coordinates Y, Z and the others X : W. Solve the three equations for Y^2, Z^2, YZ:
//!                    Y^2 = a1 Y + a2 Z + a3,   Z^2 = b1 Y + b2 Z + b3,   YZ = c1 Y + c2 Z + c3
//!                with coefficients of degree 1, 1, 2 in X : W (chart.rs).
//!             3. What follows of them is an octic in X : W, and Y, Z at a root of it (resultant.rs).
//!             4. The pair (Y, Z) is the one of six whose equations of step 2 have the largest determinant; where all six are
//!                small (axis-aligned boxes), q is first turned by a fixed orthogonal matrix.
//!             5. Newton on the sphere polishes every q. A root that leads nowhere, or an odd number of solutions, shows
//!                that two share a value of X : W; then the other charts are asked too and the answers joined (common_points.rs).
//! Solutions   8 at most
//! Degenerate  dependent quadrics: no point. A curve of solutions: the octic is rounding noise, whatever it returns satisfies the
//!             equations but is one of many
//! Source      Kukelova, Heller and Fitzgibbon 2016; homogeneous form, choice of charts and polish: mathematics.md sections 3, 6
//! ```

use crate::geometry::Vector3;

use super::chart::Chart;
use super::common_points::{CommonPoints, Point, System};
use super::quaternion::{Quadric, Quaternion, value};
use super::resultant::Resultant;
use super::tolerance::RANK_TOLERANCE;

/// How many charts are asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Charts {
    /// One where that is enough; the others where it shows that a solution is missing.
    AsNeeded,
    /// All three turnings: dearer, for single problems and for samples that are known to be special.
    All,
}

/// Charts whose determinant (of three orthonormal quadrics) is larger than this are not compared with turned ones.
const GOOD_CHART: f64 = 0.03;

/// The real common points, as unit quaternions.
#[inline]
pub fn three_quadrics(quadrics: &[Quadric; 3], charts: Charts) -> CommonPoints {
    match orthonormal(quadrics) {
        None => CommonPoints::none(),
        Some(quadrics) if charts == Charts::All => in_all_charts(&quadrics),
        Some(quadrics) => in_charts_as_needed(&quadrics),
    }
}

fn in_charts_as_needed(quadrics: &[Quadric; 3]) -> CommonPoints {
    let mut found = CommonPoints::none();
    let straight = Chart::best(quadrics, None);
    if straight.determinant.abs() > GOOD_CHART {
        add_points(&mut found, quadrics, &straight);
        if found.is_complete() {
            return found;
        }
    }
    add_best_charts(&mut found, quadrics, straight);
    found
}

/// Adds what the straight chart and the turned ones see, the best first, until no solution is missing.
#[cold]
#[inline(never)]
fn add_best_charts(found: &mut CommonPoints, quadrics: &[Quadric; 3], straight: Chart) {
    let mut charts = [straight, Chart::best(quadrics, Some(0)), Chart::best(quadrics, Some(1))];
    charts.sort_by(|a, b| b.determinant.abs().total_cmp(&a.determinant.abs()));
    for chart in &charts {
        add_points(found, quadrics, chart);
        if found.is_complete() {
            break;
        }
    }
}

fn in_all_charts(quadrics: &[Quadric; 3]) -> CommonPoints {
    let mut found = CommonPoints::none();
    for turning in [None, Some(0), Some(1)] {
        add_points(&mut found, quadrics, &Chart::best(quadrics, turning));
    }
    found
}

/// Adds what a chart sees.
fn add_points(found: &mut CommonPoints, quadrics: &[Quadric; 3], chart: &Chart) {
    if !chart.tells() {
        found.doubt();
        return;
    }
    let resultant = chart.resultant();
    found.add(&InChart { quadrics, chart, resultant: &resultant }, &resultant.octic());
}

/// Three quadrics, seen in a chart.
struct InChart<'a> {
    /// Orthonormal; in q itself, whatever the chart's coordinates.
    quadrics: &'a [Quadric; 3],
    chart: &'a Chart,
    resultant: &'a Resultant,
}

impl System for InChart<'_> {
    #[inline]
    fn at_root(&self, root: &[f64; 2]) -> Option<Point> {
        unit(self.chart.quaternion_at(self.resultant, root))
    }

    /// q moves by q e with e = (0, omega): along the three tangents of the sphere.
    #[inline]
    fn correction(&self, q: &Point) -> Vector3<f64> {
        let tangents = tangents(q);
        let mut right = [0.0; 3];
        let mut jacobian = [Vector3::zeros(); 3];
        for k in 0..3 {
            let half = half_gradient(&self.quadrics[k], q);
            let along = |t: &Quaternion| half[0] * t[0] + half[1] * t[1] + half[2] * t[2] + half[3] * t[3];
            right[k] = -0.5 * along(q);
            jacobian[k] = Vector3::new(along(&tangents[0]), along(&tangents[1]), along(&tangents[2]));
        }
        let [j0, j1, j2] = jacobian;
        let c12 = j1.cross(&j2);
        (c12 * right[0] + j2.cross(&j0) * right[1] + j0.cross(&j1) * right[2]) / j0.dot(&c12)
    }

    #[inline]
    fn corrected(&self, q: &Point, omega: &Vector3<f64>) -> Option<Point> {
        let tangents = tangents(q);
        unit(std::array::from_fn(|i| {
            q[i] + omega.x * tangents[0][i] + omega.y * tangents[1][i] + omega.z * tangents[2][i]
        }))
    }

    #[inline]
    fn misfit(&self, q: &Point) -> f64 {
        self.quadrics.iter().map(|quadric| value(quadric, q).abs()).sum()
    }

    /// Up to sign.
    #[inline]
    fn distance_sq(a: &Point, b: &Point) -> f64 {
        let sign = (0..4).map(|i| a[i] * b[i]).sum::<f64>().signum();
        (0..4).map(|i| (a[i] - sign * b[i]) * (a[i] - sign * b[i])).sum()
    }

    /// A second solution at the same X : W shows in the number of solutions, which is then odd.
    #[inline]
    fn is_near(_: &Point, _: &Point) -> bool {
        true
    }
}

#[inline]
fn tangents([w, x, y, z]: &Quaternion) -> [Quaternion; 3] {
    [[-x, *w, *z, -y], [-y, -z, *w, *x], [-z, *y, -x, *w]]
}

/// K q.
#[inline]
fn half_gradient([a, b, c, d, ab, ac, ad, bc, bd, cd]: &Quadric, [w, x, y, z]: &Quaternion) -> Quaternion {
    [
        a * w + 0.5 * (ab * x + ac * y + ad * z),
        b * x + 0.5 * (ab * w + bc * y + bd * z),
        c * y + 0.5 * (ac * w + bc * x + cd * z),
        d * z + 0.5 * (ad * w + bd * x + cd * y),
    ]
}

#[inline]
fn unit(q: Quaternion) -> Option<Quaternion> {
    let square: f64 = q.iter().map(|v| v * v).sum();
    (square > 0.0 && square.is_finite()).then(|| {
        let inverse = square.sqrt().recip();
        q.map(|v| v * inverse)
    })
}

/// Gram and Schmidt on the symmetric matrices; `None` where the quadrics are dependent.
fn orthonormal(quadrics: &[Quadric; 3]) -> Option<[Quadric; 3]> {
    let mut out = *quadrics;
    for k in 0..3 {
        let size = dot(&out[k], &out[k]).sqrt();
        if !(size > 0.0) {
            return None;
        }
        out[k] = out[k].map(|v| v / size);
        for j in 0..k {
            let overlap = dot(&out[k], &out[j]);
            for i in 0..10 {
                out[k][i] -= overlap * out[j][i];
            }
        }
        let rest = dot(&out[k], &out[k]).sqrt();
        if !(rest > RANK_TOLERANCE) {
            return None;
        }
        out[k] = out[k].map(|v| v / rest);
    }
    Some(out)
}

/// Frobenius product of the matrices: the coefficient of a mixed monomial stands for two entries of half its size.
#[inline]
fn dot(a: &Quadric, b: &Quadric) -> f64 {
    let squares: f64 = (0..4).map(|j| a[j] * b[j]).sum();
    squares + 0.5 * (4..10).map(|j| a[j] * b[j]).sum::<f64>()
}

#[cfg(test)]
mod tests;
