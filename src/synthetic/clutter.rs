//! Clutter: trees, cars and fences, which hide what is behind them and leave points that no model knows.

use super::block::Block;
use super::draws::{between, count, stream, whole};
use super::house::{Face, House};
use super::levels::Levels;
use crate::geometry::{Point3, RayCaster, Vector3};
use crate::solvers::scene::Random;

/// What is expected around a place at level 1.
const TREES: f64 = 18.0;
const ROWS_OF_CARS: f64 = 14.0;
const FENCES: f64 = 8.0;

/// From one parked car to the next, metres.
const CAR_STEP_M: f64 = 5.6;

/// Draws until a thing stands free.
const TRIES: usize = 50;

/// What the points on a thing are like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Thing {
    /// Leaves: no surface.
    Tree,
    Solid,
}

/// Things within `reach_m` of a place that stand in no house.
pub(super) fn clutter(
    built: &Block,
    rays: &RayCaster,
    place: &Point3<f64>,
    reach_m: f64,
    levels: &Levels,
    seed: u64,
) -> Vec<(Thing, Face)> {
    let mut random = stream(seed, 0);
    let ground = built.bounds().0.z;
    let mut things: Vec<(Thing, House)> = Vec::new();
    let spot = |random: &mut Random, room_m: f64| {
        let drawn = |random: &mut Random| {
            let [x, y] = [place.x, place.y].map(|at| at + between(random, -reach_m, reach_m));
            Point3::new(x, y, ground)
        };
        (0..TRIES).map(|_| drawn(random)).find(|spot| is_open(rays, spot, room_m))
    };
    for _ in 0..count(&mut random, TREES * levels.clutter) {
        let Some(at) = spot(&mut random, 1.5) else { continue };
        let (height, radius) = (between(&mut random, 4.0, 14.0), between(&mut random, 1.2, 4.0));
        let crown = House::flat([2.0 * radius, 2.0 * radius, 0.7 * height]);
        things.push((Thing::Tree, about(crown, radius, radius, &mut random, &(at + 0.3 * height * Vector3::z()))));
        things.push((Thing::Tree, about(House::flat([0.4, 0.4, 0.4 * height]), 0.2, 0.2, &mut random, &at)));
    }
    for _ in 0..count(&mut random, ROWS_OF_CARS * levels.clutter) {
        let Some(at) = spot(&mut random, 1.2) else { continue };
        let heading = heading_of_a_house(built, &mut random);
        for i in 0..whole(&mut random, 1, 6) {
            let along = Vector3::new(heading.cos(), heading.sin(), 0.0);
            let at = at + CAR_STEP_M * i as f64 * along;
            if is_open(rays, &at, 1.0) {
                let car = House::flat([4.3, 1.8, 1.4]).at([-2.15, -0.9, 0.0]);
                things.push((Thing::Solid, car.turned(heading).at(at.coords.into())));
            }
        }
    }
    for _ in 0..count(&mut random, FENCES * levels.clutter) {
        let Some(at) = spot(&mut random, 1.5) else { continue };
        let size = [between(&mut random, 4.0, 15.0), between(&mut random, 0.05, 0.8), between(&mut random, 0.9, 2.5)];
        let heading = heading_of_a_house(built, &mut random);
        things.push((Thing::Solid, House::flat(size).turned(heading).at(at.coords.into())));
    }
    things.into_iter().flat_map(|(thing, house)| house.faces.into_iter().map(move |face| (thing, face))).collect()
}

/// Turned at random about its middle, which is put at a place.
fn about(house: House, half_width: f64, half_depth: f64, random: &mut Random, at: &Point3<f64>) -> House {
    house.at([-half_width, -half_depth, 0.0]).turned(between(random, 0.0, 3.0)).at(at.coords.into())
}

/// Along the front of some house, mostly.
fn heading_of_a_house(built: &Block, random: &mut Random) -> f64 {
    if built.houses.is_empty() || random.unit() < 0.3 {
        return between(random, 0.0, std::f64::consts::PI);
    }
    let house = &built.houses[whole(random, 0, built.houses.len())];
    let normal = house.faces[0].normal();
    normal.x.atan2(-normal.y)
}

/// Whether there is room for so much around a place: no wall nearer, no roof above.
pub(super) fn is_open(rays: &RayCaster, place: &Point3<f64>, room_m: f64) -> bool {
    let breast = place + Vector3::z();
    let around = (0..8).map(|k| std::f64::consts::FRAC_PI_4 * f64::from(k));
    rays.first_hit(place, &Vector3::z(), f64::MAX).is_none()
        && around.map(|a| Vector3::new(a.cos(), a.sin(), 0.0)).all(|d| rays.first_hit(&breast, &d, room_m).is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clutter_stands_outside_and_grows_with_its_level() {
        let block = Block::town(2, 2, 3);
        let rays = block.rays();
        let things = |clutter: f64| {
            let levels = Levels { clutter, ..Levels::none() };
            super::clutter(&block, &rays, &block.middle(), 60.0, &levels, 5)
        };
        assert!(things(0.0).is_empty());
        let (some, many) = (things(0.5), things(2.0));
        assert!(some.len() > 50 && many.len() > 2 * some.len(), "{} {}", some.len(), many.len());
        assert!(many.iter().any(|(thing, _)| *thing == Thing::Tree));
    }
}
