//! An outline and its holes in their plane to triangles, even-odd, without new points unless rings cross.

mod fan;

use std::cmp::Reverse;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use spade::handles::{FixedUndirectedEdgeHandle, FixedVertexHandle};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation, mitigate_underflow};

pub(super) use self::fan::convex_fan;

/// Pairs of edges for each corner that are looked at for crossings. Chosen: a millisecond for a hundred corners; an outline meets
/// a few dozen edges beside each, all of them only where it is no outline, or has fewer corners than this.
const PAIRS_PER_CORNER: usize = 2000;

/// Crossings for each corner beyond which a ring is no polygon that somebody drew.
const CROSSINGS_PER_CORNER: usize = 2;

/// The area of the triangles may differ from the ring's own by this share before the ring is taken to overlap itself.
const AREA_SHARE: f64 = 1e-6;

/// Parts for each edge into which points on it may cut it; walking up and down a line of many points makes more.
const PARTS_PER_EDGE: usize = 16;

type Mesh = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Triangles of rings, as indices into their points, or past the end into `crossings`.
pub(super) struct Triangles {
    /// Counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    /// Points where edges cross; none in clean rings.
    pub crossings: Vec<[f64; 2]>,
    /// Whether rings cross or overlap themselves or each other, or a hole lies outside.
    pub overlaps: bool,
}

/// Triangulates an outline and its holes, one ring after the other, each ending where `ring_ends` says; whichever way round they
/// run. `None` where they are too tangled.
///
/// Edges that are walked twice (the bridge to a hole) bound nothing, so holes stay holes.
pub(super) fn triangulate(points: &[[f64; 2]], ring_ends: &[usize]) -> Option<Triangles> {
    let edges = edges_of(ring_ends);
    if let Some(triangles) = constrained(points, &edges) {
        let overlaps = differs(points, ring_ends, &triangles);
        return Some(Triangles { triangles, crossings: Vec::new(), overlaps });
    }
    let (with_crossings, edges) = cut_at_crossings(points, &edges)?;
    let triangles = constrained(&with_crossings, &edges)?;
    Some(Triangles { triangles, crossings: with_crossings[points.len()..].to_vec(), overlaps: true })
}

/// From each point to the next of its ring.
fn edges_of(ring_ends: &[usize]) -> Vec<[usize; 2]> {
    let mut edges = Vec::with_capacity(ring_ends.last().copied().unwrap_or(0));
    let mut start = 0;
    for &end in ring_ends {
        edges.extend((start..end).map(|at| [at, if at + 1 < end { at + 1 } else { start }]));
        start = end;
    }
    edges
}

/// Twice the signed area, positive when counter-clockwise.
fn doubled_area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Delaunay triangulation held by the edges, then the triangles that lie an odd number of edges inside.
/// `None` where two edges cross between points, or lie on each other beyond reason.
fn constrained(points: &[[f64; 2]], edges: &[[usize; 2]]) -> Option<Vec<[usize; 3]>> {
    let (mut mesh, handles) = delaunay(points)?;
    let mut walked = Vec::with_capacity(edges.len());
    for [from, to] in borders(&handles, edges) {
        // An edge through other points becomes several; none at all means that it would cross an earlier edge.
        let parts = mesh.try_add_constraint(from, to);
        if parts.is_empty() || walked.len() > PARTS_PER_EDGE * edges.len() {
            return None;
        }
        walked.extend(parts.into_iter().map(|part| part.as_undirected()));
    }
    let mut point_of = vec![usize::MAX; mesh.num_vertices()];
    for (at, handle) in handles.iter().enumerate() {
        point_of[handle.index()] = point_of[handle.index()].min(at);
    }
    let inside = faces_inside(&mesh, &walked);
    let corners = mesh.inner_faces().filter(|face| inside[face.fix().index()]);
    Some(corners.map(|face| face.vertices().map(|vertex| point_of[vertex.fix().index()])).collect())
}

/// Delaunay triangulation of the points, and the vertex that each became; `None` where one is not finite.
///
/// In the ring's own order a wall of n corners in line takes n * n steps (40,000 corners: 5 s): the mesh finds a place
/// by walking there from another, past all points as long as they are in line, and a corner laid beside a full line is
/// tied to all of it. So a triangle comes first, then ever larger samples of the rest, each in the order of a curve that
/// fills the plane and sought from the corner before it (Amenta, Choi and Rote 2003): about n * log n.
fn delaunay(points: &[[f64; 2]]) -> Option<(Mesh, Vec<FixedVertexHandle>)> {
    let mut mesh = Mesh::with_capacity(points.len(), 3 * points.len(), 2 * points.len());
    let mut handles: Vec<Option<FixedVertexHandle>> = vec![None; points.len()];
    let first_at_place = first_at_place(points);
    let mut insert = |at: usize, near: &mut Option<FixedVertexHandle>| {
        let point = mitigate_underflow(Point2::new(points[at][0], points[at][1]));
        let made = match *near {
            Some(near) => mesh.insert_with_hint(point, near),
            None => mesh.insert(point),
        };
        *near = made.ok();
        *near
    };
    let mut last = None;
    for at in wide_triangle(points) {
        handles[at] = Some(insert(at, &mut last)?);
    }
    // Half of the points are in the last sample, a quarter in the one before it, and so on.
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let samples: Vec<u32> = points.iter().map(|_| random.next_u32().trailing_zeros()).collect();
    let along_curve = places_along_a_curve(points);
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&at| first_at_place[at] == at && handles[at].is_none()).collect();
    order.sort_by_key(|&at| (Reverse(samples[at]), along_curve[at]));
    for at in order {
        handles[at] = Some(insert(at, &mut last)?);
    }
    let handles = first_at_place.iter().map(|&first| handles[first]).collect::<Option<_>>()?;
    Some((mesh, handles))
}

/// Where each point lies on a curve that fills the plane in the order of Z (Morton 1966), so that neighbours on it are
/// near each other, as neighbours on a ring that zigzags are not.
fn places_along_a_curve(points: &[[f64; 2]]) -> Vec<u64> {
    let bound = |axis: usize, pick: fn(f64, f64) -> f64| points.iter().map(|p| p[axis]).fold(points[0][axis], pick);
    let (low, high) = ([0, 1].map(|axis| bound(axis, f64::min)), [0, 1].map(|axis| bound(axis, f64::max)));
    let cells = f64::from(u32::MAX) / (high[0] - low[0]).max(high[1] - low[1]).max(f64::MIN_POSITIVE);
    let spread = |value: f64| (0..u32::BITS).fold(0_u64, |sum, bit| sum | ((value as u64 >> bit & 1) << (2 * bit)));
    points.iter().map(|p| spread(cells * (p[0] - low[0])) | spread(cells * (p[1] - low[1])) << 1).collect()
}

/// For each point the index of the first that equals it: one corner where thousands of spikes meet is no place to begin
/// a walk.
fn first_at_place(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<([u64; 2], usize)> = points.iter().map(|point| point.map(f64::to_bits)).zip(0..).collect();
    order.sort_unstable();
    let mut first = vec![0; points.len()];
    for same in order.chunk_by(|a, b| a.0 == b.0) {
        same.iter().for_each(|&(_, at)| first[at] = same[0].1);
    }
    first
}

/// The first point, the one farthest from it, and the one farthest from the line through both.
fn wide_triangle(points: &[[f64; 2]]) -> [usize; 3] {
    let farthest = |measure: &dyn Fn([f64; 2]) -> f64| {
        let measures = points.iter().map(|&point| measure(point));
        measures.enumerate().fold((0, 0.0), |best, (at, far)| if far > best.1 { (at, far) } else { best }).0
    };
    let first = points[0];
    let second = farthest(&|p| (p[0] - first[0]).hypot(p[1] - first[1]));
    [0, second, farthest(&|p| doubled_area(first, points[second], p).abs())]
}

/// The edges that bound something, each once: those walked an even number of times (bridges to holes, spikes) do not.
/// Each begins where fewer edges meet, since the mesh looks around the beginning for its way.
fn borders(handles: &[FixedVertexHandle], edges: &[[usize; 2]]) -> Vec<[FixedVertexHandle; 2]> {
    let ends = |edge: &[usize; 2]| edge.map(|at| handles[at].index());
    let mut pairs: Vec<[usize; 2]> = edges.iter().map(ends).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    pairs.sort_unstable();
    let alike = pairs.chunk_by(|a, b| a == b);
    let odd: Vec<[usize; 2]> = alike.filter(|same| same.len() % 2 == 1).map(|same| same[0]).collect();
    let mut meeting = vec![0_u32; handles.len()];
    for &[a, b] in &odd {
        meeting[a] += 1;
        meeting[b] += 1;
    }
    let real = odd.into_iter().filter(|[a, b]| a != b);
    let ordered = real.map(|[a, b]| if meeting[b] < meeting[a] { [b, a] } else { [a, b] });
    ordered.map(|edge| edge.map(FixedVertexHandle::from_index)).collect()
}

/// Floods from outside; every edge that was walked an odd number of times changes sides.
fn faces_inside(mesh: &Mesh, walked: &[FixedUndirectedEdgeHandle]) -> Vec<bool> {
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

/// Whether the triangles cover another area than the outline winds round without its holes.
fn differs(points: &[[f64; 2]], ring_ends: &[usize], triangles: &[[usize; 3]]) -> bool {
    let covered: f64 = triangles.iter().map(|&[a, b, c]| doubled_area(points[a], points[b], points[c]).abs()).sum();
    let mut wound = 0.0;
    let mut start = 0;
    for &end in ring_ends {
        let ring = &points[start..end];
        let fan = (1..ring.len().saturating_sub(1)).map(|at| doubled_area(ring[0], ring[at], ring[at + 1]));
        let area = fan.sum::<f64>().abs();
        wound += if start == 0 { area } else { -area };
        start = end;
    }
    (covered - wound).abs() > AREA_SHARE * wound.abs()
}

type PointsAndEdges = (Vec<[f64; 2]>, Vec<[usize; 2]>);

/// The points, with one put in wherever two edges cross. `None` for rings that are too tangled.
fn cut_at_crossings(ring: &[[f64; 2]], uncut: &[[usize; 2]]) -> Option<PointsAndEdges> {
    let count = ring.len();
    let mut points = ring.to_vec();
    let mut cuts: Vec<Vec<(f64, usize)>> = vec![Vec::new(); count];
    for ([first, second], [along_first, along_second], point) in crossings(ring, uncut)? {
        cuts[first].push((along_first, points.len()));
        cuts[second].push((along_second, points.len()));
        points.push(point);
    }
    let mut edges = Vec::with_capacity(count + 2 * (points.len() - count));
    for ([start, end], cuts) in uncut.iter().zip(&mut cuts) {
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut from = *start;
        for to in cuts.iter().map(|cut| cut.1).chain([*end]) {
            edges.push([from, to]);
            from = to;
        }
    }
    Some((points, edges))
}

/// Two edges by their numbers, the shares of the way along each, and the point where they cross.
type Crossing = ([usize; 2], [f64; 2], [f64; 2]);

/// Where edges cross, in their order; `None` where that is too often, or too many edges lie beside each
/// other to tell. Edges are taken in the order in which a line that sweeps along the points meets them.
fn crossings(ring: &[[f64; 2]], edges: &[[usize; 2]]) -> Option<Vec<Crossing>> {
    let count = ring.len();
    let extent = |k: usize| {
        let all = || ring.iter().map(|corner| corner[k]);
        all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min)
    };
    let k = if extent(0) < extent(1) { 1 } else { 0 };
    let mut spans: Vec<(f64, f64, usize)> = edges
        .iter()
        .map(|edge| edge.map(|at| ring[at][k]))
        .enumerate()
        .map(|(at, [a, b])| (a.min(b), a.max(b), at))
        .collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut found, mut pairs) = (Vec::new(), 0);
    for (rank, &(_, high, one)) in spans.iter().enumerate() {
        for &(_, _, other) in spans[rank + 1..].iter().take_while(|next| next.0 <= high) {
            let [first, second] = [one.min(other), one.max(other)];
            let [[a, b], [c, d]] = [edges[first], edges[second]];
            let ends = [ring[a], ring[b], ring[c], ring[d]];
            found.extend(crossing(ends).map(|(a, b, point)| ([first, second], [a, b], point)));
            pairs += 1;
        }
        if pairs > PAIRS_PER_CORNER * count || found.len() > CROSSINGS_PER_CORNER * count {
            return None;
        }
    }
    found.sort_by_key(|(edges, ..)| *edges);
    Some(found)
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
mod tests;
