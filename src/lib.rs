//! cityweld registers structure-from-motion (SfM) reconstructions to polyhedral city models, and to each other.
//!
//! ```text
//! city files ──► read_city ──► CityModel ──► PreparedCity ──┐
//! COLMAP, PLY ─► read_reconstruction ──► Reconstruction ────┤
//! labels, photographs ─► lift_superpixels ──────────────────┼─► align ──► Alignment ──► write_alignment
//! a coarse pose ─► read_start ──► Start ──► AlignOptions ───┘   (positions, control points ─► Estimate ─► Start)
//!
//! reconstructions (and starts in a city) ──► MergePart ──► merge ──► Merge ──► write_merge
//! ```
//!
//! | To | use |
//! |---|---|
//! | set a reconstruction into a city | [`align()`], [`AlignOptions`], [`Up`]; what comes back: [`Alignment`] |
//! | know how sure it is | [`Verdict`], [`Certainty`], [`Freedom`], [`Alternative`], [`types::ModelErrors`] |
//! | read a city model | [`read_city`], [`CityOptions`], [`CityModel`], [`PreparedCity`] |
//! | prepare a city once, and read any part of it | [`write_city_index`], [`CityIndex`], [`read_city_within`] |
//! | read a reconstruction and a start | [`read_reconstruction`], [`Reconstruction`], [`read_start`], [`Start`] |
//! | get a start from positions or control points | [`read_positions`], [`from_positions`], [`read_control_points`], [`from_control_points`], [`agreed`]; what comes back: [`Estimate`] |
//! | use label images or photographs | [`lift_superpixels`], [`SuperpixelSource`], [`SuperpixelOptions`] |
//! | join reconstructions | [`merge()`], [`MergePart`], [`MergeOptions`]; with places known already [`steps::join`]; what comes back: [`Merge`] |
//! | write results | [`write_alignment`], [`write_merge`], [`write_colmap`], [`write_ply`], [`output`] |
//! | follow long work, or end it | [`Observer`], [`Stage`], [`Cancelled`] |
//! | see what is in any input | [`inspect()`], [`Inspection`] |
//! | hold every error in one type | [`Error`] |
//! | solve point-to-plane problems of one's own | [`solvers`] |
//! | answer the `solve` command's JSON | [`problem`] |
//! | make scenes with known truth | [`synthetic`] |
//!
//! Frames stand in names: `city_from_sfm` takes coordinates of the reconstruction to those of the city. Lengths are metres of the
//! city, angles radians where the name does not say otherwise. The same input and seed give the same bytes on any number of threads.
#![forbid(unsafe_code)]
// Nothing outside tests ends the program by name: what input can bring about is an error, what it cannot is written without.
#![cfg_attr(
    not(test),
    warn(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::todo,
        clippy::string_slice
    )
)]

mod limits;
mod observer;
mod geometry;
mod random;
mod format;
mod city;
mod reconstruction;
mod imagery;
pub mod solvers;
pub mod problem;
mod robust;
mod planes;
mod georeference;
mod place_search;
mod city_index;
mod correspondence;
mod evidence;
mod uncertainty;
mod verdict;
mod merging;
mod export;
pub mod synthetic;

mod align;
mod merge;
mod error;
mod inspect;

#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;

// Alignment.
pub use align::{AlignOptions, IndexedAlignment, Place, Up, align, align_in_index};
pub use error::Error;
pub use inspect::{InputKind, Inspection, inspect};
pub use observer::{Cancelled, Observer, Stage};
pub use verdict::{Alignment, Alternative, Certainty, Freedom, Verdict};

// City, reconstruction, start.
pub use city::{
    CityIndex, CityLod, CityModel, CityOptions, CityUnit, CityUp, Facet, PlanBox, read_city, read_city_contents,
    read_city_files, read_city_within,
};
pub use city_index::write_city_index;
pub use format::control::read_control_points;
pub use format::positions::read_positions;
pub use format::read_start;
pub use geometry::{Start, StartSigmas};
pub use georeference::{Estimate, agreed, from_control_points, from_geographic, from_positions};
pub use place_search::{Disc, HeadingPrior, PlacePrior};
pub use planes::PreparedCity;
pub use reconstruction::{
    Image, Observation, Reconstruction, SfmOptions, read_reconstruction, read_reconstruction_with,
};

// Label images and photographs.
pub use imagery::{LiftedSuperpixels, SuperpixelOptions, SuperpixelSource, lift_superpixels};

// Merging.
pub use merge::{MergeOptions, MergePart, merge};
pub use merging::{Merge, MergeVerdict};

// Results as files.
pub use export::colmap::write_colmap;
pub use export::ply::write_ply;
pub use export::{write_alignment, write_merge};

// Geometry.
pub use geometry::{Matrix3, Point3, Rotation3, Similarity, Vector3};

/// What the models and results are made of, and the errors of single functions.
pub mod types {
    pub use crate::align::AlignIndexError;
    pub use crate::city::{
        CityChange, CityContents, CityDefect, CityError, CityPlace, CityRole, CitySize, CitySource, CityWarning, Crs,
        FacetId, IndexOverview, KindCounts, Lod, ObjectId, SurfaceKind, WholeCity,
    };
    pub use crate::city_index::CityIndexError;
    pub use crate::export::{ExportError, OutputError, ReportError};
    pub use crate::format::city_index::{IndexFault, WallRecord};
    pub use crate::format::cityjson::{CityJsonError, CityJsonProblem};
    pub use crate::format::control::{ControlFile, PointRole, PointSight, StoredPoint};
    pub use crate::format::footprints::FootprintFields;
    pub use crate::format::ply::{CloudField, FieldKind};
    pub use crate::format::positions::{Frame, PositionsError, PositionsFile, StoredPosition};
    pub use crate::format::{PlacementError, SurfaceError};
    pub use crate::geometry::{Camera, CameraModel, StartError};
    pub use crate::georeference::{ControlPoint, ControlUse, GeoreferenceError};
    pub use crate::imagery::{ImageryError, ImageryWarning, Superpixel};
    pub use crate::merging::{
        Account, Anchor, DropReason, Edge, EdgeFault, EdgeSource, Fused, Ledger, MergeError, MergedFrame, PairFault,
        PartPlace, PartSupport, Unbalanced,
    };
    pub use crate::planes::CityPlanes;
    pub use crate::reconstruction::{
        CameraIndex, ColmapParts, ImageIndex, KnownPositions, LasPacking, PointIndex, PoseReading, ReconstructionError,
        ReconstructionWarning, SfmFormat, SfmSource, Sight, WarningKind, recognise,
    };
    pub use crate::robust::{Matrix7, MotionParameters};
    pub use crate::verdict::{FreedomKind, FreedomUnit, ModelErrors, PlaneSupport, SearchSummary, Support};
}

/// Single steps, for programs that put their own together: superpixels of chosen images, parts whose places are known, reports as text.
pub mod steps {
    pub use crate::export::{CityCounts, InputSummary, SfmCounts, alignment_report, merge_report, start_report};
    pub use crate::imagery::{LabelMap, Labels, cut_superpixels, lift_superpixels_of};
    pub use crate::merging::{JoinOptions, PairSources, Part, join};
}

/// Folders of results as the program writes them: OUT appears whole or not at all; what a city's planes look like; an earlier alignment
/// written again.
pub mod output {
    pub use crate::export::{
        Discard, Formats, Output, OutputError, OutputKind, PlaneAttitude, Replace, UnpackedFile, planes_report,
        write_placed, write_planes_glb,
    };
    pub use crate::format::{StoredAlignment, read_alignment};
}

/// What tests and benchmarks of this package look into; nothing here is promised.
#[doc(hidden)]
pub mod internals {
    pub use crate::correspondence::{Graph, PoseSearch, Sampler, Scene};
    pub use crate::export::gltf::{Placed, Scene as GltfScene, write_scene};
    pub use crate::format::colmap::{Encoding, RigRecord};
    pub use crate::limits::*;
    pub use crate::merging::MergeLimits;
    pub use crate::planes::{
        CityPlanes, Patches, PlaneId, UpChoice, Upright, choose_up, city_planes, patches, up_of_cameras,
    };
    pub use crate::reconstruction::WarningKind;
    pub use crate::robust::{Matrix7, Motion, MotionParameters, NormalEquations, Problem, Random, tukey_weight};
}
