//! Which photograph of the reconstruction a name means: the name itself, the longest common ending of the path, or the stem; case ignored.

use std::collections::HashMap;

use super::GeoreferenceError;
use crate::reconstruction::{Image, ImageIndex};

/// The photographs of a reconstruction by their names.
pub(super) struct PhotographNames<'a> {
    images: &'a [Image],
    by_file: HashMap<String, Vec<ImageIndex>>,
    by_stem: HashMap<String, Vec<ImageIndex>>,
}

impl<'a> PhotographNames<'a> {
    pub fn new(images: &'a [Image]) -> PhotographNames<'a> {
        let (mut by_file, mut by_stem) = (HashMap::<_, Vec<_>>::new(), HashMap::<_, Vec<_>>::new());
        for (index, image) in (0..).map(ImageIndex).zip(images) {
            let file = file_of(&plain(&image.name)).to_owned();
            by_stem.entry(stem_of(&file).to_owned()).or_default().push(index);
            by_file.entry(file).or_default().push(index);
        }
        PhotographNames { images, by_file, by_stem }
    }

    /// `None` where no photograph has the name; an error where two have it alike.
    pub fn find(&self, name: &str, source_name: &str) -> Result<Option<ImageIndex>, GeoreferenceError> {
        let wanted = plain(name);
        let file = file_of(&wanted);
        let candidates = self.by_file.get(file).or_else(|| self.by_stem.get(stem_of(file)));
        let Some(candidates) = candidates else { return Ok(None) };
        let shared = |index: &ImageIndex| shared_ending(&wanted, &plain(&self.images[index.0 as usize].name));
        let longest = candidates.iter().map(shared).max().unwrap_or(0);
        let best: Vec<&ImageIndex> = candidates.iter().filter(|c| shared(c) == longest).collect();
        let exact = best.iter().find(|c| plain(&self.images[c.0 as usize].name) == wanted);
        match (exact, &best[..]) {
            (Some(exact), _) => Ok(Some(**exact)),
            (None, [one]) => Ok(Some(**one)),
            (None, [first, second, ..]) => Err(GeoreferenceError::TwoPhotographs {
                given: name.to_owned(),
                first: self.images[first.0 as usize].name.clone(),
                second: self.images[second.0 as usize].name.clone(),
                source_name: source_name.to_owned(),
            }),
            (None, []) => Ok(None),
        }
    }
}

fn plain(name: &str) -> String {
    name.replace('\\', "/").to_lowercase()
}

fn file_of(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

fn stem_of(file: &str) -> &str {
    file.rsplit_once('.').map_or(file, |(stem, _)| if stem.is_empty() { file } else { stem })
}

/// How many folders above the file are the same.
fn shared_ending(a: &str, b: &str) -> usize {
    let folders = |path| str::rsplit(path, '/').skip(1);
    folders(a).zip(folders(b)).take_while(|(a, b)| a == b).count()
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

    #[test]
    fn a_name_that_begins_with_a_point_has_no_ending() {
        assert_eq!(stem_of(".jpg"), ".jpg");
        assert_eq!(stem_of("a.b.jpg"), "a.b");
        assert_eq!(find(&[".jpg"], "x.jpg").unwrap(), None);
    }
}
