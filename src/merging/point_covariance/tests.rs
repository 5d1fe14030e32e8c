use super::*;
use crate::geometry::{Rotation3, Vector3};
use crate::random::Random;
use crate::reconstruction::Image;

/// Cameras round a point, each with a focal length of 1000 pixels.
fn seen_by(eyes: &[[f64; 3]]) -> (Reconstruction, Vec<(ImageIndex, u32)>) {
    let camera = Camera {
        model: CameraModel::SimplePinhole,
        width_px: 2000,
        height_px: 2000,
        params: vec![1000.0, 1000.0, 1000.0],
    };
    let mut sfm = Reconstruction { cameras: vec![camera], points: vec![Point3::origin()], ..Reconstruction::default() };
    for eye in eyes {
        let eye = Vector3::from(*eye);
        let ahead = -eye.normalize();
        let right = ahead.cross(&Vector3::new(0.1, 0.2, 0.9)).normalize();
        let down = ahead.cross(&right);
        let rows = Matrix3::from_rows(&[right.transpose(), down.transpose(), ahead.transpose()]);
        let rotation = Rotation3::from_matrix_unchecked(rows);
        sfm.images.push(Image {
            cam_from_sfm_rotation: rotation,
            cam_from_sfm_translation: -(rotation * eye),
            ..Image::default()
        });
    }
    let track = (0..eyes.len() as u32).map(|image| (ImageIndex(image), 0)).collect();
    (sfm, track)
}

/// The point nearest to rays of noisy keypoints, weighted by their distances: two rounds of linear triangulation.
fn triangulated(sfm: &Reconstruction, random: &mut Random, sigma_px: f64) -> Vector3<f64> {
    let (mut information, mut sum) = (Matrix3::zeros(), Vector3::zeros());
    for image in &sfm.images {
        let pixel = sfm.cameras[0].project(&image.cam_from_sfm(&Point3::origin())).unwrap();
        let noisy = pixel.map(|v| v + sigma_px * random.normal());
        let direction = image.cam_from_sfm_rotation.inverse() * sfm.cameras[0].ray(noisy).unwrap().into_inner();
        let across = (Matrix3::identity() - direction * direction.transpose()) / image.center().coords.norm_squared();
        information += across;
        sum += across * image.center().coords;
    }
    information.try_inverse().unwrap() * sum
}

#[test]
fn the_covariance_is_the_scatter_of_triangulations() {
    let limits = crate::merging::limits::MergeLimits::default().keypoints;
    for eyes in [vec![[8.0, 0.0, 1.0], [0.0, 9.0, 0.0]], vec![[6.0, 1.0, 0.0], [5.0, 3.0, 2.0], [-3.0, 7.0, -2.0]]] {
        let (sfm, track) = seen_by(&eyes);
        let stated = covariance(&sfm, &track, PointIndex(0), 1e3, &limits);
        let mut random = Random::stream(44, 0);
        let mut scatter = Matrix3::zeros();
        let draws = 4000;
        for _ in 0..draws {
            let x = triangulated(&sfm, &mut random, limits.sigma_px);
            scatter += x * x.transpose() / f64::from(draws);
        }
        assert!((scatter - stated).norm() < 0.08 * stated.norm(), "{scatter} {stated}");
    }
}

#[test]
fn what_no_ray_holds_is_as_uncertain_as_the_cloud_is_large() {
    let limits = crate::merging::limits::MergeLimits::default().keypoints;
    let (sfm, track) = seen_by(&[[8.0, 0.0, 0.0]]);
    let stated = covariance(&sfm, &track, PointIndex(0), 50.0, &limits);
    assert!((stated[(0, 0)].sqrt() - 50.0).abs() < 1e-6 && stated[(1, 1)].sqrt() < 0.01);
    let nothing = covariance(&sfm, &[], PointIndex(0), 50.0, &limits);
    assert!((nothing - Matrix3::identity() * 2500.0).norm() < 1e-6);
}
