//! Warnings about city files in words.

use std::fmt;

use super::warning::{CityDefect, CityWarning};
use super::{CityUnit, CityUp};
use crate::format::escaped;

/// Share of a city's objects that are inside out from which on a mirror image is as likely: it turns all of them. Whoever
/// winds single buildings wrongly leaves some right (1,068 of 1,103 were wrong in one published city).
const MIRROR_SHARE: f64 = 0.9;

/// A mirror image and a model wound inwards are one and the same to geometry, so whoever knows the place must look.
const MIRROR_REMEDY: &str = "if the city is a mirror image of the place instead (compare the streets with a map), no \
    pose can be right: two axes are exchanged or one is negated, so write it again with x east, y north, z up";

impl fmt::Display for CityWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(sentence) = sentence(&self.defect) {
            return write!(f, "{sentence} ({})", self.example);
        }
        let (one, many) = self.counted();
        write!(f, "{} {}", self.count, if self.count == 1 { one } else { many })?;
        self.write_remedy(f)?;
        write!(f, "; first: {}", self.example)
    }
}

impl CityWarning {
    /// What is counted, of one and of many.
    fn counted(&self) -> (&str, &str) {
        match &self.defect {
            CityDefect::UnknownLines => ("line begins with an unknown word", "lines begin with an unknown word"),
            CityDefect::FreeForms => ("curve or surface has no polygons", "curves or surfaces have no polygons"),
            CityDefect::NoSurface => ("primitive is points or lines", "primitives are points or lines"),
            CityDefect::TooFewCorners => ("face has less than 3 corners", "faces have less than 3 corners"),
            CityDefect::LostVertices => {
                ("vertex is not finite or too far from zero", "vertices are not finite or too far from zero")
            }
            CityDefect::LostCorner => ("face uses such a vertex", "faces use such vertices"),
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
            CityDefect::NoCityFile => ("file of the folder is no city model", "files of the folder are no city models"),
            CityDefect::IndexAlone => {
                ("file of the city is not where it was", "files of the city are not where they were")
            }
            CityDefect::EmptyTile => ("file of the city has no polygons", "files of the city have no polygons"),
            CityDefect::SameObject => {
                ("object has the name of one in another file", "objects have the names of ones in other files")
            }
            CityDefect::OddExtent { .. } => ("city has an odd size", "cities have an odd size"),
            CityDefect::FarApart { .. } => ("file lies far from the city", "files lie far from the city"),
            // Told in a sentence of its own.
            _ => ("", ""),
        }
    }

    /// How much of it there is, and what was done about it.
    fn write_remedy(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.defect {
            CityDefect::UnknownLines | CityDefect::FreeForms | CityDefect::NoSurface => write!(f, ", passed over")?,
            CityDefect::TooFewCorners
            | CityDefect::LostVertices
            | CityDefect::LostCorner
            | CityDefect::ZeroArea
            | CityDefect::Tangled => write!(f, ", left out")?,
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
            CityDefect::PassedOver { .. } | CityDefect::NoCityFile | CityDefect::EmptyTile => {
                write!(f, ", passed over")?
            }
            CityDefect::IndexAlone => {
                write!(f, "; the index is taken, though nothing tells whether they have changed")?
            }
            CityDefect::SameObject => write!(f, " of the city (tiles that overlap?), both kept")?,
            CityDefect::Footprints => write!(f, " that has nothing above level of detail 0, left out")?,
            CityDefect::AboveWantedLevel => write!(f, " wants, and its object has no lower one, left out")?,
            CityDefect::OddExtent { across_m } => {
                write!(f, " ({across_m} m across; units must be metres, and no vertex may stray)")?;
            }
            CityDefect::FarApart { distance_m } => {
                write!(f, " (up to {distance_m:.0} m; all files must be in one frame)")?;
            }
            _ => {}
        }
        Ok(())
    }
}

/// What concerns the city as a whole, with what to do; `None` for what is counted.
fn sentence(defect: &CityDefect) -> Option<String> {
    Some(match defect {
        CityDefect::NorthFirst { negative: 0, .. } => {
            "coordinates are written north first, as their range in the reference system shows; exchanged, so that x is east".into()
        }
        CityDefect::NorthFirst { negative, of } => format!(
            "{negative} of {of} closed shells are inside out, so north is written before east; exchanged, so that x is east; if the city is \
             a mirror image of the place now, its shells are wound inwards: write it again"
        ),
        CityDefect::Degrees { latitude, longitude, is_latitude_first } => format!(
            "coordinates are degrees, {} first; projected to metres about latitude {latitude:.3}, longitude {longitude:.3} (transverse \
             Mercator); starts and results are in that frame",
            if *is_latitude_first { "latitude" } else { "longitude" }
        ),
        CityDefect::OtherCrs { first, other } => format!(
            "the reference systems differ: {} is used, {} is not; all files must be in one",
            escaped(first),
            escaped(other)
        ),
        CityDefect::OptionWithoutUse { option, lacks } => format!("{option} changes nothing: the city has no {lacks}"),
        CityDefect::OddHeights { unit: unit @ CityUnit::Foot, height } => format!(
            "the middle house is {height:.0} high: if coordinates are feet, say --city-unit {} (or us-ft)",
            unit.word()
        ),
        CityDefect::OddHeights { unit, height } => format!(
            "the middle house is {height:.0} high, so coordinates look like {}, not metres: say --city-unit {}",
            name(*unit),
            unit.word()
        ),
        CityDefect::UprightAboutY { share, attempt } => format!(
            "{:.0} % of the facets' area stands upright or level about y, not z: try --city-up {}",
            100.0 * share,
            match attempt {
                CityUp::Y => "y",
                CityUp::Z => "z",
            }
        ),
        CityDefect::CoarseFloats { step_m } => format!(
            "positions are 32-bit numbers, {} apart here, and no better known than that: put the offset into a node's \
             translation",
            length(*step_m)
        ),
        _ => return None,
    })
}

fn name(unit: CityUnit) -> &'static str {
    match unit {
        CityUnit::Metre => "metres",
        CityUnit::Centimetre => "centimetres",
        CityUnit::Millimetre => "millimetres",
        CityUnit::Foot => "feet",
        CityUnit::UsFoot => "US survey feet",
    }
}

/// Two digits that count.
fn length(metres: f64) -> String {
    if metres >= 0.1 { format!("{metres:.1} m") } else { format!("{:.1} cm", 100.0 * metres) }
}
