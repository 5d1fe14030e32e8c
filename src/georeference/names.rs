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
