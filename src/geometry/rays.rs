//! What a straight line of sight meets first.

use std::ops::ControlFlow;

use bvh::aabb::{Aabb, Bounded, IntersectsAabb};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::{Bvh, BvhNode};
use nalgebra::{Point3, Vector3};

/// Triangles in a tree of boxes.
pub struct RayCaster {
    shapes: Vec<Shape>,
    tree: Bvh<f64, 3>,
}

/// Where a line of sight ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    pub distance: f64,
    /// Index of the triangle in the order in which they were given.
    pub triangle: u32,
}

struct Shape {
    corner: Point3<f64>,
    edges: [Vector3<f64>; 2],
    triangle: u32,
    node: usize,
}

impl RayCaster {
    pub fn new(triangles: impl Iterator<Item = [Point3<f64>; 3]>) -> RayCaster {
        let shape = |(i, [a, b, c]): (usize, [Point3<f64>; 3])| Shape {
            corner: a,
            edges: [b - a, c - a],
            triangle: i as u32,
            node: 0,
        };
        let mut shapes: Vec<Shape> = triangles.enumerate().map(shape).collect();
        let tree = Bvh::build_par(&mut shapes);
        RayCaster { shapes, tree }
    }

    /// The first triangle between `from` (exclusive) and `from + direction * reach`; `direction` has unit length. Of equally
    /// distant triangles the one with the lowest index.
    pub fn first_hit(&self, from: &Point3<f64>, direction: &Vector3<f64>, reach: f64) -> Option<Sight> {
        self.first_hit_of(|_| true, from, direction, reach)
    }

    /// The same among the triangles that `counts` accepts.
    pub fn first_hit_of(
        &self,
        counts: impl Fn(u32) -> bool,
        from: &Point3<f64>,
        direction: &Vector3<f64>,
        reach: f64,
    ) -> Option<Sight> {
        // The tree cannot be walked without any triangle.
        if self.shapes.is_empty() {
            return None;
        }
        let mut search = First { caster: self, counts, line: Line::new(from, direction, reach), direction, best: None };
        search.visit(0);
        search.best
    }

    /// Shows `see` the triangles beyond `near` on the ray without end, in no order that means anything: one call for each
    /// whose box the ray meets, with `None` where it passes the triangle by, until `see` has seen enough and breaks.
    pub fn hits(
        &self,
        from: &Point3<f64>,
        direction: &Vector3<f64>,
        near: f64,
        see: impl FnMut(Option<Sight>) -> ControlFlow<()>,
    ) {
        // The tree cannot be walked without any triangle.
        if self.shapes.is_empty() {
            return;
        }
        let line = Line::new(from, direction, f64::INFINITY);
        let sight = |shape: &Shape| {
            let distance = shape.meets(from, direction).filter(|&distance| distance > near)?;
            Some(Sight { distance, triangle: shape.triangle })
        };
        let _ = self.tree.traverse_iterator(&line, &self.shapes).map(sight).try_for_each(see);
    }
}

impl Shape {
    /// Distance along the ray to the triangle (Möller and Trumbore 1997); the surface itself at distance 0 does not count.
    fn meets(&self, from: &Point3<f64>, direction: &Vector3<f64>) -> Option<f64> {
        let [e1, e2] = &self.edges;
        let p = direction.cross(e2);
        let det = e1.dot(&p);
        if det == 0.0 {
            return None;
        }
        let to = from - self.corner;
        let u = to.dot(&p) / det;
        let q = to.cross(e1);
        let v = direction.dot(&q) / det;
        let distance = e2.dot(&q) / det;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
    }
}

/// A walk through the tree to the first hit, the nearer boxes first.
struct First<'a, F> {
    caster: &'a RayCaster,
    counts: F,
    /// Ends where the best is.
    line: Line,
    direction: &'a Vector3<f64>,
    best: Option<Sight>,
}

/// A box of an equally distant triangle may begin this share of the distance farther, by rounding.
const BOX_ROUNDING: f64 = 1e-9;

impl<F: Fn(u32) -> bool> First<'_, F> {
    fn visit(&mut self, node: usize) {
        match &self.caster.tree.nodes[node] {
            BvhNode::Leaf { shape_index, .. } => self.look_at(&self.caster.shapes[*shape_index]),
            BvhNode::Node { child_l_index, child_l_aabb, child_r_index, child_r_aabb, .. } => {
                let left = self.line.enters(child_l_aabb).map(|at| (at, *child_l_index));
                let right = self.line.enters(child_r_aabb).map(|at| (at, *child_r_index));
                let (first, second) = match (left, right) {
                    (Some(l), Some(r)) if r.0 < l.0 => (right, left),
                    (None, _) => (right, None),
                    _ => (left, right),
                };
                for (at, child) in [first, second].into_iter().flatten() {
                    if at <= self.line.reach {
                        self.visit(child);
                    }
                }
            }
        }
    }

    fn look_at(&mut self, shape: &Shape) {
        let Some(distance) = shape.meets(&self.line.from, self.direction) else { return };
        let nearer = match &self.best {
            None => distance <= self.line.reach,
            Some(best) => (distance, shape.triangle) < (best.distance, best.triangle),
        };
        if nearer && (self.counts)(shape.triangle) {
            self.best = Some(Sight { distance, triangle: shape.triangle });
            self.line.reach = self.line.reach.min(distance * (1.0 + BOX_ROUNDING));
        }
    }
}

/// A ray that ends.
struct Line {
    from: Point3<f64>,
    inverse: Vector3<f64>,
    reach: f64,
}

impl Line {
    fn new(from: &Point3<f64>, direction: &Vector3<f64>, reach: f64) -> Line {
        Line { from: *from, inverse: direction.map(f64::recip), reach }
    }

    /// How far along the line a box begins.
    #[inline]
    fn enters(&self, aabb: &Aabb<f64, 3>) -> Option<f64> {
        let (mut enter, mut leave) = (0.0f64, self.reach);
        for k in 0..3 {
            let a = (aabb.min[k] - self.from[k]) * self.inverse[k];
            let b = (aabb.max[k] - self.from[k]) * self.inverse[k];
            // A ray inside a flat box gives 0 * infinity: `min` and `max` pass over the NaN, which counts as a meeting.
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter <= leave).then_some(enter)
    }
}

impl IntersectsAabb<f64, 3> for Line {
    fn intersects_aabb(&self, aabb: &Aabb<f64, 3>) -> bool {
        self.enters(aabb).is_some()
    }
}

impl Bounded<f64, 3> for Shape {
    fn aabb(&self) -> Aabb<f64, 3> {
        let (a, b, c) = (self.corner, self.corner + self.edges[0], self.corner + self.edges[1]);
        Aabb::with_bounds(a.inf(&b).inf(&c), a.sup(&b).sup(&c))
    }
}

impl BHShape<f64, 3> for Shape {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

#[cfg(test)]
mod tests;
