//! The attributes that a reader of polygons looks at.

use std::borrow::Cow;

use quick_xml::XmlVersion;
use quick_xml::events::BytesStart;

/// What an element says of itself.
#[derive(Debug, Default)]
pub(super) struct Attributes<'a> {
    /// `gml:id`
    pub id: Option<Cow<'a, str>>,
    /// `xlink:href`
    pub href: Option<Cow<'a, str>>,
    pub srs_name: Option<Cow<'a, str>>,
    pub srs_dimension: Option<Cow<'a, str>>,
    /// Whether `orientation` is `-`.
    pub is_reversed: bool,
    /// Version of a CityGML namespace that is declared here.
    pub version: Option<String>,
    /// Whether `coordinates` are separated otherwise than by comma and space.
    pub has_separators: bool,
}

impl<'a> Attributes<'a> {
    pub fn of(element: &'a BytesStart<'_>) -> Result<Attributes<'a>, String> {
        let mut found = Attributes::default();
        // Whether a name stands twice is asked of no list: that takes time by its square.
        for attribute in element.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| error.to_string())?;
            let value = || attribute.normalized_value(XmlVersion::Explicit1_0).map_err(|error| error.to_string());
            match attribute.key.as_ref() {
                "srsName" => found.srs_name = Some(value()?),
                "srsDimension" => found.srs_dimension = Some(value()?),
                "orientation" => found.is_reversed = value()?.trim() == "-",
                "decimal" => found.has_separators |= value()? != ".",
                "cs" => found.has_separators |= value()? != ",",
                "ts" => found.has_separators |= !value()?.trim().is_empty(),
                key if key.starts_with("xmlns") => found.version = found.version.take().or(version(&value()?)),
                key if key == "id" || key.ends_with(":id") => found.id = Some(value()?),
                key if key.ends_with(":href") => found.href = Some(value()?),
                _ => {}
            }
        }
        Ok(found)
    }
}

/// `http://www.opengis.net/citygml/building/2.0` is of version 2.0.
fn version(namespace: &str) -> Option<String> {
    let (_, module) = namespace.split_once("opengis.net/citygml/")?;
    let version = module.rsplit('/').next()?;
    let is_version = version.starts_with(|c: char| c.is_ascii_digit()) && version.len() < 8;
    is_version.then(|| version.to_owned())
}
