//! Finds the file of an image, and reads and decodes it within bounds.

use std::io::Cursor;
use std::path::{Component, Path, PathBuf};

use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, Limits};

use super::ImageryError;

/// Largest file and largest decoded picture, bytes. 512 MiB hold 170 megapixels of colour, more than any camera has;
/// what claims more is taken for a damaged or hostile header.
const MEMORY_LIMIT_BYTES: u64 = 512 << 20;

/// Extensions of photographs, in the order in which they are tried after the name itself.
const PHOTO_EXTENSIONS: [&str; 6] = ["jpg", "JPG", "jpeg", "JPEG", "png", "PNG"];
const LABEL_EXTENSIONS: [&str; 2] = ["png", "PNG"];

/// The file of a photograph: the image's own name, or the same stem with another extension or case.
pub(super) fn find_photo(folder: &Path, image_name: &str) -> Option<PathBuf> {
    let named = path_inside(folder, image_name)?;
    if named.is_file() {
        return Some(named);
    }
    with_extension_of(&named, &PHOTO_EXTENSIONS)
}

/// The file of a label image: the image's name with the extension of a PNG.
pub(super) fn find_labels(folder: &Path, image_name: &str) -> Option<PathBuf> {
    with_extension_of(&path_inside(folder, image_name)?, &LABEL_EXTENSIONS)
}

/// The path of a name under the folder. Names come out of files, so one that leads elsewhere finds nothing.
/// Reconstructions made on Windows may have backslashes between folders.
fn path_inside(folder: &Path, image_name: &str) -> Option<PathBuf> {
    let plain = folder.join(image_name);
    let name = if image_name.contains('\\') && !plain.is_file() {
        image_name.replace('\\', "/")
    } else {
        image_name.to_owned()
    };
    let stays = Path::new(&name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    (stays && !name.is_empty()).then(|| folder.join(name))
}

fn with_extension_of(named: &Path, extensions: &[&str]) -> Option<PathBuf> {
    extensions.iter().map(|extension| named.with_extension(extension)).find(|path| path.is_file())
}

/// A decoded picture.
pub(super) struct Picture {
    pub pixels: DynamicImage,
    /// A JPEG whose end marker is missing: the rest of the picture was filled in by the decoder.
    pub truncated: bool,
}

/// Reads and decodes a picture, JPEG or PNG by content. The EXIF orientation is not applied: reconstructions refer to
/// the pixels as they are stored.
pub(super) fn read_picture(path: &Path, noun: &'static str, expected: &'static str) -> Result<Picture, ImageryError> {
    let bytes = read_bounded(path, noun)?;
    let undecodable = |reason: String| ImageryError::Undecodable { noun, reason, expected, path: path.to_path_buf() };
    if bytes.is_empty() {
        return Err(undecodable("the file is empty".to_owned()));
    }
    let mut reader =
        ImageReader::new(Cursor::new(&bytes)).with_guessed_format().map_err(|error| undecodable(error.to_string()))?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(MEMORY_LIMIT_BYTES);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|error| undecodable(reason_of(error)))?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(undecodable(format!("it has {width} x {height} pixels")));
    }
    if decoder.total_bytes() > MEMORY_LIMIT_BYTES {
        let limit_mib = MEMORY_LIMIT_BYTES >> 20;
        return Err(ImageryError::TooLarge { noun, width, height, limit_mib, path: path.to_path_buf() });
    }
    let pixels = DynamicImage::from_decoder(decoder).map_err(|error| undecodable(reason_of(error)))?;
    Ok(Picture { pixels, truncated: lacks_jpeg_end(&bytes) })
}

fn read_bounded(path: &Path, noun: &'static str) -> Result<Vec<u8>, ImageryError> {
    let unreadable = |reason: String| ImageryError::Unreadable { noun, reason, path: path.to_path_buf() };
    let size = std::fs::metadata(path).map_err(|error| unreadable(error.to_string()))?.len();
    if size > MEMORY_LIMIT_BYTES {
        return Err(unreadable(format!("it has {size} bytes, at most {MEMORY_LIMIT_BYTES} are read")));
    }
    std::fs::read(path).map_err(|error| unreadable(error.to_string()))
}

/// The decoder's reason on one line.
fn reason_of(error: ImageError) -> String {
    match error {
        ImageError::Unsupported(_) => "it is neither JPEG nor PNG, or of a kind that is not supported".to_owned(),
        other => other.to_string().replace('\n', " "),
    }
}

/// Whether these are the bytes of a JPEG without an end marker (FF D9) after its picture data. Segments before the
/// first scan are skipped whole, because a thumbnail in them has an end marker of its own; within picture data the two
/// bytes cannot stand for anything else (ITU T.81, B.1.1).
fn lacks_jpeg_end(bytes: &[u8]) -> bool {
    if !bytes.starts_with(&[0xFF, 0xD8]) {
        return false;
    }
    let mut at = 2;
    while let Some(&[marker_prefix, marker, high, low]) = bytes.get(at..at + 4).and_then(|s| s.first_chunk::<4>()) {
        let start_of_scan = marker == 0xDA;
        if marker_prefix != 0xFF || start_of_scan {
            break;
        }
        at += 2 + usize::from(u16::from_be_bytes([high, low]));
    }
    !bytes.get(at..).is_some_and(|rest| rest.windows(2).any(|pair| pair == [0xFF, 0xD9]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_out_of_the_folder_find_nothing() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("in")).unwrap();
        std::fs::write(folder.path().join("a.png"), b"x").unwrap();
        assert!(find_photo(folder.path(), "a.png").is_some());
        assert!(find_photo(&folder.path().join("in"), "../a.png").is_none());
        let absolute = folder.path().join("a.png");
        assert!(find_photo(&folder.path().join("in"), absolute.to_str().unwrap()).is_none());
        assert!(find_photo(folder.path(), "").is_none());
    }

    #[test]
    fn other_extensions_and_sub_folders_are_found() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("left")).unwrap();
        std::fs::write(folder.path().join("left/b.JPEG"), b"x").unwrap();
        std::fs::write(folder.path().join("left/b.png"), b"x").unwrap();
        assert_eq!(find_photo(folder.path(), "left/b.jpg"), Some(folder.path().join("left/b.JPEG")));
        assert_eq!(find_photo(folder.path(), "left\\b.tif"), Some(folder.path().join("left/b.JPEG")));
        assert_eq!(find_labels(folder.path(), "left/b.jpg"), Some(folder.path().join("left/b.png")));
        assert_eq!(find_labels(folder.path(), "b.jpg"), None);
    }

    #[test]
    fn the_end_marker_of_a_thumbnail_does_not_count() {
        let thumbnail = [0xFF, 0xE1, 0x00, 0x06, 0xFF, 0xD8, 0xFF, 0xD9];
        let scan = [0xFF, 0xDA, 0x00, 0x02, 0x12, 0x34];
        let cut: Vec<u8> = [&[0xFF, 0xD8][..], &thumbnail, &scan].concat();
        assert!(lacks_jpeg_end(&cut));
        assert!(!lacks_jpeg_end(&[&cut[..], &[0xFF, 0xD9, 0x00]].concat()));
        assert!(!lacks_jpeg_end(b"\x89PNG"));
    }
}
