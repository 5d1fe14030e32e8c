//! The points on the city as observations: surface cells of building planes, building planes of buildings.
//!
//! Question     what errs together?
//! Method       a *building* is an object of the model, or where an object is larger than any building (terrain, a model that is one mesh)
//!              a square of it. Its planes that lie in one plane in space are one *building plane*. A *surface cell* of a building plane is what lies in one cube of
//!              a grid as wide as windows repeat: its points are one observation, so that neither their number nor the noise that
//!              neighbours share can make a building plane more certain than it is

use std::collections::HashMap;
use std::ops::Range;

use crate::city::ObjectId;
use crate::correspondence::{PointPlaneMatch, PoseRefiner};
use crate::geometry::{Point3, Similarity, Vector3};
use crate::limits::UncertaintyLimits;
use crate::planes::CityPlanes;

/// One observation: how far the city's surface and the cloud's are apart at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceCell {
    /// On the city's surface.
    pub foot: Point3<f64>,
    /// Of the city's surface, outward.
    pub normal: Vector3<f64>,
    /// Distance of the cloud from the surface, metres.
    pub across_m: f64,
    /// Weight of its points together.
    pub points: f64,
}

/// Class of surfaces that share one variance: surveys of ground and of buildings differ, and a box's lid says little of the roof below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Of an object that has walls.
    Built,
    /// Of an object with next to no walls: terrain has steps and quays.
    Ground,
    /// A level top in a model of boxes.
    Lid,
}

pub(super) const KINDS: usize = 3;

/// Planes of one building in one plane in space.
#[derive(Clone, Debug)]
pub(super) struct BuildingPlane {
    pub cells: Range<usize>,
    pub middle: Point3<f64>,
    /// In the building plane, and how far it reaches along them, metres.
    pub axes: [Vector3<f64>; 2],
    pub reach_m: [f64; 2],
    pub is_wall: bool,
    /// A level top of something with walls.
    pub is_top: bool,
    pub kind: Kind,
}

#[derive(Clone, Debug)]
pub(super) struct Building {
    pub building_planes: Range<usize>,
    pub middle: Point3<f64>,
    /// Where a turn is felt as a shift of the same size, metres.
    pub lever_m: f64,
    /// Built or ground.
    pub kind: Kind,
}

/// What is observed, sorted by buildings and building planes.
#[derive(Clone, Debug, Default)]
pub(super) struct Observations {
    pub cells: Vec<SurfaceCell>,
    pub building_planes: Vec<BuildingPlane>,
    pub buildings: Vec<Building>,
    /// Noise of one point across its surface, metres.
    pub point_sigma_m: f64,
    /// All roofs on which points lie are level: a model of boxes.
    pub has_lids_only: bool,
}

/// A row with what it belongs to.
struct Placed<'a> {
    building: (ObjectId, [i32; 2]),
    row: &'a PointPlaneMatch,
}

/// Extent of an object, and how much of it is wall.
struct Body {
    low: Point3<f64>,
    high: Point3<f64>,
    walls_m2: f64,
    other_m2: f64,
}

/// What lies on the city within `gate_m` (metres of the start) at `pose`.
pub(super) fn observations(refiner: &PoseRefiner, pose: &Similarity, gate_m: f64) -> Observations {
    let scene = refiner.scene;
    let limits = &scene.limits.uncertainty;
    let all: Vec<u32> = (0..scene.level_cloud.sample_points.len() as u32).collect();
    let rows = refiner.point_plane_matches(&all, pose, gate_m);
    let planes = scene.city.planes();
    let bodies = bodies(planes, scene.limits.upright_sin);
    let mut placed: Vec<Placed> =
        rows.iter().map(|row| Placed { building: building_of(row, planes, &bodies, limits), row }).collect();
    // Rows come sorted by plane, and stay so within a building.
    placed.sort_by_key(|p| p.building);
    let point_sigma_m = (scene.level_cloud.noise_m * pose.scale).max(scene.limits.least_point_sigma_m);
    let mut sample = Observations { point_sigma_m, ..Observations::default() };
    for of_building in placed.chunk_by(|a, b| a.building == b.building) {
        let body = bodies.get(&of_building[0].building.0);
        let has_walls = body.is_some_and(|body| body.walls_m2 > limits.least_walls * body.other_m2);
        let kind = if has_walls { Kind::Built } else { Kind::Ground };
        sample.take_building(of_building, kind, scene.limits.upright_sin, limits);
    }
    sample.tell_lids();
    sample
}

fn bodies(planes: &CityPlanes, upright_sin: f64) -> HashMap<ObjectId, Body> {
    let mut bodies: HashMap<ObjectId, Body> = HashMap::new();
    for plane in &planes.planes {
        let none = Body { low: plane.low, high: plane.high, walls_m2: 0.0, other_m2: 0.0 };
        let body = bodies.entry(plane.object).or_insert(none);
        body.low = body.low.inf(&plane.low);
        body.high = body.high.sup(&plane.high);
        let is_wall = plane.plane.normal.z.abs() < upright_sin;
        *(if is_wall { &mut body.walls_m2 } else { &mut body.other_m2 }) += plane.area_m2;
    }
    bodies
}

fn building_of(
    row: &PointPlaneMatch,
    planes: &CityPlanes,
    bodies: &HashMap<ObjectId, Body>,
    limits: &UncertaintyLimits,
) -> (ObjectId, [i32; 2]) {
    let object = planes.planes[row.hit.plane.0 as usize].object;
    let is_one = bodies.get(&object).is_none_or(|body| (body.high - body.low).xy().max() <= limits.largest_building_m);
    let square = |x: f64| (x / limits.square_m).floor() as i32;
    (object, if is_one { [0, 0] } else { [square(row.place.x), square(row.place.y)] })
}

impl Observations {
    /// Whether the model is one of boxes: all tops on which points lie are level.
    fn tell_lids(&mut self) {
        let mut tops = self
            .building_planes
            .iter()
            .filter(|building_plane| building_plane.kind == Kind::Built && !building_plane.is_wall)
            .peekable();
        self.has_lids_only = tops.peek().is_some() && tops.all(|building_plane| building_plane.is_top);
        if self.has_lids_only {
            self.building_planes
                .iter_mut()
                .filter(|building_plane| building_plane.is_top)
                .for_each(|building_plane| building_plane.kind = Kind::Lid);
        }
    }

    fn take_building(&mut self, rows: &[Placed], kind: Kind, upright_sin: f64, limits: &UncertaintyLimits) {
        let first = self.building_planes.len();
        for building_plane in building_planes(rows, limits) {
            self.take_building_plane(&building_plane, kind, upright_sin, limits);
        }
        if self.building_planes.len() == first {
            return;
        }
        let middle = centroid(rows.iter().map(|p| p.row));
        let spread = rows.iter().map(|p| (p.row.place - middle).xy().norm_squared()).sum::<f64>() / rows.len() as f64;
        let lever_m = spread.sqrt().max(limits.least_lever_m);
        self.buildings.push(Building { building_planes: first..self.building_planes.len(), middle, lever_m, kind });
    }

    /// Takes a building plane, unless what lies about it weighs less than a point: strays lie on both sides of any surface, within what is asked of
    /// them, and so seem to hold it where it is.
    fn take_building_plane(
        &mut self,
        rows: &[&PointPlaneMatch],
        kind: Kind,
        upright_sin: f64,
        limits: &UncertaintyLimits,
    ) {
        let first = self.cells.len();
        let cell_of = |row: &PointPlaneMatch| row.place.coords.map(|x| (x / limits.cell_m).floor() as i64);
        let mut sorted: Vec<([i64; 3], &PointPlaneMatch)> =
            rows.iter().map(|row| (cell_of(row).into(), *row)).collect();
        sorted.sort_by_key(|(cell, _)| *cell);
        let (sigma_m, student_dof) = (self.point_sigma_m, limits.student_dof);
        self.cells.extend(sorted.chunk_by(|a, b| a.0 == b.0).map(|points| cell(points, sigma_m, student_dof)));
        let cells = &self.cells[first..];
        let total: f64 = cells.iter().map(|p| p.points).sum();
        if total < limits.least_points {
            self.cells.truncate(first);
            return;
        }
        let mean = |of: &dyn Fn(&SurfaceCell) -> Vector3<f64>| {
            cells.iter().map(|p| of(p) * p.points).sum::<Vector3<f64>>() / total
        };
        let middle = Point3::from(mean(&|p| p.foot.coords));
        let normal = mean(&|p| p.normal).try_normalize(0.0).unwrap_or(cells[0].normal);
        let along = normal.cross(&Vector3::z()).try_normalize(upright_sin).unwrap_or(Vector3::x());
        let axes = [along, normal.cross(&along)];
        let reach_m = axes.map(|axis| {
            let reach_m = cells.iter().map(|p| axis.dot(&(p.foot - middle)).abs()).fold(0.0, f64::max);
            reach_m.max(limits.cell_m)
        });
        let is_wall = normal.z.abs() < upright_sin;
        let is_top = kind == Kind::Built && normal.z > 1.0 - upright_sin;
        self.building_planes.push(BuildingPlane {
            cells: first..self.cells.len(),
            middle,
            axes,
            reach_m,
            is_wall,
            is_top,
            kind,
        });
    }
}

/// Rows of one building by building plane: planes that lie in one plane in space, the largest first.
fn building_planes<'a>(rows: &[Placed<'a>], limits: &UncertaintyLimits) -> Vec<Vec<&'a PointPlaneMatch>> {
    let mut planes: Vec<Vec<&PointPlaneMatch>> = rows
        .chunk_by(|a, b| a.row.hit.plane == b.row.hit.plane)
        .map(|plane| plane.iter().map(|p| p.row).collect())
        .collect();
    planes.sort_by(|a, b| b.len().cmp(&a.len()).then(a[0].hit.plane.cmp(&b[0].hit.plane)));
    let least_cos = limits.same_building_plane_deg.to_radians().cos();
    let mut found: Vec<(Vector3<f64>, Point3<f64>, Vec<&PointPlaneMatch>)> = Vec::new();
    for plane in planes {
        let (normal, middle) = (plane[0].hit.normal, centroid(plane.iter().copied()));
        let same = found
            .iter_mut()
            .find(|(n, m, _)| n.dot(&normal) > least_cos && n.dot(&(middle - *m)).abs() < limits.same_building_plane_m);
        match same {
            Some((_, _, building_plane)) => building_plane.extend(plane),
            None => found.push((normal, middle, plane)),
        }
    }
    found.into_iter().map(|(_, _, building_plane)| building_plane).collect()
}

fn centroid<'a>(rows: impl Iterator<Item = &'a PointPlaneMatch>) -> Point3<f64> {
    let (sum, count) = rows.fold((Vector3::zeros(), 0.0), |(sum, count), row| (sum + row.place.coords, count + 1.0));
    Point3::from(sum / f64::max(count, 1.0))
}

/// Rounds in which the points of a surface cell agree on its distance.
const ROUNDS: usize = 3;

/// The points of one cell as one observation, about their median and by Student's t of so many degrees of freedom. Noise stands across
/// the surface, so the foot is where a row is taken: else a smaller scale would seem to make the noise smaller.
fn cell(points: &[([i64; 3], &PointPlaneMatch)], sigma_m: f64, student_dof: f64) -> SurfaceCell {
    let mut across: Vec<f64> = points.iter().map(|(_, row)| row.hit.across_m).collect();
    across.sort_by(f64::total_cmp);
    let mut across_m = across[across.len() / 2];
    let mut weights: Vec<f64> = Vec::new();
    for _ in 0..ROUNDS {
        let weight = |row: &PointPlaneMatch| {
            let off = (row.hit.across_m - across_m) / sigma_m;
            row.weight * (student_dof + 1.0) / (student_dof + off * off)
        };
        weights = points.iter().map(|(_, row)| weight(row)).collect();
        let sum: f64 = points.iter().zip(&weights).map(|((_, row), weight)| row.hit.across_m * weight).sum();
        across_m = sum / weights.iter().sum::<f64>();
    }
    let total: f64 = weights.iter().sum();
    let mean = |of: &dyn Fn(&PointPlaneMatch) -> Vector3<f64>| {
        points.iter().zip(&weights).map(|((_, row), weight)| of(row) * *weight).sum::<Vector3<f64>>() / total
    };
    SurfaceCell {
        foot: Point3::from(mean(&|row| row.place.coords - row.hit.normal * row.hit.across_m)),
        normal: mean(&|row| row.hit.normal).try_normalize(0.0).unwrap_or(points[0].1.hit.normal),
        across_m,
        points: total,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use crate::planes::{Hit, PlaneId};

    /// Points of so much weight each along a wall of plane `plane`, this far before it.
    fn wall(plane: u32, points: usize, weight: f64, across_m: f64) -> Vec<PointPlaneMatch> {
        let normal = if plane == 0 { Vector3::x() } else { Vector3::y() };
        let along = normal.cross(&Vector3::z());
        let one = |k: usize| PointPlaneMatch {
            sample_point: k as u32,
            place: Point3::from(along * (0.5 + k as f64) + normal * across_m + Vector3::z()),
            hit: Hit { plane: PlaneId(plane), normal, across_m, outside_m: 0.0 },
            weight,
        };
        (0..points).map(one).collect()
    }

    fn observed(rows: &[PointPlaneMatch]) -> Observations {
        let limits = Limits::default();
        let placed: Vec<Placed> = rows.iter().map(|row| Placed { building: (ObjectId(0), [0, 0]), row }).collect();
        let mut sample = Observations { point_sigma_m: 0.02, ..Observations::default() };
        sample.take_building(&placed, Kind::Built, limits.upright_sin, &limits.uncertainty);
        sample
    }

    #[test]
    fn strays_that_weigh_less_than_a_point_hold_no_surface() {
        let seen = wall(0, 30, 1.0, 0.01);
        let with_strays = observed(&[seen.clone(), wall(1, 4, 0.1, 0.2)].concat());
        let alone = observed(&seen);
        assert_eq!(with_strays.building_planes.len(), 1);
        assert_eq!(with_strays.cells.len(), alone.cells.len());
        assert_eq!(observed(&[seen, wall(1, 4, 1.0, 0.2)].concat()).building_planes.len(), 2);
    }

    #[test]
    fn a_building_of_strays_alone_is_none() {
        let sample = observed(&wall(0, 4, 0.1, 0.2));
        assert!(sample.buildings.is_empty() && sample.building_planes.is_empty() && sample.cells.is_empty());
    }
}
