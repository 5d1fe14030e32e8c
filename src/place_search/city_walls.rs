//! The walls of the city in plan.
//!
//! Question     where do walls stand that somebody could have seen, which way do they face, from what height to what?
//! Method       exposed triangles of each upright plane, as intervals along it; those that touch are one wall
//! Assumptions  a wall is as tall everywhere as at its tallest: gables count as walls of their height

use rayon::prelude::*;

use super::prior::Disc;
use crate::geometry::Vector3;
use crate::limits::Limits;
use crate::planes::{CityPlane, PlaneId, PreparedCity};
use crate::robust::quantile;

/// A stretch of wall; city frame (local), metres.
#[derive(Clone, Copy, Debug)]
pub struct CityWall {
    pub from: [f64; 2],
    pub to: [f64; 2],
    /// Unit, outward.
    pub normal: [f64; 2],
    pub foot_m: f64,
    pub top_m: f64,
}

impl CityWall {
    pub fn length_m(&self) -> f64 {
        (self.to[0] - self.from[0]).hypot(self.to[1] - self.from[1])
    }

    pub fn height_m(&self) -> f64 {
        self.top_m - self.foot_m
    }

    /// The place so far along the wall.
    pub fn at(&self, along_m: f64) -> [f64; 2] {
        let share = along_m / self.length_m();
        [0, 1].map(|k| self.from[k] + (self.to[k] - self.from[k]) * share)
    }

    /// Distance of a place from the wall's plane, positive outside.
    pub fn across_m(&self, place: [f64; 2]) -> f64 {
        (0..2).map(|k| (place[k] - self.from[k]) * self.normal[k]).sum()
    }

    /// Distance of a place from the stretch.
    pub fn distance_m(&self, place: [f64; 2]) -> f64 {
        let along = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let to_place = [place[0] - self.from[0], place[1] - self.from[1]];
        let length_sq = along[0] * along[0] + along[1] * along[1];
        let share = ((along[0] * to_place[0] + along[1] * to_place[1]) / length_sq).clamp(0.0, 1.0);
        (to_place[0] - share * along[0]).hypot(to_place[1] - share * along[1])
    }
}

/// Gaps between pieces of one wall that do not part it, metres: a downpipe's width, or a window drawn as a hole.
const GAP_M: f64 = 0.3;
/// Slivers between corners that were drawn twice, metres.
const SLIVER_M: f64 = 0.25;

/// All walls, or those that stand within a disc.
pub fn city_walls(city: &PreparedCity, within: Option<&Disc>, limits: &Limits) -> Vec<CityWall> {
    let inside = |plane: &CityPlane| within.is_none_or(|disc| disc.meets_box(&plane.low, &plane.high));
    walls_of_planes(city, inside, limits).into_iter().flat_map(|(_, walls)| walls).collect()
}

/// The walls of the planes that are asked for, in the order of the planes.
pub fn walls_of_planes(
    city: &PreparedCity,
    asked: impl Fn(&CityPlane) -> bool + Sync,
    limits: &Limits,
) -> Vec<(PlaneId, Vec<CityWall>)> {
    let planes = &city.planes().planes;
    let of_plane = |(id, plane): (u32, &CityPlane)| {
        let upright = plane.plane.normal.z.abs() < limits.upright_sin;
        (PlaneId(id), if upright && asked(plane) { walls_of(city, plane) } else { Vec::new() })
    };
    (0..planes.len() as u32).into_par_iter().zip(planes).map(of_plane).collect()
}

/// The height that this share of the upright planes in a disc does not exceed, metres, seen or not.
pub fn tallest_m(city: &PreparedCity, within: &Disc, share: f64, limits: &Limits) -> Option<f64> {
    let upright = |plane: &&CityPlane| plane.plane.normal.z.abs() < limits.upright_sin;
    let inside = |plane: &&CityPlane| within.meets_box(&plane.low, &plane.high);
    let planes = city.planes().planes.iter().filter(upright).filter(inside);
    quantile(&mut planes.map(|plane| plane.high.z - plane.low.z).collect::<Vec<f64>>(), share)
}

/// A piece of a wall: along it, and in height.
struct Piece {
    along_m: [f64; 2],
    height_m: [f64; 2],
}

fn walls_of(city: &PreparedCity, plane: &CityPlane) -> Vec<CityWall> {
    let Some(normal) = horizontal(&plane.plane.normal) else { return Vec::new() };
    let along = [-normal[1], normal[0]];
    let mut pieces: Vec<Piece> = Vec::new();
    for facet in &plane.facets {
        let triangles = city.model.facets[facet.0 as usize].triangles.clone();
        for corners in triangles.filter(|&t| city.is_exposed(t)).map(|t| city.corners(t)) {
            let range = |of: &dyn Fn(usize) -> f64| {
                (0..3).map(of).fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
            };
            let along_m = range(&|k| along[0] * corners[k].x + along[1] * corners[k].y);
            pieces.push(Piece { along_m, height_m: range(&|k| corners[k].z) });
        }
    }
    pieces.sort_by(|a, b| a.along_m[0].total_cmp(&b.along_m[0]));
    let middle = (plane.low.coords + plane.high.coords) / 2.0;
    let foot = plane.plane.project(&middle.into());
    let across = normal[0] * foot.x + normal[1] * foot.y;
    let place = |t: f64| [0, 1].map(|k| across * normal[k] + t * along[k]);
    let wall = |p: &Piece| CityWall {
        from: place(p.along_m[0]),
        to: place(p.along_m[1]),
        normal,
        foot_m: p.height_m[0],
        top_m: p.height_m[1],
    };
    let long = |p: &&Piece| p.along_m[1] - p.along_m[0] > SLIVER_M;
    joined(pieces).iter().filter(long).map(wall).collect()
}

/// Pieces that touch become one.
fn joined(sorted: Vec<Piece>) -> Vec<Piece> {
    let mut joined: Vec<Piece> = Vec::new();
    for piece in sorted {
        match joined.last_mut().filter(|last| piece.along_m[0] <= last.along_m[1] + GAP_M) {
            Some(last) => {
                last.along_m[1] = last.along_m[1].max(piece.along_m[1]);
                last.height_m[0] = last.height_m[0].min(piece.height_m[0]);
                last.height_m[1] = last.height_m[1].max(piece.height_m[1]);
            }
            None => joined.push(piece),
        }
    }
    joined
}

/// The direction of a vector in plan; `None` where it is vertical.
pub fn horizontal(v: &Vector3<f64>) -> Option<[f64; 2]> {
    let length = v.x.hypot(v.y);
    (length > f64::EPSILON).then(|| [v.x / length, v.y / length])
}
