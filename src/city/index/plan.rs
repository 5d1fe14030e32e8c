//! Which facet goes into which block.
//!
//! A block is a square of plan. An object goes into the block of its middle as a whole, so that its planes are the same in any part of the city;
//! one that is wider than a block (ground, a mesh without objects) is shared out facet by facet.

use std::collections::BTreeMap;

use crate::city::{CityModel, Facet};
use crate::geometry::Point3;

/// Side of a block, metres. Chosen: about 200 houses of a dense town, a megabyte.
pub(super) const BLOCK_M: f64 = 250.0;

/// Column and row of a block.
pub(super) type Cell = [i64; 2];

/// What goes into one block; numbers of the model, ascending.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockPlan {
    pub facets: Vec<u32>,
    /// Those of its facets, and those that have none.
    pub objects: Vec<u32>,
    /// Vertices that no facet uses.
    pub strays: Vec<u32>,
}

/// The blocks of a model, row by row.
pub(super) fn block_plans(model: &CityModel) -> Vec<BlockPlan> {
    let mut extents: Vec<Option<Extent>> = vec![None; model.objects.len()];
    for facet in &model.facets {
        let extent = &mut extents[facet.object.0 as usize];
        let own = Extent::of(model, facet);
        *extent = Some(extent.map_or(own, |extent| extent.with(&own)));
    }
    let mut plans: BTreeMap<Cell, BlockPlan> = BTreeMap::new();
    let mut is_used = vec![false; model.vertices.len()];
    for (id, facet) in model.facets_with_ids() {
        facet.rings().flatten().for_each(|&vertex| is_used[vertex as usize] = true);
        let triangles = &model.triangles[facet.triangles.start as usize..facet.triangles.end as usize];
        triangles.iter().flatten().for_each(|&vertex| is_used[vertex as usize] = true);
        let of_object = extents[facet.object.0 as usize].filter(|extent| !extent.is_wide());
        let cell = of_object.unwrap_or_else(|| Extent::of(model, facet)).cell();
        let plan = plans.entry(cell).or_default();
        plan.facets.push(id.0);
        plan.objects.push(facet.object.0);
    }
    for (vertex, _) in (0..).zip(&is_used).filter(|(_, used)| !**used) {
        let at = model.vertices[vertex as usize];
        let cell = Extent { low: at, high: at }.cell();
        let plan = if plans.contains_key(&cell) { plans.get_mut(&cell) } else { plans.values_mut().next() };
        plan.into_iter().for_each(|plan| plan.strays.push(vertex));
    }
    let empty = (0..).zip(&extents).filter(|(_, extent)| extent.is_none()).map(|(object, _)| object);
    plans.values_mut().next().into_iter().for_each(|first| first.objects.extend(empty.clone()));
    plans.values_mut().for_each(|plan| {
        plan.objects.sort_unstable();
        plan.objects.dedup();
    });
    plans.into_values().collect()
}

/// The cell that a place of the plan lies in.
pub(super) fn cell_of(place: [f64; 2]) -> Cell {
    place.map(|value| (value / BLOCK_M).floor() as i64)
}

#[derive(Clone, Copy)]
struct Extent {
    low: Point3<f64>,
    high: Point3<f64>,
}

impl Extent {
    fn of(model: &CityModel, facet: &Facet) -> Extent {
        let mut corners = facet.outline.iter().map(|&vertex| model.vertices[vertex as usize]);
        let first = corners.next().unwrap_or_default();
        let widened = |extent: Extent, corner: Point3<f64>| extent.with(&Extent { low: corner, high: corner });
        corners.fold(Extent { low: first, high: first }, widened)
    }

    fn with(&self, other: &Extent) -> Extent {
        Extent { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    fn is_wide(&self) -> bool {
        (self.high - self.low).xy().amax() > BLOCK_M
    }

    fn cell(&self) -> Cell {
        cell_of([0, 1].map(|k| (self.low[k] + self.high[k]) / 2.0))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::synthetic::Block;

    #[test]
    fn every_facet_object_and_stray_vertex_has_its_block() {
        let mut model = Block::town(12, 9, 4).with_ground().city().unwrap();
        model.vertices.push(Point3::new(1e5, 0.0, 0.0));
        model.objects.push("empty".into());
        let plans = block_plans(&model);
        assert!(plans.len() > 4, "{} blocks", plans.len());
        let facets: Vec<u32> = plans.iter().flat_map(|plan| plan.facets.clone()).collect();
        assert_eq!(facets.len(), model.facets.len(), "no facet stands in two blocks");
        assert_eq!(BTreeSet::from_iter(facets), (0..model.facets.len() as u32).collect());
        let objects: BTreeSet<u32> = plans.iter().flat_map(|plan| plan.objects.clone()).collect();
        assert_eq!(objects, (0..model.objects.len() as u32).collect());
        let strays: Vec<u32> = plans.iter().flat_map(|plan| plan.strays.clone()).collect();
        assert_eq!(strays, [model.vertices.len() as u32 - 1]);
        assert!(plans.iter().all(|plan| plan.facets.is_sorted() && plan.objects.is_sorted()));
    }

    #[test]
    fn an_object_that_is_no_wider_than_a_block_is_in_one() {
        let model = Block::town(12, 9, 4).city().unwrap();
        let plans = block_plans(&model);
        for object in 0..model.objects.len() as u32 {
            let of_object = model.facets.iter().filter(|facet| facet.object.0 == object);
            let extent = of_object.map(|facet| Extent::of(&model, facet)).reduce(|a, b| a.with(&b)).unwrap();
            let blocks = plans.iter().filter(|plan| plan.objects.contains(&object)).count();
            assert!(extent.is_wide() || blocks == 1, "object {object} is in {blocks} blocks");
        }
    }

    #[test]
    fn cells_are_half_open_on_both_sides_of_zero() {
        for (place, cell) in [(0.0, 0), (249.999, 0), (250.0, 1), (-0.001, -1), (-250.0, -1), (-250.001, -2)] {
            assert_eq!(cell_of([place, 0.0]), [cell, 0], "{place}");
        }
    }

    #[test]
    fn a_model_without_facets_has_no_block() {
        assert!(block_plans(&CityModel::default()).is_empty());
    }
}
