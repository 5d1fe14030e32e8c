//! Linear unknowns out: Householder's triangular form of a few rows, in place, without heap.
//!
//! Every solver of this room writes its rows as `(linear unknowns | functions of the rotation)` and multiplies them
//! by an orthogonal matrix from the left until the first `K` columns are upper triangular. The rows below the `K`-th
//! are then free of the linear unknowns and are the equations of the rotation; the first `K` rows give the linear
//! unknowns back by substitution once the rotation is known. An orthogonal matrix keeps rounding errors small
//! whatever the planes, where the inverse of three chosen normals would not (mathematics.md 3.4, 12).

use super::RANK_TOLERANCE;

/// Multiplies `rows` from the left by reflections until their first `K` columns are upper triangular.
#[inline]
pub(super) fn eliminate<const M: usize, const C: usize, const K: usize>(rows: &mut [[f64; C]; M]) {
    for k in 0..K {
        let mut v = [0.0; M];
        let mut square = 0.0;
        for i in k..M {
            v[i] = rows[i][k];
            square += v[i] * v[i];
        }
        if square == 0.0 {
            continue;
        }
        let norm = square.sqrt();
        // The sign that adds, never subtracts, in v[k]: no cancellation.
        let diagonal = if v[k] > 0.0 { -norm } else { norm };
        let weight = (square - diagonal * v[k]).recip();
        v[k] -= diagonal;
        // v is zero above k: loops of fixed length cost some products with zero and gain vector instructions.
        let mut along = [0.0; C];
        for i in 0..M {
            for j in 0..C {
                along[j] += v[i] * rows[i][j];
            }
        }
        for i in 0..M {
            let step = weight * v[i];
            for j in 0..C {
                rows[i][j] -= step * along[j];
            }
        }
        rows[k][k] = diagonal;
        for row in &mut rows[k + 1..M] {
            row[k] = 0.0;
        }
    }
}

/// Whether the first three columns, triangular normals, span space.
#[inline]
pub(super) fn diagonal_holds<const M: usize, const C: usize>(m: &[[f64; C]; M]) -> bool {
    (0..3).all(|k| m[k][k].abs() > RANK_TOLERANCE)
}

/// Solves the triangular first three rows for the image of the pivot.
#[inline]
pub(super) fn back_substitute<const M: usize, const C: usize>(m: &[[f64; C]; M], right: [f64; 3]) -> [f64; 3] {
    let z = right[2] / m[2][2];
    let y = (right[1] - m[1][2] * z) / m[1][1];
    let x = (right[0] - m[0][1] * y - m[0][2] * z) / m[0][0];
    [x, y, z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangular_rows_keep_the_solutions_of_the_rows() {
        let x = [0.3, -1.2, 2.5];
        let mut rows = [[1.0, 2.0, -0.5, 0.0], [0.0, 1.5, 4.0, 0.0], [-3.0, 0.2, 0.7, 0.0], [0.4, 0.1, 0.9, 0.0]];
        for row in &mut rows {
            row[3] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2];
        }
        eliminate::<4, 4, 3>(&mut rows);
        assert!(rows[3].iter().all(|v| v.abs() < 1e-15), "{rows:?}");
        for (k, row) in rows[..3].iter().enumerate() {
            assert!(row[..k].iter().all(|&v| v == 0.0));
            assert!((row[0] * x[0] + row[1] * x[1] + row[2] * x[2] - row[3]).abs() < 1e-14);
        }
    }

    #[test]
    fn a_column_of_zeros_is_passed_over() {
        let mut rows = [[0.0, 1.0], [0.0, 2.0]];
        eliminate::<2, 2, 1>(&mut rows);
        assert_eq!(rows, [[0.0, 1.0], [0.0, 2.0]]);
    }
}
