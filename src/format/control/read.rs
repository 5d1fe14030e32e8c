//! Reads `gcp_list.txt` of ODM and lines of couples.
//!
//! ODM (docs.opendronemap.org, gcp): the coordinate system, then `geo_x geo_y geo_z im_x im_y image_name [gcp_name] [extras]`. Couples:
//! `x y z X Y Z [sigma [name]]`, reconstruction first; the sixth word, a number or a name, tells the one from the other. `check` among the
//! words after a point's name keeps it out of the estimate.

use std::path::Path;

use super::record::{ControlFile, PointRole, PointSight, StoredPoint};
use crate::format::positions::{Frame, PositionsError, frame_of_line};
use crate::format::text::{LARGEST_TEXT_BYTES, read_text};

const EXPECTED: &str = "x y z X Y Z [sigma [name]] (reconstruction, then city), or X Y Z pixel_x pixel_y photograph [name] (gcp_list.txt of ODM)";
const CHECK: &str = "check";

/// Reads control points of either form.
pub fn read_control_points(path: &Path) -> Result<ControlFile, PositionsError> {
    let io = |source| PositionsError::Io { what: "control points", path: path.into(), source };
    parse(&read_text(path, LARGEST_TEXT_BYTES).map_err(io)?, path)
}

pub(super) fn parse(text: &str, path: &Path) -> Result<ControlFile, PositionsError> {
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())).peekable();
    let named = lines.peek().and_then(|(_, first)| frame_of_line(first));
    if named.is_some() {
        lines.next();
    }
    let mut points: Vec<StoredPoint> = Vec::new();
    for (line, text) in lines.filter(|(_, text)| !text.is_empty() && !text.starts_with('#')) {
        let fault = |found| PositionsError::Line { path: path.into(), line, found, expected: EXPECTED };
        add(point(text).map_err(fault)?, &mut points).map_err(fault)?;
    }
    let Some(first) = points.first() else {
        return Err(PositionsError::Content {
            path: path.into(),
            found: "it holds no point".into(),
            expected: EXPECTED,
        });
    };
    let format =
        if matches!(first.sight, PointSight::At(_)) { "control points" } else { "control points in photographs" };
    name_the_nameless(&mut points);
    Ok(ControlFile { format, frame: named.unwrap_or(Frame::OfTheCity), points })
}

/// One line: a couple, or one sight of a point.
fn point(line: &str) -> Result<StoredPoint, String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [a, b, c, d, e, f, rest @ ..] = &words[..] else { return Err(format!("{} words", words.len())) };
    if f.parse::<f64>().is_ok() { couple([a, b, c], [d, e, f], rest) } else { sight([a, b, c], [d, e], &words[5..]) }
}

fn couple(sfm: [&str; 3], city: [&str; 3], rest: &[&str]) -> Result<StoredPoint, String> {
    let (sigma_m, after) = match rest.split_first().map(|(first, after)| (first.parse::<f64>(), after)) {
        Some((Ok(sigma), after)) if sigma.is_finite() && sigma > 0.0 => (Some(sigma), after),
        Some((Ok(sigma), _)) => return Err(format!("a sigma of {sigma}")),
        _ => (None, rest),
    };
    let [east, north, height_m] = numbers(city)?;
    let (name, role) = name_and_role(after);
    Ok(StoredPoint { name, east_north: [east, north], height_m, sigma_m, role, sight: PointSight::At(numbers(sfm)?) })
}

fn sight(city: [&str; 3], pixel: [&str; 2], rest: &[&str]) -> Result<StoredPoint, String> {
    let [east, north, height_m] = numbers(city)?;
    let pixel = numbers(pixel)?;
    let has_ending =
        |word: &&str| word.rsplit_once('.').is_some_and(|(_, ending)| ending.starts_with(|c: char| c.is_alphabetic()));
    // Names of photographs may have blanks in them; then they end with the word that has a file's ending.
    let name_words = rest.iter().position(has_ending).map_or(1, |last| last + 1).min(rest.len());
    let (photograph, after) = rest.split_at(name_words);
    let (name, role) = name_and_role(after);
    let photograph = photograph.join(" ").replace('\\', "/");
    let sight = PointSight::In(vec![(pixel, photograph)]);
    Ok(StoredPoint { name, east_north: [east, north], height_m, sigma_m: None, role, sight })
}

fn name_and_role(words: &[&str]) -> (String, PointRole) {
    let is_check = |word: &&str| word.eq_ignore_ascii_case(CHECK);
    let role = if words.iter().any(is_check) { PointRole::Check } else { PointRole::Control };
    (words.first().filter(|word| !is_check(word)).map_or(String::new(), |word| (*word).to_owned()), role)
}

fn numbers<const N: usize>(words: [&str; N]) -> Result<[f64; N], String> {
    let mut numbers = [0.0; N];
    for (number, word) in numbers.iter_mut().zip(words) {
        *number = word.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| format!("{word} is no number"))?;
    }
    Ok(numbers)
}

/// Sights of one point are joined: those of one name, or of one place where they have none.
fn add(new: StoredPoint, points: &mut Vec<StoredPoint>) -> Result<(), String> {
    let PointSight::In(sights) = &new.sight else {
        points.push(new);
        return Ok(());
    };
    let place = |p: &StoredPoint| (p.east_north, p.height_m);
    let same = |p: &&mut StoredPoint| {
        if new.name.is_empty() { p.name.is_empty() && place(p) == place(&new) } else { p.name == new.name }
    };
    let Some(known) = points.iter_mut().find(same) else {
        points.push(new);
        return Ok(());
    };
    if place(known) != place(&new) {
        return Err(format!("{} stands at another place than in an earlier line", new.name));
    }
    if new.role == PointRole::Check {
        known.role = PointRole::Check;
    }
    match &mut known.sight {
        PointSight::In(known) => known.extend(sights.iter().cloned()),
        PointSight::At(_) => return Err(format!("{} has coordinates in an earlier line and pixels in this", new.name)),
    }
    Ok(())
}

fn name_the_nameless(points: &mut [StoredPoint]) {
    for (index, point) in points.iter_mut().enumerate().filter(|(_, point)| point.name.is_empty()) {
        point.name = format!("point {}", index + 1);
    }
}
