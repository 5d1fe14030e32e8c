//! Pictures that claim more than their camera, or than their bytes can hold, are refused by their header.

use std::fs;
use std::path::Path;

use cityweld::types::{Camera, CameraModel, ImageryError, PointIndex};
use cityweld::{
    Image, LiftedSuperpixels, Observation, Reconstruction, SuperpixelOptions, SuperpixelSource, lift_superpixels,
};

/// A model of one image `name` of a camera of that size.
fn model(name: &str, (width_px, height_px): (u64, u64)) -> Reconstruction {
    let camera = Camera { model: CameraModel::SimplePinhole, width_px, height_px, params: vec![50.0, 32.0, 24.0] };
    let seen = Observation { x_px: 10.5, y_px: 20.5, point: Some(PointIndex(0)) };
    let image = Image { name: name.to_owned(), observations: vec![seen], ..Image::default() };
    Reconstruction { cameras: vec![camera], images: vec![image], ..Reconstruction::default() }
}

fn lift(source: SuperpixelSource, name: &str, camera: (u64, u64)) -> Result<LiftedSuperpixels, ImageryError> {
    lift_superpixels(&model(name, camera), &source, &SuperpixelOptions::default(), &())
}

fn labels(folder: &Path, camera: (u64, u64)) -> Result<LiftedSuperpixels, ImageryError> {
    lift(SuperpixelSource::Labels(folder.into()), "p.jpg", camera)
}

fn photos(folder: &Path, camera: (u64, u64)) -> Result<LiftedSuperpixels, ImageryError> {
    lift(SuperpixelSource::Photos(folder.into()), "p.jpg", camera)
}

fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [kind.as_slice(), data].concat();
    let mut crc = u32::MAX;
    for byte in &body {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 };
        }
    }
    [&(data.len() as u32).to_be_bytes()[..], &body, &(!crc).to_be_bytes()].concat()
}

/// A grey PNG of 8 or 16 bits that says it has this size, and ends there.
fn png_that_says(width: u32, height: u32, bits: u8) -> Vec<u8> {
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[bits, 0, 0, 0, 0]].concat();
    [
        b"\x89PNG\r\n\x1a\n".as_slice(),
        &chunk(b"IHDR", &header),
        &chunk(b"IDAT", &[0x78, 0x9C, 0x03, 0]),
        &chunk(b"IEND", &[]),
    ]
    .concat()
}

/// A small JPEG whose header says another size.
fn jpeg_that_says(width: u16, height: u16) -> Vec<u8> {
    let mut bytes = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new(&mut bytes);
    image::RgbImage::from_pixel(16, 16, image::Rgb([90, 120, 50])).write_with_encoder(encoder).unwrap();
    let frame = bytes.windows(2).position(|pair| pair == [0xFF, 0xC0]).unwrap();
    bytes[frame + 5..frame + 7].copy_from_slice(&height.to_be_bytes());
    bytes[frame + 7..frame + 9].copy_from_slice(&width.to_be_bytes());
    bytes
}

#[test]
fn labels_far_larger_than_their_camera_are_refused_by_their_header() {
    let folder = tempfile::tempdir().unwrap();
    for bits in [8, 16] {
        fs::write(folder.path().join("p.png"), png_that_says(22000, 22000, bits)).unwrap();
        assert!(matches!(labels(folder.path(), (64, 48)), Err(ImageryError::WrongShape { .. })));
        assert!(matches!(labels(folder.path(), (64, 64)), Err(ImageryError::FarLarger { .. })));
    }
    // So large that its decoder refuses it.
    fs::write(folder.path().join("p.png"), png_that_says(u32::MAX >> 1, u32::MAX >> 1, 8)).unwrap();
    assert!(labels(folder.path(), (64, 64)).is_err());
}

#[test]
fn photographs_far_larger_than_their_camera_are_refused_by_their_header() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("p.jpg"), jpeg_that_says(13000, 13000)).unwrap();
    assert!(matches!(photos(folder.path(), (64, 48)), Err(ImageryError::WrongShape { .. })));
    fs::write(folder.path().join("p.jpg"), jpeg_that_says(13000, 9750)).unwrap();
    let error = photos(folder.path(), (64, 48)).unwrap_err();
    assert!(matches!(error, ImageryError::FarLarger { .. }), "{error}");
    assert!(error.to_string().contains("13000 x 9750") && error.to_string().contains("64 x 48"), "{error}");
}

#[test]
fn pictures_whose_bytes_cannot_hold_their_pixels_are_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("p.jpg"), jpeg_that_says(13000, 9750)).unwrap();
    fs::write(folder.path().join("p.png"), png_that_says(13000, 9750, 8)).unwrap();
    for lifted in [photos(folder.path(), (13000, 9750)), labels(folder.path(), (13000, 9750))] {
        let error = lifted.unwrap_err();
        assert!(error.to_string().contains("cannot hold 13000 x 9750 pixels"), "{error}");
    }
}

#[test]
fn a_plain_picture_is_never_taken_for_one_that_is_cut_off() {
    let folder = tempfile::tempdir().unwrap();
    image::GrayImage::new(3000, 2000).save(folder.path().join("p.png")).unwrap();
    assert!(labels(folder.path(), (3000, 2000)).is_ok());
    image::RgbImage::new(3000, 2000).save(folder.path().join("p.jpg")).unwrap();
    assert!(photos(folder.path(), (3000, 2000)).unwrap().warnings.is_empty());
}

#[test]
fn a_camera_that_claims_any_size_lets_no_picture_pass_that_memory_does_not_hold() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("p.png"), png_that_says(1 << 30, 1 << 30, 16)).unwrap();
    for side in [1 << 30, 1 << 40, u64::MAX] {
        assert!(labels(folder.path(), (side, side)).is_err());
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_in_the_place_of_a_picture_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["p.jpg", "p.png"] {
        assert!(std::process::Command::new("mkfifo").arg(folder.path().join(name)).status().unwrap().success());
    }
    for lifted in [photos(folder.path(), (64, 48)), labels(folder.path(), (64, 48))] {
        let error = lifted.unwrap_err();
        assert!(error.to_string().contains("it is a pipe"), "{error}");
    }
}

#[test]
fn what_would_steer_a_terminal_is_written_out_in_messages_and_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let source = || SuperpixelSource::Photos(folder.path().into());
    let name = "p\x1b[2J\u{9b}2J\n.jpg";
    let error = lift(source(), name, (64, 48)).unwrap_err();
    assert!(!error.to_string().contains(char::is_control), "{error:?}");
    fs::write(folder.path().join(name), "no picture").unwrap();
    let error = lift(source(), name, (64, 48)).unwrap_err();
    assert!(matches!(error, ImageryError::Undecodable { .. }) && !error.to_string().contains(char::is_control));
    image::RgbImage::new(32, 24).save_with_format(folder.path().join(name), image::ImageFormat::Png).unwrap();
    let lifted = lift(source(), name, (64, 48)).unwrap();
    let warning = lifted.warnings[0].to_string();
    assert!(warning.contains("p\\u{1b}[2J") && !warning.contains(char::is_control), "{warning:?}");
}
