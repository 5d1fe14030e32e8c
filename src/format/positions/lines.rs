//! Lines of words: `name X Y Z` (COLMAP's model_aligner), and `geo.txt` of ODM, whose first line names the coordinate system.
//!
//! ODM (docs.opendronemap.org, geo): `image_name geo_x geo_y [geo_z] [omega phi kappa] [horizontal accuracy] [vertical accuracy]`.
//! COLMAP (its FAQ, geo-registration): `image_name X Y Z`, or latitude, longitude and altitude.

use std::path::Path;

use super::error::PositionsError;
use super::frame::{Frame, GEOGRAPHIC, frame_of_line};
use super::record::{PositionsFile, StoredPosition, look_like_degrees, sigma};

const EXPECTED: &str = "a photograph's name, X, Y and Z";

/// Words after the three coordinates: three angles, then the two accuracies.
const HORIZONTAL_ACCURACY: usize = 6;
const VERTICAL_ACCURACY: usize = 7;

/// Reads the lines of a text.
pub(super) fn parse(text: &str, path: &Path) -> Result<PositionsFile, PositionsError> {
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())).peekable();
    let named = lines.peek().and_then(|(_, first)| frame_of_line(first));
    if named.is_some() {
        lines.next();
    }
    let mut positions = Vec::new();
    for (line, text) in lines.filter(|(_, text)| !text.is_empty() && !text.starts_with('#')) {
        let fault = |found| PositionsError::Line { path: path.into(), line, found, expected: EXPECTED };
        positions.push(position(text).map_err(fault)?);
    }
    let format = if named.is_some() { "geo.txt" } else { "name X Y Z" };
    let frame = match named {
        Some(frame) => frame,
        None if look_like_degrees(&positions) => {
            // COLMAP's order is latitude, longitude; what is no latitude stands the other way round.
            let latitude_first = positions.iter().all(|p| p.east_north.is_some_and(|[first, _]| first.abs() <= 90.0));
            if latitude_first {
                positions.iter_mut().filter_map(|p| p.east_north.as_mut()).for_each(|place| place.reverse());
            }
            GEOGRAPHIC
        }
        None => Frame::OfTheCity,
    };
    Ok(PositionsFile { format, frame, positions, warnings: Vec::new() })
}

/// Words between blanks or commas.
fn position(line: &str) -> Result<StoredPosition, String> {
    let words: Vec<&str> =
        line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()).collect();
    let after_name = words_of_name(&words);
    let (name, rest) = words.split_at(after_name);
    let number = |k: usize| rest.get(k).map(|word| finite(word)).transpose();
    let [Some(x), Some(y)] = [number(0)?, number(1)?] else {
        return Err(format!("{} words: {line}", words.len()));
    };
    let start = StoredPosition::at(&name.join(" "), [x, y], number(2)?);
    let optional = |k: usize| rest.get(k).and_then(|word| word.parse::<f64>().ok());
    Ok(StoredPosition {
        sigma_m: sigma(optional(HORIZONTAL_ACCURACY)),
        height_sigma_m: sigma(optional(VERTICAL_ACCURACY)),
        ..start
    })
}

/// Names may have blanks in them: then they end with the word that has a file's ending.
fn words_of_name(words: &[&str]) -> usize {
    let has_ending = |word: &&str| {
        word.rsplit_once('.').is_some_and(|(_, ending)| ending.starts_with(|c: char| c.is_ascii_alphabetic()))
    };
    words.iter().rposition(has_ending).map_or(1, |last| last + 1).min(words.len())
}

pub(super) fn finite(word: &str) -> Result<f64, String> {
    word.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| format!("{word} is no number"))
}
