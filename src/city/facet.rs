//! One polygon of a file to planar facets.

use super::triangulate::triangulate;
use super::warning::CityDefect;
use crate::geometry::{Plane, Point3, Vector3};

/// Metres. A polygon narrower than this has no direction that its digits could hold: files are written to a tenth of a
/// millimetre at best.
const ZERO_WIDTH_M: f64 = 1e-6;

/// Share of a polygon's extent by which its corners may lie off its plane: a centimetre on ten metres, what data
/// sheets of LoD2 models allow.
const FLAT_SHARE: f64 = 1e-3;

/// Metres; no polygon however large may hide a step that a photograph's points would show.
const FLAT_LIMIT_M: f64 = 0.05;

/// Corners rounded to the file's digits may stand off by this many of the last digit.
const FLAT_DIGITS: f64 = 3.0;

/// A facet that has no place in the model yet. Indices from the number of vertices on mean new vertices.
pub(super) struct Draft {
    pub outline: Vec<u32>,
    pub plane: Plane,
    pub area: f64,
    pub triangles: Vec<[u32; 3]>,
}

/// What became of a polygon.
pub(super) struct Shaped {
    pub drafts: Vec<Draft>,
    pub defects: Vec<CityDefect>,
}

impl Shaped {
    fn left_out(defect: CityDefect) -> Shaped {
        Shaped { drafts: Vec::new(), defects: vec![defect] }
    }
}

/// Makes facets of a ring of vertices; `new_vertices` takes the points where it crosses itself.
pub(super) fn shape(
    ring: Vec<u32>,
    vertices: &[Point3<f64>],
    precision_m: f64,
    new_vertices: &mut Vec<Point3<f64>>,
) -> Shaped {
    let corners: Vec<Point3<f64>> = ring.iter().map(|&vertex| vertices[vertex as usize]).collect();
    let centroid = centroid(&corners);
    let area_vector = newell(&corners, &centroid);
    let extent = 2.0 * corners.iter().map(|corner| (corner - centroid).norm()).fold(0.0, f64::max);
    if corners.len() < 3 || 2.0 * area_vector.norm() <= ZERO_WIDTH_M * extent {
        return Shaped::left_out(CityDefect::ZeroArea);
    }
    let Some(plane) = Plane::through(&centroid, &area_vector) else {
        return Shaped::left_out(CityDefect::ZeroArea);
    };
    let [right, up] = axes(&plane.normal);
    let flat = |corner: &Point3<f64>| [right.dot(&(corner - centroid)), up.dot(&(corner - centroid))];
    let Some(made) = triangulate(&corners.iter().map(flat).collect::<Vec<_>>()) else {
        return Shaped::left_out(CityDefect::Tangled);
    };

    let first_new = vertices.len() + new_vertices.len();
    new_vertices.extend(made.crossings.iter().map(|[x, y]| centroid + right * *x + up * *y));
    let vertex_of = |at: usize| ring.get(at).copied().unwrap_or((first_new + at - ring.len()) as u32);
    let triangles: Vec<[u32; 3]> = made.triangles.iter().map(|triangle| triangle.map(vertex_of)).collect();
    let position_of = |vertex: u32| {
        let vertex = vertex as usize;
        vertices.get(vertex).copied().unwrap_or_else(|| new_vertices[vertex - vertices.len()])
    };
    let off_m = corners.iter().map(|corner| plane.signed_distance(corner).abs()).fold(0.0, f64::max);
    let mut defects: Vec<CityDefect> = made.overlaps.then_some(CityDefect::SelfIntersecting).into_iter().collect();
    if off_m > flat_tolerance(extent, precision_m) {
        defects.push(CityDefect::NonPlanar { worst_m: off_m });
        let drafts = triangles.iter().filter_map(|&triangle| triangle_draft(triangle, triangle.map(position_of)));
        return Shaped { drafts: drafts.collect(), defects };
    }
    let area = triangles.iter().map(|triangle| area_of(triangle.map(position_of))).sum();
    Shaped { drafts: vec![Draft { outline: ring, plane, area, triangles }], defects }
}

/// How far corners may lie off their plane, metres.
fn flat_tolerance(extent_m: f64, precision_m: f64) -> f64 {
    (FLAT_SHARE * extent_m).min(FLAT_LIMIT_M).max(FLAT_DIGITS * precision_m)
}

fn triangle_draft(triangle: [u32; 3], corners: [Point3<f64>; 3]) -> Option<Draft> {
    let centroid = centroid(&corners);
    let area_vector = newell(&corners, &centroid);
    let longest = (0..3).map(|at| (corners[at] - corners[(at + 1) % 3]).norm()).fold(0.0, f64::max);
    if 2.0 * area_vector.norm() <= ZERO_WIDTH_M * longest {
        return None;
    }
    let plane = Plane::through(&centroid, &area_vector)?;
    Some(Draft { outline: triangle.to_vec(), plane, area: area_vector.norm(), triangles: vec![triangle] })
}

fn centroid(corners: &[Point3<f64>]) -> Point3<f64> {
    let sum: Vector3<f64> = corners.iter().map(|corner| corner.coords).sum();
    Point3::from(sum / corners.len().max(1) as f64)
}

/// Newell's area vector: normal to the mean plane, as long as the projected area.
fn newell(corners: &[Point3<f64>], about: &Point3<f64>) -> Vector3<f64> {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| (a - about).cross(&(b - about))).sum::<Vector3<f64>>() / 2.0
}

fn area_of([a, b, c]: [Point3<f64>; 3]) -> f64 {
    (b - a).cross(&(c - a)).norm() / 2.0
}

/// Two unit vectors in the plane that with the normal form a right-handed frame.
fn axes(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    // The coordinate axis most across the normal gives the best conditioned cross product.
    let mut helper = Vector3::zeros();
    helper[normal.iamin()] = 1.0;
    let right = helper.cross(normal).normalize();
    [right, normal.cross(&right)]
}
