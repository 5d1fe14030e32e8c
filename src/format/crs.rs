//! Reference systems as files spell them.

use serde::{Deserialize, Serialize};

use super::wkt::{is_wkt, wkt_crs};

/// A reference system: what the file says, and what is understood of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct Crs {
    /// As the file, or the user, spells it.
    pub text: String,
    /// EPSG code of the horizontal or the whole system.
    pub epsg: Option<u32>,
    /// What heights are counted from: a name ("NAP height") or a code ("EPSG:7837").
    pub vertical: Option<String>,
}

/// Codes of the registry have four or five digits; shorter numbers are versions.
const CODES: std::ops::RangeInclusive<u32> = 1024..=99_999;

/// Whole systems with heights, and horizontal ones whose coordinates are latitude and longitude.
/// Source: EPSG dataset, epsg.org.
const COMPOUND: [(u32, &str); 12] = [
    (5554, "DHHN92 height"),
    (5555, "DHHN92 height"),
    (5556, "DHHN92 height"),
    (5971, "NN2000 height"),
    (5972, "NN2000 height"),
    (5973, "NN2000 height"),
    (5698, "NGF-IGN69 height"),
    (6697, "JGD2011 (vertical) height"),
    (7405, "ODN height"),
    (7415, "NAP height"),
    (4979, "ellipsoidal height"),
    (4937, "ellipsoidal height"),
];
const VERTICAL: [(u32, &str); 14] = [
    (3855, "EGM2008 height"),
    (5701, "ODN height"),
    (5703, "NAVD88 height"),
    (5709, "NAP height"),
    (5720, "NGF-IGN69 height"),
    (5728, "LN02 height"),
    (5729, "LHN95 height"),
    (5773, "EGM96 height"),
    (5783, "DHHN92 height"),
    (5613, "RH2000 height"),
    (5621, "EVRF2007 height"),
    (5941, "NN2000 height"),
    (6695, "JGD2011 (vertical) height"),
    (7837, "DHHN2016 height"),
];
const GEOGRAPHIC: [u32; 16] =
    [4326, 4979, 4258, 4937, 4269, 4267, 4171, 4283, 4289, 4314, 4612, 4667, 6668, 6697, 7843, 7844];

/// Names without a code, in lower case without blanks and signs, and the codes that they mean.
const NAMES: [(&str, u32); 7] = [
    ("amersfoortrdnew", 28992),
    ("rdnew", 28992),
    ("ch1903lv95", 2056),
    ("ch1903lv03", 21781),
    ("rgf93lambert93", 2154),
    ("osgb36britishnationalgrid", 27700),
    ("crs84", 4326),
];

impl Crs {
    /// What a text means, as far as it can be told; it is kept in any case.
    pub fn understood(text: &str) -> Crs {
        let text = text.trim();
        let codes = if is_wkt(text) { codes_of_wkt(text) } else { codes_of(text) };
        let epsg = codes.first().copied().or_else(|| code_of_name(text));
        let vertical = match codes.get(1) {
            Some(code) => Some(named(&VERTICAL, *code).unwrap_or_else(|| format!("EPSG:{code}"))),
            None => epsg.and_then(|code| named(&COMPOUND, code)).or_else(|| height_of_name(text)),
        };
        Crs { text: text.to_owned(), epsg, vertical }
    }

    /// Whether coordinates are degrees.
    pub fn is_geographic(&self) -> bool {
        self.epsg.is_some_and(|code| GEOGRAPHIC.contains(&code))
    }

    /// Whether the first coordinate is the longitude, as in CRS84 and unlike the EPSG codes of degrees.
    pub fn is_longitude_first(&self) -> bool {
        plain(&self.text).ends_with("crs84")
    }
}

fn named(table: &[(u32, &str)], code: u32) -> Option<String> {
    table.iter().find(|entry| entry.0 == code).map(|entry| entry.1.to_owned())
}

/// Codes in the order in which they are written: `EPSG:1`, `EPSG:1+2`, `urn:ogc:def:crs:EPSG:9.1:1`, `.../EPSG/0/1`, `...epsg.xml#1`,
/// `urn:ogc:def:crs,crs:EPSG::1,crs:EPSG::2`, or a number alone.
fn codes_of(text: &str) -> Vec<u32> {
    let lower = text.to_ascii_lowercase();
    let mut codes = Vec::new();
    let mut pieces = lower.split("epsg");
    let alone = pieces.next().unwrap_or_default();
    if let Some(code) = code(alone) {
        codes.push(code);
    }
    for piece in pieces {
        let piece = piece.strip_prefix(".xml").unwrap_or(piece);
        // After a plus stands the vertical code; of version and code the code is last.
        let beginning =
            piece.split(|c: char| !(c.is_ascii_digit() || "+:./#* ".contains(c))).next().unwrap_or_default();
        let codes_of_piece = beginning
            .split('+')
            .filter_map(|part| part.split(|c: char| !c.is_ascii_digit()).filter_map(code).next_back());
        codes.extend(codes_of_piece);
    }
    codes
}

fn code(digits: &str) -> Option<u32> {
    digits.parse().ok().filter(|code| CODES.contains(code))
}

/// Of a compound system as a whole, else of its two parts.
fn codes_of_wkt(text: &str) -> Vec<u32> {
    let understood = wkt_crs(text);
    match understood.compound_epsg {
        Some(whole) => vec![whole],
        None => understood.epsg.into_iter().chain(understood.vertical_epsg).collect(),
    }
}

/// Letters and digits alone, in lower case.
fn plain(text: &str) -> String {
    text.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// Names of national grids, and `ETRS89_UTM32`, `DE_DHDN_3GK3`, `WGS 84 / UTM zone 33N` in any punctuation.
fn code_of_name(text: &str) -> Option<u32> {
    let horizontal = text.split('*').next().unwrap_or_default();
    let name = plain(horizontal);
    if let Some(entry) = NAMES.iter().find(|entry| name.ends_with(entry.0)) {
        return Some(entry.1);
    }
    let number_after = |word: &str| -> Option<(u32, String)> {
        let rest = name.split_once(word)?.1;
        let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
        Some((digits.parse().ok()?, rest.trim_start_matches(|c: char| c.is_ascii_digit()).to_owned()))
    };
    if let Some((zone, rest)) = number_after("utmzone").or_else(|| number_after("utm")) {
        return match zone {
            28..=38 if name.contains("etrs89") => Some(25_800 + zone),
            1..=60 if name.contains("wgs84") && rest.starts_with('s') => Some(32_700 + zone),
            1..=60 if name.contains("wgs84") => Some(32_600 + zone),
            _ => None,
        };
    }
    // Gauss-Krueger strips of three degrees on DHDN.
    match number_after("3gk") {
        Some((strip @ 2..=5, _)) => Some(31_464 + strip),
        _ => None,
    }
}

/// Of `urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH` the height's system, `DHHN2016`.
fn height_of_name(text: &str) -> Option<String> {
    let name = text.split_once('*')?.1;
    let name = name.strip_prefix("DE_").unwrap_or(name);
    let name = name.strip_suffix("_NH").or_else(|| name.strip_suffix("_NN")).unwrap_or(name);
    (!name.is_empty()).then(|| format!("{name} height"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_found_in_all_spellings() {
        for (text, epsg, vertical) in [
            ("https://www.opengis.net/def/crs/EPSG/0/7415", Some(7415), Some("NAP height")),
            ("http://www.opengis.net/def/crs/EPSG/9.9.1/2056", Some(2056), None),
            ("http://www.opengis.net/gml/srs/epsg.xml#28992", Some(28992), None),
            ("urn:ogc:def:crs:EPSG::7415", Some(7415), Some("NAP height")),
            ("urn:ogc:def:crs:EPSG:6.9:25832", Some(25832), None),
            ("urn:x-ogc:def:crs:EPSG:31467", Some(31467), None),
            ("urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::5783", Some(25832), Some("DHHN92 height")),
            ("urn:ogc:def:crs,crs:EPSG:6.12:3068,crs:EPSG:6.12:5783", Some(3068), Some("DHHN92 height")),
            ("EPSG:28992", Some(28992), None),
            ("epsg:25832+7837", Some(25832), Some("DHHN2016 height")),
            ("EPSG:25832+EPSG:9999", Some(25832), Some("EPSG:9999")),
            ("EPSG: 6697", Some(6697), Some("JGD2011 (vertical) height")),
            ("urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH", Some(25832), Some("DHHN2016 height")),
            ("urn:adv:crs:ETRS89_UTM33*DE_DHHN92_NH", Some(25833), Some("DHHN92 height")),
            ("urn:adv:crs:DE_DHDN_3GK3", Some(31467), None),
            ("ETRS89 / UTM zone 32N", Some(25832), None),
            ("WGS 84 / UTM zone 33S", Some(32733), None),
            ("Amersfoort / RD New", Some(28992), None),
            ("CH1903+ / LV95", Some(2056), None),
            ("urn:ogc:def:crs:OGC:1.3:CRS84", Some(4326), None),
            ("2056", Some(2056), None),
            (
                r#"PROJCS["RD",GEOGCS["A",AUTHORITY["EPSG","4289"]],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AUTHORITY["EPSG","28992"]]"#,
                Some(28992),
                None,
            ),
            (
                r#"COMPD_CS["x",PROJCS["u",AUTHORITY["EPSG","25832"]],VERT_CS["h",AUTHORITY["EPSG","5783"]]]"#,
                Some(25832),
                Some("DHHN92 height"),
            ),
            (r#"PROJCRS["u",BASEGEOGCRS["g",ID["EPSG",4258]],ID["EPSG",25833]]"#, Some(25833), None),
        ] {
            let crs = Crs::understood(text);
            assert_eq!((crs.epsg, crs.vertical.as_deref(), crs.text.as_str()), (epsg, vertical, text), "{text}");
        }
    }

    #[test]
    fn what_is_not_understood_is_kept_as_text() {
        for text in ["CH1903", "local", "", "urn:ogc:def:crs:IGNF::LAMB93", "EPSG:", "EPSG:7", "site grid 12"] {
            let crs = Crs::understood(text);
            assert_eq!((crs.text.as_str(), crs.epsg, crs.vertical), (text, None, None));
        }
    }

    #[test]
    fn degrees_are_told_by_their_code() {
        assert!(Crs::understood("http://www.opengis.net/def/crs/EPSG/0/6697").is_geographic());
        assert!(Crs::understood("urn:ogc:def:crs:OGC::CRS84").is_longitude_first());
        assert!(!Crs::understood("EPSG:7415").is_geographic());
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_understood_or_kept(text in "(EPSG|epsg|utm|UTM zone |urn:ogc|CRS84|[0-9:+./ *é#\\[\\]\",]|\\PC){0,12}") {
            let crs = Crs::understood(&text);
            assert_eq!(crs.text, text.trim());
            assert!(crs.epsg.is_none_or(|code| CODES.contains(&code)), "{crs:?}");
        }

        #[test]
        fn codes_are_found_in_any_case_and_with_a_vertical_one(code in 1024..=32_767_u32, vertical in 5600..=5799_u32, is_upper: bool) {
            let text = format!("EPSG:{code}+{vertical}");
            let crs = Crs::understood(&if is_upper { text } else { text.to_lowercase() });
            assert_eq!(crs.epsg, Some(code));
            assert!(crs.vertical.is_some());
        }
    }
}
