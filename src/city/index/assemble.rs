//! Blocks of an index to one model: the part of the city's model that they hold, in its order, counted anew.

use std::ops::Range;

use rayon::prelude::*;
use zerocopy::little_endian::U32;

use super::pack::kind_of_code;
use super::words::{VertexNumbers, Words};
use crate::city::{CityModel, Facet, ObjectId};
use crate::format::city_index::{Block, BlockSight, FacetRecord, IndexFault, OWN_VERTEX};
use crate::geometry::{Plane, Point3, Vector3};

/// A model that was put together, and what became of the blocks.
pub struct Assembled {
    pub model: CityModel,
    /// For each block the facet of the model that each of its own is.
    pub facet_of: Vec<Vec<u32>>,
    /// For each block the object of the model that each of its own is.
    pub object_of: Vec<Vec<u32>>,
}

/// Puts blocks together, with what is known of what can be seen of each.
pub(super) fn assembled(words: &Words, blocks: &[Block], sights: &[BlockSight]) -> Result<Assembled, IndexFault> {
    let sum = |of: fn(&Block) -> usize| blocks.iter().map(of).sum::<usize>();
    for (count, what) in [(sum(|b| b.vertices.len()), "vertices"), (sum(|b| b.triangles.len()), "triangles")] {
        u32::try_from(count).map_err(|_| IndexFault::TooLarge { what })?;
    }
    let mut model = CityModel {
        origin: words.origin.into(),
        crs: words.crs.clone(),
        warnings: words.warnings.clone(),
        ..CityModel::default()
    };
    let (object_of, object_orders) = add_objects(&mut model, blocks);
    let vertex_of = add_vertices(&mut model, blocks, words.vertices);
    let mut order: Vec<(u32, u32, u32)> = Vec::with_capacity(sum(|block| block.facets.len()));
    for (at, block) in (0..).zip(blocks) {
        order.extend((0..).zip(block.facets).map(|(local, facet)| (facet.order.get(), at, local)));
    }
    order.par_sort_unstable();
    let mut facet_of: Vec<Vec<u32>> = blocks.iter().map(|block| vec![0; block.facets.len()]).collect();
    let shares: Vec<Vec<Share>> = blocks.iter().map(shares).collect();
    model.triangles.reserve(sum(|block| block.triangles.len()));
    for &(_, block, local) in &order {
        let (block, local) = (block as usize, local as usize);
        facet_of[block][local] = model.facets.len() as u32;
        let taken = Taken { block: &blocks[block], objects: &object_of[block], vertices: &vertex_of[block] };
        taken.add_facet(&mut model, &taken.block.facets[local], &shares[block][local]);
        if let Some(exposed) =
            sights.get(block).and_then(|sight| sight.exposed.get(shares[block][local].triangles.clone()))
        {
            model.exposed.extend_from_slice(exposed);
        }
    }
    for source in &words.sources {
        let before = |orders: &[u32], end: u32| orders.partition_point(|&order| order < end) as u32;
        let facets = source.facets.map(|end| order.partition_point(|&(order, ..)| order < end) as u32);
        let objects = source.objects.map(|end| before(&object_orders, end));
        model.sources.push(source.source(facets[0]..facets[1], objects[0]..objects[1]));
    }
    Ok(Assembled { model, facet_of, object_of })
}

/// Objects of all blocks in their order, each once; what each became, and their orders.
fn add_objects(model: &mut CityModel, blocks: &[Block]) -> (Vec<Vec<u32>>, Vec<u32>) {
    let mut all: Vec<(u32, usize, usize, &str)> = Vec::new();
    for (at, block) in blocks.iter().enumerate() {
        let named = block.objects.iter().zip(block.object_names()).enumerate();
        all.extend(named.map(|(local, (object, name))| (object.order.get(), at, local, name)));
    }
    all.sort_unstable_by_key(|&(order, block, local, _)| (order, block, local));
    let mut object_of: Vec<Vec<u32>> = blocks.iter().map(|block| vec![0; block.objects.len()]).collect();
    let mut orders: Vec<u32> = Vec::new();
    for (order, block, local, name) in all {
        if orders.last() != Some(&order) {
            orders.push(order);
            model.objects.push(name.to_owned());
        }
        object_of[block][local] = orders.len() as u32 - 1;
    }
    (object_of, orders)
}

/// A vertex of a block, by the order of the vertex that it is joined with and its own.
type OrderedVertex = (u64, u64, u32);

/// Vertices of all blocks in their order, those that several blocks have once; what each became.
fn add_vertices(model: &mut CityModel, blocks: &[Block], numbers: VertexNumbers) -> Vec<Vec<u32>> {
    let place = |position: &[zerocopy::little_endian::F64; 3]| Point3::from(position.map(|value| value.get()));
    let positions: Vec<Point3<f64>> =
        blocks.iter().flat_map(|block| block.vertices.iter().map(|vertex| place(&vertex.position))).collect();
    let orders = blocks.iter().flat_map(|block| block.vertices.iter().map(|vertex| vertex.order.get()));
    let mut all: Vec<OrderedVertex> = orders.zip(0..).map(|(order, at)| (order, order, at)).collect();
    if numbers == VertexNumbers::ByPlace {
        join_by_place(&mut all, &positions);
    }
    all.par_sort_unstable();
    let mut vertex_of = vec![0; all.len()];
    let mut last = None;
    for (leader, _, at) in all {
        if last != Some(leader) {
            last = Some(leader);
            model.vertices.push(positions[at as usize]);
        }
        vertex_of[at as usize] = model.vertices.len() as u32 - 1;
    }
    let mut rest = &vertex_of[..];
    let taken = blocks.iter().map(|block| {
        let (own, after) = rest.split_at(block.vertices.len());
        rest = after;
        own.to_vec()
    });
    taken.collect()
}

/// Gives all vertices at one place the order of the first of them.
fn join_by_place(all: &mut [OrderedVertex], positions: &[Point3<f64>]) {
    // Adding zero turns a negative zero into the usual one, which has other bits.
    let key = |at: u32| <[f64; 3]>::from(positions[at as usize]).map(|value| (value + 0.0).to_bits());
    let joined = all.iter().filter(|vertex| vertex.0 < OWN_VERTEX);
    let mut places: Vec<([u64; 3], u64, u32)> = joined.map(|&(order, _, at)| (key(at), order, at)).collect();
    places.par_sort_unstable();
    for same in places.chunk_by(|a, b| a.0 == b.0) {
        same.iter().for_each(|&(_, _, at)| all[at as usize].0 = same[0].1);
    }
}

/// A facet's share of the lists of its block.
struct Share {
    rings: Range<usize>,
    corners: usize,
    triangles: Range<usize>,
}

fn shares(block: &Block) -> Vec<Share> {
    let (mut ring, mut corner, mut triangle) = (0, 0, 0);
    let share = |facet: &FacetRecord| {
        let rings = ring..ring + facet.rings.get() as usize;
        let triangles = triangle..triangle + facet.triangles.get() as usize;
        let own = Share { rings: rings.clone(), corners: corner, triangles: triangles.clone() };
        corner += block.ring_lengths[rings.clone()].iter().map(|length| length.get() as usize).sum::<usize>();
        (ring, triangle) = (rings.end, triangles.end);
        own
    };
    block.facets.iter().map(share).collect()
}

/// A block, and what its objects and vertices are in the model.
struct Taken<'a> {
    block: &'a Block<'a>,
    objects: &'a [u32],
    vertices: &'a [u32],
}

impl Taken<'_> {
    fn add_facet(&self, model: &mut CityModel, record: &FacetRecord, share: &Share) {
        let vertex = |number: &U32| self.vertices[number.get() as usize];
        let mut start = share.corners;
        let rings = self.block.ring_lengths[share.rings.clone()].iter().map(|length| {
            let end = start + length.get() as usize;
            let ring: Vec<u32> = self.block.corners[start..end].iter().map(vertex).collect();
            start = end;
            ring
        });
        let mut rings = rings.collect::<Vec<_>>().into_iter();
        let first = model.triangles.len() as u32;
        let triangles = &self.block.triangles[share.triangles.clone()];
        model.triangles.extend(triangles.iter().map(|triangle| [0, 1, 2].map(|k| vertex(&triangle[k]))));
        model.facets.push(Facet {
            outline: rings.next().unwrap_or_default(),
            holes: rings.collect(),
            plane: Plane { normal: Vector3::from(record.normal.map(|value| value.get())), offset: record.offset.get() },
            area: record.area.get(),
            object: ObjectId(self.objects[record.object.get() as usize]),
            kind: kind_of_code(record.kind),
            triangles: first..model.triangles.len() as u32,
        });
    }
}
