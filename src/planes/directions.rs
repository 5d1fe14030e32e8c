//! Directions in classes, so that what faces another way is passed over without being looked at.
//!
//! Method       the sphere is projected onto the six sides of a cube, and each side divided evenly by angle; a direction that is asked for
//!              falls into one of a finer division, for which a table tells the classes that hold directions as near as asked
//! Why          nine in ten facets near a place face another way than the point that asks

use super::hit::OrientedPoint;
use crate::geometry::Vector3;

/// Classes to a side of the cube: three by three, so that all of them are bits of a word.
const COARSE: usize = 3;
const CLASSES: usize = 6 * COARSE * COARSE;
/// Of the finer division.
const FINE: usize = 10;

/// Sets of classes by direction, for one angle.
pub(super) struct Directions {
    /// Cosine of the angle that the sets are made for.
    min_cos: f64,
    near: Box<[u64; 6 * FINE * FINE]>,
}

impl Directions {
    /// For directions within an angle of each other.
    pub fn within(angle_rad: f64) -> Directions {
        let classes: Vec<Cone> = (0..CLASSES).map(Cone::of::<COARSE>).collect();
        let set = |at: usize| {
            let asked = Cone::of::<FINE>(at);
            let is_near =
                |class: &Cone| asked.axis.angle(&class.axis) <= angle_rad + asked.radius_rad + class.radius_rad;
            (0..).zip(&classes).filter(|(_, class)| is_near(class)).fold(0u64, |set, (bit, _)| set | 1 << bit)
        };
        Directions { min_cos: angle_rad.cos(), near: Box::new(std::array::from_fn(set)) }
    }

    /// The class of a direction, below 64.
    pub fn class(direction: &Vector3<f64>) -> u32 {
        place::<COARSE>(&direction.map(|x| x as f32)) as u32
    }

    /// What facets that a point may lie on by its direction have in common: normals that agree with its own, or with the opposite where
    /// its side is not known.
    #[inline]
    pub fn facing(&self, point: &OrientedPoint) -> Facing {
        let OrientedPoint { min_cos, sided, .. } = *point;
        let normal = point.normal.map(|x| x as f32);
        let mut classes = u64::MAX;
        if min_cos >= self.min_cos {
            classes = self.near[place::<FINE>(&normal)];
            if !sided {
                classes |= self.near[place::<FINE>(&-normal)];
            }
        }
        Facing { normal, least_cos: min_cos as f32 - MARGIN_OF_COS, classes }
    }
}

/// Directions that agree with one.
#[derive(Clone, Copy)]
pub struct Facing {
    pub(super) normal: Vector3<f32>,
    /// Less than any of their cosines to it in single precision.
    pub(super) least_cos: f32,
    /// The classes that hold them, as bits: all where the sets are not made for so wide an angle.
    pub(super) classes: u64,
}

/// What single precision may be off in the cosine between two directions.
const MARGIN_OF_COS: f32 = 1e-6;

/// What a cell of a division holds.
struct Cone {
    axis: Vector3<f64>,
    radius_rad: f64,
}

/// Directions are put into cells by an angle that is good to 0.004.
const SLACK_RAD: f64 = 6e-3;

impl Cone {
    fn of<const N: usize>(cell: usize) -> Cone {
        let (side, row, column) = (cell / (N * N), cell / N % N, cell % N);
        let (axis, sign) = (side / 2, if side.is_multiple_of(2) { 1.0 } else { -1.0 });
        let at = |u: f64, v: f64| {
            let tangent = |x: f64| (std::f64::consts::FRAC_PI_2 * (x / N as f64 - 0.5)).tan();
            let mut direction = Vector3::zeros();
            direction[axis] = sign;
            direction[(axis + 1) % 3] = tangent(column as f64 + u);
            direction[(axis + 2) % 3] = tangent(row as f64 + v);
            direction.normalize()
        };
        let axis = at(0.5, 0.5);
        // The corners are farthest, since edges of the division are great circles.
        let corners = [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 0.0), at(1.0, 1.0)];
        Cone { axis, radius_rad: corners.iter().map(|c| c.angle(&axis)).fold(0.0, f64::max) + SLACK_RAD }
    }
}

/// The cell of a direction (any length but zero) in a division of N by N a side.
#[inline]
fn place<const N: usize>(d: &Vector3<f32>) -> usize {
    let size = d.map(f32::abs);
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let (along, u, v) = (d[axis], d[(axis + 1) % 3], d[(axis + 2) % 3]);
    let side = 2 * axis + usize::from(along < 0.0);
    let index = |x: f32| ((0.5 + angle_of(x / along.abs())) * N as f32) as usize;
    (side * N + index(v).min(N - 1)) * N + index(u).min(N - 1)
}

/// The angle of a tangent between -1 and 1, in right angles, to 2e-3 of one.
#[inline]
fn angle_of(tangent: f32) -> f32 {
    // Rajan et al. 2006: atan(x) = pi/4 x + 0.273 x (1 - |x|), to 0.0038 radians.
    const RIGHT_ANGLES: f32 = std::f32::consts::FRAC_2_PI;
    tangent * (0.5 + 0.273 * RIGHT_ANGLES * (1.0 - tangent.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;
    use crate::robust::Random;

    fn looking(normal: &Vector3<f64>, min_cos: f64, sided: bool) -> OrientedPoint {
        OrientedPoint { position: Point3::origin(), normal: *normal, sided, min_cos }
    }

    fn any(random: &mut Random) -> Vector3<f64> {
        loop {
            let v = Vector3::from_fn(|_, _| 2.0 * random.unit() - 1.0);
            if v.norm() > 0.1 && v.norm() < 1.0 {
                return v.normalize();
            }
        }
    }

    #[test]
    fn what_is_as_near_as_asked_is_never_left_out_and_most_of_the_rest_is() {
        let angle_rad = 25f64.to_radians();
        let directions = Directions::within(angle_rad);
        let mut random = Random::stream(1, 0);
        let (mut taken, mut near) = (0, 0);
        for _ in 0..20_000 {
            let (a, b) = (any(&mut random), any(&mut random));
            let is_taken = |sided| {
                directions.facing(&looking(&a, angle_rad.cos(), sided)).classes >> Directions::class(&b) & 1 == 1
            };
            assert!(is_taken(false) || a.dot(&b).abs() < angle_rad.cos(), "{a} {b}");
            let is_taken = is_taken(true);
            assert!(is_taken || a.dot(&b) < angle_rad.cos(), "{a} {b}");
            taken += usize::from(is_taken);
            near += usize::from(a.dot(&b) >= angle_rad.cos());
        }
        assert!(near > 800 && taken < 5 * near, "{taken} taken, {near} near");
    }

    #[test]
    fn for_a_wider_angle_than_it_was_made_for_everything_is_near() {
        let directions = Directions::within(0.4);
        assert_eq!(directions.facing(&looking(&Vector3::x(), 0.5, true)).classes, u64::MAX);
        assert_ne!(directions.facing(&looking(&Vector3::x(), 0.95, true)).classes, u64::MAX);
    }

    #[test]
    fn a_direction_that_is_none_does_no_harm() {
        for d in [Vector3::zeros(), Vector3::repeat(f64::NAN), Vector3::new(f64::INFINITY, 0.0, f64::NAN)] {
            assert!(Directions::class(&d) < 64);
        }
    }
}
