//! The parts of a merge: as they were given, or all models of one folder.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::format::colmap::missing_files;

/// Where models lie below a folder that is a part.
const MODEL_SUBFOLDERS: [&str; 4] = ["", "sparse/0", "sparse", "0"];

/// Two parts and more are taken as they stand; one folder stands for the models in it, as COLMAP's mapper leaves them (`sparse/0`,
/// `sparse/1`, ...), and for its PLY clouds where it has no model.
pub fn parts(given: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let [parent] = given else { return Ok(given.to_vec()) };
    ensure!(
        parent.is_dir(),
        "one part alone cannot be joined to another; give two parts or more, or a folder that holds them: {}",
        parent.display()
    );
    let mut tried = Vec::new();
    for folder in [parent.clone(), parent.join("sparse")] {
        if !folder.is_dir() {
            continue;
        }
        let found = models_in(&folder)?;
        if found.len() > 1 {
            return Ok(found);
        }
        tried.push(found.len());
    }
    let most = tried.into_iter().max().unwrap_or(0);
    anyhow::bail!(
        "the folder holds {most} reconstructions, expected two or more (folders with COLMAP models, or PLY clouds): {}",
        parent.display()
    )
}

fn models_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries =
        std::fs::read_dir(folder).with_context(|| format!("cannot read the folder of parts: {}", folder.display()))?;
    let mut paths: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    paths.sort_by_key(|path| (number_of(path), path.clone()));
    let (models, clouds): (Vec<_>, Vec<_>) =
        paths.into_iter().filter(|p| is_model(p) || is_cloud(p)).partition(|p| is_model(p));
    Ok(if models.is_empty() { clouds } else { models })
}

fn is_model(path: &Path) -> bool {
    path.is_dir() && MODEL_SUBFOLDERS.iter().any(|sub| missing_files(&path.join(sub)).is_empty())
}

fn is_cloud(path: &Path) -> bool {
    path.is_file() && path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ply"))
}

/// COLMAP numbers its models: 10 comes after 9. Other names come last, in their own order.
fn number_of(path: &Path) -> u64 {
    path.file_name().and_then(|name| name.to_str()?.parse().ok()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(models: &[&str], files: &[&str]) -> tempfile::TempDir {
        let room = tempfile::tempdir().unwrap();
        for model in models {
            std::fs::create_dir_all(room.path().join(model)).unwrap();
            for stem in ["cameras", "images", "points3D"] {
                std::fs::write(room.path().join(model).join(stem).with_extension("bin"), "").unwrap();
            }
        }
        files.iter().for_each(|file| std::fs::write(room.path().join(file), "").unwrap());
        room
    }

    fn found(room: &tempfile::TempDir) -> Result<Vec<String>> {
        let paths = parts(&[room.path().to_path_buf()])?;
        Ok(paths.iter().map(|p| p.strip_prefix(room.path()).unwrap().to_string_lossy().into_owned()).collect())
    }

    #[test]
    fn one_folder_stands_for_its_models_in_the_order_of_their_numbers() {
        assert_eq!(found(&folder(&["0", "1", "10", "2", "west"], &["a.ply"])).unwrap(), ["0", "1", "2", "10", "west"]);
        assert_eq!(found(&folder(&["sparse/0", "sparse/1"], &[])).unwrap(), ["sparse/0", "sparse/1"]);
        assert_eq!(found(&folder(&["east/sparse/0", "west/sparse/0"], &[])).unwrap(), ["east", "west"]);
        assert_eq!(found(&folder(&[], &["b.ply", "a.PLY", "notes.txt"])).unwrap(), ["a.PLY", "b.ply"]);
    }

    #[test]
    fn a_folder_with_fewer_than_two_is_refused_with_their_number() {
        let message = found(&folder(&["0"], &["notes.txt"])).unwrap_err().to_string();
        assert!(message.contains("holds 1 reconstructions, expected two or more"), "{message}");
        let file = parts(&[PathBuf::from("none.ply")]).unwrap_err().to_string();
        assert!(file.contains("one part alone") && file.contains("none.ply"), "{file}");
        let two = [PathBuf::from("a"), PathBuf::from("b")];
        assert_eq!(parts(&two).unwrap(), two);
    }
}
