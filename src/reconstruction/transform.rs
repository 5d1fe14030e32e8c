//! Moves a reconstruction into another frame, and turns poses between their forms.

use nalgebra::{Quaternion, UnitQuaternion};

use super::{Image, Reconstruction};
use crate::format::colmap::{PoseRecord, RigRecord};
use crate::geometry::{Rotation3, Similarity, Vector3};

impl Reconstruction {
    /// The same reconstruction in the frame `city`: points, normals, poses of images and frames; the distances within
    /// rigs are scaled. Keypoints, tracks and calibrations stay.
    pub fn transformed(&self, city_from_sfm: &Similarity) -> Reconstruction {
        let mut moved = self.clone();
        moved.transform(city_from_sfm);
        moved
    }

    /// [`Reconstruction::transformed`] in place.
    pub fn transform(&mut self, city_from_sfm: &Similarity) {
        for point in &mut self.points {
            *point = city_from_sfm.apply(point);
        }
        for normal in &mut self.normals {
            *normal = city_from_sfm.rotation * *normal;
        }
        for image in &mut self.images {
            image.set_pose(&pose_in_city(&image.pose(), city_from_sfm));
        }
        if let Some(colmap) = &mut self.colmap {
            for frame in colmap.frames.iter_mut().flatten() {
                frame.rig_from_world = pose_in_city(&frame.rig_from_world, city_from_sfm);
            }
            colmap.rigs.iter_mut().flatten().for_each(|rig| scale_rig(rig, city_from_sfm.scale));
        }
    }

    /// What depends on the frame: points, poses, rigs and frames, and the cameras, but neither keypoints nor tracks, which are
    /// most of a reconstruction.
    pub fn skeleton(&self) -> Reconstruction {
        let pose = |image: &Image| Image { name: image.name.clone(), observations: Vec::new(), ..*image };
        Reconstruction {
            cameras: self.cameras.clone(),
            camera_ids: self.camera_ids.clone(),
            images: self.images.iter().map(pose).collect(),
            points: self.points.clone(),
            colmap: self.colmap.clone(),
            ..Reconstruction::default()
        }
    }
}

impl Image {
    /// The pose as files hold it; the quaternion that was read, to the bit, while the rotation is the one that was
    /// read.
    pub fn pose(&self) -> PoseRecord {
        let kept = self.quaternion_wxyz.filter(|q| rotation_of(q) == Some(self.cam_from_sfm_rotation));
        let quaternion_wxyz = kept.unwrap_or_else(|| quaternion_of(&self.cam_from_sfm_rotation));
        PoseRecord { quaternion_wxyz, translation: self.cam_from_sfm_translation.into() }
    }

    /// Sets rotation and translation; a quaternion without direction leaves the rotation as it is.
    pub fn set_pose(&mut self, pose: &PoseRecord) {
        if let Some(rotation) = rotation_of(&pose.quaternion_wxyz) {
            self.cam_from_sfm_rotation = rotation;
            self.quaternion_wxyz = Some(pose.quaternion_wxyz);
        }
        self.cam_from_sfm_translation = pose.translation.into();
    }
}

/// Lengths of quaternions below this have no direction that could be told from rounding.
const LEAST_QUATERNION: f64 = 1e-9;

/// Up to here the sum of four squares is far from overflowing.
const LARGEST_QUATERNION: f64 = 1e100;

/// A quaternion of any length made one of unit length; `None` where it is zero or not finite.
pub(super) fn unit_quaternion(quaternion_wxyz: &[f64; 4]) -> Option<UnitQuaternion<f64>> {
    let largest = quaternion_wxyz.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
    let is_finite = quaternion_wxyz.iter().all(|v| v.is_finite());
    // The squares of the largest numbers would overflow, so that quaternions are brought to about one first. Those of about
    // one are left as they are: their bits stand in files.
    let unit = if largest < LARGEST_QUATERNION { 1.0 } else { largest };
    let [w, x, y, z] = quaternion_wxyz.map(|v| v / unit);
    if is_finite { UnitQuaternion::try_new(Quaternion::new(w, x, y, z), LEAST_QUATERNION) } else { None }
}

/// The rotation of a quaternion of any length; `None` where it is zero or not finite.
pub(super) fn rotation_of(quaternion_wxyz: &[f64; 4]) -> Option<Rotation3<f64>> {
    unit_quaternion(quaternion_wxyz).map(|unit| unit.to_rotation_matrix())
}

fn quaternion_of(rotation: &Rotation3<f64>) -> [f64; 4] {
    let q = UnitQuaternion::from_rotation_matrix(rotation);
    [q.w, q.i, q.j, q.k]
}

/// With `x_city = s R x_sfm + t`, a camera's frame grows by s too, so that its axes stay orthonormal:
/// `x_cam' = R_cam R^T x_city + (s t_cam - R_cam R^T t)`.
fn pose_in_city(cam_from_sfm: &PoseRecord, city_from_sfm: &Similarity) -> PoseRecord {
    // Reading has refused quaternions without direction.
    let cam_from_sfm_rotation = unit_quaternion(&cam_from_sfm.quaternion_wxyz).unwrap_or_default();
    let city_from_sfm_rotation = UnitQuaternion::from_rotation_matrix(&city_from_sfm.rotation);
    let q = cam_from_sfm_rotation * city_from_sfm_rotation.inverse();
    let translation = city_from_sfm.scale * Vector3::from(cam_from_sfm.translation) - q * city_from_sfm.translation;
    PoseRecord { quaternion_wxyz: [q.w, q.i, q.j, q.k], translation: translation.into() }
}

fn scale_rig(rig: &mut RigRecord, scale: f64) {
    for pose in rig.others.iter_mut().filter_map(|(_, pose)| pose.as_mut()) {
        pose.translation = pose.translation.map(|v| scale * v);
    }
}

#[cfg(test)]
mod tests;
