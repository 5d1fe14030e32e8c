//! Houses with other planes: what a model makes of a house, or a builder of a model.

use nalgebra::Matrix3;

use super::house::{Face, House, Surface};
use crate::geometry::{Point3, Vector3};

/// Corners nearer than this are one corner, metres: rounding, not geometry.
const SAME_CORNER_M: f64 = 1e-6;

/// Planes that meet more obliquely than this share of their steepest crossing fix nothing: three walls of a corner whose floor is
/// missing leave its height.
const HELD_SHARE: f64 = 1e-6;

impl House {
    /// Each face's plane moved outwards by its own length, metres, in the order of the faces. Corners follow by the shortest
    /// way that puts them onto all their planes, so that faces stay flat and the shell closed.
    pub fn with_planes_moved(&self, out_m: &[f64]) -> House {
        let moved = |corner: &Point3<f64>| {
            // Least squares of n . d = out over the faces that meet here; d is the shortest where they leave it free.
            let (mut normal_matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
            for (face, out) in self.faces.iter().zip(out_m) {
                if face.corners.iter().any(|c| (c - corner).norm() < SAME_CORNER_M) {
                    let n = face.normal();
                    normal_matrix += n * n.transpose();
                    right += n * *out;
                }
            }
            let inverse = normal_matrix.pseudo_inverse(HELD_SHARE).unwrap_or_else(|_| Matrix3::zeros());
            corner + inverse * right
        };
        let face = |face: &Face| Face { corners: face.corners.iter().map(moved).collect(), ..face.clone() };
        House { faces: self.faces.iter().map(face).collect() }
    }

    /// The walls that `is_free` names so far inside the edge of the roof, which stays: a house whose model was drawn from the air.
    pub fn under_eaves(&self, inset_m: f64, is_free: impl Fn(&Face) -> bool) -> House {
        let inset = |face: &Face| if face.surface == Surface::Wall && is_free(face) { -inset_m } else { 0.0 };
        let mut house = self.with_planes_moved(&self.faces.iter().map(inset).collect::<Vec<f64>>());
        for (face, drawn) in house.faces.iter_mut().zip(&self.faces) {
            if drawn.surface == Surface::Roof {
                face.clone_from(drawn);
            }
        }
        house
    }

    /// The block model (LoD1): the same footprint under a flat lid half-way up the largest roof.
    pub fn as_lid(&self) -> House {
        let roofs = self.faces.iter().filter(|face| face.surface == Surface::Roof);
        let Some(roof) = roofs.max_by(|a, b| a.area().total_cmp(&b.area())) else { return self.clone() };
        let heights = || roof.corners.iter().map(|corner| corner.z);
        let top = 0.5 * (heights().fold(f64::INFINITY, f64::min) + heights().fold(f64::NEG_INFINITY, f64::max));
        let foot = self.foot();
        let at_top = |corner: &Point3<f64>| Point3::new(corner.x, corner.y, top);
        let next = |i: usize| &foot[(i + 1) % foot.len()];
        let wall = |i: usize| Face {
            surface: Surface::Wall,
            corners: vec![foot[i], *next(i), at_top(next(i)), at_top(&foot[i])],
        };
        let lid = Face { surface: Surface::Roof, corners: foot.iter().map(at_top).collect() };
        House { faces: (0..foot.len()).map(wall).chain([lid]).collect() }
    }

    /// The corners at the foot of the walls, counter-clockwise from above, beginning with the first wall's.
    fn foot(&self) -> Vec<Point3<f64>> {
        let low = self.faces.iter().flat_map(|f| &f.corners).map(|c| c.z).fold(f64::INFINITY, f64::min);
        let is_low = |corner: &Point3<f64>| corner.z - low < SAME_CORNER_M;
        let edges: Vec<[Point3<f64>; 2]> = self
            .faces
            .iter()
            .flat_map(|face| {
                (0..face.corners.len()).map(|i| [face.corners[i], face.corners[(i + 1) % face.corners.len()]])
            })
            .filter(|[a, b]| is_low(a) && is_low(b))
            .collect();
        let mut foot: Vec<Point3<f64>> = edges.first().map(|[a, _]| *a).into_iter().collect();
        while foot.len() < edges.len() {
            let last = foot[foot.len() - 1];
            let Some([_, b]) = edges.iter().find(|[a, _]| (a - last).norm() < SAME_CORNER_M) else { break };
            foot.push(*b);
        }
        foot
    }

    /// Scaled along up about its foot.
    pub fn stretched_up(mut self, factor: f64) -> House {
        let low = self.faces.iter().flat_map(|f| &f.corners).map(|c| c.z).fold(f64::INFINITY, f64::min);
        self.faces.iter_mut().flat_map(|f| &mut f.corners).for_each(|c| c.z = low + factor * (c.z - low));
        self
    }

    /// The middle of its foot.
    pub fn middle(&self) -> Point3<f64> {
        let foot = self.foot();
        let sum: Vector3<f64> = foot.iter().map(|c| c.coords).sum();
        Point3::from(sum / foot.len().max(1) as f64)
    }

    /// Turned about the vertical through its middle and moved.
    pub fn shifted(self, shift_m: Vector3<f64>, turn_rad: f64) -> House {
        let middle = self.middle().coords;
        self.at((-middle).into()).turned(turn_rad).at((middle + shift_m).into())
    }
}

impl Face {
    /// Cut in two along a line across it. Both parts can be seen from their first corners.
    pub fn halves(&self) -> [Face; 2] {
        let c = &self.corners;
        let middle = |i: usize, j: usize| nalgebra::center(&c[i], &c[j]);
        let [a, b] = match c.len() {
            3 => [vec![c[0], c[1], middle(1, 2)], vec![c[0], middle(1, 2), c[2]]],
            4 => {
                let (low, high) = (middle(0, 1), middle(2, 3));
                [vec![c[0], low, high, c[3]], vec![low, c[1], c[2], high]]
            }
            // The fan's own corner sees all others.
            n => [c[..=n / 2].to_vec(), [&c[..1], &c[n / 2..]].concat()],
        };
        [a, b].map(|corners| Face { surface: self.surface, corners })
    }
}

#[cfg(test)]
mod tests;
