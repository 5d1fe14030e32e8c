//! Polygons of a city file as it writes them: before axes, units and levels of detail are decided. CityJSON, CityGML and footprints
//! are read into this one shape.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Everything of one file that bounds a city object.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceFile {
    /// What the file is, with its version ("CityJSON 2.0").
    pub format: String,
    /// The reference system, as the file spells it.
    pub crs: Option<String>,
    /// Distance of neighbouring coordinates that the file can write, where it has one.
    pub step: Option<f64>,
    /// File coordinates, in the file's own order of axes.
    pub positions: Vec<[f64; 3]>,
    /// Indices into `positions` of all rings, one ring after the other; the closing corner is not repeated.
    pub corners: Vec<u32>,
    /// End of each ring in `corners`.
    pub ring_ends: Vec<u32>,
    pub surfaces: Vec<SurfaceRecord>,
    pub objects: Vec<ObjectRecord>,
    /// What was passed over, each kind once.
    pub skipped: Vec<Skipped>,
}

impl SurfaceFile {
    /// Indices into `positions` of one ring.
    pub fn ring(&self, ring: u32) -> &[u32] {
        let start = if ring == 0 { 0 } else { self.ring_ends[ring as usize - 1] };
        &self.corners[start as usize..self.ring_ends[ring as usize] as usize]
    }
}

/// One polygon: an outline and its holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceRecord {
    /// Index into [`SurfaceFile::objects`].
    pub object: u32,
    /// Index into [`SurfaceFile::ring_ends`] of the outline.
    pub first_ring: u32,
    /// The outline and its holes.
    pub ring_count: u32,
    pub lod: Option<Lod>,
    pub kind: Option<SurfaceKind>,
    /// The closed shell to which the polygon belongs, numbered through the file; its signed volume tells the order of axes.
    pub shell: Option<u32>,
}

/// Level of detail: 2.2 is (2, 2), 2 is (2, 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize, Serialize)]
pub struct Lod(pub u8, pub u8);

impl fmt::Display for Lod {
    /// As files write it: 2, 2.2.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Lod(whole, 0) => write!(f, "{whole}"),
            Lod(whole, step) => write!(f, "{whole}.{step}"),
        }
    }
}

/// What a polygon is of a building.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SurfaceKind {
    Ground,
    Roof,
    Wall,
    /// Closes a volume where nothing is built.
    Closure,
    /// Any other (floor, ceiling, window, door, water, traffic).
    Other,
}

/// A city object (building, bridge, tree) or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectRecord {
    pub id: String,
    /// The type as the file names it, without a namespace ("Building").
    pub class: String,
    /// Index into [`SurfaceFile::objects`] of what it is a part of.
    pub parent: Option<u32>,
}

/// Something that a reader passed over.
#[derive(Clone, Debug, PartialEq)]
pub struct Skipped {
    /// In words, plural, such as "points and lines".
    pub what: &'static str,
    pub count: usize,
    /// Object of the first.
    pub example: String,
}
