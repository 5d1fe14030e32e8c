//! Planes of the city that a patch may lie on, by the way they face and the place where they stand.
//!
//! Method       planes are sorted so that neighbours in direction and place are neighbours in memory; every sixteen have a common box, and every
//!              sixteen boxes another one, so that whoever asks for a direction and a place looks at few others (a packed R-tree)
//! Assumption   a plane is bound to the box of its corners
//! Source       packing: Leutenegger, Lopez and Edgington 1997 (sort-tile-recursive)

use std::cmp::Ordering;

use crate::geometry::Vector3;
use crate::planes::{CityPlane, CityPlanes, PlaneId};

/// A plane of the city that a patch may lie on, as a cache line: single precision says where to look, no more.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Target {
    /// Its corners' and its azimuth's.
    pub bounds: Bounds,
    normal: [f32; 3],
    offset: f32,
    /// Of the outward normal above the horizon, radians.
    pub elevation: f32,
    pub weight: f32,
    pub id: PlaneId,
}

/// A box in space, and a range of azimuths (radians; meaningless for level planes): x, y, z, azimuth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub low: [f32; 4],
    pub high: [f32; 4],
}

/// Which of the four is the azimuth.
const AZIMUTH: usize = 3;

/// The planes that are offered.
pub(super) struct Targets {
    /// With an azimuth.
    turned: Packed,
    /// Level planes.
    level: Packed,
}

/// Targets in blocks, and blocks in groups, with a box each.
struct Packed {
    targets: Vec<Target>,
    blocks: Vec<Bounds>,
    groups: Vec<Bounds>,
}

/// Targets of a block, and blocks of a group.
const BLOCK: usize = 16;

/// A normal nearer to up than this has no azimuth worth using.
pub(super) const LEAST_SIN_FOR_AZIMUTH: f64 = 0.3;

impl Target {
    pub fn new(id: PlaneId, plane: &CityPlane) -> Target {
        let normal = plane.plane.normal;
        let azimuth = if has_azimuth(&normal) { azimuth(&normal) } else { 0.0 };
        let bounds = Bounds::of(&plane.low.coords, &plane.high.coords, [azimuth; 2]);
        Target {
            bounds,
            normal: normal.map(|x| x as f32).into(),
            offset: plane.plane.offset as f32,
            elevation: elevation(&normal) as f32,
            weight: plane.area_m2.sqrt() as f32,
            id,
        }
    }

    pub fn normal(&self) -> Vector3<f64> {
        Vector3::from(self.normal).map(f64::from)
    }

    pub fn offset(&self) -> f64 {
        f64::from(self.offset)
    }

    /// An order of planes that their numbers in the file have no part in, unless two are the same.
    fn by_geometry(&self, other: &Target) -> Ordering {
        let numbers = |t: &Target| {
            let plane = [t.normal[0], t.normal[1], t.normal[2], t.offset, t.weight];
            t.bounds.low.into_iter().chain(t.bounds.high).chain(plane)
        };
        let pairs = numbers(self).zip(numbers(other));
        let differ = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
        differ.unwrap_or_else(|| self.id.cmp(&other.id))
    }

    /// Of the outward normal, radians; meaningless for level planes.
    pub fn azimuth(&self) -> f64 {
        f64::from(self.bounds.low[AZIMUTH])
    }
}

impl Bounds {
    const EVERYWHERE: Bounds = Bounds { low: [f32::NEG_INFINITY; 4], high: [f32::INFINITY; 4] };

    fn of(low: &Vector3<f64>, high: &Vector3<f64>, azimuths: [f64; 2]) -> Bounds {
        let four = |v: &Vector3<f64>, azimuth: f64| [v.x as f32, v.y as f32, v.z as f32, azimuth as f32];
        Bounds { low: four(low, azimuths[0]), high: four(high, azimuths[1]) }
    }

    /// A box in space, whatever the azimuth.
    pub fn in_space(low: &Vector3<f64>, high: &Vector3<f64>) -> Bounds {
        Bounds::of(low, high, [f64::NEG_INFINITY, f64::INFINITY])
    }

    #[inline]
    pub fn meets(&self, other: &Bounds) -> bool {
        (0..4).fold(true, |meets, k| meets & (self.low[k] <= other.high[k]) & (self.high[k] >= other.low[k]))
    }

    fn hull(all: impl Iterator<Item = Bounds>) -> Bounds {
        let empty = Bounds { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };
        all.fold(empty, |hull, b| Bounds {
            low: std::array::from_fn(|k| hull.low[k].min(b.low[k])),
            high: std::array::from_fn(|k| hull.high[k].max(b.high[k])),
        })
    }
}

impl Packed {
    /// `by` are the coordinates in which targets shall be near each other.
    fn new(mut targets: Vec<Target>, by: &[usize]) -> Packed {
        tile(&mut targets, by);
        let blocks: Vec<Bounds> = targets.chunks(BLOCK).map(|b| Bounds::hull(b.iter().map(|t| t.bounds))).collect();
        let groups = blocks.chunks(BLOCK).map(|g| Bounds::hull(g.iter().copied())).collect();
        Packed { targets, blocks, groups }
    }

    #[inline]
    fn each_within(&self, bounds: &Bounds, mut visit: impl FnMut(&Target)) {
        let groups = self.groups.iter().zip(self.blocks.chunks(BLOCK)).zip(self.targets.chunks(BLOCK * BLOCK));
        for ((_, blocks), targets) in groups.filter(|((group, _), _)| group.meets(bounds)) {
            let blocks = blocks.iter().zip(targets.chunks(BLOCK));
            for (_, targets) in blocks.filter(|(block, _)| block.meets(bounds)) {
                targets.iter().filter(|t| t.bounds.meets(bounds)).for_each(&mut visit);
            }
        }
    }
}

/// Sorts by the first coordinate, cuts into slabs of whole blocks, and goes on within each by the next.
fn tile(targets: &mut [Target], by: &[usize]) {
    let Some((&k, rest)) = by.split_first() else { return };
    let middle = |t: &Target| t.bounds.low[k] + t.bounds.high[k];
    targets.sort_by(|a, b| middle(a).total_cmp(&middle(b)).then_with(|| a.by_geometry(b)));
    let blocks = targets.len().div_ceil(BLOCK);
    let slabs = (blocks as f64).powf(1.0 / by.len() as f64).ceil() as usize;
    targets.chunks_mut(BLOCK * blocks.div_ceil(slabs.max(1)).max(1)).for_each(|slab| tile(slab, rest));
}

impl Targets {
    /// The planes named, as far as they are no smaller than `smallest_m2`.
    pub fn new(planes: &CityPlanes, named: &[PlaneId], smallest_m2: f64) -> Targets {
        let large =
            named.iter().map(|&id| (id, &planes.planes[id.0 as usize])).filter(|(_, p)| p.area_m2 >= smallest_m2);
        let (turned, level): (Vec<_>, Vec<_>) = large.partition(|(_, p)| has_azimuth(&p.plane.normal));
        let targets = |all: Vec<(PlaneId, &CityPlane)>| all.into_iter().map(|(id, p)| Target::new(id, p)).collect();
        Targets { turned: Packed::new(targets(turned), &[AZIMUTH, 0, 1]), level: Packed::new(targets(level), &[0, 1]) }
    }

    pub fn all(&self) -> impl Iterator<Item = &Target> {
        self.turned.targets.iter().chain(&self.level.targets)
    }

    pub fn has_level(&self) -> bool {
        !self.level.targets.is_empty()
    }

    /// Calls `visit` with the level planes whose box meets another.
    pub fn each_level(&self, bounds: &Bounds, visit: impl FnMut(&Target)) {
        self.level.each_within(bounds, visit);
    }

    /// Calls `visit` with the planes whose azimuth is within `reach` of `azimuth`, radians.
    pub fn each_facing(&self, azimuth: f64, reach: f64, visit: impl FnMut(&Target)) {
        self.each_facing_within(azimuth, reach, &Bounds::EVERYWHERE, visit);
    }

    /// The same of those whose box meets another.
    pub fn each_facing_within(&self, azimuth: f64, reach: f64, bounds: &Bounds, mut visit: impl FnMut(&Target)) {
        let turn = std::f64::consts::TAU;
        if reach >= std::f64::consts::PI {
            return self.turned.each_within(bounds, visit);
        }
        // The range, and what of it goes over the half turn.
        for azimuth in [-turn, 0.0, turn].map(|over| wrapped(azimuth) + over) {
            let [low, high] = [azimuth - reach, azimuth + reach].map(|a| a as f32);
            if low <= std::f32::consts::PI && high >= -std::f32::consts::PI {
                let mut ranged = *bounds;
                (ranged.low[AZIMUTH], ranged.high[AZIMUTH]) = (low, high);
                self.turned.each_within(&ranged, &mut visit);
            }
        }
    }
}

pub(super) fn azimuth(normal: &Vector3<f64>) -> f64 {
    normal.y.atan2(normal.x)
}

pub(super) fn elevation(normal: &Vector3<f64>) -> f64 {
    normal.z.clamp(-1.0, 1.0).asin()
}

pub(super) fn has_azimuth(normal: &Vector3<f64>) -> bool {
    normal.xy().norm() > LEAST_SIN_FOR_AZIMUTH
}

/// To (-pi, pi].
pub(super) fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

#[cfg(test)]
mod tests;
