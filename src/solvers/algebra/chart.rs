//! A view of three quadrics in which they can be solved for Y^2, Z^2 and YZ.
//!
//! Which two of the four coordinates are Y and Z is free; where no choice is good (axis-aligned boxes), q is first turned by a fixed
//! orthogonal matrix. Half-turns (w = 0) are not special.

use crate::geometry::Vector3;

use super::dual::dual_basis;
use super::quaternion::{MONOMIALS, PLACE, Quadric, Quaternion, product, value};
use super::resultant::Resultant;

/// Which coordinates are Y, Z, X, W, and what the coordinates are: q itself, or q = left q' right.
#[derive(Clone, Copy)]
pub struct Chart {
    turning: Option<usize>,
    order: [usize; 4],
    /// Of the coefficients of Y^2, Z^2 and YZ: the larger, the better.
    pub determinant: f64,
    quadrics: [Quadric; 3],
}

/// Below this determinant (of three orthonormal quadrics) a chart says nothing.
const NO_CHART: f64 = 1e-9;

/// Every two of the coordinates as Y and Z, the other two as X and W.
const ORDERS: [[usize; 4]; 6] = [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];

/// Two fixed turnings q = left q' right, unit quaternions without any relation to axes or to each other: square roots in
/// the proportions (1, 2, 3, 5), (7, 1, 2, 3) and (3, 11, 1, 6), (2, 5, 13, 1), signs mixed.
const TURNINGS: [[Quaternion; 2]; 2] = [
    [
        [0.301511344577764, 0.426401432711221, -0.522232967867094, 0.674199862463242],
        [0.733799385705343, -0.277350098112615, 0.392232270276368, 0.480384461415261],
    ],
    [
        [-0.377964473009227, 0.723746864455746, 0.218217890235992, 0.534522483824849],
        [0.308606699924184, 0.487950036474267, -0.786795792469443, 0.218217890235992],
    ],
];

impl Chart {
    /// The choice of Y and Z with the largest determinant.
    pub fn best(quadrics: &[Quadric; 3], turning: Option<usize>) -> Chart {
        let quadrics = match turning {
            None => *quadrics,
            Some(t) => quadrics.map(|quadric| turned(&quadric, &TURNINGS[t])),
        };
        let mut best = Chart { turning, order: ORDERS[0], determinant: 0.0, quadrics };
        for order in ORDERS {
            let columns = [PLACE[order[0]][order[0]], PLACE[order[1]][order[1]], PLACE[order[0]][order[1]]];
            let [a, b, c] = columns.map(|j| Vector3::new(quadrics[0][j], quadrics[1][j], quadrics[2][j]));
            let determinant = a.cross(&b).dot(&c);
            if determinant.abs() > best.determinant.abs() {
                best = Chart { order, determinant, ..best };
            }
        }
        best
    }

    /// Whether the chart's octic is more than rounding noise.
    pub fn tells(&self) -> bool {
        self.determinant.abs() > NO_CHART
    }

    /// The equations in Y, Z, 1 whose determinant is the octic.
    #[inline]
    pub fn resultant(&self) -> Resultant {
        Resultant::new(&self.solved())
    }

    /// The quaternion at a root of the octic.
    pub fn quaternion_at(&self, resultant: &Resultant, root: &[f64; 2]) -> Quaternion {
        let mut q = [0.0; 4];
        for (place, v) in self.order.iter().zip(resultant.null_vector(root)) {
            q[*place] = v;
        }
        match self.turning {
            Some(t) => product(&product(&TURNINGS[t][0], &q), &TURNINGS[t][1]),
            None => q,
        }
    }

    /// The coefficients of Y^2, Z^2 and YZ (rows a, b, c) as functions of the others: Y X, Y W, Z X, Z W, W^2, X W, X^2.
    fn solved(&self) -> [[f64; 7]; 3] {
        let [y, z, x, w] = self.order;
        let column = |i: usize, j: usize| {
            let place = PLACE[i][j];
            Vector3::new(self.quadrics[0][place], self.quadrics[1][place], self.quadrics[2][place])
        };
        let inverse = dual_basis(&[column(y, y), column(z, z), column(y, z)], -self.determinant);
        let right = [column(y, x), column(y, w), column(z, x), column(z, w), column(w, w), column(x, w), column(x, x)];
        inverse.map(|row| right.map(|r| row.dot(&r)))
    }
}

/// The quadric in q' where q = left q' right.
fn turned(quadric: &Quadric, turning: &[Quaternion; 2]) -> Quadric {
    // Columns of the orthogonal matrix: images of the four units.
    let units: [Quaternion; 4] = std::array::from_fn(|i| {
        let mut unit = [0.0; 4];
        unit[i] = 1.0;
        product(&product(&turning[0], &unit), &turning[1])
    });
    let mut out = [0.0; 10];
    for (place, (i, j)) in MONOMIALS.iter().enumerate() {
        // u_i^T K u_j = (f(u_i + u_j) - f(u_i) - f(u_j)) / 2, twice for a mixed monomial.
        out[place] = if i == j {
            value(quadric, &units[*i])
        } else {
            let sum = std::array::from_fn(|k| units[*i][k] + units[*j][k]);
            value(quadric, &sum) - value(quadric, &units[*i]) - value(quadric, &units[*j])
        };
    }
    out
}
