//! Finds the files of images in a folder: photographs, or label images.

use std::collections::VecDeque;
use std::path::{Component, Path, PathBuf};

use super::{ImageryError, SuperpixelSource};
use crate::format::file::is_there;
use crate::reconstruction::{AmbiguousName, NameMatch, match_names};

/// Extensions of photographs, and of label images; in any case.
const PHOTO_EXTENSIONS: [&str; 3] = ["jpg", "jpeg", "png"];
const LABEL_EXTENSIONS: [&str; 1] = ["png"];

/// Files below a folder that are looked at, and how deep; a wrong path may lead to a whole disk.
const MOST_FILES: usize = 1_000_000;
const DEPTH: usize = 8;

/// The file of each image, and how it was found: by the image's name, then by [`match_names`] among the pictures that lie below the
/// folder. Names come out of files, so one that leads elsewhere finds only what lies below by its ending.
pub(super) fn find_pictures(
    source: &SuperpixelSource,
    names: &[&str],
) -> Result<Vec<Option<(PathBuf, NameMatch)>>, ImageryError> {
    let (folder, extensions) = match source {
        SuperpixelSource::Labels(folder) => (folder, LABEL_EXTENSIONS.as_slice()),
        SuperpixelSource::Photos(folder) => (folder, PHOTO_EXTENSIONS.as_slice()),
    };
    let at_once: Vec<Option<PathBuf>> = names.iter().map(|name| by_name(folder, name, source)).collect();
    if at_once.iter().all(Option::is_some) {
        return Ok(at_once.into_iter().map(|path| Some((path?, NameMatch::Path))).collect());
    }
    let present = pictures_below(folder, extensions);
    let present: Vec<&str> = present.iter().map(String::as_str).collect();
    let found = match_names(names, &present).map_err(|AmbiguousName { name, first, second }| {
        ImageryError::Ambiguous { noun: source.noun(), name, first, second, folder: folder.clone() }
    })?;
    let path = |found: Option<(usize, NameMatch)>| found.map(|(place, how)| (folder.join(present[place]), how));
    Ok(found.into_iter().map(path).collect())
}

/// What a label image of an image may be called, for messages.
pub(super) fn looked_for(source: &SuperpixelSource, name: &str) -> String {
    match source {
        SuperpixelSource::Photos(_) => name.to_owned(),
        SuperpixelSource::Labels(_) => {
            let stem = Path::new(name).with_extension("png");
            format!("{} (or {name}.png)", stem.display())
        }
    }
}

/// The file of the image's own name, or for labels of the usual one.
fn by_name(folder: &Path, name: &str, source: &SuperpixelSource) -> Option<PathBuf> {
    let stays = Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !stays || name.is_empty() || name.contains('\\') {
        return None;
    }
    let named = match source {
        SuperpixelSource::Photos(_) => folder.join(name),
        SuperpixelSource::Labels(_) => folder.join(name).with_extension("png"),
    };
    is_there(&named).then_some(named)
}

/// Pictures below a folder by their path in it, with `/` between folders; in the order of their names.
fn pictures_below(folder: &Path, extensions: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    let mut looked_at = 0;
    let mut folders = VecDeque::from([(folder.to_path_buf(), String::new(), 0)]);
    while let Some((folder, prefix, depth)) = folders.pop_front() {
        let mut entries: Vec<_> = std::fs::read_dir(&folder).into_iter().flatten().flatten().collect();
        entries.sort_by_key(std::fs::DirEntry::file_name);
        looked_at += entries.len();
        for entry in entries {
            let name = entry.file_name();
            let path = format!("{prefix}{}", name.to_string_lossy());
            let is_picture = |extension: &std::ffi::OsStr| extensions.iter().any(|e| extension.eq_ignore_ascii_case(e));
            if entry.path().is_dir() {
                if depth < DEPTH && looked_at < MOST_FILES {
                    folders.push_back((entry.path(), format!("{path}/"), depth + 1));
                }
            } else if Path::new(&name).extension().is_some_and(is_picture) {
                found.push(path);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, b"x").unwrap();
        }
        folder
    }

    fn found(source: &SuperpixelSource, name: &str) -> Option<String> {
        let (path, _) = find_pictures(source, &[name]).unwrap().remove(0)?;
        Some(path.strip_prefix(source.folder()).unwrap().to_str().unwrap().replace('\\', "/"))
    }

    #[test]
    fn names_that_lead_out_of_the_folder_find_only_what_lies_in_it() {
        let folder = folder(&["a.png", "in/b.png"]);
        let source = SuperpixelSource::Photos(folder.path().join("in"));
        assert_eq!(found(&source, "../a.png"), None);
        assert_eq!(found(&source, folder.path().join("a.png").to_str().unwrap()), None);
        assert_eq!(found(&source, ""), None);
        assert_eq!(found(&source, "../../b.png").as_deref(), Some("b.png"));
    }

    #[test]
    fn other_extensions_cases_and_folders_are_found() {
        let folder = folder(&["left/b.JPEG", "left/b.png", "c.tif", "c.PNG"]);
        let photos = SuperpixelSource::Photos(folder.path().into());
        assert_eq!(found(&photos, "left/b.jpg").as_deref(), Some("left/b.JPEG"));
        assert_eq!(found(&photos, "left\\b.jpg").as_deref(), Some("left/b.JPEG"));
        assert_eq!(found(&photos, "images/C.tif").as_deref(), Some("c.PNG"));
        let labels = SuperpixelSource::Labels(folder.path().into());
        assert_eq!(found(&labels, "left/b.jpg").as_deref(), Some("left/b.png"));
        assert_eq!(found(&labels, "d.jpg"), None);
    }

    #[test]
    fn label_images_may_be_named_as_masks_of_colmap() {
        let folder = folder(&["a.jpg.png", "b.png"]);
        let labels = SuperpixelSource::Labels(folder.path().into());
        assert_eq!(found(&labels, "a.jpg").as_deref(), Some("a.jpg.png"));
        assert_eq!(looked_for(&labels, "a.jpg"), "a.png (or a.jpg.png)");
    }

    #[test]
    fn two_files_that_may_be_meant_are_an_error_that_names_both() {
        let folder = folder(&["left/b.jpg", "right/b.jpg"]);
        let error = find_pictures(&SuperpixelSource::Photos(folder.path().into()), &["b.jpg"]).unwrap_err().to_string();
        assert!(
            error.contains("left/b.jpg") && error.contains("right/b.jpg") && error.contains("photograph"),
            "{error}"
        );
    }
}
