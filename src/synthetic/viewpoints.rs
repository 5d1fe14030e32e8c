//! Viewpoints: where photographs of a town are taken from, for each kind of place.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::capture::Station;
use super::clutter::is_open;
use super::draws::{between, one_of, whole};
use super::house::{Face, Surface};
use super::quarters::{Quarter, Quarters, SIDE_M, STEP_M};
use crate::geometry::{Point3, RayCaster, Vector3};
use crate::solvers::scene::Random;

/// Eye height, metres.
const EYE_M: f64 = 1.7;

/// Photographs into these directions beside that of the walk, radians.
const SIDES: [(f64, f64); 6] =
    [(0.3, 1.0 / 6.0), (0.9, 1.0 / 6.0), (-0.9, 1.0 / 6.0), (-0.3, 1.0 / 6.0), (1.4, 1.0 / 6.0), (-1.4, 1.0 / 6.0)];

/// A photograph: from where, to where (radians counter-clockwise from east), how steeply up.
fn photo(number: usize, center: Point3<f64>, heading: f64, pitch: f64) -> Station {
    let direction = Vector3::new(pitch.cos() * heading.cos(), pitch.cos() * heading.sin(), pitch.sin());
    Station { name: format!("photo/{number:03}.jpg"), center, target: center + direction }
}

/// Along a line, some 10 to 30 photographs to all sides, from `from` towards `heading`.
pub(super) fn walk(from: Point3<f64>, heading: f64, rays: &RayCaster, random: &mut Random) -> Vec<Station> {
    let photos = whole(random, 10, 30);
    let step = between(random, 2.0, 4.5);
    let (mut at, mut heading) = (from, heading);
    let mut stations = Vec::new();
    for i in 0..photos {
        let stray = 0.4 * Vector3::new(random.normal(), random.normal(), 0.0);
        at += step * Vector3::new(heading.cos(), heading.sin(), 0.0);
        heading += 0.01 * random.normal();
        let eye = at + stray + Vector3::new(0.0, 0.0, EYE_M + 0.15 * random.normal());
        let aside = one_of(random, &SIDES) + 0.1 * random.normal();
        let pitch = between(random, 0.02, 0.3);
        if is_open(rays, &foot(&eye), 1.2) {
            stations.push(photo(i, eye, heading + aside, pitch));
        }
    }
    stations
}

fn foot(eye: &Point3<f64>) -> Point3<f64> {
    Point3::new(eye.x, eye.y, 0.0)
}

/// Along a street between blocks.
pub(super) fn street(town: &Quarters, rays: &RayCaster, random: &mut Random) -> Vec<Station> {
    let line = STEP_M * whole(random, 1, town.columns) as f64 - 0.5 * (STEP_M - SIDE_M);
    let along = between(random, 0.0, STEP_M * (town.rows as f64 - 2.0)) + 10.0;
    walk_on(line, along, rays, random)
}

/// Along the rim of the town: houses on one side only.
pub(super) fn outskirts(town: &Quarters, rays: &RayCaster, random: &mut Random) -> Vec<Station> {
    let along = between(random, 0.0, STEP_M * (town.rows as f64 - 2.0)) + 10.0;
    walk_on(-0.5 * (STEP_M - SIDE_M), along, rays, random)
}

/// On a line that runs north or east, into either sense.
fn walk_on(line: f64, along: f64, rays: &RayCaster, random: &mut Random) -> Vec<Station> {
    let back = if random.unit() < 0.5 { PI } else { 0.0 };
    // A walk that turns back begins where it would have ended, some 60 m further.
    let along = if back > 0.0 { along + STEP_M } else { along };
    if random.unit() < 0.5 {
        walk(Point3::new(line, along, 0.0), FRAC_PI_2 + back, rays, random)
    } else {
        walk(Point3::new(along, line, 0.0), back, rays, random)
    }
}

/// A block of a kind, not on the rim.
fn inner_block(town: &Quarters, kinds: &[Quarter], random: &mut Random) -> usize {
    let inner = |cell: &usize| {
        let (column, row) = (cell % town.columns, cell / town.columns);
        column > 0 && row > 0 && column + 1 < town.columns && row + 1 < town.rows && kinds.contains(&town.kind(*cell))
    };
    let cells: Vec<usize> = (0..town.columns * town.rows).filter(inner).collect();
    cells[whole(random, 0, cells.len())]
}

/// In a court, to all sides.
pub(super) fn court(town: &Quarters, rays: &RayCaster, random: &mut Random) -> Vec<Station> {
    let middle = town.middle_of(inner_block(town, &[Quarter::Court], random));
    let photos = whole(random, 10, 26);
    let mut stations = Vec::new();
    for i in 0..photos {
        let stray = 4.0 * Vector3::new(random.normal(), random.normal(), 0.0);
        let eye = middle + stray + Vector3::new(0.0, 0.0, EYE_M + 0.15 * random.normal());
        let (heading, pitch) = (between(random, 0.0, TAU), between(random, 0.0, 0.4));
        if is_open(rays, &foot(&eye), 1.2) {
            stations.push(photo(i, eye, heading, pitch));
        }
    }
    stations
}

/// From the streets all round a block, or half round it.
pub(super) fn round_block(town: &Quarters, rays: &RayCaster, random: &mut Random) -> Vec<Station> {
    let middle = town.middle_of(inner_block(town, &[Quarter::Court, Quarter::Detached, Quarter::Rows], random));
    let half = 0.5 * STEP_M - between(random, 0.0, 3.0);
    ring(
        random,
        |angle| half / angle.cos().abs().max(angle.sin().abs()),
        (middle, 0.35),
        |c| (EYE_M + 0.1 * c.normal(), between(c, 0.05, 0.35)),
    )
    .into_iter()
    .filter(|station| is_open(rays, &foot(&station.center), 1.2))
    .collect()
}

/// One house, from the ground or by a drone that flies low.
pub(super) fn single(place: Point3<f64>, half_m: f64, rays: &RayCaster, random: &mut Random) -> Vec<Station> {
    let is_low = random.unit() < 0.5;
    let beyond = half_m + between(random, 6.0, 16.0);
    let eye = |c: &mut Random| {
        if is_low {
            (EYE_M + 0.1 * c.normal(), between(c, 0.05, 0.35))
        } else {
            let height = between(c, 10.0, 22.0);
            (height, -((height - 4.0).atan2(beyond * between(c, 0.8, 1.2))))
        }
    };
    let stations = ring(random, |_| beyond, (place, 0.12), eye);
    stations.into_iter().filter(|s| !is_low || is_open(rays, &foot(&s.center), 1.2)).collect()
}

/// By a drone, 28 to 55 m up.
pub(super) fn drone(place: Point3<f64>, half_m: f64, random: &mut Random) -> Vec<Station> {
    let radius = half_m + between(random, 8.0, 30.0);
    ring(
        random,
        |_| radius,
        (place, 0.12),
        |c| {
            let height = between(c, 28.0, 55.0);
            (height, -((height - 4.0).atan2(radius * between(c, 0.8, 1.2))))
        },
    )
}

/// On a curve about a place (its distance by direction), more than half of it, looking inwards within so many radians; `eye`
/// draws height and pitch.
fn ring(
    random: &mut Random,
    distance: impl Fn(f64) -> f64,
    (place, astray): (Point3<f64>, f64),
    eye: impl Fn(&mut Random) -> (f64, f64),
) -> Vec<Station> {
    let photos = whole(random, 14, 32);
    let (from, arc) = (between(random, 0.0, TAU), between(random, PI, TAU));
    let station = |i: usize| {
        let angle = from + arc * i as f64 / photos as f64;
        let (height, pitch) = eye(random);
        let level = place + distance(angle) * Vector3::new(angle.cos(), angle.sin(), 0.0);
        let center = Point3::new(level.x, level.y, height);
        photo(i, center, angle + PI + astray * random.normal(), pitch)
    };
    (0..photos).map(station).collect()
}

/// A house of the town with gardens: its number and half its size.
pub(super) fn detached_house(town: &Quarters, random: &mut Random) -> (Point3<f64>, f64) {
    let middle = town.middle_of(inner_block(town, &[Quarter::Detached], random));
    let near = |h: &&super::House| (h.middle() - middle).xy().amax() < 0.5 * SIDE_M;
    let houses: Vec<_> = town.block.houses.iter().filter(near).collect();
    let house = houses[whole(random, 0, houses.len())];
    let place = house.middle();
    let corners = house.faces.iter().flat_map(|face| &face.corners);
    (place, corners.map(|c| (c - place).xy().norm()).fold(0.0, f64::max))
}

/// Along one wall with room before it; the wall's number among the faces and the photographs of it.
pub(super) fn before_a_wall(faces: &[Face], rays: &RayCaster, random: &mut Random) -> Option<(usize, Vec<Station>)> {
    for _ in 0..200 {
        let number = whole(random, 0, faces.len());
        let face = &faces[number];
        let normal = face.normal();
        let along = Vector3::z().cross(&normal);
        let middle = face.corners.iter().map(|c| c.coords).sum::<Vector3<f64>>() / face.corners.len() as f64;
        let width = 2.0 * face.corners.iter().map(|c| along.dot(&(c.coords - middle)).abs()).fold(0.0, f64::max);
        let before = Point3::new(middle.x, middle.y, 0.0) + 5.0 * normal;
        if face.surface != Surface::Wall || width < 6.0 || !is_open(rays, &before, 2.0) {
            continue;
        }
        let (photos, distance) = (whole(random, 8, 16), between(random, 6.0, 14.0));
        let mut stations = Vec::new();
        for i in 0..photos {
            let at = width * (i as f64 / (photos - 1) as f64 - 0.5);
            let stray = 0.5 * Vector3::new(random.normal(), random.normal(), 0.0);
            let level = middle + at * along + distance * normal + stray;
            let eye = Point3::new(level.x, level.y, EYE_M);
            let heading = (-normal.y).atan2(-normal.x) + 0.25 * random.normal();
            let pitch = between(random, 0.05, 0.3);
            if is_open(rays, &foot(&eye), 1.0) {
                stations.push(photo(i, eye, heading, pitch));
            }
        }
        return Some((number, stations));
    }
    None
}
