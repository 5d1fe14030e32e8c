//! What well-known text says of a coordinate reference system: its code and its units (OGC 01-009 and 18-010).

/// What could be understood.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WktCrs {
    /// EPSG code of the projected system, or else of the geographic one.
    pub epsg: Option<u32>,
    /// ... of a compound system as a whole, and of its heights.
    pub compound_epsg: Option<u32>,
    pub vertical_epsg: Option<u32>,
    /// True where coordinates are latitude and longitude.
    pub is_geographic: bool,
    pub horizontal: Option<WktUnit>,
    pub vertical: Option<WktUnit>,
}

/// A unit of length.
#[derive(Clone, Debug, PartialEq)]
pub struct WktUnit {
    pub name: String,
    pub metres: f64,
}

/// Keywords of either version.
const PROJECTED: [&str; 3] = ["PROJCS[", "PROJCRS[", "PROJECTEDCRS["];
const GEOGRAPHIC: [&str; 4] = ["GEOGCS[", "GEOGCRS[", "GEODCRS[", "GEOGRAPHICCRS["];
const GEOCENTRIC: [&str; 1] = ["GEOCCS["];
const COMPOUND: [&str; 2] = ["COMPD_CS[", "COMPOUNDCRS["];
const BOUND: [&str; 1] = ["BOUNDCRS["];
const VERTICAL: [&str; 3] = ["VERT_CS[", "VERTCRS[", "VERTICALCRS["];
const UNITS: [&str; 2] = ["UNIT[", "LENGTHUNIT["];
const CODES: [&str; 2] = ["AUTHORITY[", "ID["];

/// Whether a text is one, by how it begins.
pub fn is_wkt(text: &str) -> bool {
    let systems = [&PROJECTED[..], &GEOGRAPHIC, &GEOCENTRIC, &COMPOUND, &BOUND];
    systems.iter().any(|keywords| keywords.iter().any(|keyword| text.starts_with(keyword)))
}

pub fn wkt_crs(text: &str) -> WktCrs {
    let first = |keywords: &[&str]| keywords.iter().find_map(|keyword| inside(text, keyword));
    let (projected, geographic, vertical) = (first(&PROJECTED), first(&GEOGRAPHIC), first(&VERTICAL));
    WktCrs {
        epsg: projected.or(geographic).or(first(&GEOCENTRIC)).and_then(code),
        compound_epsg: first(&COMPOUND).and_then(code),
        vertical_epsg: vertical.and_then(code),
        is_geographic: projected.is_none() && geographic.is_some(),
        horizontal: projected.and_then(unit),
        vertical: vertical.and_then(unit),
    }
}

/// What stands between the brackets after the first `keyword` (which ends with a bracket and does not begin within a word).
fn inside<'a>(text: &'a str, keyword: &str) -> Option<&'a str> {
    let begins_a_word =
        |at: &usize| !text.get(..*at).unwrap_or_default().ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
    let at = text.match_indices(keyword).map(|(at, _)| at).find(begins_a_word)?;
    let rest = text.get(at + keyword.len()..)?;
    let end = children(rest).last().map_or(0, |(_, end)| *end);
    rest.get(..end)
}

/// The places of the parts at the top of a list, apart by commas, up to the bracket that closes it.
fn children(list: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let (mut depth, mut is_quoted, mut start) = (0usize, false, 0);
    for (at, byte) in list.bytes().enumerate() {
        match byte {
            b'"' => is_quoted = !is_quoted,
            _ if is_quoted => {}
            b'[' | b'(' => depth += 1,
            b']' | b')' if depth == 0 => {
                found.push((start, at));
                return found;
            }
            b']' | b')' => depth -= 1,
            b',' if depth == 0 => {
                found.push((start, at));
                start = at + 1;
            }
            _ => {}
        }
    }
    found.push((start, list.len()));
    found
}

/// The parts at the top of a list that begin with one of the keywords, without it.
fn parts<'a>(list: &'a str, keywords: &'static [&str]) -> impl DoubleEndedIterator<Item = &'a str> {
    children(list).into_iter().filter_map(move |(start, end)| {
        let part = list.get(start..end)?.trim();
        keywords.iter().find_map(|keyword| part.strip_prefix(keyword))
    })
}

fn code(list: &str) -> Option<u32> {
    let words = |part: &str| -> Vec<String> {
        part.split([',', ']']).map(|word| word.trim().trim_matches('"').to_owned()).collect()
    };
    parts(list, &CODES).rev().map(words).find_map(|words| match words.as_slice() {
        [authority, code, ..] if authority.eq_ignore_ascii_case("EPSG") => code.parse().ok(),
        _ => None,
    })
}

/// The unit of length of a system; of its axes where it has none of its own.
fn unit(list: &str) -> Option<WktUnit> {
    let of = |list: &str| {
        let found = parts(list, &UNITS).next()?;
        let name = found.split('"').nth(1)?.to_owned();
        // The code of a unit may follow its size.
        let after_name = found.split('"').nth(2)?.trim_start_matches([',', ' ']);
        let metres = after_name.split([',', ']']).next()?.trim().parse().ok()?;
        Some(WktUnit { name, metres })
    };
    of(list).or_else(|| parts(list, &["AXIS["]).find_map(of))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(name: &str, metres: f64) -> Option<WktUnit> {
        Some(WktUnit { name: name.into(), metres })
    }

    #[test]
    fn a_compound_system_of_the_first_version_is_understood() {
        let text = r#"COMPD_CS["NAD83 / Oregon GIC Lambert (ft) + NAVD88 height (ftUS)",PROJCS["NAD83 / Oregon GIC Lambert (ft)",
            GEOGCS["NAD83",DATUM["D",SPHEROID["GRS 1980",6378137,298.25,AUTHORITY["EPSG","7019"]]],UNIT["degree",0.0174532925199433,
            AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4269"]],PROJECTION["Lambert_Conformal_Conic_2SP"],
            UNIT["foot",0.3048,AUTHORITY["EPSG","9002"]],AXIS["Easting",EAST],AUTHORITY["EPSG","2992"]],VERT_CS["NAVD88 height",
            VERT_DATUM["North",2005],UNIT["US survey foot",0.304800609601219,AUTHORITY["EPSG","9003"]],AXIS["Up",UP],
            AUTHORITY["EPSG","6360"]]]"#;
        let crs = wkt_crs(text);
        assert_eq!((crs.epsg, crs.is_geographic), (Some(2992), false));
        assert_eq!(crs.horizontal, unit("foot", 0.3048));
        assert_eq!(crs.vertical, unit("US survey foot", 0.304800609601219));
    }

    #[test]
    fn a_system_of_the_second_version_keeps_its_unit_with_its_axes() {
        let text = r#"PROJCRS["ETRS89 / UTM zone 32N",BASEGEOGCRS["ETRS89",DATUM["x",ELLIPSOID["GRS 1980",6378137,298.2,
            LENGTHUNIT["metre",1]]],ID["EPSG",4258]],CONVERSION["UTM zone 32N",ID["EPSG",16032]],CS[Cartesian,2],
            AXIS["(E)",east,ORDER[1],LENGTHUNIT["metre",1,ID["EPSG",9001]]],AXIS["(N)",north,ORDER[2]],ID["EPSG",25832]]"#;
        let crs = wkt_crs(text);
        assert_eq!((crs.epsg, crs.horizontal), (Some(25832), unit("metre", 1.0)));
    }

    #[test]
    fn degrees_are_told() {
        let crs = wkt_crs(r#"GEOGCS["WGS 84",DATUM["x"],UNIT["degree",0.017],AUTHORITY["EPSG","4326"]]"#);
        assert_eq!((crs.epsg, crs.is_geographic, crs.horizontal), (Some(4326), true, None));
    }

    #[test]
    fn a_unit_without_a_code_in_place_of_its_own_is_read() {
        let crs = wkt_crs(r#"PROJCS["Local [site], \(own)",UNIT["Meter",1.0]]"#);
        assert_eq!((crs.epsg, crs.horizontal), (None, unit("Meter", 1.0)));
    }

    #[test]
    fn cut_text_and_other_text_say_less_and_never_panic() {
        let text = r#"PROJCS["a",GEOGCS["b",UNIT["degree",1]],UNIT["foot",0.3048,AUTHORITY["EPSG","9002"]],AUTHORITY["EPSG","2992"]]"#;
        for cut in 0..text.len() {
            let _ = wkt_crs(&text[..cut]);
            let _ = wkt_crs(&text[cut..]);
        }
        assert_eq!(wkt_crs("no text of this kind"), WktCrs::default());
        assert_eq!(wkt_crs("]]]],,,\"[["), WktCrs::default());
    }
}
