//! What the heights of houses say of the unit of coordinates.

use super::source::Source;
use super::{CityRole, CityUnit};
use crate::geometry::{Point3, Vector3};

/// Metres between which the middle one of a city's houses is high: garages to towers.
const HOUSE_M: (f64, f64) = (1.5, 120.0);

/// Metres; the middle house of nine city models (Amsterdam, Delft, Den Haag, Ingolstadt, Rotterdam) is 3 to 15 high.
const COMMON_HOUSE_M: f64 = 9.0;

/// Middle height above which feet are as likely as metres: the blocks of Berlin and Paris are as high at most.
const HIGH_FOR_METRES: f64 = 22.0;

/// Objects from which on their heights tell more than those of single walls.
const FEW_OBJECTS: usize = 3;

/// The sine of the slope of what still counts as a wall.
const UPRIGHT: f64 = 0.1;

/// Units that files are in by mistake.
const CANDIDATES: [CityUnit; 2] = [CityUnit::Centimetre, CityUnit::Millimetre];

/// A unit that the heights of houses suggest in place of metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UnitGuess {
    pub unit: CityUnit,
    /// Height of the middle house, in the file's own unit.
    pub height: f64,
}

/// Looks at the city files, terrain left out; `None` where metres are as good as anything.
pub(super) fn guess(sources: &[Source]) -> Option<UnitGuess> {
    let city: Vec<&Source> = sources.iter().filter(|source| source.role == CityRole::City).collect();
    let houses: Vec<(f64, f64)> = city.iter().flat_map(|source| houses_of(source)).collect();
    let is_of_houses = houses.len() >= FEW_OBJECTS;
    let heights = if is_of_houses { houses } else { city.iter().flat_map(|source| walls_of(source)).collect() };
    guessed(heights, is_of_houses)
}

/// The same by the heights of objects, where these are many.
pub(super) fn guess_by_houses(heights: Vec<f64>) -> Option<UnitGuess> {
    let is_of_houses = heights.len() >= FEW_OBJECTS;
    guessed(heights.into_iter().map(|height| (height, 1.0)).collect(), is_of_houses)
}

/// Height of each object of a file that has one.
pub(super) fn heights_of_houses(source: &Source) -> Vec<f64> {
    houses_of(source).into_iter().map(|(height, _)| height).collect()
}

fn guessed(heights: Vec<(f64, f64)>, is_of_houses: bool) -> Option<UnitGuess> {
    let height = weighted_median(heights)?;
    if height > HOUSE_M.1 {
        let fits = |unit: &CityUnit| {
            let metres = height * unit.metres();
            metres >= HOUSE_M.0 && metres <= HOUSE_M.1
        };
        let oddity = |unit: &CityUnit| (height * unit.metres() / COMMON_HOUSE_M).ln().abs();
        let unit = CANDIDATES.into_iter().filter(fits).min_by(|a, b| oddity(a).total_cmp(&oddity(b)))?;
        return Some(UnitGuess { unit, height });
    }
    (is_of_houses && height > HIGH_FOR_METRES).then_some(UnitGuess { unit: CityUnit::Foot, height })
}

/// Height of each object that has one, all of one weight.
fn houses_of(source: &Source) -> Vec<(f64, f64)> {
    let mut spans = vec![(f64::INFINITY, f64::NEG_INFINITY); source.objects.len()];
    for face in 0..source.face_count() {
        let (low, high) = &mut spans[source.face_objects[face] as usize];
        for z in source.corners_of(face).iter().map(|&at| source.positions[at as usize].z) {
            (*low, *high) = (low.min(z), high.max(z));
        }
    }
    spans.iter().map(|(low, high)| (high - low, 1.0)).filter(|house| house.0 > 0.0).collect()
}

/// Height and area of each upright face.
fn walls_of(source: &Source) -> Vec<(f64, f64)> {
    let wall = |face: usize| {
        let outline = source.rings_of(face).next()?;
        let corners: Vec<Point3<f64>> = outline.iter().map(|&at| source.positions[at as usize]).collect();
        let first = corners.first()?;
        let fan =
            (1..corners.len().saturating_sub(1)).map(|at| (corners[at] - first).cross(&(corners[at + 1] - first)));
        let area: Vector3<f64> = fan.sum();
        let heights = || corners.iter().map(|corner| corner.z);
        let height = heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
        (height > 0.0 && area.z.abs() < UPRIGHT * area.norm()).then_some((height, area.norm()))
    };
    (0..source.face_count()).filter_map(wall).collect()
}

/// The value up to which half of the weight lies; values and their weights.
fn weighted_median(mut values: Vec<(f64, f64)>) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = values.iter().map(|value| value.1).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let at = values.iter().position(|value| {
        sum += value.1;
        sum >= half
    })?;
    Some(values[at].0)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::format::obj::read_obj;

    /// Objects that are single walls of these heights, four wide.
    fn walls(heights: &[f64], role: CityRole) -> Source {
        let mut text = String::new();
        for (at, height) in heights.iter().enumerate() {
            text += &format!("o {at}\nv 0 {at} 0\nv 4 {at} 0\nv 4 {at} {height}\nv 0 {at} {height}\nf -4 -3 -2 -1\n");
        }
        Source::from_obj(Path::new("city.obj"), role, read_obj(text.as_bytes()).unwrap())
    }

    fn guessed(heights: &[f64]) -> Option<(CityUnit, f64)> {
        guess(&[walls(heights, CityRole::City)]).map(|guess| (guess.unit, guess.height))
    }

    #[test]
    fn the_middle_house_tells_and_towers_and_sheds_do_not() {
        assert_eq!(guessed(&[3.0, 9.0, 9.0, 12.0, 180.0]), None);
        assert_eq!(guessed(&[300.0, 900.0, 950.0]), Some((CityUnit::Centimetre, 900.0)));
        assert_eq!(guessed(&[9000.0, 9000.0, 120.0]), Some((CityUnit::Millimetre, 9000.0)));
        assert_eq!(guessed(&[30.0, 30.0, 30.0, 8.0]), Some((CityUnit::Foot, 30.0)));
        assert_eq!(guessed(&[1e9, 1e9, 1e9]), None, "no unit makes houses of these");
        assert_eq!(guessed(&[]), None);
    }

    #[test]
    fn where_objects_are_few_the_walls_tell_by_their_area() {
        assert_eq!(guessed(&[900.0]), Some((CityUnit::Centimetre, 900.0)));
        // A single high object may be a tower: nothing is said of feet.
        assert_eq!(guessed(&[40.0]), None);
    }

    #[test]
    fn terrain_is_no_house() {
        assert_eq!(guess(&[walls(&[900.0; 5], CityRole::Terrain)]), None);
    }
}
