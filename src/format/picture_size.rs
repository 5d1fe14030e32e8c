//! How large a picture is, by its header.

use std::io::BufReader;
use std::path::Path;

use image::ImageReader;

use super::file::open_regular;

/// Width and height of a JPEG or PNG file, pixels; `None` where there is none, or its header cannot be read.
pub fn picture_size(path: &Path) -> Option<(u32, u32)> {
    let file = open_regular(path).ok()?;
    ImageReader::new(BufReader::new(file)).with_guessed_format().ok()?.into_dimensions().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_tells_the_size_and_other_files_tell_none() {
        let folder = tempfile::tempdir().unwrap();
        let [picture, text] = ["a.png", "b.png"].map(|name| folder.path().join(name));
        image::GrayImage::new(7, 5).save(&picture).unwrap();
        std::fs::write(&text, "no picture").unwrap();
        assert_eq!(picture_size(&picture), Some((7, 5)));
        assert_eq!((picture_size(&text), picture_size(&folder.path().join("c.png"))), (None, None));
    }
}
