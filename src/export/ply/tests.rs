use super::*;
use crate::geometry::{Point3, Vector3};
use crate::reconstruction::read_reconstruction;

fn cloud(normals: bool, colors: bool) -> Reconstruction {
    let count = 50;
    let at = |k: usize, step: f64| (k as f64 * step).sin();
    Reconstruction {
        points: (0..count).map(|k| Point3::new(1e6 * at(k, 0.3), at(k, 0.7), 1e-9 * at(k, 1.1))).collect(),
        normals: (0..if normals { count } else { 0 })
            .map(|k| Vector3::new(at(k, 0.2), 0.5, at(k, 0.9)).normalize())
            .collect(),
        colors: (0..if colors { count } else { 0 }).map(|k| [k as u8, 2 * k as u8, 255 - k as u8]).collect(),
        ..Reconstruction::default()
    }
}

#[test]
fn a_cloud_that_was_written_is_read_again_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.ply");
    for (normals, colors) in [(false, false), (true, false), (false, true), (true, true)] {
        let given = cloud(normals, colors);
        write_ply(&path, &given).unwrap();
        let read = read_reconstruction(&path).unwrap();
        assert_eq!((&read.points, &read.colors), (&given.points, &given.colors));
        assert_eq!(read.normals.len(), given.normals.len());
        assert!(read.normals.iter().zip(&given.normals).all(|(a, b)| (a - b).norm() < 1e-15));
    }
}

#[test]
fn a_point_at_infinity_is_refused_by_its_number_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.ply");
    let mut given = cloud(false, false);
    given.points[7].y = f64::INFINITY;
    let error = write_ply(&path, &given).unwrap_err().to_string();
    assert!(error.contains("point 7 at infinity"), "{error}");
    assert!(!path.exists());
}
