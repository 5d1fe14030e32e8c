//! What a report says of the input.

use serde::Serialize;

use crate::city::{CityModel, CitySize, Crs};
use crate::georeference::Estimate;
use crate::reconstruction::Reconstruction;

/// What went in, for the record. Files by their names alone, so that a moved data set gives the same report.
#[derive(Clone, Debug, Serialize)]
pub struct InputSummary {
    pub city: CityCounts,
    pub sfm: SfmCounts,
    /// The start that was used; it stands under `prior`.
    #[serde(skip)]
    pub prior: Option<Estimate>,
}

#[derive(Clone, Debug, Serialize)]
pub struct CityCounts {
    pub files: Vec<String>,
    /// Stands for itself in the report.
    #[serde(skip)]
    pub crs: Option<Crs>,
    pub objects: usize,
    pub facets: usize,
    pub triangles: usize,
}

#[derive(Clone, Debug, Serialize)]
pub struct SfmCounts {
    pub file: String,
    pub images: usize,
    pub points: usize,
    pub observations: usize,
    /// Those of labels or photographs that points fall on; `None` where neither was given.
    pub superpixels: Option<usize>,
}

impl CityCounts {
    pub fn of(city: &CityModel, files: Vec<String>) -> CityCounts {
        // Of the whole city, however much of it was read.
        let CitySize { objects, facets, triangles } = city.whole_size();
        CityCounts { files, crs: city.crs.clone(), objects, facets, triangles }
    }
}

impl SfmCounts {
    pub fn of(sfm: &Reconstruction, file: String, superpixels: Option<usize>) -> SfmCounts {
        SfmCounts {
            file,
            images: sfm.images.len(),
            points: sfm.points.len(),
            observations: sfm.track_elements.len(),
            superpixels,
        }
    }
}
