//! What the program sees in any input, before anything is searched: one [`Inspection`] for each path.
//!
//! A path is asked, by its content, for a reconstruction, a city, positions, control points, in this order; what each reader finds fills the
//! same fields. A new format of a city or a reconstruction needs nothing here but a name.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use crate::city::{CityContents, CityError, CityModel, CityOptions, Crs, read_city, read_city_contents};
use crate::error::Error;
use crate::format::control::{ControlFile, PointSight, read_control_points};
use crate::format::positions::{Frame, PositionsFile, photographs_in, read_positions};
use crate::geometry::{Point3, Vector3};
use crate::limits::Limits;
use crate::planes::up_of_cameras;
use crate::reconstruction::{
    Reconstruction, ReconstructionError, ReconstructionWarning, WarningKind, read_reconstruction,
};

/// What a path holds. Fields that make no sense for it are absent from the JSON.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Inspection {
    pub path: String,
    pub kind: InputKind,
    /// With its version: "CityJSON 2.0".
    pub format: String,
    /// Buildings, or groups of a mesh; parts of others are counted as parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub objects: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parts: Option<usize>,
    /// By level of detail, then by kind (ground, roof, wall), where the format tells them.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub polygons: BTreeMap<String, BTreeMap<String, usize>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<usize>,
    /// Polygons that have some.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holes: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crs: Option<Crs>,
    /// Corners of the box about all, in the file's own system, east and north first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub low: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub high: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub images: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observations: Option<usize>,
    /// Up in the reconstruction's frame, by how its cameras were held.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up_guess: Option<[f64; 3]>,
    /// What coordinates seem to be in, where that is not metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit_guess: Option<String>,
    pub warnings: Vec<String>,
}

/// What an input is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum InputKind {
    #[default]
    City,
    Reconstruction,
    Photographs,
    Positions,
    Points,
}

/// Looks at a path, by content.
pub fn inspect(path: &Path) -> Result<Inspection, Error> {
    if path.is_dir() {
        return inspect_folder(path);
    }
    let no_reconstruction = match read_reconstruction(path) {
        Ok(sfm) => return Ok(Inspection::of_reconstruction(path, &sfm)),
        Err(error) => error,
    };
    // A file that is one, and a bad one, is told by its reader.
    if !matches!(no_reconstruction, ReconstructionError::NotAReconstruction { .. }) {
        return Err(no_reconstruction.into());
    }
    let no_city = match inspect_city(path) {
        Ok(found) => return Ok(found),
        // As above.
        Err(error) if !matches!(error, CityError::OtherFormat { .. } | CityError::UnknownFormat { .. }) => {
            return Err(error.into());
        }
        Err(error) => error,
    };
    if let Ok(points) = read_control_points(path) {
        return Ok(Inspection::of_points(path, &points));
    }
    match (read_positions(path), no_city) {
        (Ok(positions), _) => Ok(Inspection::of_positions(path, InputKind::Positions, &positions)),
        // Where the city's reader knows what it is instead, it says so.
        (Err(error), CityError::UnknownFormat { .. }) => Err(error.into()),
        (Err(_), error) => Err(error.into()),
    }
}

/// What the files of a city hold, and the model that is made of them; what has nothing to align with is told as well.
fn inspect_city(path: &Path) -> Result<Inspection, CityError> {
    let options = CityOptions::default();
    match read_city(path, &[], &options) {
        Ok(city) => {
            let mut found = Inspection::of_city(path, city.sources.iter().map(|source| &source.contents));
            found.add_model(&city);
            Ok(found)
        }
        Err(error @ (CityError::NoFaces { .. } | CityError::OnlyFootprints { .. })) => {
            let contents = read_city_contents(&[path.to_owned()], &options)?;
            let mut found = Inspection::of_city(path, contents.iter().map(|(_, file)| file));
            found.warnings.push("nothing in it can be aligned with: it has no walls and roofs".to_owned());
            if found.objects == Some(0) { Err(error) } else { Ok(found) }
        }
        Err(error) => Err(error),
    }
}

/// A folder holds a reconstruction, or else the tiles of a city, or else photographs.
fn inspect_folder(path: &Path) -> Result<Inspection, Error> {
    let no_model = match read_reconstruction(path) {
        Ok(sfm) => return Ok(Inspection::of_reconstruction(path, &sfm)),
        Err(error) => error,
    };
    if !matches!(no_model, ReconstructionError::NotAReconstruction { .. }) {
        return Err(no_model.into());
    }
    match inspect_city(path) {
        Ok(found) => return Ok(found),
        Err(CityError::EmptyFolder { .. }) => {}
        Err(error) => return Err(error.into()),
    }
    let photographs = photographs_in(path).map_or(0, |found| found.len());
    if photographs == 0 {
        return Err(no_model.into());
    }
    let seen = match read_positions(path) {
        Ok(positions) => Inspection::of_positions(path, InputKind::Photographs, &positions),
        Err(error) => Inspection {
            warnings: vec![error.to_string()],
            ..Inspection::of(path, InputKind::Photographs, "photographs without positions")
        },
    };
    Ok(Inspection { images: Some(photographs), ..seen })
}

impl Inspection {
    fn of(path: &Path, kind: InputKind, format: &str) -> Inspection {
        Inspection { path: path.to_string_lossy().into_owned(), kind, format: format.into(), ..Inspection::default() }
    }

    fn of_city<'a>(path: &Path, contents: impl Iterator<Item = &'a CityContents> + Clone) -> Inspection {
        let format = contents.clone().next().map_or("", |first| first.format.as_str());
        let mut found = Inspection::of(path, InputKind::City, format);
        let sum = |of: fn(&CityContents) -> usize| Some(contents.clone().map(of).sum());
        found.objects = sum(|file| file.objects);
        found.parts = sum(|file| file.parts);
        found.holes = sum(|file| file.holes);
        let levels = contents.clone().flat_map(|file| &file.polygons);
        // Formats without levels and kinds have nothing to tell here.
        for (lod, counts) in levels.filter(|(lod, counts)| lod.is_some() || counts.total() > counts.unsaid) {
            let level = found.polygons.entry(lod.map_or("unsaid".to_owned(), |lod| lod.to_string())).or_default();
            for (kind, count) in counts.named().filter(|(_, count)| *count > 0) {
                *level.entry(kind.to_owned()).or_default() += count;
            }
        }
        found.crs = contents.clone().find_map(|file| file.crs.clone());
        found
    }

    fn add_model(&mut self, city: &CityModel) {
        let absolute = |p: Point3<f64>| (p + city.origin).into();
        self.triangles = Some(city.triangles.len());
        self.low = city.bounds().map(|(low, _)| absolute(low));
        self.high = city.bounds().map(|(_, high)| absolute(high));
        self.warnings = city.warnings.iter().map(ToString::to_string).collect();
    }

    /// What a reconstruction holds.
    pub fn of_reconstruction(path: &Path, sfm: &Reconstruction) -> Inspection {
        let has_images = !sfm.images.is_empty();
        let rotations: Vec<_> = sfm.images.iter().map(|image| image.cam_from_sfm_rotation).collect();
        let up = if has_images { up_of_cameras(&rotations, &Limits::default()) } else { Vec::new() };
        let (low, high) = extent(sfm.points.iter().map(|p| p.coords)).unzip();
        // The file holds them, though no alignment sees them.
        let is_noise = |warning: &&ReconstructionWarning| warning.kind == WarningKind::NoiseLeftOut;
        let noise = sfm.warnings.iter().find(is_noise).map_or(0, |warning| warning.count);
        Inspection {
            images: Some(sfm.images.len()).filter(|_| has_images),
            points: Some(sfm.points.len() + noise),
            observations: Some(sfm.track_elements.len()).filter(|_| has_images),
            up_guess: up.first().map(|candidate| candidate.up.into()),
            low,
            high,
            warnings: sfm.warnings.iter().map(ToString::to_string).collect(),
            crs: sfm.crs.clone(),
            ..Inspection::of(path, InputKind::Reconstruction, &sfm.format.to_string())
        }
    }

    /// What positions of photographs say.
    pub fn of_positions(path: &Path, kind: InputKind, file: &PositionsFile) -> Inspection {
        let places = file.positions.iter().filter_map(|p| {
            let [east, north] = p.east_north?;
            Some(Vector3::new(east, north, p.height_m.unwrap_or(0.0)))
        });
        let (low, high) = extent(places).unzip();
        Inspection {
            images: Some(file.positions.len()),
            crs: crs_of(&file.frame),
            low,
            high,
            warnings: file.warnings.clone(),
            ..Inspection::of(path, kind, file.format)
        }
    }

    /// What control points say.
    pub fn of_points(path: &Path, file: &ControlFile) -> Inspection {
        let places = file.points.iter().map(|p| Vector3::new(p.east_north[0], p.east_north[1], p.height_m));
        let (low, high) = extent(places).unzip();
        let sights = |sight: &PointSight| if let PointSight::In(sights) = sight { sights.len() } else { 0 };
        let observations = file.points.iter().map(|p| sights(&p.sight)).sum();
        Inspection {
            points: Some(file.points.len()),
            observations: Some(observations).filter(|count| *count > 0),
            crs: crs_of(&file.frame),
            low,
            high,
            ..Inspection::of(path, InputKind::Points, file.format)
        }
    }
}

/// Corners of the box about all places.
fn extent(places: impl Iterator<Item = Vector3<f64>>) -> Option<([f64; 3], [f64; 3])> {
    let corners = places.fold(None, |corners: Option<(Vector3<f64>, Vector3<f64>)>, p| {
        Some(corners.map_or((p, p), |(low, high)| (low.inf(&p), high.sup(&p))))
    });
    corners.map(|(low, high)| (low.into(), high.into()))
}

fn crs_of(frame: &Frame) -> Option<Crs> {
    let named = |text: String, epsg| Some(Crs { text, epsg, vertical: None });
    match frame {
        Frame::OfTheCity => None,
        Frame::Epsg(code) => named(format!("EPSG:{code}"), Some(*code)),
        Frame::Proj(text) => named(text.clone(), None),
        Frame::Tangent { latitude_deg, longitude_deg, .. } => {
            named(format!("east, north, up at {latitude_deg}, {longitude_deg} (WGS 84)"), None)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(name: &str, content: &str) -> Result<serde_json::Value, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        let found = inspect(&path).map_err(|error| error.to_string())?;
        Ok(serde_json::to_value(found).unwrap())
    }

    #[test]
    fn every_kind_of_input_is_told_by_its_content_whatever_its_name() {
        let cloud = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n4 5 6\n";
        for (content, kind, format) in [
            ("o house\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n", "city", "OBJ"),
            (cloud, "reconstruction", "PLY"),
            ("p001.jpg 1 2 3\np002.jpg 40 5 6\n", "positions", "name X Y Z"),
            ("EPSG:28992\n1 2 3 4 5 a.jpg g\n1 2 3 4 5 b.jpg g\n", "points", "control points in photographs"),
            ("1 2 3 4 5 6 0.03 g1\n", "points", "control points"),
        ] {
            let found = told("input.dat", content).unwrap();
            assert_eq!((found["kind"].as_str(), found["format"].as_str()), (Some(kind), Some(format)), "{found}");
        }
    }

    #[test]
    fn photographs_are_counted_whether_or_not_they_say_where_they_were_taken() {
        let folder = tempfile::tempdir().unwrap();
        assert!(inspect(folder.path()).unwrap_err().to_string().contains("expected a folder with cameras"));
        std::fs::write(folder.path().join("a.jpg"), [0xFF, 0xD8]).unwrap();
        let found = inspect(folder.path()).unwrap();
        assert_eq!((found.kind, found.images), (InputKind::Photographs, Some(1)));
        assert!(found.warnings[0].contains("says where it was taken"), "{:?}", found.warnings);
    }

    #[test]
    fn extents_are_absolute_and_what_makes_no_sense_is_absent() {
        let found = told("a.obj", "v 90000 0 0\nv 90010 0 0\nv 90000 0 7\nf 1 2 3\n").unwrap();
        assert_eq!(
            (&found["low"], &found["high"]),
            (&serde_json::json!([90000.0, 0.0, 0.0]), &serde_json::json!([90010.0, 0.0, 7.0]))
        );
        assert_eq!((found["triangles"].as_u64(), found["objects"].as_u64()), (Some(1), Some(1)));
        assert!(found.get("images").is_none() && found.get("polygons").is_none() && found["warnings"].is_array());
        let found = told("a.txt", "EPSG:28992\na.jpg 1 2 3 0 0 0 3 6\n").unwrap();
        assert_eq!((found["crs"]["epsg"].as_u64(), found["images"].as_u64()), (Some(28992), Some(1)));
    }

    #[test]
    fn what_cannot_be_read_is_told_by_the_reader_that_knows_it() {
        for (name, content, says) in [
            ("a.obj", "v 0 0 0\n", "no faces"),
            ("a.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nend_header\n", "a.ply"),
            ("a.txt", "hello there\n", "name"),
            ("a.gml", "<kml/>", "KML"),
        ] {
            let message = told(name, content).unwrap_err();
            assert!(message.contains(says) && message.contains(name), "{message}");
        }
    }
}
