//! Extensions that say where a surface is, and those that hide it.

use serde::Deserialize;

use super::nodes::json_error;
use super::{GltfError, GltfProblem};

/// What of the extensions is read; nodes carry theirs themselves.
#[derive(Debug, Default)]
pub(super) struct Extensions {
    /// CESIUM_RTC: added to every coordinate.
    pub center: Option<[f64; 3]>,
    /// Whether whole numbers may be positions (KHR_mesh_quantization).
    pub is_quantized: bool,
    /// Buffers that hold nothing, and stand for what meshopt decodes.
    empty_buffers: Vec<bool>,
    used: Vec<String>,
}

/// Extensions that change how a surface looks, and not where it is, or that are read here.
const READ: [&str; 9] = [
    "KHR_materials",
    "KHR_texture",
    "EXT_texture",
    "KHR_lights",
    "EXT_structural_metadata",
    "EXT_mesh_features",
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    "CESIUM_RTC",
];

/// A surface that is packed by one of these can be read where it also stands unpacked: whether it does is seen at its buffer.
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
const DRACO: &str = "KHR_draco_mesh_compression";

const DECODE: &str = "decode it: npx @gltf-transform/cli copy IN.glb OUT.glb";

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    #[serde(default)]
    extensions_required: Vec<String>,
    #[serde(default)]
    extensions_used: Vec<String>,
    extensions: Option<OfDocument>,
    #[serde(default)]
    buffers: Vec<Buffer>,
}

#[derive(Deserialize)]
struct OfDocument {
    #[serde(rename = "CESIUM_RTC")]
    rtc: Option<Rtc>,
}

#[derive(Deserialize)]
struct Rtc {
    center: [f64; 3],
}

#[derive(Deserialize)]
struct Buffer {
    uri: Option<serde::de::IgnoredAny>,
    extensions: Option<OfBuffer>,
}

#[derive(Deserialize)]
struct OfBuffer {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    meshopt: Option<Meshopt>,
}

#[derive(Deserialize)]
struct Meshopt {
    #[serde(default)]
    fallback: bool,
}

impl Extensions {
    /// Refuses what the file cannot do without and nobody reads here.
    pub fn of(json: &[u8]) -> Result<Extensions, GltfError> {
        let document: Document = serde_json::from_slice(json).map_err(|error| json_error(&error))?;
        let Document { extensions_required, extensions_used, extensions, buffers } = document;
        let is_read = |name: &str| READ.iter().any(|read| name.starts_with(read)) || MESHOPT.contains(&name);
        if let Some(name) = extensions_required.iter().find(|name| !is_read(name)) {
            let remedy = if name == DRACO { DECODE } else { "write the file without it" };
            return Err(GltfError::at("extensionsRequired", GltfProblem::Extension { name: name.clone(), remedy }));
        }
        let is_empty = |buffer: &Buffer| {
            let meshopt = buffer.extensions.as_ref().and_then(|extensions| extensions.meshopt.as_ref());
            buffer.uri.is_none() && meshopt.is_some_and(|meshopt| meshopt.fallback)
        };
        let used: Vec<String> = extensions_used.into_iter().chain(extensions_required).collect();
        Ok(Extensions {
            center: extensions.and_then(|extensions| extensions.rtc).map(|rtc| rtc.center),
            is_quantized: used.iter().any(|name| name == "KHR_mesh_quantization"),
            empty_buffers: buffers.iter().map(is_empty).collect(),
            used,
        })
    }

    /// Says that a buffer's content is packed, where nothing else of it is there.
    pub fn check_buffer(&self, index: usize) -> Result<(), GltfError> {
        if self.empty_buffers.get(index) != Some(&true) {
            return Ok(());
        }
        let name = self.used.iter().find(|name| MESHOPT.contains(&name.as_str()));
        Err(packed(format!("buffers[{index}]"), name.map_or(MESHOPT[0], String::as_str)))
    }

    /// Says why an accessor has no bytes, where packing is the reason.
    pub fn check_accessor(&self, place: &str) -> Result<(), GltfError> {
        if self.used.iter().any(|name| name == DRACO) {
            return Err(packed(place.to_owned(), DRACO));
        }
        Ok(())
    }
}

fn packed(place: String, name: &str) -> GltfError {
    GltfError::at(place, GltfProblem::Extension { name: name.to_owned(), remedy: DECODE })
}
