//! Geometries that stand once and are shown at many places (GeometryInstance).

use serde_json::value::RawValue;

use super::boundaries::{Form, Shape};
use super::document::{Templates, Transform};
use super::fault::{CityJsonProblem, Fault, place_of};
use super::kinds::kinds_of;
use super::vertices::read_vertices;
use crate::format::surfaces::{Lod, SurfaceKind};

/// A template; `shape` counts its own `positions`.
pub(super) struct Template {
    pub lod: Option<Lod>,
    pub form: Form,
    pub shape: Shape,
    pub kinds: Vec<Option<SurfaceKind>>,
    pub positions: Vec<[f64; 3]>,
}

impl Template {
    /// Corners, vertices and surfaces, which stand once more with every instance.
    pub fn size(&self) -> usize {
        self.shape.corners.len() + self.positions.len() + self.shape.ring_ends.len()
    }
}

/// All templates of a header; `None` for those without surfaces (points, lines, instances of others).
pub(super) fn read_templates(text: &str, list: &Templates<'_>) -> Result<Vec<Option<Template>>, Fault> {
    let mut positions = Vec::new();
    if let Some(vertices) = list.vertices {
        read_vertices(vertices.get(), place_of(text, vertices.get()), &Transform::default(), &mut positions)?;
    }
    let mut templates = Vec::with_capacity(list.templates.len());
    for (at, geometry) in list.templates.iter().enumerate() {
        let named = |fault: Fault| fault.of(&format!("template {at}"));
        let (Some(form), Some(boundaries)) = (Form::named(&geometry.kind), geometry.boundaries) else {
            templates.push(None);
            continue;
        };
        let mut shape = Shape::default();
        shape.read(boundaries.get(), place_of(text, boundaries.get()), form, positions.len()).map_err(named)?;
        let (kinds, _) = kinds_of(geometry.semantics.as_ref(), &shape, form.depth());
        let positions = own_positions(&mut shape.corners, &positions);
        templates.push(Some(Template { lod: geometry.lod(), form, shape, kinds, positions }));
    }
    Ok(templates)
}

/// The positions that corners use; the corners count these from then on.
fn own_positions(corners: &mut [u32], all: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut used: Vec<u32> = corners.to_vec();
    used.sort_unstable();
    used.dedup();
    for corner in corners {
        *corner = used.partition_point(|&at| at < *corner) as u32;
    }
    used.iter().map(|&at| all[at as usize]).collect()
}

/// A template's coordinates to the file's, about the place of the instance.
pub(super) struct Placement {
    rows: [[f64; 4]; 3],
}

impl Placement {
    /// Sixteen numbers, row by row; without a matrix, as it stands.
    pub fn read(text: &str, matrix: Option<&RawValue>) -> Result<Placement, Fault> {
        let Some(matrix) = matrix else {
            return Ok(Placement { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] });
        };
        let refused = |found: String| Fault::at(place_of(text, matrix.get()), CityJsonProblem::Matrix { found });
        let numbers: Vec<f64> = serde_json::from_str(matrix.get()).map_err(|_| refused("no list of numbers".into()))?;
        let row = |at: usize| <[f64; 4]>::try_from(&numbers[4 * at..4 * at + 4]).unwrap_or_default();
        match numbers.len() {
            16 if row(3) == [0.0, 0.0, 0.0, 1.0] => Ok(Placement { rows: [row(0), row(1), row(2)] }),
            16 => Err(refused(format!("the last row {:?}", row(3)))),
            count => Err(refused(format!("{count} numbers"))),
        }
    }

    /// The template's point where the instance puts it.
    pub fn put(&self, point: [f64; 3], about: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = point;
        [0, 1, 2].map(|axis| {
            let [a, b, c, d] = self.rows[axis];
            about[axis] + (a * x + b * y + c * z + d)
        })
    }
}
