//! One polygon of a file to planar facets.

use super::triangulate::{convex_fan, triangulate};
use super::warning::CityDefect;
use super::{Facet, ObjectId, SurfaceKind};
use crate::geometry::{Axes, Plane, Point3, Vector3};

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

/// Makes facets of one run of faces, as if no other run were there.
pub(super) struct Shaper<'a> {
    vertices: &'a [Point3<f64>],
    precision_m: f64,
    /// With triangles counted from the run's first, and vertices from `vertices.len()` on in `new_vertices`.
    pub facets: Vec<Facet>,
    pub triangles: Vec<[u32; 3]>,
    /// Where polygons cross themselves.
    pub new_vertices: Vec<Point3<f64>>,
    /// Each with its face.
    pub defects: Vec<(u32, CityDefect)>,
    corners: Vec<Point3<f64>>,
    flat: Vec<[f64; 2]>,
}

/// A face of a file.
pub(super) struct Face {
    pub number: u32,
    pub object: ObjectId,
    pub kind: Option<SurfaceKind>,
    /// Vertices, none twice in a row.
    pub outline: Vec<u32>,
    pub holes: Vec<Vec<u32>>,
}

/// Where a face lies.
struct Place {
    plane: Plane,
    centroid: Point3<f64>,
    /// Whether all corners lie in the plane, as far as anybody can tell.
    is_flat: bool,
}

impl<'a> Shaper<'a> {
    pub fn new(vertices: &'a [Point3<f64>], precision_m: f64, faces: usize) -> Shaper<'a> {
        Shaper {
            vertices,
            precision_m,
            facets: Vec::with_capacity(faces),
            triangles: Vec::with_capacity(2 * faces),
            new_vertices: Vec::new(),
            defects: Vec::new(),
            corners: Vec::new(),
            flat: Vec::new(),
        }
    }

    /// Adds the facets of a face, or the reason why there are none.
    pub fn shape(&mut self, mut face: Face) {
        self.corners.clear();
        self.corners.extend(face.outline.iter().map(|&vertex| self.vertices[vertex as usize]));
        let centroid = centroid(&self.corners);
        let area_vector = newell(&self.corners, &centroid);
        let reach = self.corners.iter().map(|corner| (corner - centroid).norm_squared()).fold(0.0, f64::max);
        let extent = 2.0 * reach.sqrt();
        let is_wide = face.outline.len() >= 3 && 2.0 * area_vector.norm() > ZERO_WIDTH_M * extent;
        let Some(plane) = Plane::through(&centroid, &area_vector).filter(|_| is_wide) else {
            return self.defects.push((face.number, CityDefect::ZeroArea));
        };
        let hole_area = self.wind_holes(&mut face.holes, &plane.normal);
        self.corners.extend(face.holes.iter().flatten().map(|&vertex| self.vertices[vertex as usize]));
        let first = self.triangles.len();
        let off_m = self.corners.iter().map(|corner| plane.signed_distance(corner).abs()).fold(0.0, f64::max);
        let is_flat = off_m <= flat_tolerance(extent, self.precision_m);
        let Some(is_clean) = self.cut(&face, &Place { plane, centroid, is_flat }) else {
            return self.defects.push((face.number, CityDefect::Tangled));
        };
        if !is_flat {
            self.defects.push((face.number, CityDefect::NonPlanar { worst_m: off_m }));
            return self.add_split(first, &face);
        }
        // Triangles of flat rings cover what these wind round, unless they overlap. A hole as large as its polygon rounds below zero.
        let area = if is_clean { (area_vector.norm() - hole_area).max(0.0) } else { self.covered_area(first) };
        let triangles = first as u32..self.triangles.len() as u32;
        let Face { outline, holes, object, kind, .. } = face;
        self.facets.push(Facet { outline, holes, plane, area, object, kind, triangles });
    }

    /// Turns holes so that they run clockwise seen from outside, as a neighbour's edges expect, drops those without an area, and
    /// gives the area of all.
    fn wind_holes(&self, holes: &mut Vec<Vec<u32>>, normal: &Vector3<f64>) -> f64 {
        let mut whole = 0.0;
        holes.retain_mut(|hole| {
            let corners: Vec<Point3<f64>> = hole.iter().map(|&vertex| self.vertices[vertex as usize]).collect();
            let area = newell(&corners, &centroid(&corners)).dot(normal);
            if area > 0.0 {
                hole.reverse();
            }
            whole += area.abs();
            hole.len() >= 3 && area != 0.0
        });
        whole
    }

    /// Adds the face's triangles and says whether it is free of overlaps; `None` where it is too tangled.
    fn cut(&mut self, face: &Face, place: &Place) -> Option<bool> {
        let outline = &face.outline;
        if let ([a, b, c], []) = (&outline[..], &face.holes[..]) {
            self.triangles.push([*a, *b, *c]);
            return Some(true);
        }
        if let [a, b, c, d] = self.corners[..]
            && let Some(halves) = halves([a, b, c, d], &place.plane.normal)
        {
            self.triangles.extend(halves.map(|half| half.map(|at| outline[at])));
            return Some(true);
        }
        let Axes { x: right, y: up, .. } = Axes::along_coordinates(&place.plane.normal);
        let centroid = place.centroid;
        self.flat.clear();
        let in_plane = |corner: &Point3<f64>| [right.dot(&(corner - centroid)), up.dot(&(corner - centroid))];
        self.flat.extend(self.corners.iter().map(in_plane));
        // The triangles of what is not flat become facets, for which Delaunay's are better than a fan.
        if place.is_flat
            && face.holes.is_empty()
            && let Some(fan) = convex_fan(&self.flat, self.precision_m)
        {
            self.triangles.extend(fan.map(|triangle| triangle.map(|at| outline[at])));
            return Some(true);
        }
        let rings: Vec<u32> = outline.iter().chain(face.holes.iter().flatten()).copied().collect();
        let made = triangulate(&self.flat, &face.ring_ends())?;
        let first_new = self.vertices.len() + self.new_vertices.len();
        self.new_vertices.extend(made.crossings.iter().map(|[x, y]| centroid + right * *x + up * *y));
        let vertex_of = |at: usize| rings.get(at).copied().unwrap_or_else(|| (first_new + at - rings.len()) as u32);
        self.triangles.extend(made.triangles.iter().map(|triangle| triangle.map(vertex_of)));
        self.defects.extend(made.overlaps.then_some((face.number, CityDefect::SelfIntersecting)));
        Some(!made.overlaps)
    }

    fn covered_area(&self, first: usize) -> f64 {
        self.triangles[first..].iter().map(|triangle| area_of(self.positions(triangle))).sum()
    }

    /// Makes a facet of every triangle from `first` on that has a plane, and forgets the others.
    fn add_split(&mut self, first: usize, face: &Face) {
        let triangles = self.triangles.split_off(first);
        for triangle in triangles {
            let corners = self.positions(&triangle);
            let centroid = centroid(&corners);
            let area_vector = newell(&corners, &centroid);
            let longest = (0..3).map(|at| (corners[at] - corners[(at + 1) % 3]).norm()).fold(0.0, f64::max);
            let is_wide = 2.0 * area_vector.norm() > ZERO_WIDTH_M * longest;
            if let Some(plane) = Plane::through(&centroid, &area_vector).filter(|_| is_wide) {
                let start = self.triangles.len() as u32;
                self.triangles.push(triangle);
                self.facets.push(Facet {
                    outline: triangle.to_vec(),
                    holes: Vec::new(),
                    plane,
                    area: area_vector.norm(),
                    object: face.object,
                    kind: face.kind,
                    triangles: start..start + 1,
                });
            }
        }
    }

    fn positions(&self, triangle: &[u32; 3]) -> [Point3<f64>; 3] {
        triangle.map(|vertex| {
            let vertex = vertex as usize;
            self.vertices.get(vertex).copied().unwrap_or_else(|| self.new_vertices[vertex - self.vertices.len()])
        })
    }
}

impl Face {
    /// Where each ring ends in the list of all corners.
    fn ring_ends(&self) -> Vec<usize> {
        let lengths = std::iter::once(self.outline.len()).chain(self.holes.iter().map(Vec::len));
        lengths
            .scan(0, |end, length| {
                *end += length;
                Some(*end)
            })
            .collect()
    }
}

/// How far corners may lie off their plane, metres.
fn flat_tolerance(extent_m: f64, precision_m: f64) -> f64 {
    (FLAT_SHARE * extent_m).max(FLAT_DIGITS * precision_m).min(FLAT_LIMIT_M)
}

fn centroid(corners: &[Point3<f64>]) -> Point3<f64> {
    let sum: Vector3<f64> = corners.iter().map(|corner| corner.coords).sum();
    Point3::from(sum / corners.len().max(1) as f64)
}

/// Newell's area vector: normal to the mean plane, as long as the projected area.
fn newell(corners: &[Point3<f64>], about: &Point3<f64>) -> Vector3<f64> {
    let Some(last) = corners.last() else { return Vector3::zeros() };
    let mut sum = Vector3::zeros();
    let mut before = last - about;
    for corner in corners {
        let here = corner - about;
        sum += before.cross(&here);
        before = here;
    }
    sum / 2.0
}

fn area_of([a, b, c]: [Point3<f64>; 3]) -> f64 {
    (b - a).cross(&(c - a)).norm() / 2.0
}

/// Cuts a quadrilateral along the diagonal that leaves the larger smaller half. `None` where neither leaves two halves
/// that run the right way round, as when it crosses itself.
fn halves([a, b, c, d]: [Point3<f64>; 4], normal: &Vector3<f64>) -> Option<[[usize; 3]; 2]> {
    let doubled_area = |one: Vector3<f64>, other: Vector3<f64>| normal.dot(&one.cross(&other));
    let from_a = doubled_area(b - a, c - a).min(doubled_area(c - a, d - a));
    let from_b = doubled_area(c - b, d - b).min(doubled_area(d - b, a - b));
    if from_a.max(from_b) <= 0.0 {
        return None;
    }
    Some(if from_a >= from_b { [[0, 1, 2], [0, 2, 3]] } else { [[1, 2, 3], [1, 3, 0]] })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Facets, defects by face, triangles.
    type Shaped = (Vec<Facet>, Vec<(u32, CityDefect)>, Vec<[u32; 3]>);

    fn shaped(vertices: &[[f64; 3]], outline: &[u32], holes: &[&[u32]]) -> Shaped {
        let vertices: Vec<Point3<f64>> = vertices.iter().map(|&[x, y, z]| Point3::new(x, y, z)).collect();
        let mut shaper = Shaper::new(&vertices, 1e-3, 1);
        let holes = holes.iter().map(|hole| hole.to_vec()).collect();
        shaper.shape(Face { number: 0, object: ObjectId(0), kind: None, outline: outline.to_vec(), holes });
        let Shaper { facets, triangles, defects, .. } = shaper;
        (facets, defects, triangles)
    }

    #[test]
    fn a_facet_that_is_all_hole_has_no_area_and_none_below_zero() {
        // Areas are sums that round differently with the turn and the corner that is first: a quarter of these lay below zero by 1e-14.
        for (step, first) in (0..100).flat_map(|step| (0..5).map(move |first| (step, first))) {
            let (s, c) = (0.037 * f64::from(step)).sin_cos();
            let turned = |[x, y]: [f64; 2]| [x * c - y * s + 0.1, x * s + y * c + 0.7, 0.3 * x + 0.1];
            let vertices = [[0.0, 0.0], [7.1, 0.0], [7.1, 3.337], [3.976, 5.893], [0.0, 3.337]].map(turned);
            let mut hole = [0, 1, 2, 3, 4];
            hole.rotate_left(first);
            let (facets, ..) = shaped(&vertices, &[0, 1, 2, 3, 4], &[&hole]);
            assert!(facets.iter().all(|facet| (0.0..1e-9).contains(&facet.area)), "{step} {first}: {facets:?}");
        }
    }

    #[test]
    fn corners_of_a_clean_polygon_are_its_own_in_a_list_of_many_vertices() {
        // The number of a new vertex must not be reckoned for a corner that is none: where rings share their vertices it lies below zero,
        // which ends a program with checks of overflow.
        let vertices = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [2.0, 1.0, 0.0], [0.0, 4.0, 0.0]];
        let (facets, defects, triangles) = shaped(&vertices, &[0, 1, 2, 3, 4], &[&[0, 1, 2, 3, 4]]);
        assert!(triangles.iter().flatten().all(|&at| at < 5), "{triangles:?}");
        let (clean, none, triangles) = shaped(&vertices, &[0, 1, 2, 3, 4], &[]);
        assert_eq!((clean.len(), none.as_slice(), triangles.len()), (1, [].as_slice(), 3));
        assert!(facets.len() + defects.len() > 0);
    }

    #[test]
    fn crossings_become_vertices_behind_those_that_are_there() {
        let vertices = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 4.0, 0.0], [2.0, 9.0, 0.0]];
        let (facets, defects, triangles) = shaped(&vertices, &[0, 1, 2, 3, 4], &[]);
        assert_eq!(defects, [(0, CityDefect::SelfIntersecting)]);
        assert!(facets.len() == 1 && triangles.iter().flatten().all(|&at| at <= 6), "{triangles:?}");
        assert!([5, 6].iter().all(|new| triangles.iter().flatten().any(|at| at == new)), "{triangles:?}");
    }

    #[test]
    fn a_fan_gives_the_plane_and_the_area_of_the_mesh() {
        for corners in 5..=12_u32 {
            // On an ellipse that leans, at large coordinates, to the digits of a file.
            let place = |at: u32| {
                let (sin, cos) = (f64::from(at) * std::f64::consts::TAU / f64::from(corners)).sin_cos();
                [85_000.0 + 9.0 * cos, 446_000.0 + 4.0 * sin, 3.0 * cos + 2.0 * sin].map(|v| (v * 1e3).round() / 1e3)
            };
            let outline: Vec<u32> = (0..corners).collect();
            let vertices: Vec<[f64; 3]> = outline.iter().map(|&at| place(at)).collect();
            let (facets, defects, triangles) = shaped(&vertices, &outline, &[]);
            assert!(facets.len() == 1 && defects.is_empty() && triangles.len() as u32 == corners - 2);
            let points: Vec<Point3<f64>> = vertices.iter().copied().map(Point3::from).collect();
            let Axes { x, y, .. } = Axes::along_coordinates(&facets[0].plane.normal);
            let flat: Vec<[f64; 2]> = points.iter().map(|p| p - points[0]).map(|v| [x.dot(&v), y.dot(&v)]).collect();
            assert!(convex_fan(&flat, 1e-3).is_some());
            let sum = |triangles: &[[usize; 3]]| -> Vector3<f64> {
                triangles.iter().map(|&[a, b, c]| (points[b] - points[a]).cross(&(points[c] - points[a])) / 2.0).sum()
            };
            let by_fan = sum(&triangles.iter().map(|t| t.map(|at| at as usize)).collect::<Vec<_>>());
            let by_mesh = sum(&triangulate(&flat, &[flat.len()]).unwrap().triangles);
            assert!((by_fan - by_mesh).norm() < 1e-9, "{by_fan} {by_mesh}");
            assert!((by_mesh.norm() - facets[0].area).abs() < 1e-9);
            assert!((by_mesh.normalize() - facets[0].plane.normal).norm() < 1e-9);
        }
    }
}
