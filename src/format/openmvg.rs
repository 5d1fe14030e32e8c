//! Reconstructions of OpenMVG: `sfm_data.json`, as cereal writes it: maps as lists of key and value, pointers with a name of
//! their class the first time it appears (<https://openmvg.readthedocs.io>).

use std::collections::HashMap;
use std::path::Path;

use serde::Deserialize;

use super::sfm_file::{SfmFileError, json_of};

#[derive(Clone, Debug, Default, Deserialize)]
pub struct OpenMvgModel {
    pub views: Vec<Keyed<Pointer<OpenMvgView>>>,
    #[serde(default)]
    pub intrinsics: Vec<Keyed<Pointer<OpenMvgIntrinsic>>>,
    #[serde(default)]
    pub extrinsics: Vec<Keyed<OpenMvgPose>>,
    #[serde(default)]
    pub structure: Vec<Keyed<OpenMvgLandmark>>,
}

/// An entry of a map.
#[derive(Clone, Debug, Deserialize)]
pub struct Keyed<T> {
    pub key: u32,
    pub value: T,
}

/// What a pointer to an object of a class points to.
#[derive(Clone, Debug, Deserialize)]
pub struct Pointer<T> {
    #[serde(default)]
    polymorphic_id: u32,
    polymorphic_name: Option<String>,
    ptr_wrapper: Wrapper<T>,
}

#[derive(Clone, Debug, Deserialize)]
struct Wrapper<T> {
    data: T,
}

#[derive(Clone, Debug, Deserialize)]
pub struct OpenMvgView {
    #[serde(default)]
    pub local_path: String,
    pub filename: String,
    pub id_intrinsic: u32,
    pub id_pose: u32,
}

/// The numbers of a camera, whatever its class.
#[derive(Clone, Debug, Deserialize)]
pub struct OpenMvgIntrinsic {
    width: Option<u64>,
    height: Option<u64>,
    /// Where classes without a focal length keep their size.
    value0: Option<Size>,
    #[serde(default)]
    pub focal_length: f64,
    #[serde(default)]
    pub principal_point: [f64; 2],
    pub disto_k1: Option<Vec<f64>>,
    pub disto_k3: Option<Vec<f64>>,
    pub disto_t2: Option<Vec<f64>>,
    pub fisheye: Option<Vec<f64>>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
struct Size {
    width: u64,
    height: u64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub struct OpenMvgPose {
    /// World to camera, row by row.
    pub rotation: [[f64; 3]; 3],
    pub center: [f64; 3],
}

#[derive(Clone, Debug, Deserialize)]
pub struct OpenMvgLandmark {
    #[serde(rename = "X")]
    pub position: [f64; 3],
    #[serde(default)]
    pub observations: Vec<Keyed<OpenMvgObservation>>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub struct OpenMvgObservation {
    /// Pixels right and down from the corner.
    pub x: [f64; 2],
}

impl<T> Pointer<T> {
    pub fn data(&self) -> &T {
        &self.ptr_wrapper.data
    }
}

impl OpenMvgIntrinsic {
    /// Width and height, pixels.
    pub fn size(&self) -> Option<(u64, u64)> {
        self.width.zip(self.height).or(self.value0.map(|size| (size.width, size.height)))
    }
}

impl OpenMvgModel {
    /// The class of each intrinsic: cereal names one where it first appears, with the highest bit of its number set.
    pub fn intrinsic_classes(&self) -> Vec<&str> {
        const NAMED: u32 = 1 << 31;
        let mut names = HashMap::new();
        let mut classes = Vec::with_capacity(self.intrinsics.len());
        for Keyed { value, .. } in &self.intrinsics {
            let id = value.polymorphic_id & !NAMED;
            if let Some(name) = &value.polymorphic_name {
                names.insert(id, name.as_str());
            }
            classes.push(names.get(&id).copied().unwrap_or(""));
        }
        classes
    }
}

pub fn is_openmvg(start: &[u8]) -> bool {
    memchr::memmem::find(start, b"\"sfm_data_version\"").is_some()
}

pub fn read_openmvg(path: &Path) -> Result<OpenMvgModel, SfmFileError> {
    json_of(path, "OpenMVG's sfm_data.json")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::sfm_file::json;

    const FILE: &str = r#"{"sfm_data_version": "0.3", "root_path": "/x", "views": [{"key": 4, "value": {"polymorphic_id": 1073741824,
        "ptr_wrapper": {"id": 1, "data": {"local_path": "a", "filename": "b.jpg", "width": 8, "height": 6, "id_view": 4,
        "id_intrinsic": 0, "id_pose": 4}}}}], "intrinsics": [
        {"key": 0, "value": {"polymorphic_id": 2147483649, "polymorphic_name": "pinhole_radial_k1", "ptr_wrapper": {"id": 2,
        "data": {"width": 8, "height": 6, "focal_length": 9, "principal_point": [4, 3], "disto_k1": [0.1]}}}},
        {"key": 1, "value": {"polymorphic_id": 1, "ptr_wrapper": {"id": 3, "data": {"width": 8, "height": 6,
        "focal_length": 9, "principal_point": [4, 3], "disto_k1": [0.2]}}}},
        {"key": 2, "value": {"polymorphic_id": 2147483650, "polymorphic_name": "spherical", "ptr_wrapper": {"id": 4, "data":
        {"value0": {"width": 80, "height": 40}}}}}],
        "extrinsics": [{"key": 4, "value": {"rotation": [[1,0,0],[0,1,0],[0,0,1]], "center": [1,2,3]}}],
        "structure": [{"key": 0, "value": {"X": [0, 0, 9], "observations": [{"key": 4, "value": {"id_feat": 0, "x": [4, 3]}}]}}],
        "control_points": []}"#;

    #[test]
    fn classes_are_named_once_and_known_after() {
        let model: OpenMvgModel = json(FILE.as_bytes()).unwrap();
        assert_eq!(model.intrinsic_classes(), ["pinhole_radial_k1", "pinhole_radial_k1", "spherical"]);
        let sizes: Vec<_> = model.intrinsics.iter().map(|i| i.value.data().size()).collect();
        assert_eq!(sizes, [Some((8, 6)), Some((8, 6)), Some((80, 40))]);
        assert_eq!(model.structure[0].value.observations[0].value.x, [4.0, 3.0]);
        assert_eq!(model.views[0].value.data().local_path, "a");
    }

    #[test]
    fn cut_and_changed_files_never_panic() {
        for cut in 0..FILE.len() {
            assert!(json::<OpenMvgModel>(&FILE.as_bytes()[..cut]).is_err());
            for value in *b"\0-9]}\"x" {
                let mut changed = FILE.as_bytes().to_vec();
                changed[cut] = value;
                let _ = json::<OpenMvgModel>(&changed).map(|model| model.intrinsic_classes().len());
            }
        }
    }
}
