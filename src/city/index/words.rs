//! What an index says of the city as a whole; JSON in its directory.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::stamp::{FileStamp, FolderStamp};
use crate::city::{CityContents, CityModel, CityRole, CitySize, CitySource, CityWarning, Crs, WholeCity};
use crate::format::city_index::IndexFault;
use crate::geometry::Point3;

/// What an index says of the city as a whole.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Words {
    /// Who wrote it.
    pub program: String,
    pub origin: [f64; 3],
    pub crs: Option<Crs>,
    pub size: CitySize,
    /// Lowest and highest corner of the box about all vertices; metres about the origin.
    pub bounds: [[f64; 3]; 2],
    pub vertices: VertexNumbers,
    pub sources: Vec<SourceWords>,
    pub warnings: Vec<CityWarning>,
    pub files: Vec<FileStamp>,
    pub folders: Vec<FolderStamp>,
}

/// What the order of a vertex tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub(super) enum VertexNumbers {
    /// Vertices of two blocks are one if they have the same order.
    OfCity,
    /// ... if they are at the same place; then the lower order counts.
    ByPlace,
}

/// What one file gave to the model.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct SourceWords {
    pub path: String,
    pub role: CityRole,
    /// Orders of its facets and objects: from, to.
    pub facets: [u32; 2],
    pub objects: [u32; 2],
    pub precision_m: f64,
    pub contents: CityContents,
}

impl SourceWords {
    fn of(source: &CitySource) -> SourceWords {
        SourceWords {
            path: source.path.to_string_lossy().into_owned(),
            role: source.role,
            facets: [source.facets.start, source.facets.end],
            objects: [source.objects.start, source.objects.end],
            precision_m: source.precision_m,
            contents: source.contents.clone(),
        }
    }

    /// With the facets and objects that are there of it.
    pub fn source(&self, facets: std::ops::Range<u32>, objects: std::ops::Range<u32>) -> CitySource {
        CitySource {
            path: Path::new(&self.path).to_owned(),
            role: self.role,
            facets,
            objects,
            precision_m: self.precision_m,
            contents: self.contents.clone(),
        }
    }
}

impl Words {
    /// Reads the words of a directory, whose numbers must make sense.
    pub fn read(json: &[u8]) -> Result<Words, IndexFault> {
        let nonsense = |found: String| IndexFault::Nonsense { what: "the directory", at: 0, found };
        let words: Words = serde_json::from_slice(json).map_err(|error| nonsense(error.to_string()))?;
        let is_place = words.origin.iter().chain(words.bounds.iter().flatten()).all(|value| value.is_finite());
        let is_forward = |[from, to]: [u32; 2]| from <= to;
        let are_sources = words.sources.iter().all(|source| is_forward(source.facets) && is_forward(source.objects));
        match is_place && are_sources {
            true => Ok(words),
            false => Err(nonsense("an origin that is nowhere, or files that end before they begin".to_owned())),
        }
    }

    /// What is told to a part of it.
    pub fn whole(&self) -> WholeCity {
        let [low, high] = self.bounds.map(Point3::from);
        WholeCity { size: self.size, low, high }
    }

    /// Of files whose model is not there yet.
    pub fn of_files(files: Vec<FileStamp>, folders: Vec<FolderStamp>) -> Words {
        Words::of(&CityModel::default(), files, folders)
    }

    /// Of a model whose facets, objects and vertices are numbered as they are in the index.
    pub fn of(model: &CityModel, files: Vec<FileStamp>, folders: Vec<FolderStamp>) -> Words {
        Words {
            program: concat!("cityweld ", env!("CARGO_PKG_VERSION")).to_owned(),
            origin: model.origin.into(),
            crs: model.crs.clone(),
            size: CitySize::of(model),
            bounds: model.bounds().map_or([[0.0; 3]; 2], |(low, high)| [low.into(), high.into()]),
            vertices: VertexNumbers::OfCity,
            sources: model.sources.iter().map(SourceWords::of).collect(),
            warnings: model.warnings.clone(),
            files,
            folders,
        }
    }
}
