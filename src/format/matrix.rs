//! A similarity as a matrix of 4 x 4 in text, row by row: what CloudCompare, PDAL, MeshLab and Open3D write.
//!
//! x_city = s R x + t stands in the first three rows as [s R | t]; the last is 0 0 0 1. Blanks, commas, semicolons or brackets separate.

use std::path::Path;

use super::placement::PlacementError;
use crate::geometry::{Matrix3, Similarity, Vector3};

/// Lengths of rows and their angles may stray from those of a similarity by this share: few digits are written.
const TOLERANCE: f64 = 1e-4;

/// Whether a text begins like numbers rather than JSON of an object. JSON's own nested lists are taken for a matrix, too.
pub(super) fn looks_like_matrix(text: &str) -> bool {
    let words = numbers(text);
    let is_number = |word: &&str| word.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    words.len() > 1 && words.first().is_some_and(is_number)
}

pub(super) fn parse_matrix(text: &str, path: &Path) -> Result<Similarity, PlacementError> {
    let fault = |found: String| PlacementError::Matrix { path: path.into(), found };
    let words = numbers(text);
    let mut m = [0f64; 16];
    if words.len() != m.len() {
        return Err(fault(format!("{} numbers", words.len())));
    }
    for (number, word) in m.iter_mut().zip(&words) {
        *number = word.parse().map_err(|_| fault(format!("{word} is no number")))?;
    }
    if !m.iter().all(|v| v.is_finite()) {
        return Err(fault("a number is not finite".into()));
    }
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        let transposed = m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0 && m[15] == 1.0;
        let remedy = if transposed { " (it seems to be written column by column; transpose it)" } else { "" };
        return Err(fault(format!("its last row is {} {} {} {}{remedy}", m[12], m[13], m[14], m[15])));
    }
    let linear = Matrix3::new(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]);
    let translation = Vector3::new(m[3], m[7], m[11]);
    let (scale, rotation) = similar(&linear).map_err(fault)?;
    Similarity::try_new(scale, rotation, translation).map_err(|source| PlacementError::NotASimilarity {
        what: "matrix",
        path: path.into(),
        source,
    })
}

/// The scale and the rotation of s R.
fn similar(linear: &Matrix3<f64>) -> Result<(f64, Matrix3<f64>), String> {
    let lengths = [0, 1, 2].map(|k| linear.column(k).norm());
    let determinant = linear.determinant();
    let scale = determinant.abs().cbrt();
    if !(scale > 0.0 && scale.is_finite()) {
        return Err("it flattens space (its determinant is 0)".into());
    }
    if determinant < 0.0 {
        return Err("it mirrors (its determinant is negative); a reconstruction is turned, never mirrored".into());
    }
    let [x, y, z] = lengths;
    if lengths.iter().any(|length| (length / scale - 1.0).abs() > TOLERANCE) {
        return Err(format!("it scales unevenly ({x} along x, {y} along y, {z} along z), expected one scale"));
    }
    let turn = linear / scale;
    let stray = (turn.transpose() * turn - Matrix3::identity()).amax();
    if stray > TOLERANCE {
        return Err(format!("it shears: its columns are not square to each other (by {stray:.2e})"));
    }
    // Few digits are made exact, as the last step of a chain of roundings.
    Ok((scale, crate::geometry::orthonormalised(&turn).into_inner()))
}

fn numbers(text: &str) -> Vec<&str> {
    let uncommented = text.lines().flat_map(|line| line.split('#').next());
    uncommented.flat_map(|line| line.split(is_separator)).filter(|word| !word.is_empty()).collect()
}

fn is_separator(c: char) -> bool {
    c.is_whitespace() || ",;[]()".contains(c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;

    fn parse(text: &str) -> Result<Similarity, String> {
        parse_matrix(text, Path::new("m.txt")).map_err(|error| error.to_string())
    }

    const TURNED: &str = "0 -2 0 10\n2 0 0 20\n0 0 2 30\n0 0 0 1\n";

    #[test]
    fn a_matrix_maps_as_it_says_row_by_row() {
        let pose = parse(TURNED).unwrap();
        assert_eq!(pose.scale, 2.0);
        assert!((pose.apply(&Point3::new(1.0, 0.0, 0.0)) - Point3::new(10.0, 22.0, 30.0)).norm() < 1e-12);
        for other in
            ["[[0,-2,0,10],[2,0,0,20],[0,0,2,30],[0,0,0,1]]", "# CloudCompare\n0,-2,0,10;2,0,0,20;0,0,2,30;0,0,0,1"]
        {
            assert!(looks_like_matrix(other) && parse(other) == Ok(pose), "{other}");
        }
    }

    #[test]
    fn few_digits_are_made_a_rotation() {
        let pose = parse("0.866025 -0.5 0 0 0.5 0.866025 0 0 0 0 1 0 0 0 0 1").unwrap();
        let r = pose.rotation.matrix();
        assert!((r * r.transpose() - Matrix3::identity()).amax() < 1e-14);
    }

    #[test]
    fn what_is_no_similarity_is_named() {
        for (text, says) in [
            ("1 0 0 0 0 1 0 0 0 0 2 0 0 0 0 1", "scales unevenly (1 along x, 1 along y, 2 along z)"),
            ("1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1", "mirrors"),
            ("1 0.5 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "unevenly"),
            ("0 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "flattens"),
            ("1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1", "transpose it"),
            ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2", "last row"),
            ("1 0 0 0 0 1 0 0 0 0 1 0", "12 numbers"),
            ("1 0 0 x 0 1 0 0 0 0 1 0 0 0 0 1", "x is no number"),
            ("1 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1", "not finite"),
        ] {
            let message = parse(text).unwrap_err();
            assert!(message.contains(says) && message.contains("m.txt"), "{text}: {message}");
        }
    }

    #[test]
    fn json_objects_and_words_are_no_matrices() {
        for text in ["{\"scale\": 1}", "", "5", "[]", "p001.jpg 1 2 3", "name"] {
            assert!(!looks_like_matrix(text), "{text}");
        }
    }

    #[test]
    fn a_matrix_cut_anywhere_is_an_error_or_a_matrix() {
        for cut in 0..TURNED.len() {
            let _ = parse(&TURNED[..cut]);
        }
    }
}
