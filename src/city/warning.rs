//! What a city file has wrong and the model tolerates.

use std::fmt;
use std::mem::discriminant;
use std::path::PathBuf;

use crate::format::escaped;

/// Share of a city's objects that are inside out from which on a mirror image is as likely: it turns all of them. Whoever
/// winds single buildings wrongly leaves some right (1,068 of 1,103 were wrong in one published city).
const MIRROR_SHARE: f64 = 0.9;

/// A mirror image and a model wound inwards are one and the same to geometry, so whoever knows the place must look.
const MIRROR_REMEDY: &str = "if the city is a mirror image of the place instead (compare the streets with a map), no \
    pose can be right: two axes are exchanged or one is negated, so write it again with x east, y north, z up";

/// A kind of defect that was tolerated: how often it was met, and where first.
#[derive(Clone, Debug, PartialEq)]
pub struct CityWarning {
    pub defect: CityDefect,
    /// Of what the defect is about: vertices, faces, lines, objects.
    pub count: u64,
    pub example: CityPlace,
}

/// Where an oddity was first met.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CityPlace {
    pub path: PathBuf,
    /// Counted from 1; `None` in files without lines.
    pub line: Option<u32>,
    /// Empty where it concerns none.
    pub object: String,
}

/// What was wrong, and what was done about it.
#[derive(Clone, Debug, PartialEq)]
pub enum CityDefect {
    /// Lines that begin with a word OBJ does not know; passed over.
    UnknownLines,
    /// Curves and surfaces without polygons; passed over.
    FreeForms,
    /// Points and lines of a glTF mesh; passed over.
    NoSurface,
    /// Faces of fewer than three corners; left out.
    TooFewCorners,
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
    PassedOver { what: &'static str },
    /// Footprints (level of detail 0) of objects that have nothing else; left out.
    Footprints,
    /// Polygons of objects that have nothing up to the level of detail that was asked for; left out.
    AboveWantedLevel,
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

    pub fn into_list(self) -> Vec<CityWarning> {
        self.0
    }
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

impl fmt::Display for CityWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (one, many) = match self.defect {
            CityDefect::UnknownLines => ("line begins with an unknown word", "lines begin with an unknown word"),
            CityDefect::FreeForms => ("curve or surface has no polygons", "curves or surfaces have no polygons"),
            CityDefect::NoSurface => ("primitive is points or lines", "primitives are points or lines"),
            CityDefect::TooFewCorners => ("face has less than 3 corners", "faces have less than 3 corners"),
            CityDefect::ZeroArea => ("face has no area", "faces have no area"),
            CityDefect::DuplicateVertices => ("vertex repeats an earlier one", "vertices repeat earlier ones"),
            CityDefect::NonPlanar { .. } => ("polygon is not planar", "polygons are not planar"),
            CityDefect::SelfIntersecting => {
                ("polygon crosses or overlaps itself", "polygons cross or overlap themselves")
            }
            CityDefect::Tangled => ("polygon is tangled", "polygons are tangled"),
            CityDefect::Doubled => ("facet stands twice", "facets stand twice"),
            CityDefect::DoubledReversed => {
                ("facet stands back to back with its like", "facets stand back to back with their like")
            }
            CityDefect::InsideOut { .. } => ("object is wound inside out", "objects are wound inside out"),
            CityDefect::WoundAgainstTheRest { .. } => {
                ("object has facets wound against the rest", "objects have facets wound against the rest")
            }
            CityDefect::TerrainLooksDown => ("terrain is wound downwards", "terrains are wound downwards"),
            CityDefect::MixedOrientation { .. } => {
                ("object has facets whose sides disagree", "objects have facets whose sides disagree")
            }
            CityDefect::OpenShell { .. } => ("object is an open shell", "objects are open shells"),
            CityDefect::PassedOver { what } => (what, what),
            CityDefect::Footprints => ("polygon is the footprint of an object", "polygons are footprints of objects"),
            CityDefect::AboveWantedLevel => (
                "polygon is of a higher level of detail than --lod",
                "polygons are of higher levels of detail than --lod",
            ),
            CityDefect::OddExtent { .. } => ("city has an odd size", "cities have an odd size"),
            CityDefect::FarApart { .. } => ("file lies far from the city", "files lie far from the city"),
        };
        write!(f, "{} {}", self.count, if self.count == 1 { one } else { many })?;
        match self.defect {
            CityDefect::UnknownLines | CityDefect::FreeForms | CityDefect::NoSurface => write!(f, ", passed over")?,
            CityDefect::TooFewCorners | CityDefect::ZeroArea | CityDefect::Tangled => write!(f, ", left out")?,
            CityDefect::DuplicateVertices => write!(f, ", joined")?,
            CityDefect::NonPlanar { worst_m } => write!(f, " (worst by {worst_m:.3} m), split into triangles")?,
            CityDefect::SelfIntersecting => write!(f, ", kept by the even-odd rule")?,
            CityDefect::Doubled => write!(f, ", kept")?,
            CityDefect::DoubledReversed => write!(f, " (party walls, or walls without thickness), kept")?,
            CityDefect::InsideOut { of } => {
                write!(f, " (of {of}), turned")?;
                if self.count as f64 > MIRROR_SHARE * of as f64 {
                    write!(f, "; {MIRROR_REMEDY}")?;
                }
            }
            CityDefect::WoundAgainstTheRest { facets } => write!(f, " (facets: {facets}), turned")?,
            CityDefect::TerrainLooksDown => write!(f, ", turned")?,
            CityDefect::MixedOrientation { edges } => write!(f, " (at {edges} edges), kept as they are")?,
            CityDefect::OpenShell { open_edges, edges } => {
                write!(f, " ({open_edges} of {edges} edges belong to one facet alone), kept")?;
            }
            CityDefect::PassedOver { .. } => write!(f, ", passed over")?,
            CityDefect::Footprints => write!(f, " that has nothing above level of detail 0, left out")?,
            CityDefect::AboveWantedLevel => write!(f, " wants, and its object has no lower one, left out")?,
            CityDefect::OddExtent { across_m } => {
                write!(f, " ({across_m} m across; units must be metres, and no vertex may stray)")?;
            }
            CityDefect::FarApart { distance_m } => {
                write!(f, " (up to {distance_m:.0} m; all files must be in one frame)")?;
            }
        }
        write!(f, "; first: {}", self.example)
    }
}
