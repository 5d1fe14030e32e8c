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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::random::Random;

    fn cloud(count: usize, levels: usize) -> Vec<Point3<f64>> {
        let mut random = Random::stream(count as u64, 0);
        (0..count).map(|_| Point3::from([0, 1, 2].map(|_| random.below(levels) as f64 - 1.0))).collect()
    }

    #[test]
    fn each_place_is_the_first_point_that_stands_there() {
        let mut points = cloud(400, 6);
        points.extend([Point3::new(0.0, -0.0, 0.0), Point3::new(-0.0, 0.0, 0.0)]);
        let places = Places::of(&points);
        let first = |p: &Point3<f64>| points.iter().position(|other| other == p).unwrap() as u32;
        let expected: BTreeSet<u32> = points.iter().map(first).collect();
        assert_eq!(places.firsts.iter().map(|p| p.0).collect::<BTreeSet<_>>(), expected);
        assert_eq!(places.firsts.len(), expected.len());
        // A point's slot is that of its place, wherever the place stands in the support.
        let support: Vec<PointIndex> = places.firsts.iter().rev().step_by(2).copied().collect();
        for (p, slot) in points.iter().zip(places.slots(&support)) {
            let place = PointIndex(first(p));
            assert_eq!(slot, support.iter().position(|s| *s == place).map(|at| at as u32), "{p}");
        }
    }

    #[test]
    fn a_thinning_keeps_few_enough_points_of_the_cloud_and_reaches_all_of_it() {
        let points = cloud(20_000, 60);
        let places = Places::of(&points).firsts;
        for most in [50, 1000, 5000] {
            let kept = thinned(&points, &places, most);
            assert!(kept.len() <= most && kept.len() * 4 >= most, "{} of {most}", kept.len());
            let distinct: BTreeSet<u32> = kept.iter().map(|p| p.0).collect();
            assert_eq!(distinct.len(), kept.len());
            // Even: every eighth of the box has its share.
            for octant in 0..8 {
                let is_in =
                    |p: &&PointIndex| (0..3).all(|k| (points[p.0 as usize][k] > 28.5) == (octant >> k & 1 == 1));
                let share = kept.iter().filter(is_in).count() as f64 / kept.len() as f64;
                let fair = if most < 100 { 0.02..0.3 } else { 0.06..0.22 };
                assert!(fair.contains(&share), "{share} of {most} in octant {octant}");
            }
        }
        assert_eq!(thinned(&points, &places, places.len()), places);
    }

    #[test]
    fn a_cloud_in_a_plane_on_a_line_or_with_a_point_far_off_is_thinned_all_the_same() {
        let flat: Vec<_> = cloud(5000, 80).iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
        let straight: Vec<_> = (0..5000).map(|k| Point3::new(f64::from(k), 0.0, 0.0)).collect();
        let mut stray = cloud(5000, 80);
        stray.push(Point3::new(1e12, 0.0, 0.0));
        for points in [flat, straight, stray] {
            let places = Places::of(&points).firsts;
            let kept = thinned(&points, &places, 300);
            assert!((30..=300).contains(&kept.len()), "{}", kept.len());
        }
    }
}
