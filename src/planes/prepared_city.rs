//! A city model made ready for alignments, once for all of them.
//!
//! Planes and the tree for lines of sight are made when they are first asked for; what can be seen, and which facet is
//! nearest, is found out tile by tile, where somebody asks. So a small reconstruction in a large city pays for its own streets only,
//! and the next one there for nothing.

use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use super::city_planes::PlaneId;
use super::facet_grid::{FacetGrid, Look};
use super::facet_visibility::FacetVisibility;
use super::hit::{Hit, OrientedPoint};
use super::surface::CitySurface;
use crate::city::{CityModel, FacetId};
use crate::geometry::Point3;
use crate::limits::{FacetVisibilityLimits, Limits};

/// A city model with all that alignments ask of it; read it as the surface that it is.
pub struct PreparedCity {
    surface: CitySurface,
    exposure: FacetVisibility,
    /// One for each reach that was asked for.
    grids: Mutex<Vec<Arc<FacetGrid>>>,
}

/// Grids are made for reaches in this ratio: a grid that reaches farther than asked lists more facets in each cell.
const REACH_RATIO: f64 = 1.19;

impl PreparedCity {
    /// A city whose exposure is judged as [`Limits::default`] says.
    pub fn new(model: CityModel) -> PreparedCity {
        PreparedCity::with_limits(model, &Limits::default().facet_visibility)
    }

    pub fn with_limits(model: CityModel, limits: &FacetVisibilityLimits) -> PreparedCity {
        let surface = CitySurface::new(model);
        PreparedCity { exposure: FacetVisibility::new(&surface, limits), surface, grids: Mutex::new(Vec::new()) }
    }

    /// Whether somebody could have seen a triangle from the open.
    pub fn is_exposed(&self, triangle: u32) -> bool {
        self.exposure.of(triangle, &self.surface)
    }

    /// For each plane whether any of it within a box can be seen.
    pub fn planes_in_sight(&self, low: &Point3<f64>, high: &Point3<f64>) -> Vec<PlaneId> {
        let meets = |a: &Point3<f64>, b: &Point3<f64>| (0..3).all(|k| a[k] <= high[k] && b[k] >= low[k]);
        let triangle_in_sight = |t: u32| {
            let [a, b, c] = self.corners(t);
            meets(&a.inf(&b).inf(&c), &a.sup(&b).sup(&c)) && self.is_exposed(t)
        };
        let facet_in_sight = |f: &FacetId| self.model.facets[f.0 as usize].triangles.clone().any(triangle_in_sight);
        let planes = &self.planes().planes;
        let in_sight = |i: &u32| {
            let plane = &planes[*i as usize];
            meets(&plane.low, &plane.high) && plane.facets.iter().any(facet_in_sight)
        };
        (0..planes.len() as u32).into_par_iter().filter(in_sight).map(PlaneId).collect()
    }

    /// The facet that a sample point lies on, by a grid of this city.
    #[inline]
    pub fn nearest(&self, grid: &FacetGrid, sample_point: &OrientedPoint, gate_m: f64) -> Option<Hit> {
        let facing = grid.facing(sample_point);
        let mut look = self.look(grid, &sample_point.position)?;
        look.find_list();
        look.nearest(sample_point, &facing, gate_m)
    }

    /// Where to look in a grid of this city; `None` beyond it.
    #[inline]
    pub fn look<'g>(&self, grid: &'g FacetGrid, place: &Point3<f64>) -> Option<Look<'g>> {
        grid.look(place, &self.surface, &self.exposure)
    }

    /// The grid of facets that answers within `reach_m`.
    pub fn grid(&self, reach_m: f64) -> Arc<FacetGrid> {
        // A step of a geometric series, so that parts whose noise differs a little share a grid.
        let step = (reach_m.ln() / REACH_RATIO.ln()).ceil();
        let reach_m = REACH_RATIO.powf(step);
        let mut grids = self.grids.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(grid) = grids.iter().find(|grid| grid.reach_m() == reach_m) {
            return Arc::clone(grid);
        }
        let grid = Arc::new(FacetGrid::new(&self.model, reach_m));
        grids.push(Arc::clone(&grid));
        grid
    }
}

impl std::ops::Deref for PreparedCity {
    type Target = CitySurface;

    fn deref(&self) -> &CitySurface {
        &self.surface
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector3;
    use crate::synthetic::{Block, Face, House, Surface};

    /// Five houses, wall to wall along x, each 6 m wide, 9 m deep and 7 m high, with an upper floor in each, on their ground.
    fn row() -> Block {
        let mut house = House::flat([6.0, 9.0, 7.0]);
        let floor = [(0.2, 0.2), (5.8, 0.2), (5.8, 8.8), (0.2, 8.8)].map(|(x, y)| Point3::new(x, y, 3.5));
        house.faces.push(Face { surface: Surface::Roof, corners: floor.to_vec() });
        Block::row(&house, 5, 6.0).with_ground()
    }

    fn prepared(block: &Block) -> PreparedCity {
        PreparedCity::new(block.city().unwrap())
    }

    fn triangles(city: &PreparedCity) -> std::ops::Range<u32> {
        0..city.model.triangles.len() as u32
    }

    /// Middle of a triangle as the block has it.
    fn middle(city: &PreparedCity, triangle: u32) -> Point3<f64> {
        let [a, b, c] = city.corners(triangle);
        Point3::from((a.coords + b.coords + c.coords) / 3.0 + city.model.origin)
    }

    #[test]
    fn street_walls_gables_and_roofs_are_exposed_and_party_walls_and_floors_are_not() {
        let city = prepared(&row());
        let (mut open, mut closed) = (0, 0);
        for t in triangles(&city) {
            let (at, normal) = (middle(&city, t), city.model.facets[city.facet_of(t).0 as usize].plane.normal);
            let is_party_wall = normal.x.abs() > 0.9 && at.x > 0.1 && at.x < 29.9;
            let is_floor = (at.z - 3.5).abs() < 0.1 && normal.z.abs() > 0.9;
            assert_eq!(city.is_exposed(t), !is_party_wall && !is_floor, "{at} {normal}");
            *(if city.is_exposed(t) { &mut open } else { &mut closed }) += 1;
        }
        // Two triangles each: ten street walls, two gables, five roofs and the ground; eight party walls and five floors.
        assert_eq!((open, closed), (2 * 18, 2 * 13));
    }

    #[test]
    fn walls_on_both_sides_of_a_passage_are_exposed_and_of_a_joint_are_not() {
        let facing_walls_exposed = |gap_m: f64| {
            let city = prepared(&Block::row(&House::flat([6.0, 9.0, 7.0]), 2, 6.0 + gap_m));
            let facing = |t: &u32| (5.9..6.1 + gap_m).contains(&middle(&city, *t).x) && middle(&city, *t).z < 6.9;
            let inner: Vec<u32> = triangles(&city)
                .filter(facing)
                .filter(|t| city.model.facets[city.facet_of(*t).0 as usize].plane.normal.x.abs() > 0.9)
                .collect();
            assert_eq!(inner.len(), 4);
            inner.iter().filter(|t| city.is_exposed(**t)).count()
        };
        assert_eq!([0.0, 0.02, 0.3].map(facing_walls_exposed), [0, 0, 0]);
        assert_eq!([1.5, 4.0].map(facing_walls_exposed), [4, 4]);
    }

    #[test]
    fn what_is_asked_twice_or_in_another_order_is_answered_the_same() {
        let town = Block::town(2, 2, 4).with_ground();
        let (one, other) = (prepared(&town), prepared(&town));
        let (low, high) = one.model.bounds().unwrap();
        let first: Vec<bool> = triangles(&one).map(|t| one.is_exposed(t)).collect();
        let planes = other.planes_in_sight(&low, &high);
        let mut backwards: Vec<bool> = triangles(&other).rev().map(|t| other.is_exposed(t)).collect();
        backwards.reverse();
        assert_eq!(first, backwards);
        assert_eq!(first, triangles(&one).map(|t| one.is_exposed(t)).collect::<Vec<_>>());
        assert_eq!(planes, one.planes_in_sight(&low, &high));
        assert_eq!(planes, other.planes_in_sight(&low, &high));
        assert!(Arc::ptr_eq(&one.grid(2.0), &one.grid(2.0)));
        assert!(std::ptr::eq(one.rays(), one.rays()) && std::ptr::eq(one.planes(), one.planes()));
    }

    #[test]
    fn a_grid_reaches_as_far_as_asked_and_not_a_fifth_farther() {
        let city = prepared(&row());
        for reach_m in [0.01, 0.5, 1.45, 1.46, 3.0, 40.0] {
            let found_m = city.grid(reach_m).reach_m();
            assert!(found_m >= reach_m && found_m < 1.2 * reach_m, "{found_m} for {reach_m}");
        }
        assert!(!Arc::ptr_eq(&city.grid(1.0), &city.grid(2.0)));
    }

    #[test]
    fn planes_in_sight_are_those_with_an_exposed_triangle_that_reaches_into_the_box() {
        let city = prepared(&row());
        let all = city.planes().planes.len();
        for (low, high) in
            [([-1.0, -1.0, -1.0], [7.0, 4.0, 8.0]), ([13.0, -0.5, 1.0], [14.0, 0.5, 2.0]), ([70.0; 3], [90.0; 3])]
        {
            let [low, high] = [low, high].map(|x: [f64; 3]| Point3::from(Vector3::from(x) - city.model.origin));
            let found = city.planes_in_sight(&low, &high);
            let mut expected: Vec<PlaneId> = triangles(&city)
                .filter(|t| {
                    let [a, b, c] = city.corners(*t);
                    let (least, most) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
                    (0..3).all(|k| least[k] <= high[k] && most[k] >= low[k]) && city.is_exposed(*t)
                })
                .map(|t| city.planes().of_facet(city.facet_of(t)))
                .collect();
            expected.sort();
            expected.dedup();
            assert_eq!(found, expected);
            assert!(found.len() < all / 2, "{} of {all}", found.len());
        }
    }

    #[test]
    fn a_plane_between_whose_facets_a_box_lies_is_not_in_sight() {
        // One house of two wings, 10 m apart, whose fronts lie in one plane.
        let wing = House::flat([6.0, 9.0, 7.0]);
        let faces = [wing.clone(), wing.at([16.0, 0.0, 0.0])].into_iter().flat_map(|wing| wing.faces).collect();
        let city = prepared(&Block::new(vec![House { faces }]));
        let [low, high] =
            [[10.0, -1.0, 1.0], [12.0, 10.0, 9.0]].map(|x| Point3::from(Vector3::from(x) - city.model.origin));
        assert!(city.planes_in_sight(&low, &high).is_empty());
        let (low, high) = city.model.bounds().unwrap();
        assert_eq!(city.planes_in_sight(&low, &high).len(), city.planes().planes.len());
    }

    #[test]
    fn a_model_whose_facets_were_taken_away_by_hand_is_that_of_the_facets_that_are_left() {
        let mut model = row().city().unwrap();
        model.facets.remove(0);
        let city = PreparedCity::new(model);
        let of_facets: usize = city.model.facets.iter().map(|facet| facet.triangles.len()).sum();
        assert_eq!(city.model.triangles.len(), of_facets);
        for (id, facet) in city.model.facets_with_ids() {
            assert!(facet.triangles.clone().all(|t| city.facet_of(t) == id));
        }
    }
}
