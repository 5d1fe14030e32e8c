//! Which photograph of the reconstruction a name in a file of positions or control points means (`reconstruction/names.rs` has the rule).

use super::GeoreferenceError;
use crate::reconstruction::{Image, ImageIndex, NameIndex};

/// The photographs of a reconstruction by their names.
pub(super) struct PhotographNames<'a>(NameIndex<'a>);

impl<'a> PhotographNames<'a> {
    pub fn new(images: &'a [Image]) -> PhotographNames<'a> {
        PhotographNames(NameIndex::of(images.iter().map(|image| image.name.as_str())))
    }

    /// `None` where no photograph has the name; an error where two have it alike.
    pub fn find(&self, name: &str, source_name: &str) -> Result<Option<ImageIndex>, GeoreferenceError> {
        let found = self.0.find(name).map_err(|two| GeoreferenceError::TwoPhotographs {
            given: two.name,
            first: two.first,
            second: two.second,
            source_name: source_name.to_owned(),
        })?;
        Ok(found.map(|(place, _)| ImageIndex(place as u32)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(images: &[&str], name: &str) -> Result<Option<u32>, String> {
        let image = |name: &&str| Image { name: (*name).to_owned(), ..Image::default() };
        let images: Vec<Image> = images.iter().map(image).collect();
        let found = PhotographNames::new(&images).find(name, "geo.txt");
        found.map(|index| index.map(|index| index.0)).map_err(|error| error.to_string())
    }

    #[test]
    fn the_whole_path_wins_then_the_longest_ending_then_the_stem() {
        let images = ["a/cam1/p.jpg", "b/cam1/p.jpg", "b/cam2/p.jpg", "b/q.PNG"];
        for (name, index) in [
            ("a/cam1/p.jpg", Some(0)),
            ("A\\CAM1\\P.JPG", Some(0)),
            ("/home/me/b/cam1/p.jpg", Some(1)),
            ("cam2/p.jpg", Some(2)),
            ("q.png", Some(3)),
            ("q.jpg", Some(3)),
            ("q", Some(3)),
            ("r.jpg", None),
            ("", None),
        ] {
            assert_eq!(find(&images, name).unwrap(), index, "{name}");
        }
    }

    #[test]
    fn two_that_are_as_likely_are_an_error_that_names_both() {
        let message = find(&["a/p.jpg", "b/p.jpg"], "p.jpg").unwrap_err();
        assert!(message.contains("p.jpg may be a/p.jpg or b/p.jpg") && message.ends_with("geo.txt"), "{message}");
        assert!(find(&["p.jpg", "p.png"], "p").unwrap_err().contains("p.jpg or p.png"));
        // The name itself is nobody else's.
        assert_eq!(find(&["b/p.jpg", "p.jpg"], "p.jpg").unwrap(), Some(1));
    }
}
