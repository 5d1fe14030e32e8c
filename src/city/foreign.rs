//! Formats that are not read, by what they begin with, so that each is named with what to do.

/// A format that is not read: what the file begins with, what it is, what to do.
struct Foreign {
    begins: &'static [u8],
    found: &'static str,
    remedy: &'static str,
}

const EXPORT: &str = "export OBJ or glTF from the program that made it";
const UNPACK: &str = "unpack it";
const NO_CITY: &str = "give the city model first";
const CLOUD: &str = "a cloud goes in the place of the reconstruction";

const fn foreign(begins: &'static [u8], found: &'static str, remedy: &'static str) -> Foreign {
    Foreign { begins, found, remedy }
}

/// In the order in which they are tried: longer beginnings before shorter ones that they begin with.
const TABLE: [Foreign; 29] = [
    // Before UTF-16, whose mark it begins with.
    foreign(b"\xFF\xFE\xFF\x0ES\0k\0e\0t\0c\0h\0U\0p\0", "this is a SketchUp file", "export OBJ or glTF from SketchUp"),
    foreign(b"\xFF\xFE", "this is UTF-16 text", "save it as UTF-8"),
    foreign(b"\xFE\xFF", "this is UTF-16 text", "save it as UTF-8"),
    foreign(b"BLENDER", "this is a Blender file", "export OBJ or glTF from Blender"),
    foreign(b"Kaydara FBX Binary", "this is an FBX file", EXPORT),
    foreign(b"; FBX", "this is an FBX file", EXPORT),
    foreign(b"AutoCAD Binary DXF", "this is a DXF drawing", EXPORT),
    foreign(b"AC10", "this is a DWG drawing", EXPORT),
    foreign(
        b"ISO-10303-21",
        "this is an IFC (STEP) file",
        "export OBJ, glTF or CityGML (IfcConvert writes OBJ and glTF)",
    ),
    foreign(b"3D Geometry File Format", "this is a Rhino file", EXPORT),
    foreign(b"PXR-USDC", "this is a USD file", EXPORT),
    foreign(b"#usda", "this is a USD file", EXPORT),
    foreign(b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "this is a 3ds Max or Revit file", EXPORT),
    foreign(b"7z\xBC\xAF\x27\x1C", "this is a 7-Zip archive", UNPACK),
    foreign(b"Rar!", "this is a RAR archive", UNPACK),
    foreign(b"PK\x03\x04", "this is a ZIP archive", UNPACK),
    foreign(b"\x1F\x8B", "this is a gzip archive", UNPACK),
    foreign(b"BZh", "this is a bzip2 archive", UNPACK),
    foreign(b"\xFD7zXZ", "this is an xz archive", UNPACK),
    foreign(b"\x28\xB5\x2F\xFD", "this is a Zstandard archive, or a compressed Blender file", UNPACK),
    foreign(b"%PDF", "this is a PDF document", NO_CITY),
    foreign(b"\x89PNG", "this is a PNG picture", NO_CITY),
    foreign(b"\xFF\xD8\xFF", "this is a JPEG picture", NO_CITY),
    foreign(b"II*\0", "this is a TIFF picture", NO_CITY),
    foreign(b"MM\0*", "this is a TIFF picture", NO_CITY),
    foreign(b"LASF", "this is a LAS cloud", CLOUD),
    foreign(b"ASTM-E57", "this is an E57 cloud", CLOUD),
    foreign(b"SQLite format 3\0", "this is a database that is no GeoPackage", "get the city as CityJSON or CityGML"),
    foreign(
        b"fcb\x01",
        "this is FlatCityBuf, which this program was built without",
        "convert it to CityJSON (fcb deser IN.fcb OUT.city.jsonl), or build the program with --features flatcitybuf",
    ),
];

/// What a file is instead of a city model, and what to do about it.
pub(super) fn foreign_format(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let known = TABLE.iter().find(|foreign| bytes.starts_with(foreign.begins));
    known.map(|foreign| (foreign.found, foreign.remedy)).or_else(|| by_structure(bytes))
}

/// What has no mark at its beginning: its own length tells.
fn by_structure(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let number =
        |at: usize| -> Option<u64> { Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?).into()) };
    let length = bytes.len() as u64;
    // The main chunk 0x4D4D holds the whole file.
    if bytes.starts_with(b"MM") && number(2) == Some(length) {
        return Some(("this is a 3DS file", EXPORT));
    }
    let text = &bytes[..bytes.len().min(LOOKED_AT)];
    let mut lines = text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    if lines.next() == Some(b"0") && lines.next() == Some(b"SECTION") {
        return Some(("this is a DXF drawing", EXPORT));
    }
    None
}

/// A DXF drawing says within its first lines what it is.
const LOOKED_AT: usize = 256;
