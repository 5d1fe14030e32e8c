//! Which points take part: one at each place, and of a large cloud an even thinning.

use std::cmp::Ordering;
use std::collections::HashMap;

use rayon::prelude::*;

use crate::geometry::Point3;
use crate::reconstruction::PointIndex;

/// Which points stand at one place. Copies are told by equal coordinates alone: in a frame of large coordinates a tolerance
/// that takes in the rounding of a copy takes in the neighbours as well.
pub(super) struct Places {
    /// The first point of each place, by place.
    pub(super) firsts: Vec<PointIndex>,
    /// For each point the first one at its place.
    first_at: Vec<PointIndex>,
}

impl Places {
    pub(super) fn of(points: &[Point3<f64>]) -> Places {
        let mut order: Vec<PointIndex> = (0..points.len() as u32).map(PointIndex).collect();
        let place = |i: &PointIndex| &points[i.0 as usize];
        order.par_sort_unstable_by(|a, b| by_place(place(a), place(b)).then(a.cmp(b)));
        let mut places = Places { firsts: Vec::with_capacity(points.len()), first_at: order.clone() };
        for copies in order.chunk_by(|a, b| by_place(place(a), place(b)).is_eq()) {
            places.firsts.push(copies[0]);
            copies.iter().for_each(|i| places.first_at[i.0 as usize] = copies[0]);
        }
        places
    }

    /// For each point where its place stands in the support.
    pub(super) fn slots(&self, support: &[PointIndex]) -> Vec<Option<u32>> {
        let mut slot_of = vec![None; self.first_at.len()];
        support.iter().zip(0..).for_each(|(p, slot)| slot_of[p.0 as usize] = Some(slot));
        self.first_at.iter().map(|first| slot_of[first.0 as usize]).collect()
    }
}

/// By x, then y, then z; the two zeros are one.
fn by_place(a: &Point3<f64>, b: &Point3<f64>) -> Ordering {
    let coordinate = |k: usize| (a[k] + 0.0).total_cmp(&(b[k] + 0.0));
    coordinate(0).then_with(|| coordinate(1)).then_with(|| coordinate(2))
}

/// An even thinning of `places` (sorted) to about `most` of them: of each cell of a grid the point next to its middle, the cell
/// widened until few enough are left.
pub(super) fn thinned(points: &[Point3<f64>], places: &[PointIndex], most: usize) -> Vec<PointIndex> {
    if places.len() <= most {
        return places.to_vec();
    }
    let place = |p: &PointIndex| &points[p.0 as usize];
    // Outliers must not set the cell: the box of the middle 96 % of a coordinate does.
    let mut low = [0.0; 3];
    let mut extent = [0.0; 3];
    for k in 0..3 {
        let mut c: Vec<f64> = places.iter().map(|p| place(p)[k]).collect();
        let mut at = |rank: usize| *c.select_nth_unstable_by(rank, f64::total_cmp).1;
        low[k] = at(places.len() / 50);
        extent[k] = (at(places.len() - 1 - places.len() / 50) - low[k]).max(f64::MIN_POSITIVE);
    }
    // A surface of area A in cells of width w meets about A / w^2 of them, a line of length l about l / w.
    let longest = extent.iter().copied().fold(0.0, f64::max);
    let [a, b, c] = extent.map(|e| e / longest);
    let area = 2.0 * (a * b + b * c + c * a);
    let mut width = longest * (area / (8.0 * most as f64)).sqrt().max(1.0 / most as f64);
    loop {
        let mut next_to_middle: HashMap<[i64; 3], (f64, PointIndex)> = HashMap::with_capacity(most * 2);
        for &p in places {
            let in_cells = [0, 1, 2].map(|k| (place(&p)[k] - low[k]) / width);
            let off = in_cells.iter().map(|x| (x - x.floor() - 0.5).powi(2)).sum();
            let kept = next_to_middle.entry(in_cells.map(|x| x.floor() as i64)).or_insert((off, p));
            if off < kept.0 {
                *kept = (off, p);
            }
        }
        if next_to_middle.len() <= most {
            let mut kept: Vec<PointIndex> = next_to_middle.into_values().map(|(_, p)| p).collect();
            kept.sort_unstable_by(|a, b| by_place(place(a), place(b)));
            return kept;
        }
        width *= (next_to_middle.len() as f64 / most as f64).sqrt().max(1.05);
    }
}
