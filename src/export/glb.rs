//! One GLB file in the making: geometry goes into three shared buffer views, the tree into typed JSON.

use std::collections::BTreeMap;

use gltf_json as json;
use json::accessor::{ComponentType, GenericComponentType, Type};
use json::buffer::{Stride, Target, View};
use json::mesh::{Mode, Primitive, Semantic};
use json::validation::{Checked, USize64};
use json::{Index, Node};

/// GLB container, glTF 2.0 specification, chapter 4.
const MAGIC: u32 = 0x4654_6C67;
const VERSION: u32 = 2;
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;
const HEADER_BYTES: usize = 12;
const CHUNK_HEADER_BYTES: usize = 8;

/// Geometry whose primitives share vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometry<'a> {
    pub positions: &'a [[f32; 3]],
    /// Linear RGBA, one per position, or empty.
    pub colors: &'a [[u16; 4]],
    /// Empty where the positions are taken one after another.
    pub indices: &'a [u32],
    pub mode: Mode,
    pub material: Index<json::Material>,
}

/// A GLB under construction.
#[derive(Default)]
pub(super) struct Glb {
    root: json::Root,
    positions: Vec<u8>,
    colors: Vec<u8>,
    indices: Vec<u8>,
}

/// What a buffer view holds; an accessor names this until the views are made.
const POSITIONS: u32 = 0;
const COLORS: u32 = 1;
const INDICES: u32 = 2;

/// From where the triangles of a material are drawn.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum SeenFrom {
    Outside,
    BothSides,
}

impl Glb {
    pub fn material(&mut self, name: &str, color: [f32; 3], seen_from: SeenFrom) -> Index<json::Material> {
        self.root.push(json::Material {
            name: Some(name.into()),
            double_sided: seen_from == SeenFrom::BothSides,
            pbr_metallic_roughness: json::material::PbrMetallicRoughness {
                base_color_factor: json::material::PbrBaseColorFactor([color[0], color[1], color[2], 1.0]),
                metallic_factor: json::material::StrengthFactor(0.0),
                ..Default::default()
            },
            ..Default::default()
        })
    }

    /// A mesh of one primitive; `None` where there is nothing to see, since glTF has no empty meshes.
    pub fn mesh(&mut self, name: &str, geometry: &Geometry<'_>) -> Option<Index<json::Mesh>> {
        let drawn = if geometry.indices.is_empty() { geometry.positions.len() } else { geometry.indices.len() };
        if drawn == 0 {
            return None;
        }
        let mut attributes = BTreeMap::new();
        attributes.insert(Checked::Valid(Semantic::Positions), self.position_accessor(geometry.positions));
        if !geometry.colors.is_empty() {
            attributes.insert(Checked::Valid(Semantic::Colors(0)), self.color_accessor(geometry.colors));
        }
        let indices = (!geometry.indices.is_empty()).then(|| self.index_accessor(geometry.indices));
        let primitive = Primitive {
            attributes,
            indices,
            material: Some(geometry.material),
            mode: Checked::Valid(geometry.mode),
            extensions: None,
            extras: None,
            targets: None,
        };
        Some(self.root.push(json::Mesh {
            name: named(name),
            primitives: vec![primitive],
            weights: None,
            extensions: None,
            extras: None,
        }))
    }

    pub fn node(&mut self, name: &str, node: Node) -> Index<Node> {
        self.root.push(Node { name: named(name), ..node })
    }

    /// The whole file, with `root` as its only root node and `extras` about the asset.
    pub fn into_bytes(mut self, root: Index<Node>, extras: &serde_json::Value) -> Result<Vec<u8>, serde_json::Error> {
        self.root.asset = json::Asset {
            generator: Some(concat!("cityweld ", env!("CARGO_PKG_VERSION")).into()),
            extras: Some(serde_json::value::to_raw_value(extras)?),
            ..Default::default()
        };
        let scene = json::Scene { nodes: vec![root], name: None, extensions: None, extras: None };
        self.root.scene = Some(self.root.push(scene));
        let binary = self.push_views();
        let mut json = self.root.to_vec()?;
        json.resize(json.len().next_multiple_of(4), b' ');

        let chunks = if binary > 0 { 2 } else { 1 };
        let total = HEADER_BYTES + chunks * CHUNK_HEADER_BYTES + json.len() + binary;
        let mut bytes = Vec::with_capacity(total);
        for word in [MAGIC, VERSION, total as u32, json.len() as u32, CHUNK_JSON] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(&json);
        if binary > 0 {
            bytes.extend((binary as u32).to_le_bytes());
            bytes.extend(CHUNK_BIN.to_le_bytes());
            bytes.extend(self.positions.iter().chain(&self.colors).chain(&self.indices));
        }
        Ok(bytes)
    }

    /// Declares the buffer and those of its views that hold anything (glTF has no empty ones); returns its length.
    fn push_views(&mut self) -> usize {
        let vertex = Some(Checked::Valid(Target::ArrayBuffer));
        let index = Some(Checked::Valid(Target::ElementArrayBuffer));
        let views = [
            (self.positions.len(), vertex, Some(Stride(size_of::<[f32; 3]>()))),
            (self.colors.len(), vertex, Some(Stride(size_of::<[u16; 4]>()))),
            (self.indices.len(), index, None),
        ];
        let total = views.iter().map(|(length, ..)| length).sum::<usize>();
        if total == 0 {
            return 0;
        }
        let buffer = self.root.push(json::Buffer {
            byte_length: USize64(total as u64),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        let mut offset = 0;
        let mut numbers = [None; 3];
        for ((length, target, byte_stride), number) in views.into_iter().zip(&mut numbers) {
            if length == 0 {
                continue;
            }
            *number = Some(self.root.push(View {
                buffer,
                byte_length: USize64(length as u64),
                byte_offset: Some(USize64(offset as u64)),
                byte_stride,
                name: None,
                target,
                extensions: None,
                extras: None,
            }));
            offset += length;
        }
        for accessor in &mut self.root.accessors {
            accessor.buffer_view = accessor.buffer_view.and_then(|kind| numbers[kind.value()]);
        }
        total
    }

    fn position_accessor(&mut self, positions: &[[f32; 3]]) -> Index<json::Accessor> {
        let mut low = positions[0];
        let mut high = positions[0];
        for position in positions {
            for axis in 0..3 {
                low[axis] = low[axis].min(position[axis]);
                high[axis] = high[axis].max(position[axis]);
            }
        }
        let offset = self.positions.len();
        self.positions.extend(positions.iter().flatten().flat_map(|v| v.to_le_bytes()));
        let accessor = accessor(POSITIONS, offset, positions.len(), ComponentType::F32, Type::Vec3);
        self.root.push(json::Accessor { min: Some(low.to_vec().into()), max: Some(high.to_vec().into()), ..accessor })
    }

    fn color_accessor(&mut self, colors: &[[u16; 4]]) -> Index<json::Accessor> {
        let offset = self.colors.len();
        self.colors.extend(colors.iter().flatten().flat_map(|v| v.to_le_bytes()));
        let accessor = accessor(COLORS, offset, colors.len(), ComponentType::U16, Type::Vec4);
        self.root.push(json::Accessor { normalized: true, ..accessor })
    }

    fn index_accessor(&mut self, indices: &[u32]) -> Index<json::Accessor> {
        let offset = self.indices.len();
        self.indices.extend(indices.iter().flat_map(|v| v.to_le_bytes()));
        self.root.push(accessor(INDICES, offset, indices.len(), ComponentType::U32, Type::Scalar))
    }
}

fn accessor(kind: u32, offset: usize, count: usize, component: ComponentType, shape: Type) -> json::Accessor {
    json::Accessor {
        buffer_view: Some(Index::new(kind)),
        byte_offset: Some(USize64(offset as u64)),
        count: USize64(count as u64),
        component_type: Checked::Valid(GenericComponentType(component)),
        type_: Checked::Valid(shape),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
        extensions: None,
        extras: None,
    }
}

fn named(name: &str) -> Option<String> {
    (!name.is_empty()).then(|| name.to_owned())
}
