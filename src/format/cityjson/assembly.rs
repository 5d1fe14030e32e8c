//! Geometries of city objects to one [`SurfaceFile`].

use super::boundaries::{Form, Shape, corner};
use super::document::Geometry;
use super::fault::{CityJsonProblem, Fault, place_of};
use super::kinds::kinds_of;
use super::nest::{Nest, Token};
use super::templates::{Placement, Template};
use super::vertices::COORDINATE_LIMIT;
use crate::format::surfaces::{Lod, Skipped, SurfaceFile, SurfaceKind, SurfaceRecord};

/// Corners, rings and vertices of instances that a file may come to for each of its bytes: an instance of some hundred bytes shows a
/// whole template once more. Chosen as for glTF: a lamp of 4,000 of them may be at every corner.
const ELEMENTS_PER_BYTE: usize = 64;

/// Elements of instances that any file may have, and that none may exceed.
const ELEMENTS_ALLOWED: (usize, usize) = (1 << 16, 1 << 26);

/// A file in the making.
pub(super) struct Assembly<'a> {
    text: &'a str,
    pub file: SurfaceFile,
    shells: u32,
    /// Corners, rings and vertices of instances.
    instanced: usize,
    /// Kept for its memory.
    shape: Shape,
}

/// Where the indices of a document point.
pub(super) struct Vertices {
    /// The first of its vertices among all positions.
    pub first: usize,
    pub count: usize,
}

impl<'a> Assembly<'a> {
    pub fn new(text: &'a str) -> Assembly<'a> {
        Assembly { text, file: SurfaceFile::default(), shells: 0, instanced: 0, shape: Shape::default() }
    }

    /// Counts what was passed over.
    pub fn skip(&mut self, what: &'static str, count: usize, object: u32) {
        if count == 0 {
            return;
        }
        match self.file.skipped.iter_mut().find(|skipped| skipped.what == what) {
            Some(skipped) => skipped.count += count,
            None => {
                let example = self.file.objects[object as usize].id.clone();
                self.file.skipped.push(Skipped { what, count, example });
            }
        }
    }

    /// Adds one geometry of an object.
    pub fn add(
        &mut self,
        object: u32,
        geometry: &Geometry<'_>,
        vertices: &Vertices,
        templates: &[Option<Template>],
    ) -> Result<(), Fault> {
        match (Form::named(&geometry.kind), geometry.kind.as_ref()) {
            (Some(form), _) => self.add_surfaces(object, geometry, form, vertices),
            (None, "GeometryInstance") => self.add_instance(object, geometry, vertices, templates),
            (None, "MultiPoint" | "MultiLineString") => {
                self.skip("points and lines", 1, object);
                Ok(())
            }
            (None, _) => {
                self.skip("geometries of a type that CityJSON does not have", 1, object);
                Ok(())
            }
        }
    }

    fn add_surfaces(
        &mut self,
        object: u32,
        geometry: &Geometry<'_>,
        form: Form,
        vertices: &Vertices,
    ) -> Result<(), Fault> {
        let Some(boundaries) = geometry.boundaries else { return Ok(()) };
        let place = place_of(self.text, boundaries.get());
        let mut shape = std::mem::take(&mut self.shape);
        shape.read(boundaries.get(), place, form, vertices.count)?;
        let (kinds, misfits) = kinds_of(geometry.semantics.as_ref(), &shape, form.depth());
        self.skip("values of semantics that fit no surface", misfits, object);
        let added = self.add_shape(object, &shape, form, geometry.lod(), &kinds, vertices.first);
        self.shape = shape;
        added.ok_or_else(|| Fault::at(place, CityJsonProblem::TooMany))
    }

    fn add_instance(
        &mut self,
        object: u32,
        geometry: &Geometry<'_>,
        vertices: &Vertices,
        templates: &[Option<Template>],
    ) -> Result<(), Fault> {
        let place = geometry.boundaries.or(geometry.matrix).map_or(0, |part| place_of(self.text, part.get()));
        let at = geometry.template.ok_or_else(|| Fault::at(place, CityJsonProblem::Missing { what: "`template`" }))?;
        let known = usize::try_from(at).ok().and_then(|at| templates.get(at));
        let template = known.ok_or_else(|| {
            let (what, count) = ("templates", templates.len());
            Fault::at(place, CityJsonProblem::IndexOutOfRange { what, index: at.to_string(), count })
        })?;
        let Some(template) = template else {
            self.skip("points and lines", 1, object);
            return Ok(());
        };
        let about = self.file.positions[vertices.first + self.place_of_instance(geometry, vertices)? as usize];
        let placement = Placement::read(self.text, geometry.matrix)?;
        self.instanced = self.instanced.saturating_add(template.size());
        let bytes = self.text.len();
        let limit = bytes.saturating_mul(ELEMENTS_PER_BYTE).clamp(ELEMENTS_ALLOWED.0, ELEMENTS_ALLOWED.1);
        if self.instanced > limit {
            return Err(Fault::at(place, CityJsonProblem::TooLarge { limit, bytes }));
        }
        let first = self.file.positions.len();
        for &point in &template.positions {
            let put = placement.put(point, about);
            if let Some(found) = put.iter().find(|value| value.is_nan() || value.abs() > COORDINATE_LIMIT) {
                let problem = CityJsonProblem::OutOfReach { found: found.to_string(), limit: COORDINATE_LIMIT };
                return Err(Fault::at(place, problem));
            }
            self.file.positions.push(put);
        }
        let lod = geometry.lod().or(template.lod);
        let added = self.add_shape(object, &template.shape, template.form, lod, &template.kinds, first);
        added.ok_or_else(|| Fault::at(place, CityJsonProblem::TooMany))
    }

    /// The one index in the boundaries of an instance.
    fn place_of_instance(&self, geometry: &Geometry<'_>, vertices: &Vertices) -> Result<u32, Fault> {
        let missing =
            || CityJsonProblem::Missing { what: "the place of a GeometryInstance (one index in `boundaries`)" };
        let boundaries = geometry.boundaries.ok_or_else(|| Fault::at(0, missing()))?.get();
        let byte = place_of(self.text, boundaries);
        let mut nest = Nest::new(boundaries);
        while let Some((at, token)) = nest.next() {
            if let Token::Leaf(leaf) = token {
                return corner(leaf, vertices.count).map_err(|problem| Fault::at(byte + at, problem));
            }
        }
        Err(Fault::at(byte, missing()))
    }

    /// Adds the surfaces of a shape whose corners count from the position `first`; `None` where there are too many to count.
    fn add_shape(
        &mut self,
        object: u32,
        shape: &Shape,
        form: Form,
        lod: Option<Lod>,
        kinds: &[Option<SurfaceKind>],
        first: usize,
    ) -> Option<()> {
        u32::try_from(self.file.positions.len()).ok()?;
        u32::try_from(self.file.corners.len() + shape.corners.len()).ok()?;
        let (first_corner, first_ring) = (self.file.corners.len() as u32, self.file.ring_ends.len() as u32);
        self.file.corners.extend(shape.corners.iter().map(|corner| first as u32 + corner));
        self.file.ring_ends.extend(shape.ring_ends.iter().map(|end| first_corner + end));
        let shells = self.shells_of(shape, form);
        let mut rings_before = 0;
        let mut without_ring = 0;
        for (surface, &ring_end) in shape.surface_ends.iter().enumerate() {
            let ring_count = ring_end - rings_before;
            let (lod, kind, shell) = (lod, kinds[surface], shells[surface]);
            if ring_count > 0 {
                let first_ring = first_ring + rings_before;
                self.file.surfaces.push(SurfaceRecord { object, first_ring, ring_count, lod, kind, shell });
            } else {
                without_ring += 1;
            }
            rings_before = ring_end;
        }
        self.skip("surfaces without a ring", without_ring, object);
        Some(())
    }

    /// The closed shell of each surface: the outer ones of solids. Cavities would tell the order of axes the wrong way round.
    fn shells_of(&mut self, shape: &Shape, form: Form) -> Vec<Option<u32>> {
        let mut shells = vec![None; shape.surface_ends.len()];
        if form == Form::Surfaces {
            return shells;
        }
        let mut shells_before = 0;
        for &shell_end in &shape.solid_ends {
            let outer = shells_before as usize;
            if shell_end > shells_before {
                let start = if outer == 0 { 0 } else { shape.shell_ends[outer - 1] } as usize;
                shells[start..shape.shell_ends[outer] as usize].fill(Some(self.shells));
                self.shells = self.shells.saturating_add(1);
            }
            shells_before = shell_end;
        }
        shells
    }
}
