//! A convex outline to triangles without a mesh: a fan from one of its corners. Most outlines of a city that are no quadrilaterals are
//! gables and roofs of five or six corners, for which a constrained triangulation was a third of the time of reading.

use super::doubled_area;

/// Corners up to which fans from all of them are compared.
const FAN_CORNERS: usize = 16;

/// Triangles of a convex outline that runs counter-clockwise, as indices into its corners: the fan of which the smallest triangle is
/// largest. `None` for any other, and for many corners. A corner may lie `rounding` within the line from its neighbour to its other
/// neighbour, as digits put corners in the middle of an edge.
pub(in crate::city) fn convex_fan(corners: &[[f64; 2]], rounding: f64) -> Option<impl Iterator<Item = [usize; 3]>> {
    let count = corners.len();
    if !(3..=FAN_CORNERS).contains(&count) || !(0..count).all(|at| is_convex_at(corners, at, rounding)) {
        return None;
    }
    let smallest = (0..count).map(|apex| smallest_of_fan(corners, apex));
    let (apex, least) =
        smallest.enumerate().fold((0, 0.0), |best, (at, least)| if least > best.1 { (at, least) } else { best });
    (least > 0.0).then(|| (1..count - 1).map(move |at| [apex, (apex + at) % count, (apex + at + 1) % count]))
}

fn is_convex_at(corners: &[[f64; 2]], at: usize, rounding: f64) -> bool {
    let count = corners.len();
    let (before, after) = (corners[(at + count - 1) % count], corners[(at + 1) % count]);
    let across = (after[0] - before[0]).hypot(after[1] - before[1]);
    doubled_area(before, corners[at], after) >= -rounding * across
}

/// Twice the area of the smallest triangle of a fan; nothing above zero where triangles would overlap. With all of them above zero and no corner to
/// the right of the fan's first edge, the directions from its apex turn one way, by half a turn at most: the outline is simple.
fn smallest_of_fan(corners: &[[f64; 2]], apex: usize) -> f64 {
    let count = corners.len();
    let corner = |at: usize| corners[(apex + at) % count];
    let triangles = (1..count - 1).map(|at| doubled_area(corner(0), corner(at), corner(at + 1)));
    let is_left = (2..count).all(|at| doubled_area(corner(0), corner(1), corner(at)) >= 0.0);
    if is_left { triangles.fold(f64::INFINITY, f64::min) } else { 0.0 }
}
