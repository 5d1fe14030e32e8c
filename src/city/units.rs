//! What the heights of houses say of the unit of coordinates.

use super::source::Source;
use super::{CityRole, CityUnit};
use crate::geometry::{Point3, Vector3};

/// Metres between which the middle one of a city's houses is high: garages to towers.
const HOUSE_M: (f64, f64) = (1.5, 120.0);

/// Metres; the middle house of the cities that this was tried on is 5 to 14 high.
const COMMON_HOUSE_M: f64 = 9.0;

/// Middle height above which feet are as likely as metres, where houses are not slender.
const HIGH_FOR_METRES: f64 = 20.0;

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
    let houses: Vec<[f64; 2]> = city.iter().flat_map(|source| houses_of(source)).collect();
    let heights: Vec<(f64, f64)> = if houses.len() >= FEW_OBJECTS {
        houses.iter().map(|house| (house[0], 1.0)).collect()
    } else {
        city.iter().flat_map(|source| walls_of(source)).collect()
    };
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
    let width = weighted_median(houses.iter().map(|house| (house[1], 1.0)).collect())?;
    let is_broad = width > height;
    (houses.len() >= FEW_OBJECTS && height > HIGH_FOR_METRES && is_broad)
        .then_some(UnitGuess { unit: CityUnit::Foot, height })
}

/// Height and width of each object that has a height.
fn houses_of(source: &Source) -> Vec<[f64; 2]> {
    let nowhere = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
    let mut boxes = vec![nowhere; source.objects.len()];
    for face in 0..source.face_count() {
        let (low, high) = &mut boxes[source.face_objects[face] as usize];
        for corner in source.rings_of(face).flatten().map(|&at| source.positions[at as usize]) {
            (*low, *high) = (low.inf(&corner), high.sup(&corner));
        }
    }
    let sizes = boxes.iter().map(|(low, high)| high - low);
    sizes.filter(|size| size.z > 0.0).map(|size| [size.z, size.x.min(size.y)]).collect()
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
