//! The surface round each point of a cloud: nearest neighbours and the plane through them.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;
use std::num::NonZero;

use super::fit::fit_plane;
use crate::geometry::{Point3, Vector3};

/// Neighbours that the local plane is fitted to, the point itself included.
pub const NEIGHBOURS: usize = 14;

/// Points are handled in blocks of this size, so that the result does not depend on the number of threads.
const BLOCK: usize = 1024;

/// The plane through a point's neighbours.
#[derive(Clone, Copy, Debug)]
pub struct LocalSurface {
    /// Unit; its sign means nothing.
    pub normal: Vector3<f64>,
    /// Standard deviation of the neighbours across the plane; the frame's unit.
    pub rms: f64,
    /// Standard deviation across the plane over that along the plane's shorter axis: 0 is flat, 1 is no plane.
    pub roughness: f64,
}

/// For each point its surface (`None` where the neighbours lie on a line or in one place), and all neighbour lists
/// behind each other, `NEIGHBOURS.min(points.len())` entries each, nearest first.
pub fn local_surfaces(points: &[Point3<f64>]) -> (Vec<Option<LocalSurface>>, Vec<u32>) {
    let Some(count) = NonZero::new(NEIGHBOURS.min(points.len())) else { return (Vec::new(), Vec::new()) };
    let entries: Vec<[f64; 3]> = points.iter().map(|p| [p.x, p.y, p.z]).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&entries) else {
        return (vec![None; points.len()], Vec::new());
    };
    let neighbours_of = |p: &[f64; 3]| -> Vec<u32> {
        let mut found: Vec<(f64, u32)> = tree
            .query(p)
            .nearest_n::<SquaredEuclidean<f64>>(count)
            .execute()
            .iter()
            .map(|n| (n.distance, n.item))
            .collect();
        // The tree answers ties by its layout.
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|(_, item)| item).collect()
    };
    let blocks: Vec<Vec<(Option<LocalSurface>, Vec<u32>)>> = entries
        .par_chunks(BLOCK)
        .map(|block| {
            block
                .iter()
                .map(|p| {
                    let neighbours = neighbours_of(p);
                    (surface(points, &neighbours), neighbours)
                })
                .collect()
        })
        .collect();
    let mut surfaces = Vec::with_capacity(points.len());
    let mut lists = Vec::with_capacity(points.len() * count.get());
    for (surface, neighbours) in blocks.into_iter().flatten() {
        surfaces.push(surface);
        lists.extend(neighbours);
    }
    (surfaces, lists)
}

fn surface(points: &[Point3<f64>], neighbours: &[u32]) -> Option<LocalSurface> {
    let fit = fit_plane(neighbours.iter().map(|&i| points[i as usize]))?;
    Some(LocalSurface { normal: fit.plane.normal, rms: fit.rms, roughness: fit.rms / fit.spread[1] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sees_the_plane_round_each_point_of_a_grid() {
        let points: Vec<_> = (0..100).map(|i| Point3::new(f64::from(i % 10), 0.0, f64::from(i / 10))).collect();
        let (surfaces, lists) = local_surfaces(&points);
        assert_eq!(lists.len(), 100 * NEIGHBOURS);
        assert!(surfaces.iter().flatten().all(|s| s.normal.y.abs() > 1.0 - 1e-12 && s.rms < 1e-7));
        assert!((0..100).all(|i| lists[i * NEIGHBOURS] == i as u32));
    }

    #[test]
    fn survives_clouds_without_extent() {
        assert!(local_surfaces(&[]).0.is_empty());
        let same = vec![Point3::new(1.0, 2.0, 3.0); 40];
        assert!(local_surfaces(&same).0.iter().all(Option::is_none));
    }
}
