//! Planes through points: least squares, and robustly among points that do not belong.

use crate::geometry::{Matrix3, Plane, Point3, Vector3};
use nalgebra::SymmetricEigen;

/// A least-squares plane and how the points lie in it.
#[derive(Clone, Copy, Debug)]
pub struct FittedPlane {
    pub plane: Plane,
    pub center: Point3<f64>,
    /// Root mean square distance from the plane; the frame's unit.
    pub rms: f64,
    /// Standard deviations along the two in-plane principal axes, the longer first; the frame's unit.
    pub spread: [f64; 2],
    /// The in-plane principal axes, the longer first.
    pub axes: [Vector3<f64>; 2],
}

/// Spreads are roots of eigenvalues that carry a rounding of some 1e-16 of the largest: below 1e-8 of it they mean nothing.
const SPREAD_ROUNDING: f64 = 1e-7;

/// Least-squares plane (smallest principal direction about the centroid); `None` with fewer than three points or where
/// the points lie on a line.
pub fn fit_plane(points: impl Iterator<Item = Point3<f64>> + Clone) -> Option<FittedPlane> {
    let (mut count, mut sum) = (0usize, Vector3::zeros());
    for p in points.clone() {
        count += 1;
        sum += p.coords;
    }
    if count < 3 {
        return None;
    }
    let center = sum / count as f64;
    let mut moment = Matrix3::zeros();
    for p in points {
        let d = p.coords - center;
        moment += d * d.transpose();
    }
    let eigen = SymmetricEigen::new(moment / count as f64);
    let mut order = [0usize, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let [small, middle, large] = order.map(|k| eigen.eigenvalues[k].max(0.0).sqrt());
    // On a line the plane turns freely about it: the middle spread is only rounding of the long one.
    if !large.is_finite() || middle <= SPREAD_ROUNDING * large || large == 0.0 {
        return None;
    }
    let normal = eigen.eigenvectors.column(order[0]).into_owned();
    let axis = |k: usize| eigen.eigenvectors.column(order[k]).into_owned();
    let plane = Plane::through(&Point3::from(center), &normal)?;
    Some(FittedPlane {
        plane,
        center: Point3::from(center),
        rms: small,
        spread: [large, middle],
        axes: [axis(2), axis(1)],
    })
}

/// Least-squares plane of the points within `tolerance` of the plane through three of them that has most such points,
/// and the indices (into `points`) of those. Small sets are tried whole, large ones by a fixed scheme of triples.
pub fn fit_plane_robustly(points: &[Point3<f64>], tolerance: f64) -> Option<(FittedPlane, Vec<usize>)> {
    let mut best: Option<(usize, Plane)> = None;
    for [a, b, c] in triples(points.len()) {
        let normal = (points[b] - points[a]).cross(&(points[c] - points[a]));
        let Some(plane) = Plane::through(&points[a], &normal) else { continue };
        let inside = points.iter().filter(|p| plane.signed_distance(p).abs() <= tolerance).count();
        if best.is_none_or(|(most, _)| inside > most) {
            best = Some((inside, plane));
        }
    }
    let (_, mut plane) = best?;
    let mut found = None;
    // Twice: the plane through three noisy points misses some that the fitted one holds.
    for _ in 0..2 {
        let inside: Vec<usize> =
            (0..points.len()).filter(|&i| plane.signed_distance(&points[i]).abs() <= tolerance).collect();
        let fit = fit_plane(inside.iter().map(|&i| points[i]))?;
        plane = fit.plane;
        found = Some((fit, inside));
    }
    found
}

/// Most triples that a robust fit tries: with half of the points outside, 60 miss with probability 3e-4.
const MOST_TRIPLES: usize = 60;

/// All triples of few points; of many, a fixed sequence that steps through them with three different strides.
fn triples(count: usize) -> Vec<[usize; 3]> {
    let mut all = Vec::new();
    if count < 8 {
        for a in 0..count {
            for b in a + 1..count {
                all.extend((b + 1..count).map(|c| [a, b, c]));
            }
        }
        return all;
    }
    let mut state = 1u64;
    let mut next = || {
        // Knuth's MMIX generator: fixed, so that the same points give the same plane.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % count
    };
    while all.len() < MOST_TRIPLES {
        let [a, b, c] = [next(), next(), next()];
        if a != b && b != c && a != c {
            all.push([a, b, c]);
        }
    }
    all
}

#[cfg(test)]
mod tests;
