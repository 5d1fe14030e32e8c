//! What lies at a path, as far as names and the first bytes tell.

use std::collections::VecDeque;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::format::JsonKind;
use crate::format::colmap::missing_files;
use crate::format::file::open_regular;
use crate::format::gltf::is_glb;
use crate::format::ply::is_ply;

use super::Role;

/// Bytes of a file that are looked at.
const LOOKED_AT: u64 = 1 << 16;

/// Folders that are looked at below one, and images in each; a wrong path may lead to a whole disk.
const FOLDERS_LOOKED_AT: usize = 200;
const IMAGES_LOOKED_AT: usize = 64;

/// Where a model is read from below the folder that is given, without a word.
const MODEL_SUBFOLDERS: [&str; 4] = ["", "sparse/0", "sparse", "0"];

/// Files of a model, one of which may stand for all.
const MODEL_STEMS: [&str; 5] = ["cameras", "images", "points3D", "rigs", "frames"];

/// What is seen at a path. Several things may be: a project's folder holds images and a model.
#[derive(Debug, Default)]
pub struct Glance {
    pub is_city: bool,
    pub json: Option<JsonKind>,
    /// The first JPEG file, or PNG file in colour.
    photograph: Option<PathBuf>,
    /// The first PNG file in grey; photographs may be grey, too.
    grey_image: Option<PathBuf>,
    is_cloud: bool,
    model: Option<Model>,
    /// The report in a folder that an alignment has become.
    report: Option<PathBuf>,
}

#[derive(Debug)]
enum Model {
    AtHand,
    /// Some of its files.
    InPart,
    Below(PathBuf),
}

impl Glance {
    pub fn at(path: &Path) -> Glance {
        match path.metadata() {
            Ok(found) if found.is_dir() => Glance::at_folder(path),
            // Pipes are not opened: to look is to wait.
            Ok(found) if found.is_file() => Glance::at_file(path),
            _ => Glance::default(),
        }
    }

    fn at_file(path: &Path) -> Glance {
        let start = start_of(path, LOOKED_AT);
        let text = String::from_utf8_lossy(&start);
        let text = text.trim_start_matches('\u{feff}').trim_start();
        let is_json = text.starts_with('{');
        let json = if is_json { JsonKind::of(text).or_else(|| kind_of_long(text)) } else { None };
        let is_cloud = is_ply(&start);
        let is_named = |endings: &[&str]| {
            path.extension().is_some_and(|is| endings.iter().any(|ending| is.eq_ignore_ascii_case(ending)))
        };
        let is_city = is_glb(&start)
            || (is_json && json.is_none() && (is_named(&["gltf"]) || text.contains("\"asset\"")))
            || (!is_json && !is_cloud && (is_named(&["obj"]) || text.lines().any(is_obj_vertex)));
        let stands_for_model = path.file_stem().is_some_and(|stem| MODEL_STEMS.iter().any(|known| stem == *known))
            && !is_city
            && !is_cloud;
        let model = path.parent().filter(|folder| stands_for_model && missing_files(folder).is_empty());
        Glance { is_city, json, is_cloud, model: model.map(|_| Model::AtHand), ..Glance::default() }
    }

    fn at_folder(path: &Path) -> Glance {
        let report = Some(path.join("alignment.json")).filter(|report| report.is_file());
        let mut found = Glance { report, ..Glance::default() };
        for sub in MODEL_SUBFOLDERS {
            match missing_files(&path.join(sub)).len() {
                0 => found.model = Some(Model::AtHand),
                1 | 2 if found.model.is_none() => found.model = Some(Model::InPart),
                _ => {}
            }
        }
        let mut looked_at = 0;
        let mut folders = VecDeque::from([path.to_path_buf()]);
        while let Some(folder) = folders.pop_front().filter(|_| looked_at < FOLDERS_LOOKED_AT) {
            looked_at += 1;
            if found.model.is_none() && missing_files(&folder).is_empty() {
                found.model = Some(Model::Below(folder.clone()));
            }
            let mut images = 0;
            for path in entries(&folder) {
                if path.is_dir() {
                    folders.push_back(path);
                } else if images < IMAGES_LOOKED_AT {
                    images += usize::from(found.adds_image(path));
                }
            }
        }
        found
    }

    fn adds_image(&mut self, path: PathBuf) -> bool {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let place = match ending.as_deref() {
            Some("png") if is_grey(&path) => &mut self.grey_image,
            Some("jpg" | "jpeg" | "png") => &mut self.photograph,
            _ => return false,
        };
        place.get_or_insert(path);
        true
    }

    /// True where anything was recognised.
    pub fn is_known(&self) -> bool {
        let is_other = self.is_city || self.json.is_some() || self.is_cloud || self.has_images();
        // What a model lacks is told by its reader.
        !matches!(self.model, Some(Model::InPart)) && (is_other || self.model.is_some())
    }

    pub fn is_reconstruction(&self) -> bool {
        self.is_cloud || matches!(self.model, Some(Model::AtHand))
    }

    pub fn has_images(&self) -> bool {
        self.photograph.is_some() || self.grey_image.is_some()
    }

    /// Previews may lie beside label images, so one grey image is enough.
    pub fn may_be_labels(&self) -> bool {
        self.grey_image.is_some()
    }

    /// What is wrong with this in a role, and where it belongs; `None` where the reader of the role says it better.
    pub fn complaint(&self, role: Role) -> Option<String> {
        if let (Some(Model::Below(folder)), Role::Sfm | Role::Part) = (&self.model, role) {
            let folder = folder.display();
            return Some(format!("a folder without a model of its own, but one lies in {folder}; give that"));
        }
        if let (Some(report), Role::Start | Role::Alignment) = (&self.report, role) {
            return Some(format!("a folder, expected {}; give {}", expected(role), report.display()));
        }
        let remedy = match role {
            // What is in a PLY file may be a city; its reader asks for another format.
            Role::City | Role::Terrain | Role::CityOption if self.is_cloud => return None,
            Role::City if self.model.is_some() => "the city comes first, the reconstruction second",
            Role::Sfm if self.is_city => {
                "the city comes first, the reconstruction second (further meshes go with --terrain)"
            }
            Role::Part if self.is_city => "give a city with --city and a --start for every part",
            // Which JSON file it is, is told by what reads it.
            Role::Start | Role::Alignment if self.json.is_some() => return None,
            _ => self.place(),
        };
        Some(format!("{}, expected {}; {remedy}", self.words(), expected(role)))
    }

    fn words(&self) -> String {
        let image = self.photograph.as_ref().or(self.grey_image.as_ref());
        match (self.json, image) {
            (Some(kind), _) => kind.words().into(),
            _ if self.is_city => "a city model".into(),
            _ if self.is_cloud => "a PLY cloud".into(),
            _ if self.model.is_some() => "a COLMAP model".into(),
            (_, Some(image)) => format!("a folder of images ({})", image.file_name().unwrap_or_default().display()),
            _ => "something else".into(),
        }
    }

    fn place(&self) -> &'static str {
        match self.json {
            Some(JsonKind::Start) => "give it with --start",
            Some(JsonKind::Alignment) => {
                "give it with --start to align again, or with --alignment to `cityweld export`"
            }
            Some(_) => "`cityweld --help` shows what goes where",
            None if self.is_city => "give it as CITY",
            None if self.is_cloud || self.model.is_some() => "give it as the reconstruction",
            None if self.grey_image.is_none() => "give photographs with --photos",
            None => "give photographs with --photos, label images with --labels",
        }
    }
}

fn expected(role: Role) -> &'static str {
    match role {
        Role::City | Role::Terrain | Role::CityOption => "a city model (OBJ, glTF or GLB)",
        Role::Sfm | Role::Part => "a reconstruction (a folder with a COLMAP model, or a PLY cloud)",
        Role::Start => "a start (JSON), or an alignment.json",
        Role::Alignment => "an alignment.json",
        Role::Labels => "a folder of label images (PNG, grey)",
        Role::Photos => "a folder of images (JPEG or PNG)",
        Role::Points => "control points (x y z X Y Z [sigma [name]], or gcp_list.txt)",
        Role::Positions => {
            "positions of photographs (a folder with EXIF, database.db, geo.txt, a table, or name X Y Z)"
        }
    }
}

fn is_obj_vertex(line: &str) -> bool {
    let numbers = line.strip_prefix("v ").map(|rest| rest.split_whitespace().take(3).map(str::parse::<f64>));
    numbers.is_some_and(|numbers| numbers.filter(Result::is_ok).count() == 3)
}

/// Reports that are longer than what is looked at name their schema first.
fn kind_of_long(text: &str) -> Option<JsonKind> {
    let (_, rest) = text.split_once("\"schema\"")?;
    let name = rest.split('"').nth(1)?;
    JsonKind::by_schema(&format!("{{\"schema\": {}}}", serde_json::Value::from(name)))
}

fn start_of(path: &Path, bytes: u64) -> Vec<u8> {
    let mut start = Vec::new();
    let _ = open_regular(path).and_then(|file| file.take(bytes).read_to_end(&mut start));
    start
}

/// The sort of a PNG's samples stands at a fixed place of its first chunk (PNG specification, 11.2.1): 0 and 4 are grey.
fn is_grey(path: &Path) -> bool {
    const SORT_AT: usize = 25;
    let start = start_of(path, SORT_AT as u64 + 1);
    start.starts_with(b"\x89PNG") && start.get(SORT_AT).is_some_and(|sort| [0, 4].contains(sort))
}

/// In the order of their names; empty where they cannot be read.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn what_would_be_waited_for_is_not_looked_into() {
        let folder = tempfile::tempdir().unwrap();
        // As a device that calls itself a regular file: /proc/kmsg, which is not for everybody to read.
        let pipe = folder.path().join("pipe.png");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(start_of(&pipe, LOOKED_AT).is_empty() && !is_grey(&pipe));
    }
}
