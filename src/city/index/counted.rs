//! The places of what a part of a file holds among all that the file holds.

use super::survey::Feature;
use crate::city::build::BuiltPart;
use crate::city::source::Source;
use crate::format::city_index::OWN_VERTEX;

/// Crossings with itself that one polygon can have: two to this power.
const CROSSINGS_BITS: u32 = 24;

/// The places of a part's faces, objects and vertices among those of the whole.
pub(super) struct Counted {
    pub faces: Vec<u32>,
    pub objects: Vec<u32>,
    pub vertices: Vec<u64>,
}

impl Counted {
    /// `of_features`: each with the faces, objects and corners before it.
    pub fn new(of_features: &[(Feature, [u64; 3])], source: &Source, part: &BuiltPart) -> Counted {
        let (mut faces, mut objects, mut corners) = (Vec::new(), Vec::new(), Vec::new());
        for (own, before) in of_features {
            faces.extend((before[0]..).take(own.faces as usize).map(|face| face as u32));
            objects.extend((before[1]..).take(own.objects as usize).map(|object| object as u32));
            corners.extend((before[2]..).take(own.corners as usize));
        }
        // A vertex is numbered by the first corner that uses it, as the whole file's are.
        let mut vertices = vec![u64::MAX; part.model.vertices.len()];
        for (&corner, &position) in corners.iter().zip(&source.corners) {
            let vertex = &mut vertices[part.vertex_of[position as usize] as usize];
            *vertex = (*vertex).min(corner);
        }
        // What is left are crossings of polygons with themselves, which come after all corners, in the order of the polygons.
        for (facet, &face) in part.model.facets.iter().zip(&part.facet_faces) {
            let triangles = &part.model.triangles[facet.triangles.start as usize..facet.triangles.end as usize];
            let own = OWN_VERTEX | (u64::from(faces[face as usize]) << CROSSINGS_BITS);
            for &vertex in triangles.iter().flatten() {
                let order = &mut vertices[vertex as usize];
                *order = if *order == u64::MAX { own } else { *order };
            }
        }
        number_crossings(&mut vertices);
        Counted { faces, objects, vertices }
    }
}

/// Crossings of one polygon follow each other.
fn number_crossings(vertices: &mut [u64]) {
    let (mut last, mut count) = (0, 0);
    for vertex in vertices.iter_mut().filter(|vertex| (OWN_VERTEX..u64::MAX).contains(*vertex)) {
        count = if *vertex == last { count + 1 } else { 0 };
        last = *vertex;
        *vertex += count;
    }
}
