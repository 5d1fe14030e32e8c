//! The real common points of equations whose solutions an octic tells: three quadrics, or two bilinear equations in two angles.
//!
//! ```text
//! Question    all real solutions, each once, and whether one may be missing
//! Method      1. Every real root of the octic gives a point, up to the root's digits.
//!             2. Newton's method on the equations themselves makes it exact, or tells that the root led nowhere.
//!             3. A point that is there already is left out.
//!             4. Real solutions come in pairs, and every root has one. A root without a point of its own, or an odd number of
//!                points, shows that one is missing: two solutions share a root.
//! ```

use crate::geometry::Vector3;

use super::octic::real_roots;

/// Bezout: three quadrics meet in eight points, and the octic of two angles has eight roots.
pub const MOST_POINTS: usize = 8;

/// A unit quaternion, or the cosines and sines of two angles.
pub type Point = [f64; 4];

/// Newton steps from a root; one or two are usual, nearly double solutions take more.
const MOST_STEPS: usize = 25;

/// Square of a step after which nothing more is to be gained.
const AT_REST_SQ: f64 = 1e-17;

/// Sum of the equations' absolute values at an accepted point; the equations are orthonormal.
const MISFIT: f64 = 1e-11;

/// Points closer than this (squared) are one solution: nearly double ones cannot be told apart beyond the square root of
/// the precision.
const SAME_SQ: f64 = 1e-14;

/// Equations with finitely many solutions, each of which belongs to a root of one octic.
pub trait System {
    /// The point that belongs to the root `(x, w)`; `None` where the root does not tell.
    fn at_root(&self, root: &[f64; 2]) -> Option<Point>;
    /// Newton's correction, in as many directions as the points have freedoms.
    fn correction(&self, at: &Point) -> Vector3<f64>;
    /// The point after a correction.
    fn corrected(&self, at: &Point, correction: &Vector3<f64>) -> Option<Point>;
    /// Sum of the absolute values of the equations.
    fn misfit(&self, at: &Point) -> f64;
    /// Squared distance of two solutions.
    fn distance_sq(a: &Point, b: &Point) -> f64;
    /// Whether the start was that solution up to the root's digits.
    fn is_near(start: &Point, solution: &Point) -> bool;
}

/// Distinct points, and whether every root led to one of its own.
#[derive(Clone, Copy, Debug)]
pub struct CommonPoints {
    points: [Point; MOST_POINTS],
    len: usize,
    every_root_has_one: bool,
}

impl std::ops::Deref for CommonPoints {
    type Target = [Point];

    fn deref(&self) -> &[Point] {
        &self.points[..self.len]
    }
}

impl CommonPoints {
    #[inline]
    pub fn none() -> CommonPoints {
        CommonPoints { points: [[0.0; 4]; MOST_POINTS], len: 0, every_root_has_one: false }
    }

    /// Whether no solution is missing, as far as the octic that was added last can tell.
    #[inline]
    pub fn is_complete(&self) -> bool {
        self.every_root_has_one && self.len.is_multiple_of(2)
    }

    /// What was found last may lack a solution.
    pub fn doubt(&mut self) {
        self.every_root_has_one = false;
    }

    /// Adds the solutions that the roots of an octic lead to.
    #[inline]
    pub fn add(&mut self, system: &impl System, octic: &[f64; 9]) {
        self.every_root_has_one = true;
        for root in real_roots(octic).iter() {
            self.every_root_has_one &= self.add_root(system, root);
        }
    }

    /// Whether the root led to a new point.
    #[inline]
    fn add_root<S: System>(&mut self, system: &S, root: &[f64; 2]) -> bool {
        let Some(start) = system.at_root(root) else { return false };
        let Some(point) = newton(system, start) else { return false };
        self.keep::<S>(point) && S::is_near(&start, &point)
    }

    #[inline]
    fn keep<S: System>(&mut self, point: Point) -> bool {
        let new = self.len < MOST_POINTS && !self.iter().any(|other| S::distance_sq(other, &point) < SAME_SQ);
        if new {
            self.points[self.len] = point;
            self.len += 1;
        }
        new
    }
}

/// Newton's method from a start; `None` where it does not end on a solution.
#[inline]
fn newton(system: &impl System, start: Point) -> Option<Point> {
    let mut at = start;
    for _ in 0..MOST_STEPS {
        let correction = system.correction(&at);
        let size_sq = correction.norm_squared();
        // Also false for NaN.
        if !(size_sq < 1.0) {
            // On the spot already (a double point, exactly met), or gone astray.
            break;
        }
        at = system.corrected(&at, &correction)?;
        if size_sq < AT_REST_SQ {
            return Some(at);
        }
    }
    (system.misfit(&at) < MISFIT).then_some(at)
}
