//! Reads and decodes pictures within bounds.

use std::io::{self, BufRead, BufReader, Cursor, Read, Seek};
use std::path::Path;

use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, Limits};

use super::ImageryError;
use super::size::{most_pixels, size_in_camera};
use crate::format::file::{open_regular, read_at_most};

/// Largest file and largest decoded picture, bytes. 512 MiB hold 170 megapixels of colour, more than any camera has;
/// what claims more is taken for a damaged or hostile header.
const MEMORY_LIMIT_BYTES: u64 = 512 << 20;

/// Four channels of 16 bits.
const MOST_BYTES_OF_A_PIXEL: u64 = 8;

/// What may stand in a file beside its pixels: previews, profiles, text.
const METADATA_BYTES: u64 = 16 << 20;

/// A block of 8 x 8 pixels takes a bit at least, its DC difference; of colours one may have all pixels across and another all
/// down, each a quarter of the other way (ITU T.81, A.1.1 and F.1.2.1).
const MOST_PIXELS_OF_A_JPEG_BYTE: u64 = 8 * 64 * 4;

/// Deflate writes at most 1032 bytes for one (RFC 1951: 258 in two bits), and eight pixels may share a byte.
const MOST_PIXELS_OF_A_PNG_BYTE: u64 = 1032 * 8;

/// While a picture is decoded: coefficients of a progressive JPEG, two bytes in each of three channels; or the copy in eight
/// bits of a picture that has more.
const BESIDE_A_PIXEL: u64 = 6;

/// As every JPEG begins.
const JPEG_START: [u8; 3] = [0xFF, 0xD8, 0xFF];

/// What a file should hold.
#[derive(Clone, Copy)]
pub(super) struct Expected {
    pub noun: &'static str,
    pub format: &'static str,
}

/// A picture whose header has been read and fits its camera; not decoded yet.
pub(super) struct Picture<'p> {
    pub path: &'p Path,
    expected: Expected,
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Width and height of the image to which observations refer.
    pub image_size: (u32, u32),
    decoder: Box<dyn ImageDecoder>,
    truncated: bool,
}

/// A decoded picture.
pub(super) struct Decoded {
    pub pixels: DynamicImage,
    /// A JPEG whose end marker is missing: the rest of the picture was filled in by the decoder.
    pub truncated: bool,
}

/// Opens a picture, JPEG or PNG by content, and compares its header with the size of its camera, if there is one. The EXIF
/// orientation is not applied: reconstructions refer to the pixels as they are stored.
pub(super) fn open_picture(
    path: &Path,
    expected: Expected,
    camera: Option<(u32, u32)>,
) -> Result<Picture<'_>, ImageryError> {
    let noun = expected.noun;
    let unreadable =
        |error: io::Error| ImageryError::Unreadable { noun, reason: error.to_string(), path: path.to_path_buf() };
    let fault = |reason: String| undecodable(path, expected, reason);
    let mut file = open_regular(path).map_err(unreadable)?;
    let file_bytes = file.metadata().map_err(unreadable)?.len();
    if file_bytes == 0 {
        return Err(fault("the file is empty".to_owned()));
    }
    // As much as the largest picture that is taken would have uncompressed.
    let limit = MEMORY_LIMIT_BYTES.min(most_pixels(camera) * MOST_BYTES_OF_A_PIXEL + METADATA_BYTES);
    let mut truncated = false;
    let mut start = [0; 3];
    let is_jpeg = file.read_exact(&mut start).is_ok() && start == JPEG_START;
    file.rewind().map_err(unreadable)?;
    // A JPEG is read whole, as its decoder does; of a PNG no more than is decoded.
    let bytes: Box<dyn BufReadSeek> = if is_jpeg {
        let bytes = read_at_most(file, file_bytes, limit).map_err(unreadable)?;
        truncated = lacks_jpeg_end(&bytes);
        Box::new(Cursor::new(bytes))
    } else {
        Box::new(BufReader::new(file))
    };
    let mut reader = ImageReader::new(bytes).with_guessed_format().map_err(|error| fault(error.to_string()))?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(limit);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|error| fault(reason_of(error)))?;
    let size @ (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(fault(format!("it has {width} x {height} pixels")));
    }
    let image_size = size_in_camera(camera, size, noun, path)?;
    if decoder.total_bytes() > MEMORY_LIMIT_BYTES {
        let limit_mib = MEMORY_LIMIT_BYTES >> 20;
        return Err(ImageryError::TooLarge { noun, width, height, limit_mib, path: path.to_path_buf() });
    }
    let pixels = u64::from(width) * u64::from(height);
    if file_bytes < pixels / if is_jpeg { MOST_PIXELS_OF_A_JPEG_BYTE } else { MOST_PIXELS_OF_A_PNG_BYTE } {
        return Err(fault(format!("its {file_bytes} bytes cannot hold {width} x {height} pixels, it is cut off")));
    }
    Ok(Picture { path, expected, size, image_size, decoder: Box::new(decoder), truncated })
}

impl Picture<'_> {
    /// Memory that decoding takes at most, bytes.
    pub fn decoding_bytes(&self) -> u64 {
        let pixels = u64::from(self.size.0) * u64::from(self.size.1);
        self.decoder.total_bytes() + pixels * BESIDE_A_PIXEL
    }

    pub fn decode(self) -> Result<Decoded, ImageryError> {
        let (path, expected) = (self.path, self.expected);
        let pixels = DynamicImage::from_decoder(self.decoder);
        let pixels = pixels.map_err(|error| undecodable(path, expected, reason_of(error)))?;
        Ok(Decoded { pixels, truncated: self.truncated })
    }
}

fn undecodable(path: &Path, Expected { noun, format }: Expected, reason: String) -> ImageryError {
    ImageryError::Undecodable { noun, reason, expected: format, path: path.to_path_buf() }
}

/// Where a decoder reads from.
trait BufReadSeek: BufRead + Seek {}

impl<T: BufRead + Seek> BufReadSeek for T {}

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
    fn the_end_marker_of_a_thumbnail_does_not_count() {
        let thumbnail = [0xFF, 0xE1, 0x00, 0x06, 0xFF, 0xD8, 0xFF, 0xD9];
        let scan = [0xFF, 0xDA, 0x00, 0x02, 0x12, 0x34];
        let cut: Vec<u8> = [&[0xFF, 0xD8][..], &thumbnail, &scan].concat();
        assert!(lacks_jpeg_end(&cut));
        assert!(!lacks_jpeg_end(&[&cut[..], &[0xFF, 0xD9, 0x00]].concat()));
        assert!(!lacks_jpeg_end(b"\x89PNG"));
    }
}
