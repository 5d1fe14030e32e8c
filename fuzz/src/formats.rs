//! Every format that is read: its seeds, and the reader that is held to its promises.

use crate::promises::readers::{
    Reader, alignment, city, city_contents, control_points, crs_of_text, inspection, positions, reconstruction, start,
};
use crate::seeds::Source::{self, Beside, BesideFolder, Each, File, Folder};

pub struct Format {
    pub name: &'static str,
    pub read: Reader,
    pub seeds: &'static [Source],
    pub bulk: Bulk,
}

/// How much a byte of a file may stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bulk {
    /// What it says.
    Plain,
    /// A few bytes show a whole mesh again: the readers of cities allow 64 corners a byte.
    Repeated,
    /// Points are packed: the reader of LAZ allows 8 a byte.
    Packed,
    /// The `e57` crate unpacks a packet (64 KiB at most) whole, in which a point may be a bit of each coordinate.
    Packets,
}

impl Bulk {
    /// Memory that a reader may hold for each byte of its input.
    pub fn bytes_of_a_byte(self) -> usize {
        match self {
            Bulk::Plain => 4,
            // A corner with its index and its share of a triangle, twice while they are turned into the model.
            Bulk::Repeated => 4 + 64 * 64,
            // A point with its colour and further values.
            Bulk::Packed => 4 + 8 * 64,
            // As the crate keeps a point until it is asked for.
            Bulk::Packets => 4 + 8 * 512,
        }
    }
}

const fn format(name: &'static str, read: Reader, seeds: &'static [Source]) -> Format {
    Format { name, read, seeds, bulk: Bulk::Plain }
}

const fn repeated(name: &'static str, read: Reader, seeds: &'static [Source]) -> Format {
    Format { name, read, seeds, bulk: Bulk::Repeated }
}

const fn in_packets(name: &'static str, read: Reader, seeds: &'static [Source]) -> Format {
    Format { name, read, seeds, bulk: Bulk::Packets }
}

const fn packed(name: &'static str, read: Reader, seeds: &'static [Source]) -> Format {
    Format { name, read, seeds, bulk: Bulk::Packed }
}

/// In the order of issue and manual: cities, reconstructions, what places them, and whatever it may be.
pub static FORMATS: [Format; 29] = [
    repeated("cityjson", city, CITYJSON),
    repeated(
        "cityjsonseq",
        city,
        &[
            Each("fuzz/seeds/cityjsonseq"),
            File("tests/data/formats/city/3dbag_b2.city.jsonl"),
            Beside("city/small.city.jsonl"),
        ],
    ),
    repeated("citygml", city, CITYGML),
    format(
        "obj",
        city,
        &[
            File("tests/data/city/good.obj"),
            File("tests/data/city/continued.obj"),
            File("tests/data/city/bom_crlf.obj"),
        ],
    ),
    repeated(
        "gltf",
        city,
        &[File("tests/data/city/good.gltf"), File("tests/data/city/good.glb"), Beside("tiles/v11/0.glb")],
    ),
    repeated(
        "tiles",
        city,
        &[
            Folder("fuzz/seeds/tileset", "tileset.json"),
            File("tests/data/formats/house.b3dm"),
            BesideFolder("tiles/v11", "tileset.json"),
        ],
    ),
    format("stl", city, &[Each("fuzz/seeds/stl")]),
    format("ply_mesh", city, &[Each("fuzz/seeds/ply_mesh")]),
    format(
        "shapefile",
        city,
        &[Folder("fuzz/seeds/shapefile", "houses.shp"), BesideFolder("footprints", "test_buildings.shp")],
    ),
    format("geopackage", city, &[Each("fuzz/seeds/geopackage")]),
    repeated("city_contents", city_contents, CITY),
    format("colmap_text", reconstruction, &[Folder("fuzz/seeds/colmap_text", "")]),
    format("colmap_binary", reconstruction, COLMAP_BINARY),
    format("ply", reconstruction, &[Each("fuzz/seeds/ply")]),
    format("las", reconstruction, &[File("tests/data/formats/autzen.las")]),
    packed("laz", reconstruction, &[File("tests/data/formats/autzen.laz"), Beside("points/32-1-472-150-76.laz")]),
    packed("copc", reconstruction, &[File("tests/data/formats/autzen.copc.laz")]),
    in_packets("e57", reconstruction, &[Each("fuzz/seeds/e57"), Beside("points/two_scans.e57")]),
    format("opensfm", reconstruction, &[Each("fuzz/seeds/opensfm")]),
    format("nerfstudio", reconstruction, &[Folder("fuzz/seeds/nerfstudio", "transforms.json")]),
    format("openmvg", reconstruction, &[Each("fuzz/seeds/openmvg")]),
    format("bundler", reconstruction, &[Folder("fuzz/seeds/bundler", "bundle.out")]),
    format("nvm", reconstruction, &[Each("fuzz/seeds/nvm"), Beside("sfm/visualsfm.nvm")]),
    format("start", start, &[Each("fuzz/seeds/start")]),
    format("alignment", alignment, &[File("fuzz/seeds/start/alignment.json")]),
    format("positions", positions, POSITIONS),
    format("control", control_points, &[Each("fuzz/seeds/control")]),
    format("crs", crs_of_text, &[Each("fuzz/seeds/crs")]),
    repeated("inspect", inspection, ANY),
];

const CITYJSON: &[Source] = &[Each("fuzz/seeds/cityjson"), File("tests/data/formats/city/DH_01_subs_v1.0.city.json")];

const CITYGML: &[Source] =
    &[Each("fuzz/seeds/citygml"), Beside("city/FZK-Haus-LoD2__v3.gml"), Beside("city/TUM-Main-Entrance.gml")];

/// One of each, for what is told of a city before it is made.
const CITY: &[Source] = &[
    File("tests/data/formats/city/geometry_instance.city.json"),
    Each("fuzz/seeds/cityjson"),
    Each("fuzz/seeds/citygml"),
    File("tests/data/city/good.obj"),
    File("tests/data/city/good.gltf"),
    Each("fuzz/seeds/stl"),
];

const COLMAP_BINARY: &[Source] = &[
    Folder("tests/data/reconstruction/binary/sound", ""),
    Folder("tests/data/reconstruction/binary/sound_framed", ""),
];

const POSITIONS: &[Source] = &[
    Folder("tests/data/positions/exif", ""),
    Each("fuzz/seeds/positions"),
    File("tests/data/positions/couples.txt"),
    File("tests/data/positions/geo.txt"),
    File("tests/data/positions/name_x_y_z.txt"),
    File("tests/data/positions/reference.csv"),
    Each("fuzz/seeds/opensfm"),
    Beside("starts/rotterdam_oblique/ref_images_wgs84.txt"),
];

/// Some of all kinds, for who asks what a file is.
const ANY: &[Source] = &[
    Each("fuzz/seeds/cityjson"),
    Each("fuzz/seeds/citygml"),
    Each("fuzz/seeds/opensfm"),
    Each("fuzz/seeds/control"),
    Each("fuzz/seeds/positions"),
    Each("fuzz/seeds/ply"),
    Each("fuzz/seeds/ply_mesh"),
    File("tests/data/city/good.obj"),
    File("tests/data/city/good.glb"),
    File("tests/data/positions/geo.txt"),
    Folder("tests/data/positions/exif", ""),
    Folder("fuzz/seeds/colmap_text", ""),
    Folder("fuzz/seeds/nerfstudio", ""),
];

/// The format of a name.
pub fn named(name: &str) -> Result<&'static Format, String> {
    FORMATS.iter().find(|format| format.name == name).ok_or_else(|| {
        let known: Vec<&str> = FORMATS.iter().map(|format| format.name).collect();
        format!("no format is called `{name}`; there are {}", known.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_a_name_of_its_own_and_seeds_in_the_repository() {
        for format in &FORMATS {
            assert_eq!(named(format.name).unwrap().name, format.name);
            assert!(!crate::seeds::cases(format.seeds).unwrap().is_empty(), "{}", format.name);
            assert_eq!(FORMATS.iter().filter(|other| other.name == format.name).count(), 1);
        }
        assert!(named("dwg").is_err());
    }

    #[test]
    fn every_format_has_a_target_of_cargo_fuzz() {
        let manifest = include_str!("../Cargo.toml");
        for format in &FORMATS {
            assert!(manifest.contains(&format!("path = \"fuzz_targets/{}.rs\"", format.name)), "{}", format.name);
        }
    }
}
