//! Implicit geometries: templates that are placed by a matrix and a point.

use std::collections::HashMap;
use std::ops::Range;

use nalgebra::{Matrix4, Point3};

use crate::format::surface_builder::{SurfaceBuilder, SurfaceTraits};
use crate::format::surface_error::SurfaceError;
use crate::format::surfaces::Lod;

/// Corners that all placed templates together may come to for each byte of the file, and in any case, and at most. Chosen: a
/// placed template takes some 600 bytes of XML, and a detailed tree has thousands of corners.
const CORNERS_PER_BYTE: u64 = 64;
const CORNERS_OF_ANY_FILE: u64 = 1 << 16;
const MOST_CORNERS: u64 = 1 << 26;

/// A template where one object has it: `x = matrix * x_in_template + reference`.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    pub object: u32,
    pub lod: Option<Lod>,
    pub matrix: Option<Matrix4<f64>>,
    pub reference: Option<[f64; 3]>,
    pub template: Template,
}

/// Where the geometry is.
#[derive(Clone, Debug)]
pub(super) enum Template {
    /// Surfaces of the templates, by their numbers.
    Inline(Range<u32>),
    Named(Box<str>),
    /// In a file of another format.
    Library,
}

/// Templates and where they stand.
#[derive(Debug, Default)]
pub(super) struct Instances {
    pub templates: SurfaceBuilder,
    pub ids: HashMap<Box<str>, Range<u32>>,
    pub instances: Vec<Instance>,
}

impl Instances {
    /// Writes every template out where it is placed.
    pub fn place(&self, builder: &mut SurfaceBuilder, file_bytes: u64) -> Result<(), SurfaceError> {
        self.check_room(file_bytes)?;
        for instance in &self.instances {
            let missing = match (&instance.template, self.surfaces_of(instance), instance.reference) {
                (Template::Library, ..) => "implicit geometries whose template is another file",
                (_, Some(surfaces), Some(reference)) => {
                    for surface in surfaces {
                        self.place_surface(surface, instance, reference, builder)?;
                    }
                    continue;
                }
                _ => "implicit geometries without a template or a reference point",
            };
            let example = builder.object_id(Some(instance.object)).unwrap_or_default();
            builder.skip(missing, 1, || example);
        }
        Ok(())
    }

    /// Refuses more corners than the bytes that are there can stand for.
    fn check_room(&self, file_bytes: u64) -> Result<(), SurfaceError> {
        let limit = (file_bytes.saturating_mul(CORNERS_PER_BYTE)).clamp(CORNERS_OF_ANY_FILE, MOST_CORNERS);
        let surfaces = self.instances.iter().filter_map(|instance| self.surfaces_of(instance));
        let corners: u64 =
            surfaces.map(|surfaces| self.corners_before(surfaces.end) - self.corners_before(surfaces.start)).sum();
        if corners > limit {
            return Err(SurfaceError::whole(format!(
                "implicit geometries come to more than {limit} corners, too many for {file_bytes} bytes; split the file"
            )));
        }
        Ok(())
    }

    fn surfaces_of(&self, instance: &Instance) -> Option<Range<u32>> {
        match &instance.template {
            Template::Inline(surfaces) => Some(surfaces.clone()),
            Template::Named(href) => self.ids.get(href.strip_prefix('#')?).cloned(),
            Template::Library => None,
        }
    }

    /// Corners of the templates' surfaces before this one.
    fn corners_before(&self, surface: u32) -> u64 {
        let file = &self.templates.file;
        let ring =
            file.surfaces.get(surface as usize).map_or(file.ring_ends.len(), |record| record.first_ring as usize);
        ring.checked_sub(1).map_or(0, |before| u64::from(file.ring_ends[before]))
    }

    fn rings_of(&self, surface: u32) -> impl Iterator<Item = Range<usize>> {
        let record = self.templates.file.surfaces[surface as usize];
        let ends = &self.templates.file.ring_ends;
        let start = move |ring: usize| ring.checked_sub(1).map_or(0, |before| ends[before] as usize);
        let rings = record.first_ring as usize..(record.first_ring + record.ring_count) as usize;
        rings.map(move |ring| start(ring)..ends[ring] as usize)
    }

    fn place_surface(
        &self,
        surface: u32,
        instance: &Instance,
        reference: [f64; 3],
        builder: &mut SurfaceBuilder,
    ) -> Result<(), SurfaceError> {
        let matrix = instance.matrix.unwrap_or_else(Matrix4::identity);
        let is_mirrored = matrix.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        let placed = |corner: &u32| {
            let position = Point3::from(self.templates.file.positions[*corner as usize]);
            let turned = matrix.fixed_view::<3, 3>(0, 0) * position.coords + matrix.fixed_view::<3, 1>(0, 3);
            [0, 1, 2].map(|axis| turned[axis] + reference[axis])
        };
        let corners = &self.templates.file.corners;
        let mut rings: Vec<Vec<[f64; 3]>> =
            self.rings_of(surface).map(|ring| corners[ring].iter().map(placed).collect()).collect();
        if is_mirrored {
            rings.iter_mut().for_each(|ring| ring.reverse());
        }
        if !rings.iter().flatten().flatten().all(|value| value.is_finite()) {
            let problem = "an implicit geometry is placed at coordinates that are not finite; mend its matrix";
            return Err(SurfaceError::whole(problem).of(builder.object_id(Some(instance.object))));
        }
        let kind = self.templates.file.surfaces[surface as usize].kind;
        let traits = SurfaceTraits { object: instance.object, lod: instance.lod, kind, shell: None };
        builder.add_surface(rings.iter().map(Vec::as_slice), traits)
    }
}

/// A matrix of sixteen numbers row by row, whose last row is 0 0 0 1.
pub(super) fn matrix_of(numbers: &[f64]) -> Result<Matrix4<f64>, String> {
    if numbers.len() != 16 || numbers[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(
            "transformationMatrix is not affine; expected 16 numbers row by row, the last four 0 0 0 1".to_owned()
        );
    }
    Ok(Matrix4::from_row_slice(numbers))
}
