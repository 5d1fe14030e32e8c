//! Rows in units of their own: points about their centroid, planes about the point nearest to all of them.
//!
//! Normalising is also where the structural tests stand: they need the same quantities.

use std::collections::HashSet;

use super::degeneracy::{Degeneracy, condition};
use super::forms::{Form, forms_of};
use super::same_planes::{SAME_PLANE, SamePlanes, parallel};
use crate::geometry::{Matrix3, Rotation3, Similarity, Vector3};
use crate::solvers::algebra::singular::Singular;
use crate::solvers::row::Row;
use crate::solvers::sought::Sought;

/// Singular value of the normals, relative to the largest, below which they lie in one plane.
const NORMAL_RANK: f64 = 1e-10;

/// Spread of the points, relative to their coordinates, below which they coincide.
const SAME_POINT: f64 = 1e-13;

/// Distance of the planes from their common point, relative to their offsets, below which they are concurrent.
const CONCURRENT: f64 = 1e-12;

/// Singular value of the points of one plane, in units of the spread, below which they have no extent in a direction.
const EXTENT: f64 = 1e-11;

/// Directions that the normals hold this weakly do not move the planes' common point: nearly parallel planes must not throw
/// it far away.
const NEAR: f64 = 1e-2;

/// Singular values below this, relative to the largest, carry no information.
pub const NO_INFORMATION: f64 = 1e-13;

/// A problem in units of its own, past the structural tests.
pub struct Normalised {
    pub sought: Sought,
    /// Unit normals; points about `centroid` in units of `spread`; offsets about `near` in units of `unit`.
    pub rows: Vec<Row>,
    /// The rows, or what they come to where they are many: what solving sees.
    pub forms: Vec<Form>,
    /// The normals of the forms as a matrix.
    normals: Singular,
    /// Index of the plane of each row: rows of the same plane share it.
    plane_of: Vec<usize>,
    pub centroid: Vector3<f64>,
    pub spread: f64,
    pub near: Vector3<f64>,
    pub unit: f64,
}

/// A row's normal scaled by a power of two to about 1, its offset likewise, and the rest of the normal's length.
struct Scaled {
    normal: Vector3<f64>,
    offset: f64,
    length: f64,
}

impl Normalised {
    pub fn new(sought: &Sought, rows: &[Row]) -> Result<Normalised, Degeneracy> {
        let rows = different(rows);
        if rows.len() < sought.unknowns() {
            return Err(Degeneracy::TooFewRows { rows: rows.len(), unknowns: sought.unknowns() });
        }
        let scaled: Vec<Scaled> = rows.iter().map(scaled).collect();
        let planes = Planes::of(&scaled);
        planes.check()?;
        let points: Vec<Vector3<f64>> = rows.iter().map(|row| row.point).collect();
        let (centroid, spread) = centred(&points)?;
        let near = nearest_point(&scaled);
        let offsets: Vec<f64> = scaled.iter().map(|s| s.about(&near)).collect();
        let unit = if sought.is_similarity() { planes.size_apart(&offsets)? } else { spread };
        let rows: Vec<Row> = (0..rows.len())
            .map(|r| Row {
                point: (points[r] - centroid) / spread,
                normal: planes.normals[r],
                offset: offsets[r] / unit,
            })
            .collect();
        let forms = forms_of(&rows);
        let normals = Singular::of(&forms.iter().map(|form| form.normal.into()).collect::<Vec<[f64; 3]>>());
        let plane_of = planes.plane_of;
        let problem = Normalised { sought: *sought, rows, forms, normals, plane_of, centroid, spread, near, unit };
        problem.check_points()?;
        problem.check_motion()?;
        Ok(problem)
    }

    /// Every plane supplies at most as many independent rows as its points span dimensions, and one.
    fn check_points(&self) -> Result<(), Degeneracy> {
        if self.sought.up().is_some() {
            return Ok(());
        }
        let (mut rank, mut crowded) = (0, false);
        for on in self.by_plane().chunk_by(|&a, &b| self.plane_of[a] == self.plane_of[b]) {
            let on: Vec<Vector3<f64>> = on.iter().map(|&row| self.rows[row].point).collect();
            let mean = on.iter().sum::<Vector3<f64>>() / on.len() as f64;
            let size = on.iter().map(|p| p.amax()).fold(1.0, f64::max);
            let centred: Vec<[f64; 3]> = on.iter().map(|p| (p - mean).into()).collect();
            let extents = Singular::of(&centred).sorted();
            rank += (1 + extents.iter().filter(|&&s| s > EXTENT * size).count()).min(3);
            crowded |= on.len() > 3;
            if rank >= self.sought.unknowns() {
                break;
            }
        }
        match (rank < self.sought.unknowns(), crowded) {
            (false, _) => Ok(()),
            (true, true) => Err(Degeneracy::CrowdedPlane),
            (true, false) => Err(Degeneracy::CollinearPoints),
        }
    }

    /// What is free at one arbitrary rotation is free at every pose.
    fn check_motion(&self) -> Result<(), Degeneracy> {
        let turn = match self.sought.up() {
            None => Rotation3::from_euler_angles(0.71, -0.43, 1.27).into_inner(),
            Some(up) => up.rotation(0.6, 0.8),
        };
        let images: Vec<Vector3<f64>> = self.rows.iter().map(|row| turn * row.point).collect();
        let normals: Vec<Vector3<f64>> = self.rows.iter().map(|row| row.normal).collect();
        if condition(&self.sought, &images, &normals) < SAME_PLANE {
            return Err(Degeneracy::FreeMotion);
        }
        Ok(())
    }

    /// The translation that fits best to what the forms say without it.
    pub fn foot_of(&self, heights: &[f64]) -> Vector3<f64> {
        Vector3::from_vec(self.normals.least_squares(heights, NO_INFORMATION))
    }

    /// A pose in the units that the rows came in.
    pub fn similarity(&self, scale: f64, rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> Similarity {
        let scale = if self.sought.is_similarity() { scale * self.unit / self.spread } else { 1.0 };
        let translation = self.near + self.unit * translation - scale * (rotation * self.centroid);
        Similarity { scale, rotation: Rotation3::from_matrix_unchecked(*rotation), translation }
    }

    /// The rows, those of one plane after the other.
    fn by_plane(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.rows.len()).collect();
        order.sort_by_key(|&row| self.plane_of[row]);
        order
    }

    /// Unit normal (sensor frame) of a large triangle on one plane, and that plane's normal; `None` where every plane's
    /// points are collinear. Of each plane: a point far from its first, one far from that, one far from the line through both.
    /// No triangle on the plane has more than four times its area: its sides are at most twice as long, and its height is
    /// at most twice the last distance.
    pub fn largest_triangle(&self) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let mut best = (EXTENT, None);
        for on in self.by_plane().chunk_by(|&a, &b| self.plane_of[a] == self.plane_of[b]) {
            let points = || on.iter().map(|&row| self.rows[row].point);
            let a = farthest(points(), |p| (p - self.rows[on[0]].point).norm());
            let along = farthest(points(), |p| (p - a).norm()) - a;
            let across = along.cross(&(farthest(points(), |p| along.cross(&(p - a)).norm()) - a));
            let area = across.norm();
            if area > best.0 {
                best = (area, Some((across / area, self.rows[on[0]].normal)));
            }
        }
        best.1
    }
}

/// The first of the points for which `distance` is largest.
fn farthest(points: impl Iterator<Item = Vector3<f64>>, distance: impl Fn(&Vector3<f64>) -> f64) -> Vector3<f64> {
    let measured = points.map(|point| (distance(&point), point));
    measured.reduce(|best, next| if next.0 > best.0 { next } else { best }).map_or(Vector3::zeros(), |(_, point)| point)
}

/// The rows without repetition.
fn different(rows: &[Row]) -> Vec<Row> {
    let mut seen = HashSet::with_capacity(rows.len());
    // Both zeros are one number.
    let bits = |v: &f64| (v + 0.0).to_bits();
    let numbers = |row: &Row| {
        let [p, n] = [row.point, row.normal];
        [p.x, p.y, p.z, n.x, n.y, n.z, row.offset].map(|v| bits(&v))
    };
    rows.iter().filter(|row| seen.insert(numbers(row))).copied().collect()
}

/// Scaling by a power of two is exact.
fn scaled(row: &Row) -> Scaled {
    let largest = row.normal.amax();
    let exponent = (largest.log2().floor() as i32).clamp(-1000, 1000);
    let factor = 2f64.powi(-exponent);
    let normal = row.normal * factor;
    Scaled { normal, offset: row.offset * factor, length: normal.norm() }
}

impl Scaled {
    /// Distance of the plane from `x`, with twice the digits in between: products by fused multiply-add, sums with
    /// their errors kept.
    fn about(&self, x: &Vector3<f64>) -> f64 {
        let (mut sum, mut error) = (self.offset, 0.0);
        for i in 0..3 {
            let product = self.normal[i] * x[i];
            let product_error = self.normal[i].mul_add(x[i], -product);
            let next = sum + product;
            let part = next - sum;
            error += (sum - (next - part)) + (product - part) + product_error;
            sum = next;
        }
        (sum + error) / self.length
    }
}

/// The planes of the rows.
struct Planes {
    normals: Vec<Vector3<f64>>,
    offsets: Vec<f64>,
    plane_of: Vec<usize>,
    planes: usize,
    /// Up to three.
    directions: usize,
}

impl Planes {
    fn of(scaled: &[Scaled]) -> Planes {
        let normals: Vec<Vector3<f64>> = scaled.iter().map(|s| s.normal / s.length).collect();
        let offsets: Vec<f64> = scaled.iter().map(|s| s.offset / s.length).collect();
        let SamePlanes { plane_of, planes } = SamePlanes::of(&normals, &offsets);
        // No more than three directions are asked for.
        let mut directions: Vec<Vector3<f64>> = Vec::new();
        for normal in &normals {
            if directions.len() < 3 && !directions.iter().any(|known| parallel(normal, known)) {
                directions.push(*normal);
            }
        }
        Planes { normals, offsets, plane_of, planes, directions: directions.len() }
    }

    fn check(&self) -> Result<(), Degeneracy> {
        if self.planes < 3 {
            return Err(Degeneracy::TooFewPlanes);
        }
        if self.directions < 3 {
            return Err(Degeneracy::ParallelPlanes);
        }
        let singular = Singular::of(&self.matrix());
        if singular.smallest() < NORMAL_RANK * singular.largest() {
            return Err(Degeneracy::CoplanarNormals);
        }
        Ok(())
    }

    fn matrix(&self) -> Vec<[f64; 3]> {
        self.normals.iter().map(|&n| n.into()).collect()
    }

    /// Root mean square of the offsets about the common point; refused where the planes do meet there.
    fn size_apart(&self, offsets: &[f64]) -> Result<f64, Degeneracy> {
        let foot = Vector3::from_vec(Singular::of(&self.matrix()).least_squares(offsets, 0.0));
        let apart = offsets.iter().zip(&self.normals).map(|(e, n)| (e - n.dot(&foot)).abs()).fold(0.0, f64::max);
        let largest = self.offsets.iter().map(|d| d.abs()).fold(0.0, f64::max);
        if apart <= CONCURRENT * largest || self.planes < 4 {
            return Err(Degeneracy::ConcurrentPlanes);
        }
        Ok((offsets.iter().map(|e| e * e).sum::<f64>() / offsets.len() as f64).sqrt())
    }
}

/// Centroid and root mean square distance from it.
fn centred(points: &[Vector3<f64>]) -> Result<(Vector3<f64>, f64), Degeneracy> {
    let count = points.len() as f64;
    let largest = points.iter().map(|p| p.amax()).fold(0.0, f64::max);
    // Dividing first keeps the largest finite numbers finite.
    let centroid = points.iter().map(|p| p / count).sum::<Vector3<f64>>();
    let extent = points.iter().map(|p| (p - centroid).amax()).fold(0.0, f64::max);
    if !(extent > 0.0 && extent > SAME_POINT * largest) {
        return Err(Degeneracy::OnePoint);
    }
    let mean_sq = points.iter().map(|p| ((p - centroid) / extent).norm_squared()).sum::<f64>() / count;
    Ok((centroid, extent * mean_sq.sqrt()))
}

/// The point nearest to all planes, by least squares; two rounds, so that the second starts near.
fn nearest_point(scaled: &[Scaled]) -> Vector3<f64> {
    let matrix: Vec<[f64; 3]> = scaled.iter().map(|s| (s.normal / s.length).into()).collect();
    let singular = Singular::of(&matrix);
    let mut near = Vector3::zeros();
    for _ in 0..2 {
        let offsets: Vec<f64> = scaled.iter().map(|s| s.about(&near)).collect();
        near -= Vector3::from_vec(singular.least_squares(&offsets, NEAR));
    }
    near
}
