//! EXT_mesh_gpu_instancing: a node that shows its mesh many times.

use gltf::json::accessor::{ComponentType, Type};
use serde::Deserialize;

use super::accessor::Values;
use super::buffers::Buffers;
use super::check::{self, Expected};
use super::nodes::{Affine, affine_of};
use super::{GltfError, GltfProblem};

/// Accessors of where the instances stand, in the node's frame; each may be missing.
#[derive(Debug, Deserialize)]
pub(super) struct Instancing {
    attributes: Attributes,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Attributes {
    translation: Option<u32>,
    rotation: Option<u32>,
    scale: Option<u32>,
}

const VECTORS: Expected =
    Expected { kind: Type::Vec3, components: &[ComponentType::F32], words: "three 32-bit floats (VEC3, FLOAT)" };

const ROTATIONS: Expected = Expected {
    kind: Type::Vec4,
    components: &[ComponentType::F32, ComponentType::I8, ComponentType::I16],
    words: "four floats or signed whole numbers (VEC4)",
};

impl Instancing {
    fn accessors(&self) -> [(Option<u32>, &'static Expected); 3] {
        let Attributes { translation, rotation, scale } = self.attributes;
        [(translation, &VECTORS), (rotation, &ROTATIONS), (scale, &VECTORS)]
    }

    /// Checks the accessors; returns how many instances there are.
    pub fn check(&self, root: &gltf::json::Root, buffers: &mut Buffers<'_>) -> Result<usize, GltfError> {
        let mut count = None;
        for (accessor, expected) in self.accessors() {
            let Some(accessor) = accessor else { continue };
            let found = check::accessor_of(root, accessor as usize, expected, buffers)?;
            if count.is_some_and(|count| count != found) {
                let what = format!("{found} instances here, and another number in the accessor before");
                return Err(GltfError::at(format!("accessors[{accessor}]"), GltfProblem::Invalid { what }));
            }
            count = Some(found);
        }
        count.ok_or_else(|| {
            GltfError::at(
                "EXT_mesh_gpu_instancing",
                GltfProblem::Invalid { what: "no attribute says where instances stand".to_owned() },
            )
        })
    }

    /// Where the instances stand in the node's frame. To be called after the check.
    pub fn places(
        &self,
        root: &gltf::json::Root,
        buffers: &Buffers<'_>,
        count: usize,
    ) -> Result<Vec<Affine>, GltfError> {
        let Attributes { translation, rotation, scale } = self.attributes;
        let mut translations = translation.map(|at| Values::<3>::of(root, at as usize, buffers)).transpose()?;
        let mut rotations = rotation.map(|at| Values::<4>::of(root, at as usize, buffers)).transpose()?;
        let mut scales = scale.map(|at| Values::<3>::of(root, at as usize, buffers)).transpose()?;
        let place = |_| {
            let translation = translations.as_mut().and_then(Iterator::next).unwrap_or_default();
            let rotation = rotations.as_mut().and_then(Iterator::next).unwrap_or([0.0, 0.0, 0.0, 1.0]);
            let scale = scales.as_mut().and_then(Iterator::next).unwrap_or([1.0; 3]);
            affine_of(translation, rotation, scale).map_err(|problem| GltfError::at("EXT_mesh_gpu_instancing", problem))
        };
        (0..count).map(place).collect()
    }
}
