//! How a reconstruction may bend: smooth displacements that no similarity undoes.
//!
//! Input        places of the cloud
//! Output       displacements there, each orthogonal to all similarities and to each other over the cloud, of root mean square 1
//! Method       shears, and the squares and cubes of the level coordinates along each axis, made orthogonal by Gram and Schmidt.
//!              Orthogonal to similarities, since the pose that is sought is the similarity that fits the bent cloud best

use crate::geometry::{Point3, Vector3};
use crate::robust::MotionParameters;

/// Similarities: three shifts, three turns, the scale.
const SIMILARITIES: usize = 7;
/// Five shears; three squares and four cubes along three axes.
pub(super) const FIELDS: usize = 5 + 7 * 3;
/// What is left of a field when those before it are taken out may be no more than noise.
const LEAST_LEFT: f64 = 0.05;
/// Cubes would make much of what lies beyond the scene.
const FARTHEST: f64 = 1.8;

/// The fields over a cloud.
pub(super) struct Bending {
    /// Each field in terms of the raw ones.
    mixes: Vec<[f64; SIMILARITIES + FIELDS]>,
}

impl Bending {
    /// Of a cloud that stands at these places.
    pub fn over(places: &[Point3<f64>], parameters: &MotionParameters) -> Bending {
        const ALL: usize = SIMILARITIES + FIELDS;
        // Inner products of the raw fields over the cloud.
        let mut products = [[0.0; ALL]; ALL];
        for place in places {
            let raw = raw_fields(place, parameters);
            for i in 0..ALL {
                for j in 0..=i {
                    products[i][j] += raw[i].dot(&raw[j]) / places.len() as f64;
                }
            }
        }
        // Only the lower triangle is filled.
        let of = |i: usize, j: usize| products[i.max(j)][i.min(j)];
        let product = |a: &[f64; ALL], b: &[f64; ALL]| -> f64 {
            (0..ALL).map(|i| a[i] * (0..ALL).map(|j| of(i, j) * b[j]).sum::<f64>()).sum()
        };
        let mut done: Vec<[f64; ALL]> = Vec::new();
        let mut mixes = Vec::new();
        for k in 0..ALL {
            let mut field = [0.0; ALL];
            field[k] = 1.0;
            let before = product(&field, &field).max(0.0).sqrt();
            // Twice, since once leaves what was rounded.
            for _ in 0..2 {
                for other in &done {
                    let share = product(&field, other);
                    field.iter_mut().zip(other).for_each(|(f, o)| *f -= share * o);
                }
            }
            let left = product(&field, &field).max(0.0).sqrt();
            if left > LEAST_LEFT * before {
                field.iter_mut().for_each(|f| *f /= left);
                done.push(field);
                if k >= SIMILARITIES {
                    mixes.push(field);
                }
            }
        }
        Bending { mixes }
    }

    /// How many fields there are.
    pub fn count(&self) -> usize {
        self.mixes.len()
    }

    /// The displacement of a place by each field.
    pub fn at(&self, place: &Point3<f64>, parameters: &MotionParameters) -> Vec<Vector3<f64>> {
        let raw = raw_fields(place, parameters);
        self.mixes.iter().map(|mix| raw.iter().zip(mix).map(|(field, share)| field * *share).sum()).collect()
    }
}

fn raw_fields(place: &Point3<f64>, parameters: &MotionParameters) -> [Vector3<f64>; SIMILARITIES + FIELDS] {
    let y = ((place - parameters.center) / parameters.radius).map(|v| v.clamp(-FARTHEST, FARTHEST));
    let (a, b, c) = (y.x, y.y, y.z);
    let mut fields = [Vector3::zeros(); SIMILARITIES + FIELDS];
    let linear = [
        Vector3::x(),
        Vector3::y(),
        Vector3::z(),
        Vector3::new(0.0, -c, b),
        Vector3::new(c, 0.0, -a),
        Vector3::new(-b, a, 0.0),
        y,
        Vector3::new(a, -b, 0.0),
        Vector3::new(b, a, 0.0),
        Vector3::new(c, 0.0, a),
        Vector3::new(0.0, c, b),
        Vector3::new(a, b, -2.0 * c),
    ];
    fields[..linear.len()].copy_from_slice(&linear);
    let powers = [a * a, a * b, b * b, a * a * a, a * a * b, a * b * b, b * b * b];
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let curved = powers.iter().flat_map(|power| axes.iter().map(move |axis| axis * *power));
    fields[linear.len()..].iter_mut().zip(curved).for_each(|(field, value)| *field = value);
    fields
}

#[cfg(test)]
mod tests;
