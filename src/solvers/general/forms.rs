//! Rows as linear forms, and very many of them as few.
//!
//! ```text
//! Question    which few equations say of every pose as much as a million rows do
//! Method      A row is linear in (s R, t, 1): n . s R p + n . t + d = <n p^T, s R> + n . t + d, thirteen coefficients. Householder's
//!             triangular form of all rows has at most thirteen, and for every pose the same sum of squares.
//! Cost        linear in the number of rows; what comes after it does not depend on that number
//! Source      Golub and Van Loan, Matrix Computations, 5.2
//! ```

use crate::geometry::{Matrix3, Vector3};
use crate::solvers::elimination::triangular;
use crate::solvers::row::Row;

/// Nine of s R, three of t, and the constant.
const COEFFICIENTS: usize = 13;

/// Rows that are brought to triangular form at once: few enough to stay in the processor's nearest memory, and several times
/// those that are kept, which pass through again.
const ROWS_AT_ONCE: usize = 64;

/// `<turning, s R> + normal . t + offset`
#[derive(Clone, Copy, Debug)]
pub struct Form {
    pub turning: Matrix3<f64>,
    pub normal: Vector3<f64>,
    pub offset: f64,
}

impl Form {
    pub fn of(row: &Row) -> Form {
        Form { turning: row.normal * row.point.transpose(), normal: row.normal, offset: row.offset }
    }

    fn coefficients(&self) -> [f64; COEFFICIENTS] {
        let (b, n) = (self.turning.as_slice(), self.normal);
        [b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8], n.x, n.y, n.z, self.offset]
    }

    fn from_coefficients(c: &[f64; COEFFICIENTS]) -> Form {
        let turning = Matrix3::from_column_slice(&c[..9]);
        Form { turning, normal: Vector3::new(c[9], c[10], c[11]), offset: c[12] }
    }
}

/// The rows as forms; more than thirteen become thirteen.
pub fn forms_of(rows: &[Row]) -> Vec<Form> {
    if rows.len() <= COEFFICIENTS {
        return rows.iter().map(Form::of).collect();
    }
    let reduced = reduced(rows.iter().map(|row| Form::of(row).coefficients()));
    reduced.iter().map(Form::from_coefficients).collect()
}

/// At most C rows, with the same sum of squares for every vector that all rows are multiplied by.
pub fn reduced<const C: usize>(rows: impl Iterator<Item = [f64; C]>) -> Vec<[f64; C]> {
    let mut kept = Vec::with_capacity(ROWS_AT_ONCE);
    for row in rows {
        if kept.len() == ROWS_AT_ONCE {
            triangular(&mut kept, C);
            kept.truncate(C);
        }
        kept.push(row);
    }
    if kept.len() > C {
        triangular(&mut kept, C);
        kept.truncate(C);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Rotation3;

    #[test]
    fn thirteen_forms_have_the_sum_of_squares_of_all_rows() {
        let value = |i: usize, k: usize| ((7 * i + 3 * k + i * k) as f64).sin();
        let vector = |i: usize, k: usize| Vector3::new(value(i, k), value(i, k + 1), value(i, k + 2));
        let rows: Vec<Row> = (0..1000)
            .map(|i| Row { point: vector(i, 0), normal: vector(i, 3).normalize(), offset: value(i, 6) })
            .collect();
        let forms = forms_of(&rows);
        assert_eq!(forms.len(), 13);
        for angle in [0.0, 0.4, 2.0] {
            let turned = Rotation3::from_euler_angles(angle, -0.3, 1.0 - angle).into_inner() * 1.7;
            let t = Vector3::new(0.3, angle, -2.0);
            let of_rows: f64 = rows.iter().map(|r| (r.normal.dot(&(turned * r.point + t)) + r.offset).powi(2)).sum();
            let of_forms: f64 =
                forms.iter().map(|f| (f.turning.dot(&turned) + f.normal.dot(&t) + f.offset).powi(2)).sum();
            assert!((of_forms / of_rows - 1.0).abs() < 1e-13, "{of_forms} {of_rows}");
        }
    }

    #[test]
    fn few_rows_are_forms_to_the_bit() {
        let row = Row { point: Vector3::new(1.0, 0.1, 3.0), normal: Vector3::new(0.6, 0.0, 0.8), offset: 0.3 };
        let forms = forms_of(&[row; 13]);
        assert_eq!(forms.len(), 13);
        assert_eq!(forms[12].turning[(2, 1)], 0.8 * 0.1);
    }
}
