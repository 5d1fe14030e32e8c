//! One block of the model: objects, vertices, facets with their rings and triangles.
//!
//! Counts first, then one list after the other; rings, corners and triangles of all facets one after the other. Numbers of objects and
//! vertices count within the block.

use zerocopy::little_endian::U32;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

use super::fault::IndexFault;
use super::records::{BlockCounts, FacetRecord, ObjectRecord, VertexRecord};

/// A block that was read and whose numbers lead nowhere outside it.
pub struct Block<'a> {
    pub objects: &'a [ObjectRecord],
    /// Names of all objects, without anything between them.
    pub names: &'a str,
    pub vertices: &'a [VertexRecord],
    pub facets: &'a [FacetRecord],
    /// Corners of each ring.
    pub ring_lengths: &'a [U32],
    pub corners: &'a [U32],
    pub triangles: &'a [[U32; 3]],
}

/// A block in the making.
#[derive(Clone, Debug, Default)]
pub struct BlockParts {
    pub objects: Vec<ObjectRecord>,
    pub names: String,
    pub vertices: Vec<VertexRecord>,
    pub facets: Vec<FacetRecord>,
    pub ring_lengths: Vec<U32>,
    pub corners: Vec<U32>,
    pub triangles: Vec<[U32; 3]>,
}

impl BlockParts {
    pub fn to_bytes(&self) -> Result<Vec<u8>, IndexFault> {
        let count = |length: usize, what| match u32::try_from(length) {
            Ok(count) => Ok(U32::new(count)),
            Err(_) => Err(IndexFault::TooLarge { what }),
        };
        let counts = BlockCounts {
            objects: count(self.objects.len(), "objects of a block")?,
            name_bytes: count(self.names.len(), "names of a block")?,
            vertices: count(self.vertices.len(), "vertices of a block")?,
            facets: count(self.facets.len(), "facets of a block")?,
            rings: count(self.ring_lengths.len(), "rings of a block")?,
            corners: count(self.corners.len(), "corners of a block")?,
            triangles: count(self.triangles.len(), "triangles of a block")?,
        };
        let lists = [
            counts.as_bytes(),
            self.objects.as_bytes(),
            self.names.as_bytes(),
            self.vertices.as_bytes(),
            self.facets.as_bytes(),
            self.ring_lengths.as_bytes(),
            self.corners.as_bytes(),
            self.triangles.as_bytes(),
        ];
        Ok(lists.concat())
    }
}

impl<'a> Block<'a> {
    /// Takes a block out of bytes of the file, whose first is at `at`.
    pub fn read(bytes: &'a [u8], at: u64) -> Result<Block<'a>, IndexFault> {
        let nonsense = |found: &str| IndexFault::Nonsense { what: "a block", at, found: found.to_owned() };
        let (counts, mut rest) = BlockCounts::ref_from_prefix(bytes).map_err(|_| nonsense("it is too short"))?;
        let block = Block {
            objects: taken(&mut rest, counts.objects, at)?,
            names: std::str::from_utf8(taken(&mut rest, counts.name_bytes, at)?)
                .map_err(|_| nonsense("a name is no UTF-8"))?,
            vertices: taken(&mut rest, counts.vertices, at)?,
            facets: taken(&mut rest, counts.facets, at)?,
            ring_lengths: taken(&mut rest, counts.rings, at)?,
            corners: taken(&mut rest, counts.corners, at)?,
            triangles: taken(&mut rest, counts.triangles, at)?,
        };
        match block.contradiction().or_else(|| (!rest.is_empty()).then_some("it is longer than what is in it")) {
            Some(found) => Err(nonsense(found)),
            None => Ok(block),
        }
    }

    /// The name of each object.
    pub fn object_names(&self) -> impl Iterator<Item = &'a str> {
        let (mut at, names) = (0, self.names);
        self.objects.iter().map(move |object| {
            let start = at;
            at += object.name_length.get() as usize;
            names.get(start..at).unwrap_or_default()
        })
    }

    fn contradiction(&self) -> Option<&'static str> {
        let sum = |lengths: &mut dyn Iterator<Item = U32>| lengths.map(|length| u64::from(length.get())).sum::<u64>();
        let is_finite = |values: &[zerocopy::little_endian::F64]| values.iter().all(|value| value.get().is_finite());
        let (objects, vertices) = (self.objects.len() as u32, self.vertices.len() as u32);
        let is_vertex = |number: &U32| number.get() < vertices;
        let facets = || self.facets.iter();
        let mut names_end = 0_usize;
        let tells_names = self.objects.iter().all(|object| {
            names_end = names_end.saturating_add(object.name_length.get() as usize);
            self.names.is_char_boundary(names_end)
        });
        let checks = [
            (tells_names && names_end == self.names.len(), "names end elsewhere"),
            (sum(&mut facets().map(|f| f.rings)) == self.ring_lengths.len() as u64, "rings are of no facet"),
            (sum(&mut self.ring_lengths.iter().copied()) == self.corners.len() as u64, "corners are of no ring"),
            (sum(&mut facets().map(|f| f.triangles)) == self.triangles.len() as u64, "triangles are of no facet"),
            (facets().all(|f| f.rings.get() > 0), "a facet has no outline"),
            (self.ring_lengths.iter().all(|length| length.get() >= 3), "a ring has less than three corners"),
            (facets().all(|f| f.object.get() < objects), "a facet is of no object"),
            (self.corners.iter().all(is_vertex), "a corner is at no vertex"),
            (self.triangles.iter().flatten().all(is_vertex), "a triangle is at no vertex"),
            (self.vertices.iter().all(|v| is_finite(&v.position)), "a vertex is nowhere"),
            (facets().all(|f| is_finite(&f.normal) && is_finite(&[f.offset, f.area])), "a facet is in no plane"),
        ];
        checks.into_iter().find(|(holds, _)| !holds).map(|(_, found)| found)
    }
}

/// Takes a list off the bytes that are left; there is no more of it than there are bytes.
fn taken<'a, T: FromBytes + KnownLayout + Immutable>(
    rest: &mut &'a [u8],
    count: U32,
    at: u64,
) -> Result<&'a [T], IndexFault>
where
    [T]: KnownLayout<PointerMetadata = usize>,
{
    let (list, after) = <[T]>::ref_from_prefix_with_elems(rest, count.get() as usize).map_err(|_| {
        let found = format!("a list of {count} in {} bytes", rest.len());
        IndexFault::Nonsense { what: "a block", at, found }
    })?;
    *rest = after;
    Ok(list)
}
