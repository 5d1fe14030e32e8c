//! What a city file has wrong and the model tolerates.

use std::borrow::Cow;
use std::fmt;
use std::mem::discriminant;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::{CityUnit, CityUp};
use crate::format::escaped;

/// A kind of defect that was tolerated: how often it was met, and where first.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct CityWarning {
    pub defect: CityDefect,
    /// Of what the defect is about: vertices, faces, lines, objects.
    pub count: u64,
    pub example: CityPlace,
}

/// Where an oddity was first met.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct CityPlace {
    #[serde(serialize_with = "as_text")]
    pub path: PathBuf,
    /// Counted from 1; `None` in files without lines.
    pub line: Option<u32>,
    /// Empty where it concerns none.
    pub object: String,
}

/// What was wrong, and what was done about it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum CityDefect {
    /// Lines that begin with a word OBJ does not know; passed over.
    UnknownLines,
    /// Curves and surfaces without polygons; passed over.
    FreeForms,
    /// Points and lines of a glTF mesh; passed over.
    NoSurface,
    /// Faces of fewer than three corners; left out.
    TooFewCorners,
    /// Vertices that are not finite or out of reach; left out.
    LostVertices,
    /// Faces that use such a vertex; left out.
    LostCorner,
    /// Faces without area; left out.
    ZeroArea,
    /// Vertices at exactly the place of an earlier one of the same file; joined with it.
    DuplicateVertices,
    /// Polygons whose corners lie off their plane by more than the tolerance; split into triangles.
    NonPlanar { worst_m: f64 },
    /// Polygons that cross or overlap themselves; what lies inside an odd number of times was kept.
    SelfIntersecting,
    /// Polygons that cross themselves beyond repair; left out.
    Tangled,
    /// Facets with the outline of an earlier one, the same way round.
    Doubled,
    /// Facets with the outline of an earlier one, the other way round: party walls, or walls without thickness.
    DoubledReversed,
    /// Objects, of so many in the file, that had their outward side inside; turned.
    InsideOut { of: u64 },
    /// Objects with facets whose outward side was inside, while the rest was right; turned.
    WoundAgainstTheRest { facets: u64 },
    /// Terrain that looked down; turned.
    TerrainLooksDown,
    /// Objects with edges that two facets walk in the same direction, so that one of them has its outward side inside.
    MixedOrientation { edges: u64 },
    /// Objects with edges that only one facet has.
    OpenShell { open_edges: u64, edges: u64 },
    /// What a reader of a format passed over, in words.
    PassedOver { what: Cow<'static, str> },
    /// Footprints (level of detail 0) of objects that have nothing else; left out.
    Footprints,
    /// Polygons of objects that have nothing up to the level of detail that was asked for; left out.
    AboveWantedLevel,
    /// Files of a folder that are no city models; passed over.
    NoCityFile,
    /// Files of a city that were not found where its index was opened, so that nothing tells whether they are still the same.
    IndexAlone,
    /// Files of the city without polygons; left out.
    EmptyTile,
    /// Objects with the name of one in another file of the city; both kept.
    SameObject,
    /// North, or the latitude, is written before east; exchanged. By the volume of closed shells, so many of them, or by the reference system.
    NorthFirst { negative: u64, of: u64 },
    /// An option that no file of the city has anything for; passed over.
    OptionWithoutUse { option: Cow<'static, str>, lacks: Cow<'static, str> },
    /// Coordinates are degrees; projected about this place, in degrees.
    Degrees { latitude: f64, longitude: f64, is_latitude_first: bool },
    /// Files, or what was given, name different reference systems; the first is used for all.
    OtherCrs { first: String, other: String },
    /// The middle house is as high as none is in metres.
    OddHeights { unit: CityUnit, height: f64 },
    /// So much of the city's area stands upright about y; another axis may be up.
    UprightAboutY { share: f64, attempt: CityUp },
    /// Positions are 32-bit numbers this far from zero, so that neighbouring ones lie this far apart.
    CoarseFloats { step_m: f64 },
    /// The city is as wide as none is: other units than metres, or vertices that belong elsewhere.
    OddExtent { across_m: f64 },
    /// Further files so far from the city that they must be in another frame.
    FarApart { distance_m: f64 },
}

impl CityDefect {
    /// Whether both are told in one line.
    fn is_like(&self, other: &CityDefect) -> bool {
        match (self, other) {
            (CityDefect::PassedOver { what }, CityDefect::PassedOver { what: other }) => what == other,
            _ => discriminant(self) == discriminant(other),
        }
    }

    /// Takes in the figures of the same kind of defect elsewhere.
    fn merge(&mut self, other: &CityDefect) {
        match (self, other) {
            (CityDefect::NonPlanar { worst_m }, CityDefect::NonPlanar { worst_m: other_m }) => {
                *worst_m = worst_m.max(*other_m);
            }
            (CityDefect::InsideOut { of }, CityDefect::InsideOut { of: others }) => *of += others,
            (CityDefect::WoundAgainstTheRest { facets }, CityDefect::WoundAgainstTheRest { facets: others }) => {
                *facets += others
            }
            (CityDefect::MixedOrientation { edges }, CityDefect::MixedOrientation { edges: others }) => {
                *edges += others;
            }
            (
                CityDefect::OpenShell { open_edges, edges },
                CityDefect::OpenShell { open_edges: others_open, edges: others },
            ) => {
                *open_edges += others_open;
                *edges += others;
            }
            (CityDefect::CoarseFloats { step_m }, CityDefect::CoarseFloats { step_m: other }) => {
                *step_m = step_m.max(*other);
            }
            (CityDefect::FarApart { distance_m }, CityDefect::FarApart { distance_m: other_m }) => {
                *distance_m = distance_m.max(*other_m);
            }
            _ => {}
        }
    }
}

/// Warnings in the making: one entry a kind, in the order in which the kinds were first met.
#[derive(Clone, Debug, Default)]
pub(super) struct Warnings(Vec<CityWarning>);

impl Warnings {
    /// Counts a defect; asks for the place only when the kind is new.
    pub fn add(&mut self, defect: CityDefect, count: u64, place: impl FnOnce() -> CityPlace) {
        match self.0.iter_mut().find(|warning| warning.defect.is_like(&defect)) {
            _ if count == 0 => {}
            Some(warning) => {
                warning.count += count;
                warning.defect.merge(&defect);
            }
            None => self.0.push(CityWarning { defect, count, example: place() }),
        }
    }

    /// Takes in warnings that were counted elsewhere.
    pub fn add_all(&mut self, warnings: impl IntoIterator<Item = CityWarning>) {
        for CityWarning { defect, count, example } in warnings {
            self.add(defect, count, || example);
        }
    }

    pub fn into_list(self) -> Vec<CityWarning> {
        self.0
    }
}

/// A path that is to be shown; names that are no UTF-8 as near as text comes to them.
pub(super) fn as_text<S: serde::Serializer>(path: &std::path::Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&path.to_string_lossy())
}

impl fmt::Display for CityPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.object.is_empty() {
            write!(f, "object {}, ", escaped(&self.object))?;
        }
        let name = self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy();
        match self.line {
            Some(line) => write!(f, "{}:{line}", escaped(&name)),
            None => write!(f, "{}", escaped(&name)),
        }
    }
}
