//! How city files are to be taken.

use serde::{Deserialize, Serialize};

use super::levels::CityLod;
use super::warning::CityDefect;
use crate::format::footprints::{FootprintFields, is_of_footprints};
use crate::format::surfaces::SurfaceFile;

/// How to take city files.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CityOptions {
    /// Which axis points up; where `None`, as the format has it: y in glTF, z in all others.
    pub up: Option<CityUp>,
    /// Which level of detail is taken, where a file has several.
    pub lod: CityLod,
    /// What coordinates are in; metres where `None`, with a warning where the heights of houses deny it.
    pub unit: Option<CityUnit>,
    /// Added to every coordinate, metres (for models that were shifted to be written).
    pub origin: [f64; 3],
    /// Reference system of files that do not say theirs, such as `EPSG:25832+7837`.
    pub crs: Option<String>,
    /// The attributes that make houses of footprints (Shapefile, GeoPackage).
    pub footprints: FootprintFields,
}

impl CityOptions {
    pub fn with_up(self, up: CityUp) -> CityOptions {
        CityOptions { up: Some(up), ..self }
    }

    pub fn with_lod(self, lod: CityLod) -> CityOptions {
        CityOptions { lod, ..self }
    }

    pub fn with_unit(self, unit: CityUnit) -> CityOptions {
        CityOptions { unit: Some(unit), ..self }
    }

    /// Metres.
    pub fn with_origin(self, origin: [f64; 3]) -> CityOptions {
        CityOptions { origin, ..self }
    }

    /// The attribute with the heights of houses above their base.
    pub fn with_height_field(self, name: impl Into<String>) -> CityOptions {
        let footprints = FootprintFields { height: Some(name.into()), ..self.footprints };
        CityOptions { footprints, ..self }
    }

    /// The attribute with the heights of their bases; 0 where none is named.
    pub fn with_base_field(self, name: impl Into<String>) -> CityOptions {
        let footprints = FootprintFields { base: Some(name.into()), ..self.footprints };
        CityOptions { footprints, ..self }
    }

    pub fn with_crs(self, crs: impl Into<String>) -> CityOptions {
        CityOptions { crs: Some(crs.into()), ..self }
    }

    /// Options that none of the files has anything for.
    pub(super) fn without_use(&self, files: &[&SurfaceFile]) -> Vec<CityDefect> {
        let has_levels = files.iter().any(|file| file.surfaces.iter().any(|surface| surface.lod.is_some()));
        let has_footprints = files.iter().any(|file| is_of_footprints(file));
        let FootprintFields { height, base } = &self.footprints;
        let (levels, footprints) = ("levels of detail in its files", "footprints (Shapefile, GeoPackage)");
        let unused = [
            (self.lod != CityLod::Highest && !has_levels, "--lod", levels),
            (height.is_some() && !has_footprints, "--height-field", footprints),
            (base.is_some() && !has_footprints, "--base-field", footprints),
        ];
        let defect = |(_, option, lacks): (bool, &'static str, &'static str)| CityDefect::OptionWithoutUse {
            option: option.into(),
            lacks: lacks.into(),
        };
        unused.into_iter().filter(|unused| unused.0).map(defect).collect()
    }
}

/// The axis that points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub enum CityUp {
    #[default]
    Z,
    /// (x, y, z) becomes (x, -z, y).
    Y,
}

/// What coordinates are in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub enum CityUnit {
    #[default]
    Metre,
    Centimetre,
    Millimetre,
    /// International foot, 0.3048 m.
    Foot,
    /// Foot of the United States' survey, 1200 / 3937 m.
    UsFoot,
}

impl CityUnit {
    /// Metres of one unit.
    pub fn metres(self) -> f64 {
        match self {
            CityUnit::Metre => 1.0,
            CityUnit::Centimetre => 0.01,
            CityUnit::Millimetre => 0.001,
            CityUnit::Foot => 0.3048,
            CityUnit::UsFoot => 1200.0 / 3937.0,
        }
    }

    /// As the command line names it.
    pub fn word(self) -> &'static str {
        match self {
            CityUnit::Metre => "m",
            CityUnit::Centimetre => "cm",
            CityUnit::Millimetre => "mm",
            CityUnit::Foot => "ft",
            CityUnit::UsFoot => "us-ft",
        }
    }
}
