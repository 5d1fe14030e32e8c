//! Cameras of nerfstudio and instant-ngp: `transforms.json`
//! (<https://docs.nerf.studio/quickstart/data_conventions.html>), as it stands.

use std::path::Path;

use serde::Deserialize;

use super::sfm_file::{SfmFileError, json_of};

#[derive(Clone, Debug, Default, Deserialize)]
pub struct NerfstudioModel {
    #[serde(flatten)]
    pub shared: NerfstudioCamera,
    pub frames: Vec<NerfstudioFrame>,
    /// What turned the world of the reconstruction into this one: three rows, or four.
    pub applied_transform: Option<Vec<[f64; 4]>>,
    /// ... and was multiplied by after it.
    pub applied_scale: Option<f64>,
    pub ply_file_path: Option<String>,
}

/// The numbers of a camera; those of a frame go before those of all.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
pub struct NerfstudioCamera {
    pub camera_model: Option<String>,
    pub is_fisheye: Option<bool>,
    pub w: Option<f64>,
    pub h: Option<f64>,
    pub fl_x: Option<f64>,
    pub fl_y: Option<f64>,
    pub cx: Option<f64>,
    pub cy: Option<f64>,
    /// Field of view in radians, in place of the focal length.
    pub camera_angle_x: Option<f64>,
    pub k1: Option<f64>,
    pub k2: Option<f64>,
    pub k3: Option<f64>,
    pub k4: Option<f64>,
    pub p1: Option<f64>,
    pub p2: Option<f64>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct NerfstudioFrame {
    pub file_path: String,
    /// Camera to world, row by row; x right, y up, z back.
    pub transform_matrix: Vec<[f64; 4]>,
    #[serde(flatten)]
    pub own: NerfstudioCamera,
}

impl NerfstudioCamera {
    /// This camera where it says something, another where it does not.
    pub fn or(&self, other: &NerfstudioCamera) -> NerfstudioCamera {
        NerfstudioCamera {
            camera_model: self.camera_model.clone().or_else(|| other.camera_model.clone()),
            is_fisheye: self.is_fisheye.or(other.is_fisheye),
            w: self.w.or(other.w),
            h: self.h.or(other.h),
            fl_x: self.fl_x.or(other.fl_x),
            fl_y: self.fl_y.or(other.fl_y),
            cx: self.cx.or(other.cx),
            cy: self.cy.or(other.cy),
            camera_angle_x: self.camera_angle_x.or(other.camera_angle_x),
            k1: self.k1.or(other.k1),
            k2: self.k2.or(other.k2),
            k3: self.k3.or(other.k3),
            k4: self.k4.or(other.k4),
            p1: self.p1.or(other.p1),
            p2: self.p2.or(other.p2),
        }
    }
}

pub fn is_nerfstudio(start: &[u8]) -> bool {
    ["\"frames\"", "\"transform_matrix\""].iter().all(|key| memchr::memmem::find(start, key.as_bytes()).is_some())
}

pub fn read_nerfstudio(path: &Path) -> Result<NerfstudioModel, SfmFileError> {
    json_of(path, "nerfstudio's transforms.json")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::sfm_file::json;

    const FILE: &str = r#"{"w": 960, "h": 720, "fl_x": 700.5, "camera_model": "OPENCV", "k1": 0.1, "applied_transform":
        [[1,0,0,0],[0,0,1,0],[0,-1,0,0]], "frames": [{"file_path": "images/a.jpg", "transform_matrix":
        [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]], "fl_x": 800, "colmap_im_id": 1}]}"#;

    #[test]
    fn numbers_of_a_frame_go_before_those_of_all() {
        let model: NerfstudioModel = json(FILE.as_bytes()).unwrap();
        let camera = model.frames[0].own.or(&model.shared);
        assert_eq!((camera.fl_x, camera.w, camera.k1), (Some(800.0), Some(960.0), Some(0.1)));
        assert_eq!(model.frames[0].transform_matrix[1][3], 2.0);
        assert!(is_nerfstudio(FILE.as_bytes()) && !is_nerfstudio(b"{\"frames\": []}"));
    }

    #[test]
    fn cut_and_changed_files_never_panic() {
        for cut in 0..FILE.len() {
            assert!(json::<NerfstudioModel>(&FILE.as_bytes()[..cut]).is_err());
            for value in *b"\0-9]}\"x" {
                let mut changed = FILE.as_bytes().to_vec();
                changed[cut] = value;
                let _ = json::<NerfstudioModel>(&changed);
            }
        }
    }
}
