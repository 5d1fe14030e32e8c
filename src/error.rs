//! All errors of the library as one.

use crate::align::AlignIndexError;
use crate::city::CityError;
use crate::city_index::CityIndexError;
use crate::export::{ExportError, OutputError, ReportError};
use crate::format::PlacementError;
use crate::format::positions::PositionsError;
use crate::geometry::StartError;
use crate::georeference::GeoreferenceError;
use crate::imagery::ImageryError;
use crate::merging::MergeError;
use crate::observer::Cancelled;
use crate::reconstruction::ReconstructionError;

/// Whatever a function of this library may end with; each function names the one that is its own. Messages say what is wrong, where,
/// and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    #[error(transparent)]
    City(#[from] CityError),
    #[error(transparent)]
    CityIndex(#[from] CityIndexError),
    #[error(transparent)]
    AlignIndex(#[from] AlignIndexError),
    #[error(transparent)]
    Reconstruction(#[from] ReconstructionError),
    #[error(transparent)]
    Imagery(#[from] ImageryError),
    #[error(transparent)]
    Start(#[from] StartError),
    /// A start or an earlier alignment that cannot be read.
    #[error(transparent)]
    Placement(#[from] PlacementError),
    /// Positions of photographs, or control points, that cannot be read.
    #[error(transparent)]
    Positions(#[from] PositionsError),
    /// ... or that place nothing.
    #[error(transparent)]
    Georeference(#[from] GeoreferenceError),
    #[error(transparent)]
    Merge(#[from] MergeError),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    #[error(transparent)]
    Report(#[from] ReportError),
    #[error(transparent)]
    Export(#[from] ExportError),
    #[error(transparent)]
    Output(#[from] OutputError),
}

#[cfg(test)]
mod tests;
