//! What lies at a path, as far as names and the first bytes tell.

use std::collections::VecDeque;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::format::JsonKind;
use crate::format::city_index::is_city_index;
use crate::format::colmap::missing_files;
use crate::format::file::open_regular;
use crate::format::gltf::is_glb;
use crate::reconstruction::{SfmSource, recognise};

use super::Role;

/// Bytes of a file that are looked at.
const LOOKED_AT: u64 = 1 << 16;

/// Folders that are looked at below one, and images in each; a wrong path may lead to a whole disk.
const FOLDERS_LOOKED_AT: usize = 200;
const IMAGES_LOOKED_AT: usize = 64;

/// Files of a folder that are looked into for a city, and their endings.
const CITIES_LOOKED_AT: usize = 8;
const CITY_ENDINGS: [&str; 12] =
    ["obj", "gltf", "glb", "json", "jsonl", "cityjson", "gml", "xml", "b3dm", "stl", "shp", "gpkg"];

/// What the JSON of a city has near its beginning: glTF, CityJSON.
const CITY_KEYS: [&str; 3] = ["\"asset\"", "\"CityJSON", "\"CityObjects\""];

/// Where a model is missed when some of its files are there.
const MODEL_SUBFOLDERS: [&str; 4] = ["", "sparse/0", "sparse", "0"];

/// What is seen at a path. Several things may be: a project's folder holds images and a model.
#[derive(Debug, Default)]
pub struct Glance {
    pub is_city: bool,
    pub json: Option<JsonKind>,
    /// The first JPEG file, or PNG file in colour.
    photograph: Option<PathBuf>,
    /// The first PNG file in grey; photographs may be grey, too.
    grey_image: Option<PathBuf>,
    /// A reconstruction that is no COLMAP model.
    other_sfm: Option<SfmSource>,
    model: Option<Model>,
    /// The report in a folder that an alignment has become.
    report: Option<PathBuf>,
}

#[derive(Debug)]
enum Model {
    AtHand,
    /// Some of its files.
    InPart,
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
        // A city's JSON has a `transform` as well as an alignment.
        let is_city_json = is_json && CITY_KEYS.iter().any(|key| text.contains(key));
        let json = match is_json {
            true if is_city_json => JsonKind::by_schema(text),
            true => JsonKind::of(text).or_else(|| kind_of_long(text)),
            false => None,
        };
        let (model, other_sfm) = sfm_at(path);
        let is_named = |endings: &[&str]| {
            path.extension().is_some_and(|is| endings.iter().any(|ending| is.eq_ignore_ascii_case(ending)))
        };
        let is_city = is_glb(&start)
            || is_city_index(&start)
            || (is_json && json.is_none() && (is_city_json || is_named(&["gltf"])))
            || (!is_json && other_sfm.is_none() && (is_named(&["obj"]) || text.lines().any(is_obj_vertex)));
        let model = model.filter(|_| !is_city);
        Glance { is_city, json, other_sfm, model, ..Glance::default() }
    }

    fn at_folder(path: &Path) -> Glance {
        let report = Some(path.join("alignment.json")).filter(|report| report.is_file());
        let (model, other_sfm) = sfm_at(path);
        let mut found = Glance { report, model, other_sfm, ..Glance::default() };
        let is_part = |sub: &str| [1, 2].contains(&missing_files(&path.join(sub)).len());
        if found.model.is_none() && found.other_sfm.is_none() && MODEL_SUBFOLDERS.iter().any(|sub| is_part(sub)) {
            found.model = Some(Model::InPart);
        }
        let (mut looked_at, mut cities_looked_at) = (0, 0);
        let top = path.to_path_buf();
        let mut folders = VecDeque::from([top.clone()]);
        while let Some(folder) = folders.pop_front().filter(|_| looked_at < FOLDERS_LOOKED_AT) {
            looked_at += 1;
            let mut images = 0;
            for path in entries(&folder) {
                if path.is_dir() {
                    folders.push_back(path);
                } else if folder == top && is_city_file(&path, &mut cities_looked_at) {
                    found.is_city = true;
                } else if images < IMAGES_LOOKED_AT {
                    images += usize::from(found.adds_image(path));
                }
            }
        }
        // Models of a city may lie beside a reconstruction of it.
        found.is_city &= found.model.is_none();
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
        let is_other = self.is_city || self.json.is_some() || self.other_sfm.is_some() || self.has_images();
        // What a model lacks is told by its reader.
        !matches!(self.model, Some(Model::InPart)) && (is_other || self.model.is_some())
    }

    pub fn is_reconstruction(&self) -> bool {
        self.other_sfm.is_some() || matches!(self.model, Some(Model::AtHand))
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
        if let (Some(report), Role::Start | Role::Alignment) = (&self.report, role) {
            return Some(format!("a folder, expected {}; give {}", expected(role), report.display()));
        }
        let remedy = match role {
            // What is in a PLY file may be a city; its reader asks for another format.
            Role::City | Role::Terrain | Role::CityOption if matches!(self.other_sfm, Some(SfmSource::Ply(_))) => {
                return None;
            }
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
        if let (Some(source), false) = (&self.other_sfm, self.is_city) {
            return words_of(source).into();
        }
        match (self.json, image) {
            (Some(kind), _) => kind.words().into(),
            _ if self.is_city => "a city model".into(),
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
            None if self.other_sfm.is_some() || self.model.is_some() => "give it as the reconstruction",
            None if self.grey_image.is_none() => "give photographs with --photos",
            None => "give photographs with --photos, label images with --labels",
        }
    }
}

/// The reconstruction that is read from a path: a COLMAP model, or another.
fn sfm_at(path: &Path) -> (Option<Model>, Option<SfmSource>) {
    match recognise(path) {
        Ok(SfmSource::Colmap(_)) => (Some(Model::AtHand), None),
        Ok(other) => (None, Some(other)),
        Err(_) => (None, None),
    }
}

fn words_of(source: &SfmSource) -> &'static str {
    match source {
        SfmSource::Colmap(_) => "a COLMAP model",
        SfmSource::Ply(_) => "a PLY cloud",
        SfmSource::Las(_) => "a LAS cloud",
        SfmSource::E57(_) => "an E57 cloud",
        SfmSource::OpenSfm(_) => "a reconstruction of OpenSfM",
        SfmSource::Nerfstudio(_) => "cameras of nerfstudio",
        SfmSource::OpenMvg(_) => "a reconstruction of OpenMVG",
        SfmSource::Bundler(_) => "a reconstruction of Bundler",
        SfmSource::Nvm(_) => "a reconstruction of VisualSFM",
    }
}

fn expected(role: Role) -> &'static str {
    match role {
        Role::City | Role::Terrain | Role::CityOption => "a city model (CityJSON, CityGML, OBJ, glTF, 3D Tiles, ...)",
        Role::Sfm | Role::Part => "a reconstruction (a COLMAP folder, a cloud, or what other tools wrote)",
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

/// Whether one of the first files of a folder is a city model; others are not opened.
fn is_city_file(path: &Path, looked_at: &mut usize) -> bool {
    let may_be = path.extension().is_some_and(|is| CITY_ENDINGS.iter().any(|ending| is.eq_ignore_ascii_case(ending)));
    if !may_be || *looked_at >= CITIES_LOOKED_AT {
        return false;
    }
    *looked_at += 1;
    Glance::at_file(path).is_city
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
