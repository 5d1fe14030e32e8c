//! Which file, or which photograph of another reconstruction, an image's name means.
//!
//! Question     tools write `p001.jpg`, `images/p001.jpg`, `C:\job\images\P001.JPG` for one photograph, and masks as `p001.png` or
//!              `p001.jpg.png`. Which of the names that are there is the one that is meant?
//! Method       1. the same path; 2. the same file name, case ignored (jpeg is jpg), and the longest common ending of the path;
//!              3. the same, with the stem in place of the file name. Of equals one that is an ending of the other wins. Two
//!              that are left are an error that names both. What somebody has by its own path is nobody else's.
//! Fails when   two cameras number their pictures alike and one of them is missing: [`NameMatch`] says how a name was matched, and
//!              callers count it

use std::collections::HashMap;

/// How a name was matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NameMatch {
    /// The same path, or for labels the same but for the extension.
    Path,
    /// One path is the end of the other.
    Ending,
    /// File name and folders above it agree as far as `folders` tells, then not.
    PartOfPath { folders: usize },
    /// The same but for the extension.
    Stem,
}

/// A name that may mean two.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the image {} may be {} or {}; give both the same path, or take one away",
    crate::format::escaped(name),
    crate::format::escaped(first),
    crate::format::escaped(second)
)]
pub struct AmbiguousName {
    pub name: String,
    pub first: String,
    pub second: String,
}

/// What is compared of a path.
struct Parts {
    /// From the file's up; lower case.
    folders: Vec<String>,
    file: String,
    stem: String,
}

/// Extensions of pictures; a name may have two of them.
const EXTENSIONS: [&str; 8] = ["jpg", "jpeg", "png", "tif", "tiff", "bmp", "webp", "dng"];

impl Parts {
    fn of(name: &str) -> Parts {
        let lower = name.to_lowercase().replace('\\', "/");
        let mut pieces = lower.split('/').rev().filter(|piece| !piece.is_empty() && *piece != ".");
        let file = pieces.next().unwrap_or_default();
        let file = file.strip_suffix(".jpeg").map_or(file.to_owned(), |stem| format!("{stem}.jpg"));
        Parts { folders: pieces.map(str::to_owned).collect(), stem: stem(&file).to_owned(), file }
    }

    /// Folders that agree, from the file's up.
    fn common(&self, other: &Parts) -> usize {
        self.folders.iter().zip(&other.folders).take_while(|(a, b)| a == b).count()
    }

    /// Whether one path is the end of the other.
    fn is_ending(&self, other: &Parts) -> bool {
        self.common(other) == self.folders.len().min(other.folders.len())
    }
}

/// The name of a file without its extensions: `x` of `x.jpg.png`, `a.b` of `a.b.png`.
fn stem(file: &str) -> &str {
    let Some((stem, _)) = file.rsplit_once('.') else { return file };
    match stem.rsplit_once('.') {
        Some((shorter, extension)) if EXTENSIONS.contains(&extension) && !shorter.is_empty() => shorter,
        _ => stem,
    }
}

/// Which of the `present` names each of the `wanted` ones means; indices into `present`. Each is meant by one at most.
pub fn match_names(wanted: &[&str], present: &[&str]) -> Result<Vec<Option<(usize, NameMatch)>>, AmbiguousName> {
    let by_path: HashMap<&str, usize> = present.iter().enumerate().rev().map(|(i, name)| (*name, i)).collect();
    let mut found: Vec<Option<(usize, NameMatch)>> =
        wanted.iter().map(|name| Some((*by_path.get(name)?, NameMatch::Path))).collect();
    if found.iter().all(Option::is_some) {
        return Ok(found);
    }
    let mut taken_by = vec![None; present.len()];
    found.iter().enumerate().filter_map(|(w, f)| Some((w, (*f)?.0))).for_each(|(w, p)| taken_by[p] = Some(w));
    let index = NameIndex::of(present.iter().copied());
    for (number, name) in wanted.iter().enumerate().filter(|(number, _)| found[*number].is_none()).collect::<Vec<_>>() {
        let Some((place, how)) = index.find(name)? else { continue };
        match taken_by[place] {
            None => {
                taken_by[place] = Some(number);
                found[number] = Some((place, how));
            }
            // Somebody's own.
            Some(other) if found[other].is_some_and(|(_, how)| how == NameMatch::Path) => {}
            Some(other) => {
                let (first, second) = (wanted[other].to_string(), name.to_string());
                return Err(AmbiguousName { name: present[place].to_string(), first, second });
            }
        }
    }
    Ok(found)
}

/// Names that are there, by their file name and by their stem.
pub struct NameIndex<'a> {
    present: Vec<&'a str>,
    parts: Vec<Parts>,
    by_file: HashMap<String, Vec<usize>>,
    by_stem: HashMap<String, Vec<usize>>,
}

impl<'a> NameIndex<'a> {
    pub fn of(present: impl IntoIterator<Item = &'a str>) -> NameIndex<'a> {
        let present: Vec<&str> = present.into_iter().collect();
        let parts: Vec<Parts> = present.iter().map(|name| Parts::of(name)).collect();
        let (mut by_file, mut by_stem): (HashMap<String, Vec<usize>>, HashMap<String, Vec<usize>>) = Default::default();
        for (number, part) in parts.iter().enumerate() {
            by_file.entry(part.file.clone()).or_default().push(number);
            by_stem.entry(part.stem.clone()).or_default().push(number);
        }
        NameIndex { present, parts, by_file, by_stem }
    }

    /// Which of the names that are there this one means, and how that was told; each may be meant by several.
    pub fn find(&self, name: &str) -> Result<Option<(usize, NameMatch)>, AmbiguousName> {
        let sought = Parts::of(name);
        if let Some(place) = self.best(name, &sought, self.by_file.get(&sought.file))? {
            let folders = self.parts[place].common(&sought);
            let is_ending = self.parts[place].is_ending(&sought);
            let how = if is_ending { NameMatch::Ending } else { NameMatch::PartOfPath { folders } };
            return Ok(Some((place, how)));
        }
        let found = self.best(name, &sought, self.by_stem.get(&sought.stem))?;
        Ok(found.map(|place| {
            let is_same_folder = self.parts[place].folders == sought.folders;
            (place, if is_same_folder { NameMatch::Path } else { NameMatch::Stem })
        }))
    }

    /// The one with the longest common ending.
    fn best(
        &self,
        name: &str,
        sought: &Parts,
        candidates: Option<&Vec<usize>>,
    ) -> Result<Option<usize>, AmbiguousName> {
        let Some(candidates) = candidates else { return Ok(None) };
        let rank = |i: usize| {
            let part = &self.parts[i];
            // Of two endings the path itself.
            (part.common(sought), part.is_ending(sought), part.folders == sought.folders)
        };
        let Some(highest) = candidates.iter().map(|i| rank(*i)).max() else { return Ok(None) };
        let mut best = candidates.iter().filter(|i| rank(**i) == highest);
        match (best.next(), best.next()) {
            (Some(first), Some(second)) => {
                let (first, second) = (self.present[*first].to_string(), self.present[*second].to_string());
                Err(AmbiguousName { name: name.to_string(), first, second })
            }
            (first, _) => Ok(first.copied()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matched(wanted: &[&str], present: &[&str]) -> Vec<Option<(usize, NameMatch)>> {
        match_names(wanted, present).unwrap()
    }

    #[test]
    fn the_same_path_goes_first_whatever_else_fits() {
        let found = matched(&["a/p.jpg", "p.jpg"], &["p.jpg", "a/p.jpg", "b/p.jpg"]);
        assert_eq!(found, [Some((1, NameMatch::Path)), Some((0, NameMatch::Path))]);
    }

    #[test]
    fn prefixes_backslashes_case_and_jpeg_make_no_other_photograph() {
        for wanted in ["images/p001.jpg", "C:\\job\\images\\p001.jpg", "./p001.jpg", "IMAGES/P001.JPG", "p001.jpeg"] {
            assert_eq!(matched(&[wanted], &["p002.jpg", "p001.jpg"]), [Some((1, NameMatch::Ending))], "{wanted}");
        }
    }

    #[test]
    fn the_longest_common_ending_decides() {
        let present = ["x/left/1.jpg", "x/right/1.jpg", "1.png"];
        assert_eq!(matched(&["/data/x/right/1.jpg"], &present), [Some((1, NameMatch::Ending))]);
        assert_eq!(matched(&["/y/left/1.jpg"], &present), [Some((0, NameMatch::PartOfPath { folders: 1 }))]);
    }

    #[test]
    fn of_equals_one_that_is_an_ending_wins() {
        assert_eq!(matched(&["images/1.jpg"], &["thumbs/1.jpg", "1.jpg"]), [Some((1, NameMatch::Ending))]);
    }

    #[test]
    fn two_that_are_left_are_named() {
        let error = match_names(&["1.jpg"], &["left/1.jpg", "right/1.jpg"]).unwrap_err();
        assert_eq!((error.first.as_str(), error.second.as_str()), ("left/1.jpg", "right/1.jpg"));
        let error = match_names(&["left/1.jpg", "right/1.jpg"], &["1.jpg"]).unwrap_err().to_string();
        assert!(error.contains("left/1.jpg") && error.contains("right/1.jpg"), "{error}");
    }

    #[test]
    fn what_somebody_has_by_its_own_path_is_nobody_elses() {
        let found = matched(&["left/1.jpg", "right/1.jpg"], &["left/1.jpg"]);
        assert_eq!(found, [Some((0, NameMatch::Path)), None]);
    }

    #[test]
    fn masks_go_by_the_stem_with_one_extension_or_two() {
        for present in ["a/p.png", "a/p.jpg.png", "a/P.JPG.png"] {
            assert_eq!(matched(&["a/p.jpg"], &[present]), [Some((0, NameMatch::Path))], "{present}");
        }
        assert_eq!(matched(&["a/p.jpg"], &["p.jpg.png"]), [Some((0, NameMatch::Stem))]);
        assert_eq!(matched(&["a/p.1.jpg"], &["a/p.png"]), [None]);
        assert_eq!(stem(".jpg.png"), ".jpg");
    }

    #[test]
    fn names_of_nothing_find_nothing() {
        assert_eq!(matched(&["", "/", "\\", "."], &["a.jpg"]), [None; 4]);
        assert_eq!(matched(&["a.jpg"], &[]), [None]);
    }
}
