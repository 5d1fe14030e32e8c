//! One name for one photograph: parts that were reconstructed from different folders call it differently.
//!
//! Question     which photographs of a part are which of the parts before it, although their paths differ?
//! Method       [`match_names`]; a match counts where one path is the end of the other, or two folders agree as well as the file
//!              name, or the name differs by its extension alone. Cameras of several folders number their pictures alike: where
//!              only the file names agree nothing is joined, and a warning says so
//! Output       images bear the name that the first part has for them, and warnings count how they were matched

use super::error::MergeError;
use super::part::Part;
use crate::reconstruction::{AmbiguousName, NameMatch, match_names};

/// Folders that must agree where paths differ above them. Chosen: `images/p001.jpg` is common, `job_7/images/p001.jpg` is not.
const FEWEST_FOLDERS: usize = 1;

/// Gives photographs that are the same the same name; what was matched how is returned as warnings.
pub fn unify_names(parts: &mut [Part]) -> Result<Vec<String>, MergeError> {
    let mut warnings = Vec::new();
    let mut known: Vec<String> = Vec::new();
    for part in parts {
        let matched = {
            let names: Vec<&str> = part.sfm.images.iter().map(|image| image.name.as_str()).collect();
            let before: Vec<&str> = known.iter().map(String::as_str).collect();
            match_names(&names, &before)
                .map_err(|ambiguous: AmbiguousName| MergeError::AmbiguousName { part: part.name.clone(), ambiguous })?
        };
        let (mut renamed, mut alike) = (Vec::new(), Vec::new());
        for (image, matched) in part.sfm.images.iter_mut().zip(matched) {
            let Some((place, how)) = matched else { continue };
            match how {
                _ if image.name == known[place] => {}
                NameMatch::PartOfPath { folders } if folders < FEWEST_FOLDERS => {
                    alike.push((image.name.clone(), known[place].clone()));
                }
                _ => {
                    renamed.push((image.name.clone(), known[place].clone()));
                    image.name.clone_from(&known[place]);
                }
            }
        }
        warnings.extend(told(
            &part.name,
            &renamed,
            "are those of the parts before by the ending of the path or the stem",
        ));
        let alike_words = "have the base names of others in folders of another name, and are not taken for the same; name the \
                           folders alike if they are";
        warnings.extend(told(&part.name, &alike, alike_words));
        known.extend(part.sfm.images.iter().map(|image| image.name.clone()));
        known.sort();
        known.dedup();
    }
    Ok(warnings)
}

fn told(part: &str, pairs: &[(String, String)], words: &str) -> Option<String> {
    let (name, other) = pairs.first()?;
    Some(format!("{part}: {} photographs {words} (such as {name} and {other})", pairs.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reconstruction::{Image, Reconstruction};

    fn parts(names: &[&[&str]]) -> Vec<Part> {
        let image = |name: &&str| Image { name: name.to_string(), ..Image::default() };
        let part = |(number, names): (usize, &&[&str])| Part {
            name: format!("part_{number}"),
            sfm: Reconstruction { images: names.iter().map(image).collect(), ..Reconstruction::default() },
            superpixels: None,
            anchor: None,
        };
        names.iter().enumerate().map(part).collect()
    }

    fn names(part: &Part) -> Vec<&str> {
        part.sfm.images.iter().map(|image| image.name.as_str()).collect()
    }

    #[test]
    fn a_prefix_is_taken_off_and_told() {
        let mut given = parts(&[&["p1.jpg", "p2.jpg"], &["images/p2.jpg", "images/p3.jpg"], &["p3.JPG", "p1.jpg"]]);
        let warnings = unify_names(&mut given).unwrap();
        assert_eq!(names(&given[1]), ["p2.jpg", "images/p3.jpg"]);
        assert_eq!(names(&given[2]), ["images/p3.jpg", "p1.jpg"]);
        assert!(warnings[0].contains("part_1: 1 photographs") && warnings[0].contains("images/p2.jpg"), "{warnings:?}");
    }

    #[test]
    fn whole_paths_of_two_machines_meet_in_their_last_folder() {
        let mut given = parts(&[&["/home/me/job/photos/1.jpg"], &["D:\\job\\photos\\1.jpg"]]);
        unify_names(&mut given).unwrap();
        assert_eq!(names(&given[1]), ["/home/me/job/photos/1.jpg"]);
    }

    #[test]
    fn pictures_that_two_cameras_number_alike_stay_apart_and_are_told() {
        let mut given = parts(&[&["cam1/1.jpg"], &["cam2/1.jpg"]]);
        let warnings = unify_names(&mut given).unwrap();
        assert_eq!(names(&given[1]), ["cam2/1.jpg"]);
        assert!(warnings[0].contains("base names") && warnings[0].contains("cam1/1.jpg"), "{warnings:?}");
    }

    #[test]
    fn a_name_that_may_mean_two_is_refused() {
        let mut given = parts(&[&["left/1.jpg", "right/1.jpg"], &["1.jpg"]]);
        let error = unify_names(&mut given).unwrap_err().to_string();
        assert!(["part_1", "left/1.jpg", "right/1.jpg"].iter().all(|word| error.contains(word)), "{error}");
    }

    #[test]
    fn names_that_agree_are_left_alone() {
        let mut given = parts(&[&["a/1.jpg", "b/1.jpg"], &["b/1.jpg", "a/1.jpg", "c/2.jpg"]]);
        assert!(unify_names(&mut given).unwrap().is_empty());
        assert_eq!(names(&given[1]), ["b/1.jpg", "a/1.jpg", "c/2.jpg"]);
    }
}
