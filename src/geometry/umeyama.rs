//! The similarity of point couples in closed form.
//!
//! Problem      the similarity a_from_b with the least sum of squared distances | T b_i - a_i |
//! Given        three couples or more
//! Method       rotation from the singular value decomposition of the couples' cross covariance, with the sign that keeps it a rotation;
//!              scale from its trace; translation from the means
//! Degenerate   couples on a line or in a point: `None`
//! Source       Umeyama 1991, equations 40 to 42

use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

use super::Similarity;

/// Ratio of the second spread to the first below which points lie on a line: rounding.
const ON_A_LINE: f64 = 1e-9;

/// Least-squares similarity of point couples; `None` where they do not fix it.
pub fn umeyama(couples: &[(Point3<f64>, Point3<f64>)]) -> Option<Similarity> {
    let count = couples.len() as f64;
    let mean_a = couples.iter().map(|(a, _)| a.coords).sum::<Vector3<f64>>() / count;
    let mean_b = couples.iter().map(|(_, b)| b.coords).sum::<Vector3<f64>>() / count;
    let mut cross = Matrix3::zeros();
    let mut spread = 0.0;
    for (a, b) in couples {
        cross += (a.coords - mean_a) * (b.coords - mean_b).transpose();
        spread += (b.coords - mean_b).norm_squared();
    }
    let svd = cross.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| svd.singular_values[j].total_cmp(&svd.singular_values[i]));
    // Two spread directions are needed; the third follows.
    let [largest, second] = [svd.singular_values[order[0]], svd.singular_values[order[1]]];
    if largest <= 0.0 || second <= ON_A_LINE * largest || spread <= 0.0 {
        return None;
    }
    let mut sign = Vector3::repeat(1.0);
    sign[order[2]] = (u.determinant() * v_t.determinant()).signum();
    let rotation = Rotation3::from_matrix_unchecked(u * Matrix3::from_diagonal(&sign) * v_t);
    let scale = svd.singular_values.dot(&sign) / spread;
    (scale > 0.0 && scale.is_finite())
        .then(|| Similarity::about(&Point3::from(mean_b), &Point3::from(mean_a), scale, rotation))
}

#[cfg(test)]
mod tests;
