//! Whether a picture can be its camera's, told from its header before anything is decoded.

use std::path::Path;

use super::ImageryError;

/// Share by which the shape (width over height) of a picture may stray from its camera's: scaling rounds to whole pixels.
const SHAPE_TOLERANCE: f64 = 0.02;

/// A picture may have this many times its camera's pixels. Chosen: tools that scale photographs down before they match them
/// halve them once or twice, so that the originals have four times the width and height.
const MOST_TIMES_THE_CAMERA: u64 = 16;

/// Pixels that are allowed in any case: twelve megabytes.
const PIXELS_OF_ANY_PICTURE: u64 = 4_000_000;

/// Pixels of a picture without a camera: what [`super::files`] has memory for.
const PIXELS_WITHOUT_CAMERA: u64 = 180_000_000;

/// The size that a camera gives its pictures, if it is one.
pub(super) fn of_camera(camera: &crate::geometry::Camera) -> Option<(u32, u32)> {
    let side = |pixels: u64| u32::try_from(pixels).unwrap_or(u32::MAX);
    let size = (side(camera.width_px), side(camera.height_px));
    (size.0 > 0 && size.1 > 0).then_some(size)
}

/// Pixels that a picture of this camera may have.
pub(super) fn most_pixels(camera: Option<(u32, u32)>) -> u64 {
    match camera {
        Some(camera) => pixels(camera).saturating_mul(MOST_TIMES_THE_CAMERA).max(PIXELS_OF_ANY_PICTURE),
        None => PIXELS_WITHOUT_CAMERA,
    }
}

fn pixels(size: (u32, u32)) -> u64 {
    u64::from(size.0) * u64::from(size.1)
}

/// The size of the image to which observations refer: the camera's, which must have the picture's shape. Pictures without
/// a camera stand for themselves.
pub(super) fn size_in_camera(
    camera: Option<(u32, u32)>,
    found: (u32, u32),
    noun: &'static str,
    path: &Path,
) -> Result<(u32, u32), ImageryError> {
    let Some(camera) = camera else { return Ok(found) };
    if !same_shape(found, camera) {
        let turned = same_shape((found.1, found.0), camera);
        return Err(ImageryError::WrongShape { noun, found, camera, turned, path: path.to_path_buf() });
    }
    if pixels(found) > most_pixels(Some(camera)) {
        let most_times = MOST_TIMES_THE_CAMERA;
        return Err(ImageryError::FarLarger { noun, found, camera, most_times, path: path.to_path_buf() });
    }
    Ok(camera)
}

/// Whether one size is the other scaled, to within rounding by a pixel.
fn same_shape(found: (u32, u32), camera: (u32, u32)) -> bool {
    let [width, height, camera_width, camera_height] = [found.0, found.1, camera.0, camera.1].map(f64::from);
    let stray = (width * camera_height / (height * camera_width)).ln().abs();
    stray <= f64::max(SHAPE_TOLERANCE, 1.0 / width.min(height))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_agree_to_within_rounding() {
        assert!(same_shape((31, 23), (960, 720)) && same_shape((3, 2), (960, 720)));
        assert!(!same_shape((720, 960), (960, 720)) && !same_shape((512, 512), (960, 720)));
    }

    #[test]
    fn a_picture_far_larger_than_its_camera_is_refused() {
        let check = |found| size_in_camera(Some((640, 480)), found, "photograph", Path::new("p.jpg"));
        assert_eq!(check((2560, 1920)).unwrap(), (640, 480));
        assert_eq!(check((40, 30)).unwrap(), (640, 480));
        assert!(matches!(check((2576, 1932)), Err(ImageryError::FarLarger { .. })));
        assert!(matches!(check((13000, 9750)), Err(ImageryError::FarLarger { .. })));
        assert!(matches!(check((13000, 13000)), Err(ImageryError::WrongShape { .. })));
        let of_small = size_in_camera(Some((64, 48)), (1600, 1200), "photograph", Path::new("p.jpg"));
        assert_eq!(of_small.unwrap(), (64, 48));
        assert_eq!(size_in_camera(None, (13000, 9750), "photograph", Path::new("p.jpg")).unwrap(), (13000, 9750));
    }
}
