//! Everything that a search works on: the cloud in the level frame, the city, and what is known of the pose beforehand.

use std::sync::Arc;

use super::level_cloud::LevelCloud;
use super::mover::Mover;
use super::prior::{Prior, Reach, Vertical};
use crate::geometry::{Point3, Similarity, Start, Vector3};
use crate::limits::Limits;
use crate::planes::{FacetGrid, Facing, Hit, Look, OrientedPoint, Patches, PreparedCity, Upright};
use crate::robust::Motion;

/// A cloud in a city.
pub struct Scene<'a> {
    pub city: &'a PreparedCity,
    pub limits: &'a Limits,
    pub level_cloud: LevelCloud,
    pub prior: Prior,
    /// The part of the city that the cloud can come to lie in. What lies beyond is met by stray points alone, of which a handful would count
    /// as much as a facade: a plane's own error bounds what its points say.
    pub reach: Reach,
    /// Of the city, for the gates of refinement and for those of the search.
    narrow_grid: Arc<FacetGrid>,
    wide_grid: Arc<FacetGrid>,
    /// What "near" means to all gates, metres of the start.
    pub gate_unit_m: f64,
}

/// Sample points that are looked up together.
const BLOCK: usize = 32;

impl<'a> Scene<'a> {
    /// `start` maps to the city's local frame; with a rigid motion its scale is the given one.
    pub fn new(
        city: &'a PreparedCity,
        patches: &Patches,
        start: &Start,
        motion: Motion,
        upright: &Upright,
        limits: &'a Limits,
    ) -> Scene<'a> {
        let level_cloud = LevelCloud::new(patches, start.city_from_sfm(), upright, limits);
        let prior = Prior::new(
            start,
            level_cloud.center_in_city,
            level_cloud.radius_m,
            motion,
            if upright.known { Vertical::Known } else { Vertical::Free },
            city.model.bounds(),
            limits,
        );
        let gate_unit_m = limits.model_unit_m + limits.noise_sigmas * level_cloud.noise_m;
        // A pose may be as much larger than the start as the scale allows, and its gates with it.
        let grid = |gate_units: f64| city.grid(gate_units * gate_unit_m * prior.most_scale());
        let (narrow_grid, wide_grid) = (grid(limits.line_search.basin_gates_units[0]), grid(limits.search.gate_units));
        let reach = prior.reach(&level_cloud.extent());
        Scene { city, limits, level_cloud, prior, reach, narrow_grid, wide_grid, gate_unit_m }
    }

    /// The facet that a point lies on.
    #[cfg(test)]
    pub fn nearest(&self, sample_point: &OrientedPoint, gate_m: f64) -> Option<Hit> {
        if !self.reach.contains(&sample_point.position) {
            return None;
        }
        self.city.nearest(self.grid(gate_m), sample_point, gate_m)
    }

    /// Tells `see` which sample points of a point subset (by their place in it, in order) meet a facet under a pose, where in the city, and which. Each
    /// sample point has a gate of its own, metres of the city, the widest of which is told beforehand.
    #[inline]
    pub fn meet(
        &self,
        point_subset: &[u32],
        city_from_level: &Similarity,
        widest_m: f64,
        gate_m: impl Fn(u32) -> f64,
        mut see: impl FnMut(usize, &OrientedPoint, &Hit),
    ) {
        let (mover, grid) = (Mover::new(city_from_level), self.grid(widest_m));
        let mut facing: Option<(u32, Vector3<f64>, Facing)> = None;
        let mut looks: Vec<(usize, Point3<f64>, Look)> = Vec::with_capacity(BLOCK);
        for first in (0..point_subset.len()).step_by(BLOCK) {
            let block = first..point_subset.len().min(first + BLOCK);
            looks.clear();
            for k in block {
                let place = mover.place(&self.level_cloud.sample_points[point_subset[k] as usize]);
                let look = if self.reach.contains(&place) { self.city.look(grid, &place) } else { None };
                looks.extend(look.map(|look| (k, place, look)));
            }
            // Memory takes long to answer, but answers several at once: first all are asked, step by step, and then looked at.
            looks.iter_mut().for_each(|(_, _, look)| look.find_list());
            looks.iter().for_each(|(_, _, look)| look.fetch_list());
            looks.retain(|(_, _, look)| !look.is_empty());
            looks.iter().for_each(|(_, _, look)| look.fetch_triangles());
            for (k, position, look) in &looks {
                let i = point_subset[*k];
                let sample_point = &self.level_cloud.sample_points[i as usize];
                // Sample points of one patch face one way.
                let (_, normal, facing) = match &mut facing {
                    Some(known) if faces_as(&self.level_cloud.sample_points[known.0 as usize], sample_point) => known,
                    other => {
                        let normal = mover.direction(sample_point);
                        other.insert((i, normal, grid.facing(&OrientedPoint { normal, ..*sample_point })))
                    }
                };
                let sample_point = OrientedPoint { position: *position, normal: *normal, ..*sample_point };
                if let Some(hit) = look.nearest(&sample_point, facing, gate_m(i)) {
                    see(*k, &sample_point, &hit);
                }
            }
        }
    }

    /// The shorter a grid reaches, the fewer facets it looks at.
    fn grid(&self, gate_m: f64) -> &FacetGrid {
        if gate_m <= self.narrow_grid.reach_m() { &self.narrow_grid } else { &self.wide_grid }
    }

    /// To the city's local frame.
    pub fn city_from_sfm(&self, city_from_level: &Similarity) -> Similarity {
        *city_from_level * self.level_cloud.level_from_sfm
    }
}

#[inline]
fn faces_as(sample_point: &OrientedPoint, other: &OrientedPoint) -> bool {
    sample_point.normal == other.normal && sample_point.min_cos == other.min_cos && sample_point.sided == other.sided
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspondence::test_scene::{Made, walls_alone};
    use crate::geometry::StartSigmas;
    use crate::planes::PlaneId;
    use crate::synthetic::{Block, Offset};

    #[test]
    fn nothing_beyond_the_reach_is_met_and_all_that_can_be_seen_within_it_is() {
        // What was seen is the first block of a town that goes on.
        let town = Block::town(4, 1, 3);
        let survey = Block::new(town.houses[..6].to_vec()).cloud(&walls_alone());
        let made = Made::new(town, survey);
        let up = made.survey.city_from_sfm.rotation.inverse() * Vector3::z();
        let upright = Upright { up, sigma_rad: 0.0, known: true };
        let sigmas = StartSigmas { position_m: 2.0, height_m: 1.0, ..StartSigmas::default() };
        let scene = made.scene_with(&Offset::default(), sigmas, Motion::Rigid, &upright);
        let (mut within, mut beyond) = (0, 0);
        for (id, facet) in made.city.model.facets_with_ids() {
            for triangle in facet.triangles.clone().filter(|t| made.city.is_exposed(*t)) {
                let [a, b, c] = made.city.corners(triangle);
                let position = Point3::from((a.coords + b.coords + c.coords) / 3.0);
                let sample_point = OrientedPoint { position, normal: facet.plane.normal, sided: true, min_cos: 0.9 };
                let met: Option<PlaneId> = scene.nearest(&sample_point, scene.gate_unit_m).map(|hit| hit.plane);
                let is_within = scene.reach.contains(&position);
                assert_eq!(met, is_within.then(|| made.city.planes().of_facet(id)), "{position}");
                *(if is_within { &mut within } else { &mut beyond }) += 1;
            }
        }
        assert!(within > 20 && beyond > 100, "{within} {beyond}");
    }

    #[test]
    fn the_grid_answers_as_far_as_the_widest_gate_of_the_largest_scale_within_reach() {
        let made = Made::four_houses();
        for motion in [Motion::Rigid, Motion::Similarity] {
            let scene = made.scene(&Offset::default(), motion);
            let widest_m = made.limits.search.gate_units * scene.gate_unit_m * scene.prior.most_scale();
            assert!(scene.wide_grid.reach_m() >= widest_m, "{} {widest_m}", scene.wide_grid.reach_m());
        }
    }
}
