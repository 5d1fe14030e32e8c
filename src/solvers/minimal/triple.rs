//! Three points on one plane: what they say of the pose, and what of it they leave open.
//!
//! The triple spans a plane of the sensor with unit normal m, and R m = sigma n1, sigma = +-1: the rotation turns about a known axis
//! (turn.rs). The first plane gives the height of X, the image of p_1, over itself: n1 . X = -d1. With X = (u, w, -d1) in the
//! plane's axes each further row reads, y taken from p_1,
//!
//! ```text
//! v_x u + v_y w + delta + s (v . R y) = 0,   delta = d - v_z d1.
//! ```

use crate::geometry::{Axes, Vector3};
use crate::solvers::algebra::tolerance::RANK_TOLERANCE;
use crate::solvers::elimination::Eliminated;
use crate::solvers::poses::Poses;
use crate::solvers::row::Row;
use crate::solvers::turn::{KnownAxis, Sense, Turn, line_with};

/// Columns of a row: the unknowns w and u, the offset delta, then the parts of v . R y.
pub type Columns = [f64; 8];

/// The plane with three points: its normal in either frame.
pub struct Triple {
    axis: KnownAxis,
    pivot: Vector3<f64>,
    /// Offset of the first plane.
    height: f64,
}

impl Triple {
    /// Axes of the first three rows' plane; `None` for collinear points.
    #[inline]
    pub fn new(rows: &[Row]) -> Option<Triple> {
        Triple::with_object_axes(rows, Axes::about(&rows[0].normal))
    }

    /// The object's first axis lies along `towards` as seen on the plane: rows with that normal have no w. `None` also where
    /// `towards` is across the plane.
    #[inline]
    pub fn towards(rows: &[Row], towards: &Vector3<f64>) -> Option<Triple> {
        let n = rows[0].normal;
        let across = n.cross(towards);
        let length = across.norm();
        if !(length > RANK_TOLERANCE) {
            return None;
        }
        let y = across / length;
        Triple::with_object_axes(rows, Axes { x: y.cross(&n), y, z: n })
    }

    #[inline]
    fn with_object_axes(rows: &[Row], object: Axes) -> Option<Triple> {
        let pivot = rows[0].point;
        let (first, second) = (rows[1].point - pivot, rows[2].point - pivot);
        let m = first.cross(&second);
        let (length, area) = (first.norm(), m.norm());
        // Also false for NaN.
        if !(area > RANK_TOLERANCE * length * second.norm()) {
            return None;
        }
        let (z, x) = (m / area, first / length);
        let sensor = Axes { x, y: z.cross(&x), z };
        Some(Triple { axis: KnownAxis { sensor, object }, pivot, height: rows[0].offset })
    }

    #[inline]
    pub fn columns(&self, row: &Row) -> Columns {
        let v = self.axis.object.coordinates(&row.normal);
        let delta = row.offset - v[2] * self.height;
        let [a, b, c, d, e] = self.axis.parts(&v, &self.axis.sensor.coordinates(&(row.point - self.pivot)));
        [v[1], v[0], delta, a, b, c, d, e]
    }

    /// The difference of two rows of one plane: neither translation nor offset is left.
    #[inline]
    pub fn difference(&self, from: &Row, to: &Row) -> Columns {
        let v = self.axis.object.coordinates(&from.normal);
        let [a, b, c, d, e] = self.axis.parts(&v, &self.axis.sensor.coordinates(&(to.point - from.point)));
        [0.0, 0.0, 0.0, a, b, c, d, e]
    }

    /// All poses whose rotation satisfies one equation; `size_sq` as for the circle.
    #[inline(always)]
    pub fn poses<const M: usize>(&self, rows: &Eliminated<2, M, 8>, equation: &Columns, size_sq: f64) -> Poses {
        let mut poses = Poses::none();
        for sense in Sense::BOTH {
            for turn in Turn::on(line_with(&equation[3..], equation[2], sense), sense, size_sq) {
                self.push(&mut poses, rows, &turn);
            }
        }
        poses
    }

    /// Adds the pose at a rotation, unless it is a mirror image.
    #[inline(always)]
    pub fn push<const M: usize>(&self, poses: &mut Poses, rows: &Eliminated<2, M, 8>, turn: &Turn) {
        if let Some((scale, [w, u])) = rows.scale_and_translation(|row| turn.along(&row[3..])) {
            let image = self.axis.object.vector(u, w, -self.height);
            poses.push_about(&self.pivot, &image, scale, self.axis.rotation(turn));
        }
    }
}
