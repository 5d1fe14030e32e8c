//! A city model out of polygons that a program already holds.

use std::path::PathBuf;

use super::build::build;
use super::source::{Source, written_precision};
use super::{CityContents, CityError, CityModel, CityRole};
use crate::geometry::Point3;

/// What messages and [`super::CitySource::path`] name in the place of a file.
const NO_FILE: &str = "polygons";

impl CityModel {
    /// A model of polygons instead of files. Each is the name of its object and its corners in metres, z up, counter-clockwise
    /// seen from outside; polygons of one name that follow each other are one object. Treated like a file: coordinates are
    /// shifted to a local origin, equal corners joined, oddities counted in [`CityModel::warnings`].
    pub fn from_polygons<Name: AsRef<str>>(polygons: &[(Name, Vec<Point3<f64>>)]) -> Result<CityModel, CityError> {
        let mut objects: Vec<String> = Vec::new();
        let mut face_objects = Vec::with_capacity(polygons.len());
        let mut positions = Vec::new();
        let mut face_ends = Vec::with_capacity(polygons.len());
        for (polygon, (object, corners)) in polygons.iter().enumerate() {
            let object = object.as_ref();
            if let Some(corner) = corners.iter().find(|c| !c.iter().all(|v| v.is_finite())) {
                let corner = [corner.x, corner.y, corner.z];
                return Err(CityError::CornerNotFinite { polygon, object: object.to_owned(), corner });
            }
            if objects.last().is_none_or(|last| last != object) {
                objects.push(object.to_owned());
            }
            face_objects.push(objects.len() as u32 - 1);
            positions.extend_from_slice(corners);
            let too_large = || CityError::TooLarge { path: PathBuf::from(NO_FILE) };
            face_ends.push(u32::try_from(positions.len()).map_err(|_| too_large())?);
        }
        build(vec![Source {
            path: PathBuf::from(NO_FILE),
            role: CityRole::City,
            precision_m: written_precision(&positions, 0.0),
            corners: (0..positions.len() as u32).collect(),
            positions,
            face_ends,
            holes: Vec::new(),
            face_lines: Vec::new(),
            face_kinds: Vec::new(),
            face_objects,
            contents: CityContents::plain("polygons", objects.len(), polygons.len()),
            objects,
            shares_vertices: false,
            warnings: Vec::new(),
        }])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64) -> Vec<Point3<f64>> {
        [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)].map(|(x, y)| Point3::new(x, y, z)).to_vec()
    }

    #[test]
    fn polygons_become_facets_of_the_objects_that_they_name() {
        let city = CityModel::from_polygons(&[("a", square(0.0)), ("a", square(3.0)), ("b", square(9.0))]).unwrap();
        assert_eq!(city.objects, ["a", "b"]);
        let objects: Vec<u32> = city.facets.iter().map(|f| f.object.0).collect();
        assert_eq!(objects, [0, 0, 1]);
        assert!(city.facets.iter().all(|f| f.area == 16.0 && f.plane.normal.z == 1.0));
        let corner = city.vertices[city.facets[2].outline[0] as usize] + city.origin;
        assert!((corner - Point3::new(0.0, 0.0, 9.0)).norm() < 1e-12);
    }

    #[test]
    fn refuses_corners_that_are_nowhere_and_polygons_that_are_none() {
        let mut nowhere = square(0.0);
        nowhere[1].y = f64::NAN;
        let error = CityModel::from_polygons(&[("a", square(0.0)), ("b", nowhere)]).unwrap_err().to_string();
        assert!(error.starts_with("polygon 1 of object b has a corner at (4, NaN, 0)"), "{error}");
        assert!(matches!(CityModel::from_polygons::<&str>(&[]), Err(CityError::NoFaces { .. })));
    }
}
