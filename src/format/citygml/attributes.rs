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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_told_by_their_local_names() {
        let text = r##"Polygon gml:id="a&amp;b" xlink:href="#c" srsName=" EPSG:1 " srsDimension='3' orientation="-" name="x""##;
        let element = BytesStart::from_content(text, 7);
        let found = Attributes::of(&element).unwrap();
        assert_eq!((found.id.as_deref(), found.href.as_deref()), (Some("a&b"), Some("#c")));
        assert_eq!((found.srs_name.as_deref(), found.srs_dimension.as_deref()), (Some(" EPSG:1 "), Some("3")));
        assert!(found.is_reversed && !found.has_separators && found.version.is_none());
    }

    #[test]
    fn the_version_is_the_end_of_any_namespace_of_citygml() {
        for (namespace, expected) in [
            ("http://www.opengis.net/citygml/2.0", Some("2.0")),
            ("http://www.opengis.net/citygml/building/1.0", Some("1.0")),
            ("http://www.opengis.net/citygml/profiles/base/3.0", Some("3.0")),
            ("http://www.opengis.net/citygml/building", None),
            ("http://www.opengis.net/gml/3.2", None),
        ] {
            assert_eq!(version(namespace).as_deref(), expected, "{namespace}");
        }
    }

    #[test]
    fn separators_other_than_comma_and_space_are_noticed() {
        for (text, expected) in
            [(r#"c cs="," decimal="." ts=" ""#, false), (r#"c cs=";""#, true), (r#"c decimal=",""#, true)]
        {
            assert_eq!(Attributes::of(&BytesStart::from_content(text, 1)).unwrap().has_separators, expected, "{text}");
        }
    }

    #[test]
    fn broken_attributes_are_an_error() {
        for text in [r#"a gml:id="&nobody;""#, "a gml:id=c", "a gml:id", r#"a gml:id="x"#] {
            assert!(Attributes::of(&BytesStart::from_content(text, 1)).is_err(), "{text}");
        }
    }
}
