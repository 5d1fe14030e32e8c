//! Puts a [`SurfaceFile`] together: rings, surfaces, objects, and what was passed over.

use super::surface_error::SurfaceError;
use super::surfaces::{Lod, ObjectRecord, Skipped, SurfaceFile, SurfaceKind, SurfaceRecord};

/// A file in the making.
#[derive(Debug, Default)]
pub(super) struct SurfaceBuilder {
    pub file: SurfaceFile,
}

/// What is said of a surface besides its rings.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SurfaceTraits {
    pub object: u32,
    pub lod: Option<Lod>,
    pub kind: Option<SurfaceKind>,
    pub shell: Option<u32>,
}

impl SurfaceBuilder {
    /// Adds a polygon: its outline and its holes, each as a list of points of its own. They come to lie in `positions` one
    /// after the other, none is shared.
    pub fn add_surface<'r>(
        &mut self,
        rings: impl IntoIterator<Item = &'r [[f64; 3]]>,
        traits: SurfaceTraits,
    ) -> Result<(), SurfaceError> {
        let first_ring = self.file.ring_ends.len() as u32;
        for ring in rings {
            let first = self.file.positions.len();
            self.file.positions.extend_from_slice(ring);
            let end = u32::try_from(self.file.positions.len()).map_err(|_| too_large())?;
            self.file.corners.extend(first as u32..end);
            self.end_ring()?;
        }
        self.end_surface(first_ring, traits);
        Ok(())
    }

    /// Adds a polygon without holes between positions that are there already.
    pub fn add_polygon(
        &mut self,
        corners: impl IntoIterator<Item = u32>,
        traits: SurfaceTraits,
    ) -> Result<(), SurfaceError> {
        let first_ring = self.file.ring_ends.len() as u32;
        self.file.corners.extend(corners);
        self.end_ring()?;
        self.end_surface(first_ring, traits);
        Ok(())
    }

    fn end_ring(&mut self) -> Result<(), SurfaceError> {
        let end = u32::try_from(self.file.corners.len()).map_err(|_| too_large())?;
        self.file.ring_ends.push(end);
        Ok(())
    }

    fn end_surface(&mut self, first_ring: u32, SurfaceTraits { object, lod, kind, shell }: SurfaceTraits) {
        let ring_count = self.file.ring_ends.len() as u32 - first_ring;
        self.file.surfaces.push(SurfaceRecord { object, first_ring, ring_count, lod, kind, shell });
    }

    /// Adds an object and returns its number.
    pub fn add_object(&mut self, id: String, class: &str, parent: Option<u32>) -> u32 {
        self.file.objects.push(ObjectRecord { id, class: class.to_owned(), parent });
        self.file.objects.len() as u32 - 1
    }

    pub fn surface_count(&self) -> u32 {
        self.file.surfaces.len() as u32
    }

    /// Counts what is passed over, each kind once; asks for the object only when the kind is new.
    pub fn skip(&mut self, what: &'static str, count: usize, example: impl FnOnce() -> String) {
        match self.file.skipped.iter_mut().find(|skipped| skipped.what == what) {
            _ if count == 0 => {}
            Some(skipped) => skipped.count += count,
            None => self.file.skipped.push(Skipped { what, count, example: example() }),
        }
    }

    /// Turns a surface round: every ring the other way.
    pub fn reverse(&mut self, surface: usize) {
        let SurfaceRecord { first_ring, ring_count, .. } = self.file.surfaces[surface];
        for ring in first_ring as usize..(first_ring + ring_count) as usize {
            let start = ring.checked_sub(1).map_or(0, |before| self.file.ring_ends[before] as usize);
            self.file.corners[start..self.file.ring_ends[ring] as usize].reverse();
        }
    }

    /// Name of an object, or nothing.
    pub fn object_id(&self, object: Option<u32>) -> Option<String> {
        object.and_then(|object| self.file.objects.get(object as usize)).map(|object| object.id.clone())
    }
}

fn too_large() -> SurfaceError {
    SurfaceError::whole("more than 4 billion corners; split the model")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversed_surface_has_all_its_rings_the_other_way_and_no_others() {
        let mut builder = SurfaceBuilder::default();
        let ring = |z: f64| vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z]];
        let (outline, hole) = (ring(0.0), ring(1.0));
        for _ in 0..2 {
            builder.add_surface([&outline[..], &hole[..]], SurfaceTraits::default()).unwrap();
        }
        builder.reverse(1);
        assert_eq!(builder.file.corners, [0, 1, 2, 3, 4, 5, 8, 7, 6, 11, 10, 9]);
        assert_eq!(builder.file.ring_ends, [3, 6, 9, 12]);
    }

    #[test]
    fn what_is_passed_over_stands_once_with_the_first_example() {
        let mut builder = SurfaceBuilder::default();
        builder.skip("curves", 0, || unreachable!());
        builder.skip("curves", 2, || "first".to_owned());
        builder.skip("curves", 3, || unreachable!());
        assert_eq!(builder.file.skipped, [Skipped { what: "curves", count: 5, example: "first".to_owned() }]);
    }
}
