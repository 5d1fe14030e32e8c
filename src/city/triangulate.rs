//! A ring of points in its plane to triangles, even-odd, without new points unless the ring crosses itself.

use spade::handles::FixedUndirectedEdgeHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation, mitigate_underflow};

/// Rings that cross themselves are searched edge against edge; longer ones would take too long.
const CROSSING_SEARCH_LIMIT: usize = 2000;

/// Crossings for each corner beyond which a ring is no polygon that somebody drew.
const CROSSINGS_PER_CORNER: usize = 2;

/// The area of the triangles may differ from the ring's own by this share before the ring is taken to overlap itself.
const AREA_SHARE: f64 = 1e-6;

/// Triangles of a ring, as indices into the ring, or past its end into `crossings`.
pub(super) struct Triangles {
    /// Counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    /// Points where the ring's edges cross; none in a clean ring.
    pub crossings: Vec<[f64; 2]>,
    /// Whether the ring crosses or overlaps itself.
    pub overlaps: bool,
}

/// Triangulates a ring that runs counter-clockwise by its signed area. `None` where it is too tangled.
///
/// Edges that are walked twice (the bridge to a hole) bound nothing, so holes stay holes.
pub(super) fn triangulate(ring: &[[f64; 2]]) -> Option<Triangles> {
    let edges: Vec<[usize; 2]> = (0..ring.len()).map(|at| [at, (at + 1) % ring.len()]).collect();
    if let Some(triangles) = constrained(ring, &edges) {
        let overlaps = differs(ring, &triangles);
        return Some(Triangles { triangles, crossings: Vec::new(), overlaps });
    }
    let (points, edges) = cut_at_crossings(ring)?;
    let triangles = constrained(&points, &edges)?;
    Some(Triangles { triangles, crossings: points[ring.len()..].to_vec(), overlaps: true })
}

/// Twice the signed area, positive when counter-clockwise.
fn doubled_area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Delaunay triangulation held by the edges, then the triangles that lie an odd number of edges inside.
/// `None` where two edges cross between points.
fn constrained(points: &[[f64; 2]], edges: &[[usize; 2]]) -> Option<Vec<[usize; 3]>> {
    let mut mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(points.len());
    let mut point_of = Vec::with_capacity(points.len());
    for (at, point) in points.iter().enumerate() {
        let handle = mesh.insert(mitigate_underflow(Point2::new(point[0], point[1]))).ok()?;
        if handle.index() == point_of.len() {
            point_of.push(at);
        }
        handles.push(handle);
    }
    let mut walked = Vec::with_capacity(edges.len());
    for &[from, to] in edges {
        if handles[from] == handles[to] {
            continue;
        }
        // An edge through other points becomes several; none at all means that it would cross an earlier edge.
        let parts = mesh.try_add_constraint(handles[from], handles[to]);
        if parts.is_empty() {
            return None;
        }
        walked.extend(parts.into_iter().map(|part| part.as_undirected()));
    }
    let inside = faces_inside(&mesh, &walked);
    let corners = mesh.inner_faces().filter(|face| inside[face.fix().index()]);
    Some(corners.map(|face| face.vertices().map(|vertex| point_of[vertex.fix().index()])).collect())
}

/// Floods from outside; every edge that was walked an odd number of times changes sides.
fn faces_inside(
    mesh: &ConstrainedDelaunayTriangulation<Point2<f64>>,
    walked: &[FixedUndirectedEdgeHandle],
) -> Vec<bool> {
    let mut is_border = vec![false; mesh.num_undirected_edges()];
    for edge in walked {
        is_border[edge.index()] ^= true;
    }
    let mut side: Vec<Option<bool>> = vec![None; mesh.num_all_faces()];
    let mut open = Vec::with_capacity(mesh.num_all_faces());
    side[mesh.outer_face().fix().index()] = Some(false);
    // The outer face has no list of edges; every edge of the hull leads out of it.
    for edge in mesh.convex_hull() {
        let inner = edge.rev().face().fix();
        let (inner, border) = if inner == mesh.outer_face().fix() { (edge.face().fix(), edge) } else { (inner, edge) };
        if side[inner.index()].is_none() {
            side[inner.index()] = Some(is_border[border.as_undirected().fix().index()]);
            open.push(inner);
        }
    }
    while let Some(face) = open.pop() {
        let here = side[face.index()].unwrap_or(false);
        let Some(face) = mesh.face(face).as_inner() else { continue };
        for edge in face.adjacent_edges() {
            let next = edge.rev().face().fix();
            if side[next.index()].is_none() {
                side[next.index()] = Some(here ^ is_border[edge.as_undirected().fix().index()]);
                open.push(next);
            }
        }
    }
    side.into_iter().map(|side| side == Some(true)).collect()
}

/// Whether the triangles cover another area than the ring winds round.
fn differs(ring: &[[f64; 2]], triangles: &[[usize; 3]]) -> bool {
    let covered: f64 = triangles.iter().map(|&[a, b, c]| doubled_area(ring[a], ring[b], ring[c]).abs()).sum();
    let wound: f64 = (1..ring.len() - 1).map(|at| doubled_area(ring[0], ring[at], ring[at + 1])).sum();
    (covered - wound).abs() > AREA_SHARE * wound.abs()
}

type PointsAndEdges = (Vec<[f64; 2]>, Vec<[usize; 2]>);

/// The ring with a point put in wherever two of its edges cross. `None` for rings that are too long, or too tangled.
fn cut_at_crossings(ring: &[[f64; 2]]) -> Option<PointsAndEdges> {
    let count = ring.len();
    if count > CROSSING_SEARCH_LIMIT {
        return None;
    }
    let mut points = ring.to_vec();
    let mut cuts: Vec<Vec<(f64, usize)>> = vec![Vec::new(); count];
    for first in 0..count {
        for second in first + 1..count {
            let ends = [ring[first], ring[(first + 1) % count], ring[second], ring[(second + 1) % count]];
            if let Some((along_first, along_second, point)) = crossing(ends) {
                cuts[first].push((along_first, points.len()));
                cuts[second].push((along_second, points.len()));
                points.push(point);
            }
        }
        if points.len() > count * (1 + CROSSINGS_PER_CORNER) {
            return None;
        }
    }
    let mut edges = Vec::with_capacity(count + 2 * (points.len() - count));
    for (at, cuts) in cuts.iter_mut().enumerate() {
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let stops = cuts.iter().map(|cut| cut.1).chain([(at + 1) % count]);
        let mut from = at;
        for to in stops {
            edges.push([from, to]);
            from = to;
        }
    }
    Some((points, edges))
}

/// Where the inner parts of two edges cross, with the shares of the way along each.
fn crossing([a, b, c, d]: [[f64; 2]; 4]) -> Option<(f64, f64, [f64; 2])> {
    let (c_side, d_side) = (doubled_area(a, b, c), doubled_area(a, b, d));
    let (a_side, b_side) = (doubled_area(c, d, a), doubled_area(c, d, b));
    if c_side * d_side >= 0.0 || a_side * b_side >= 0.0 {
        return None;
    }
    let along_first = a_side / (a_side - b_side);
    let along_second = c_side / (c_side - d_side);
    let point = [a[0] + along_first * (b[0] - a[0]), a[1] + along_first * (b[1] - a[1])];
    Some((along_first, along_second, point))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Area of the triangles; all run counter-clockwise.
    fn area(ring: &[[f64; 2]]) -> Option<f64> {
        let made = triangulate(ring)?;
        let points = [ring, &made.crossings].concat();
        let areas = made.triangles.iter().map(|&[a, b, c]| doubled_area(points[a], points[b], points[c]) / 2.0);
        assert!(areas.clone().all(|area| area >= 0.0));
        Some(areas.sum())
    }

    fn overlaps(ring: &[[f64; 2]]) -> bool {
        triangulate(ring).unwrap().overlaps
    }

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];

    #[test]
    fn concave_rings_keep_their_area() {
        let l = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        assert_eq!(area(&l), Some(6.0));
        assert_eq!(triangulate(&l).unwrap().triangles.len(), 4);
        assert!(!overlaps(&l));
    }

    #[test]
    fn a_star_of_many_corners_keeps_its_area() {
        let star: Vec<[f64; 2]> = (0..2000)
            .map(|at| {
                let (sin, cos) = (f64::from(at) * std::f64::consts::TAU / 2000.0).sin_cos();
                let radius = if at % 2 == 0 { 10.0 } else { 4.0 };
                [radius * cos, radius * sin]
            })
            .collect();
        let expected = 1000.0 * 10.0 * 4.0 * (std::f64::consts::TAU / 2000.0).sin();
        assert!((area(&star).unwrap() - expected).abs() < 1e-9 * expected);
        assert_eq!(triangulate(&star).unwrap().triangles.len(), 1998);
    }

    #[test]
    fn a_bridged_hole_stays_a_hole() {
        let hole = [[2.0, 2.0], [2.0, 4.0], [4.0, 4.0], [4.0, 2.0], [2.0, 2.0]];
        let ring = [&SQUARE[..], &SQUARE[..1], &hole].concat();
        assert_eq!(area(&ring), Some(96.0));
        assert!(!overlaps(&ring));
    }

    #[test]
    fn a_hole_that_shares_part_of_an_edge_stays_a_hole() {
        let hole = [[4.0, 0.0], [4.0, 2.0], [7.0, 2.0], [7.0, 0.0], [4.0, 0.0]];
        let ring = [&SQUARE[..1], &hole, &SQUARE[1..]].concat();
        assert_eq!(area(&ring), Some(94.0));
    }

    #[test]
    fn a_spike_covers_nothing() {
        let ring = [&SQUARE[..2], &[[15.0, 0.0]], &SQUARE[1..]].concat();
        assert_eq!(area(&ring), Some(100.0));
        assert!(!overlaps(&ring));
    }

    #[test]
    fn corners_on_an_edge_and_repeated_places_change_nothing() {
        let ring = [&SQUARE[..1], &[[3.0, 0.0], [6.0, 0.0], [6.0, 0.0]], &SQUARE[1..], &SQUARE[..1]].concat();
        assert_eq!(area(&ring), Some(100.0));
    }

    #[test]
    fn a_ring_that_crosses_itself_keeps_what_lies_inside_an_odd_number_of_times() {
        // Two squares of 1 and 9 that meet in a crossing.
        let ring = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [4.0, 4.0], [4.0, 3.0], [0.0, 3.0]];
        assert!((area(&ring).unwrap() - 10.0).abs() < 1e-12);
        assert!(overlaps(&ring));
    }

    #[test]
    fn a_ball_of_wool_is_given_up_soon() {
        let at = |step: u64| (step * 7919 % 1999) as f64;
        let ring: Vec<[f64; 2]> = (0..1999).map(|step| [at(step), at(step * step)]).collect();
        assert!(triangulate(&ring).is_none());
    }

    #[test]
    fn no_ring_makes_it_panic() {
        use rand_chacha::ChaCha8Rng;
        use rand_chacha::rand_core::{Rng, SeedableRng};
        let mut random = ChaCha8Rng::seed_from_u64(7);
        for round in 0..3000 {
            let corners = 3 + random.next_u64() % 9;
            // A coarse grid makes collinear, repeated and touching corners the rule.
            let grid = if round % 2 == 0 { 5.0 } else { 1e6 };
            let mut coordinate = || (grid * (random.next_u64() as f64 / u64::MAX as f64)).round();
            let ring: Vec<[f64; 2]> = (0..corners).map(|_| [coordinate(), coordinate()]).collect();
            area(&ring);
        }
    }
}
