//! How CITY is to be read: options that every command with a city takes.

use std::path::PathBuf;
use std::str::FromStr;

use clap::ValueEnum;

use super::values::numbers;
use crate::city::{CityLod, CityOptions, CityUnit, CityUp, Lod};
use crate::format::crs::Crs;
use crate::format::footprints::FootprintFields;

#[derive(clap::Args, Clone, Debug, Default)]
#[command(next_help_heading = "City options")]
pub struct CityArgs {
    /// Further meshes in the same frame as CITY, such as ground; may be given several times
    #[arg(long, value_name = "FILE")]
    pub terrain: Vec<PathBuf>,
    /// Axis that is up in the city's files [default: y in glTF, z in all others]
    #[arg(long, value_name = "AXIS", value_enum)]
    pub city_up: Option<CityUpArg>,
    /// Level of detail: the highest of each object up to this (1, 1.3, 2.2) [default: the highest of each object]. Level 0,
    /// footprints, is never taken
    #[arg(long, value_name = "LEVEL", allow_hyphen_values = true)]
    pub lod: Option<LodArg>,
    /// What the city's coordinates are in [default: m, with a warning where the heights of houses deny it]
    #[arg(long, value_name = "UNIT", value_enum)]
    pub city_unit: Option<CityUnitArg>,
    /// Added to every coordinate of the city, metres, for models that were shifted when they were written
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub city_origin: Option<OriginArg>,
    /// Reference system of the city, where its files do not say theirs: EPSG:H or EPSG:H+V
    #[arg(long, value_name = "CRS", value_parser = reference_system)]
    pub crs: Option<String>,
    /// Attribute of footprints (Shapefile, GeoPackage) with the heights of houses above their base, in the unit of the coordinates
    #[arg(long, value_name = "NAME")]
    pub height_field: Option<String>,
    /// Attribute of footprints with the heights of their bases, in the unit of the coordinates [default: all at 0]
    #[arg(long, value_name = "NAME")]
    pub base_field: Option<String>,
}

impl CityArgs {
    pub fn options(&self) -> CityOptions {
        let up = |up| match up {
            CityUpArg::Z => CityUp::Z,
            CityUpArg::Y => CityUp::Y,
        };
        let unit = |unit| match unit {
            CityUnitArg::M => CityUnit::Metre,
            CityUnitArg::Cm => CityUnit::Centimetre,
            CityUnitArg::Mm => CityUnit::Millimetre,
            CityUnitArg::Ft => CityUnit::Foot,
            CityUnitArg::UsFt => CityUnit::UsFoot,
        };
        CityOptions {
            up: self.city_up.map(up),
            lod: self.lod.map_or(CityLod::Highest, |lod| CityLod::UpTo(lod.0)),
            unit: self.city_unit.map(unit),
            origin: self.city_origin.map_or([0.0; 3], |origin| origin.0),
            crs: self.crs.clone(),
            footprints: FootprintFields { height: self.height_field.clone(), base: self.base_field.clone() },
        }
    }

    /// The first option that belongs to a city, where one is given.
    pub fn first_given(&self) -> Option<&'static str> {
        let given = [
            (!self.terrain.is_empty(), "--terrain"),
            (self.city_up.is_some(), "--city-up"),
            (self.lod.is_some(), "--lod"),
            (self.city_unit.is_some(), "--city-unit"),
            (self.city_origin.is_some(), "--city-origin"),
            (self.crs.is_some(), "--crs"),
            (self.height_field.is_some(), "--height-field"),
            (self.base_field.is_some(), "--base-field"),
        ];
        given.into_iter().find(|(is_given, _)| *is_given).map(|(_, option)| option)
    }
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum CityUpArg {
    Z,
    Y,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum CityUnitArg {
    M,
    Cm,
    Mm,
    /// International feet, 0.3048 m
    Ft,
    /// Feet of the US survey, 1200/3937 m
    UsFt,
}

/// `--crs`, as it was typed: a code, or another spelling of a system that has one.
fn reference_system(text: &str) -> Result<String, &'static str> {
    let expected = "expected EPSG:<code> of a registered system, such as EPSG:25832 or EPSG:25832+7837";
    Crs::understood(text).epsg.map(|_| text.to_owned()).ok_or(expected)
}

/// `--lod`: 2 takes all of 2.x, 2.1 what is not above it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LodArg(pub Lod);

impl FromStr for LodArg {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<LodArg, &'static str> {
        let expected = "expected a level above 0, such as 1, 1.3 or 2.2";
        let (whole, step) =
            text.trim().split_once('.').map_or((text.trim(), None), |(whole, step)| (whole, Some(step)));
        let whole: u8 = whole.parse().map_err(|_| expected)?;
        let step: u8 = step.map_or(Ok(u8::MAX), str::parse).map_err(|_| expected)?;
        if whole == 0 { Err(expected) } else { Ok(LodArg(Lod(whole, step))) }
    }
}

/// `--city-origin`, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OriginArg(pub [f64; 3]);

impl FromStr for OriginArg {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<OriginArg, &'static str> {
        match numbers(text).as_deref() {
            Some(&[x, y, z]) => Ok(OriginArg([x, y, z])),
            _ => Err("expected three numbers X,Y,Z in metres"),
        }
    }
}
