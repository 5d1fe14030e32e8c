//! The moved COLMAP model, opened again by pycolmap.
//!
//! Needs python3 with pycolmap; the environment variable CITYWELD_PYTHONPATH may name the folder that holds it. Skipped
//! where it is missing and the variable is not set.

use std::path::Path;
use std::process::Command;

use cityweld::export::colmap::write_colmap;
use cityweld::format::read_start;
use cityweld::reconstruction::read_reconstruction;

/// Prints counts, the mean track length, the mean reprojection error over all observations, and one camera's centre.
const SCRIPT: &str = "
import sys, numpy, pycolmap
model = pycolmap.Reconstruction(sys.argv[1])
errors = []
for image in model.images.values():
    for point2D in image.points2D:
        if point2D.has_point3D():
            seen = image.project_point(model.points3D[point2D.point3D_id].xyz)
            errors.append(numpy.linalg.norm(seen - point2D.xy))
image = next(image for image in model.images.values() if image.name == 'p007.jpg')
print(len(model.images), len(model.points3D), len(errors), float(numpy.mean(errors)), *image.projection_center())
";

fn python() -> Command {
    let mut python = Command::new("python3");
    if let Some(folder) = std::env::var_os("CITYWELD_PYTHONPATH") {
        python.env("PYTHONPATH", folder);
    }
    python
}

fn look_at(folder: &Path) -> Vec<f64> {
    let output = python().arg("-c").arg(SCRIPT).arg(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

#[test]
fn pycolmap_opens_the_moved_model_and_projects_as_before() {
    let found = python().args(["-c", "import numpy, pycolmap"]).output().is_ok_and(|output| output.status.success());
    let wanted = std::env::var_os("CITYWELD_PYTHONPATH").is_some();
    assert!(found || !wanted, "CITYWELD_PYTHONPATH is set, but python3 finds no pycolmap there");
    if !found {
        println!("skipped: python3 finds no pycolmap");
        return;
    }
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");
    let reconstruction = read_reconstruction(&sample.join("sfm")).unwrap();
    let city_from_sfm = read_start(&sample.join("start.json")).unwrap().city_from_sfm;
    let room = tempfile::tempdir().unwrap();
    write_colmap(room.path(), &reconstruction.transformed(&city_from_sfm)).unwrap();

    let (before, after) = (look_at(&sample.join("sfm")), look_at(room.path()));
    assert_eq!(before[..3], after[..3], "images, points, observations");
    // A similarity leaves every projection where it is; the sample's own points are rounded to 1e-6 units.
    assert!((before[3] - after[3]).abs() < 1e-6, "mean reprojection error {} px, was {} px", after[3], before[3]);
    let center = city_from_sfm.apply(&cityweld::geometry::Point3::new(before[4], before[5], before[6]));
    let found = cityweld::geometry::Point3::new(after[4], after[5], after[6]);
    assert!((center - found).norm() < 1e-6, "the camera stands at {found}, expected {center}");
}
