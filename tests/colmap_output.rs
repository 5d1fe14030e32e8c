//! The moved COLMAP model, opened again by pycolmap.

mod needs;
mod pieces;

use std::path::Path;

use cityweld::steps::{JoinOptions, Part, join};
use cityweld::{MergeVerdict, Rotation3, Similarity, Vector3, read_reconstruction, read_start, write_colmap};
use needs::pycolmap;
use pieces::piece;

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

fn look_at(folder: &Path) -> Vec<f64> {
    let output = pycolmap().unwrap().arg("-c").arg(SCRIPT).arg(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

#[test]
fn pycolmap_opens_the_moved_model_and_projects_as_before() {
    if pycolmap().is_none() {
        return;
    }
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");
    let reconstruction = read_reconstruction(&sample.join("sfm")).unwrap();
    let city_from_sfm = *read_start(&sample.join("start.json")).unwrap().city_from_sfm();
    let room = tempfile::tempdir().unwrap();
    write_colmap(room.path(), &reconstruction.transformed(&city_from_sfm)).unwrap();

    let (before, after) = (look_at(&sample.join("sfm")), look_at(room.path()));
    assert_eq!(before[..3], after[..3], "images, points, observations");
    // A similarity leaves every projection where it is; the sample's own points are rounded to 1e-6 units.
    assert!((before[3] - after[3]).abs() < 1e-6, "mean reprojection error {} px, was {} px", after[3], before[3]);
    let center = city_from_sfm.apply(&cityweld::Point3::new(before[4], before[5], before[6]));
    let found = cityweld::Point3::new(after[4], after[5], after[6]);
    assert!((center - found).norm() < 1e-6, "the camera stands at {found}, expected {center}");
}

/// Prints images, points, mean track length, mean reprojection error as the file tells it and as pycolmap computes it itself, rigs,
/// frames, and how many images stand where their frame puts them.
const STATISTICS: &str = "
import sys, pycolmap
model = pycolmap.Reconstruction(sys.argv[1])
told = model.compute_mean_reprojection_error()
model.update_point_3d_errors()
print(model.num_images(), model.num_points3D(), model.compute_mean_track_length(), told, model.compute_mean_reprojection_error(),
      len(model.rigs), len(model.frames), sum(image.has_pose for image in model.images.values()))
";

#[test]
fn pycolmap_opens_a_merged_model_and_its_statistics_agree() {
    if pycolmap().is_none() {
        return;
    }
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");
    let whole = read_reconstruction(&sample.join("sfm")).unwrap();
    let turned = Similarity {
        scale: 0.3,
        rotation: Rotation3::from_euler_angles(0.5, -1.0, 2.0),
        translation: Vector3::new(4.0, 0.0, -9.0),
    };
    let part = |name: &str, sfm| Part { name: name.into(), sfm, superpixels: None, anchor: None };
    let parts = [part("a", piece(&whole, 0..14, &Similarity::identity())), part("b", piece(&whole, 11..24, &turned))];
    let merged = join(&parts, &JoinOptions::default(), &()).unwrap();
    assert_eq!(merged.verdict, MergeVerdict::Merged, "{}", merged.reason);
    let sfm = merged.model.unwrap().sfm;
    let room = tempfile::tempdir().unwrap();
    write_colmap(room.path(), &sfm).unwrap();

    let output = pycolmap().unwrap().arg("-c").arg(STATISTICS).arg(room.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let found: Vec<f64> = text.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let (images, points) = (sfm.images.len() as f64, sfm.points.len() as f64);
    let error_px = sfm.point_errors_px.iter().sum::<f64>() / points;
    assert_eq!(found[..2], [images, points]);
    assert!((found[2] - sfm.track_elements.len() as f64 / points).abs() < 1e-9, "mean track length: {text}");
    // The sample's files are text of six digits.
    assert!((found[3] - error_px).abs() < 1e-3 && (found[4] - error_px).abs() < 1e-3, "{error_px} px, {text}");
    assert_eq!(found[5..], [1.0, images, images], "rigs, frames, images with a pose");
}
