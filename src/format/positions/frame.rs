//! Which coordinate system positions are in, as files name it.

/// Longitude and latitude of WGS 84 in degrees (EPSG writes latitude first; the records here never do).
pub const GEOGRAPHIC: Frame = Frame::Epsg(4326);

/// The frame of a file's coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Frame {
    /// The file does not say: that of the city.
    OfTheCity,
    /// A code of the EPSG register.
    Epsg(u32),
    /// A PROJ string.
    Proj(String),
    /// East, north and up of the plane that touches the ellipsoid of WGS 84 at a point.
    Tangent { latitude_deg: f64, longitude_deg: f64, height_m: f64 },
}

/// The frame that the first line of `geo.txt` and `gcp_list.txt` names (ODM's documentation: "EPSG:4326", "+proj=utm ...", "WGS84 UTM 32N");
/// `None` where the line is none of these.
pub(in crate::format) fn frame_of_line(line: &str) -> Option<Frame> {
    let line = line.trim().trim_start_matches('#').trim();
    if line.starts_with('+') {
        return line.contains("proj=").then(|| Frame::Proj(line.to_owned()));
    }
    let words: Vec<String> = line.split_whitespace().map(str::to_uppercase).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["WGS84"] => Some(GEOGRAPHIC),
        ["WGS84", "UTM", zone] => utm(zone),
        [one] if one.starts_with("EPSG") => epsg_in(one).map(Frame::Epsg),
        _ => None,
    }
}

/// EPSG numbers zones of WGS 84 / UTM from 32601 on the northern and 32701 on the southern half.
fn utm(zone: &str) -> Option<Frame> {
    let (number, half) = zone.split_at_checked(zone.len().checked_sub(1)?)?;
    let number: u32 = number.parse().ok().filter(|zone| (1..=60).contains(zone))?;
    match half {
        "N" => Some(Frame::Epsg(32600 + number)),
        "S" => Some(Frame::Epsg(32700 + number)),
        _ => None,
    }
}

/// The code after "EPSG" and its colons, wherever it stands in a text.
pub(in crate::format) fn epsg_in(text: &str) -> Option<u32> {
    let upper = text.to_uppercase();
    let (_, after) = upper.split_once("EPSG")?;
    let digits: String =
        after.trim_start_matches([':', ' ', '"', '\'']).chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn understands_the_first_lines_that_odm_documents() {
        for (line, frame) in [
            ("EPSG:4326", Some(GEOGRAPHIC)),
            ("epsg:28992\r", Some(Frame::Epsg(28992))),
            ("WGS84 UTM 32N", Some(Frame::Epsg(32632))),
            ("WGS84 UTM 17S", Some(Frame::Epsg(32717))),
            ("+proj=utm +zone=32 +ellps=WGS84", Some(Frame::Proj("+proj=utm +zone=32 +ellps=WGS84".into()))),
            ("WGS84 UTM 99N", None),
            ("WGS84 UTM Ä", None),
            ("p001.jpg 4.4 51.9 73.2", None),
            ("EPSG:", None),
            ("", None),
        ] {
            assert_eq!(frame_of_line(line), frame, "{line}");
        }
    }

    #[test]
    fn finds_a_code_in_a_remark() {
        assert_eq!(epsg_in("CoordinateSystem: WGS 84 (EPSG::4326)"), Some(4326));
        assert_eq!(epsg_in("AUTHORITY[\"EPSG\",\"28992\"]"), None);
        assert_eq!(epsg_in("EPSG:99999999999999"), None);
    }
}
