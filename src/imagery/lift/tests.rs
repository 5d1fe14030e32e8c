use super::*;
use crate::geometry::{Camera, CameraModel};
use crate::reconstruction::{CameraIndex, Observation};

fn image(name: &str, observations: &[(f64, f64, Option<u32>)]) -> Image {
    Image {
        name: name.to_owned(),
        observations: observations
            .iter()
            .map(|&(x_px, y_px, point)| Observation { x_px, y_px, point: point.map(PointIndex) })
            .collect(),
        ..Image::default()
    }
}

fn labels_2x1(folder: &std::path::Path, name: &str, labels: [u16; 2]) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    image::ImageBuffer::<image::Luma<u16>, _>::from_raw(2, 1, labels.to_vec()).unwrap().save(path).unwrap();
}

#[test]
fn points_are_gathered_by_image_and_label() {
    let folder = tempfile::tempdir().unwrap();
    labels_2x1(folder.path(), "a.png", [7, 40_000]);
    labels_2x1(folder.path(), "sub/b.png", [0, 3]);
    let seen_a = [(1.5, 0.5, Some(4)), (0.5, 0.5, Some(2)), (1.2, 0.1, Some(1)), (1.9, 0.9, Some(4))];
    let seen_b = [(0.5, 0.5, Some(9)), (1.5, 0.5, Some(1)), (1.5, 0.5, None), (2.5, 0.5, Some(5))];
    let images = vec![image("a.jpg", &seen_a), image("sub/b.jpg", &seen_b), image("c.jpg", &[(0.5, 0.5, Some(0))])];
    let reconstruction = Reconstruction { images, ..Reconstruction::default() };
    let source = SuperpixelSource::Labels(folder.path().to_path_buf());
    let lifted = lift_superpixels(&reconstruction, &source, &SuperpixelOptions::default(), &()).unwrap();
    let flat: Vec<_> = lifted
        .superpixels
        .iter()
        .map(|s| (s.image.0, s.label, s.points.iter().map(|p| p.0).collect::<Vec<_>>()))
        .collect();
    assert_eq!(flat, vec![(0, 7, vec![2]), (0, 40_000, vec![1, 4]), (1, 3, vec![1])]);
    assert_eq!((lifted.images_read, lifted.images_missing), (2, 1));
    assert_eq!(
        lifted.warnings,
        vec![
            ImageryWarning::Missing { noun: "label image", count: 1, example: "c.jpg".to_owned() },
            ImageryWarning::OutsideImage { count: 1, example: "sub/b.jpg".to_owned() },
        ]
    );
}

fn camera(width_px: u64, height_px: u64) -> Camera {
    Camera { model: CameraModel::SimplePinhole, width_px, height_px, params: vec![1.0, 0.0, 0.0] }
}

#[test]
fn labels_of_another_size_are_scaled_to_the_camera() {
    let folder = tempfile::tempdir().unwrap();
    labels_2x1(folder.path(), "a.png", [7, 8]);
    let images = vec![image("a.jpg", &[(99.9, 60.0, Some(0)), (100.0, 60.0, Some(1))])];
    let reconstruction = Reconstruction { images, cameras: vec![camera(200, 100)], ..Reconstruction::default() };
    let source = SuperpixelSource::Labels(folder.path().to_path_buf());
    let lifted = lift_superpixels(&reconstruction, &source, &SuperpixelOptions::default(), &()).unwrap();
    let flat: Vec<_> = lifted.superpixels.iter().map(|s| (s.label, s.points.clone())).collect();
    assert_eq!(flat, vec![(7, vec![PointIndex(0)]), (8, vec![PointIndex(1)])]);
    assert_eq!(lifted.warnings, vec![]);
}

#[test]
fn photographs_of_another_size_are_scaled_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    image::RgbImage::new(64, 48).save(folder.path().join("a.png")).unwrap();
    let images = vec![image("a.jpg", &[(600.0, 400.0, Some(0))])];
    let reconstruction = Reconstruction { images, cameras: vec![camera(640, 480)], ..Reconstruction::default() };
    let source = SuperpixelSource::Photos(folder.path().to_path_buf());
    let lifted = lift_superpixels(&reconstruction, &source, &SuperpixelOptions::default(), &()).unwrap();
    assert_eq!(lifted.superpixels.len(), 1);
    let scaled = ImageryWarning::Scaled { count: 1, example: "a.jpg".to_owned(), found: (64, 48), camera: (640, 480) };
    assert_eq!(lifted.warnings, vec![scaled]);
}

#[test]
fn a_picture_that_was_turned_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    labels_2x1(folder.path(), "a.png", [7, 8]);
    let mut turned = image("a.jpg", &[(5.0, 5.0, Some(0))]);
    turned.camera = CameraIndex(1);
    let cameras = vec![camera(200, 100), camera(100, 200)];
    let reconstruction = Reconstruction { images: vec![turned], cameras, ..Reconstruction::default() };
    let source = SuperpixelSource::Labels(folder.path().to_path_buf());
    let error = lift_superpixels(&reconstruction, &source, &SuperpixelOptions::default(), &()).unwrap_err();
    assert!(matches!(error, ImageryError::WrongShape { turned: true, .. }), "{error}");
}
