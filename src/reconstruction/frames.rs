//! What rigs and frames say of the images' poses.

use nalgebra::{Isometry3, Translation3};

use super::ReconstructionError;
use super::checker::Checker;
use super::ids::IdIndex;
use super::transform::unit_quaternion;
use crate::format::colmap::{FrameRecord, PoseRecord, RigRecord, SENSOR_CAMERA, SensorRecord};

/// How far (radians, and share of the translation's length) an image's pose may be from its frame's and still count as
/// the same: text of few digits.
const POSE_TOLERANCE: f64 = 1e-5;

/// Looks up the poses of images by rigs and frames; empty for models without them.
pub(super) struct FramePoses<'a> {
    rigs: &'a [RigRecord],
    frames: &'a [FrameRecord],
    rig_index: IdIndex,
    frame_of_image: IdIndex,
    /// Frame and place within its data, by the values of `frame_of_image`.
    data: Vec<(usize, usize)>,
}

impl<'a> FramePoses<'a> {
    /// Checks rigs and frames on the way: ids, finite poses, frames of known rigs.
    pub(super) fn new(
        check: &Checker,
        rigs: Option<&'a [RigRecord]>,
        frames: Option<&'a [FrameRecord]>,
    ) -> Result<FramePoses<'a>, ReconstructionError> {
        let (rigs, frames) = (rigs.unwrap_or_default(), frames.unwrap_or_default());
        let rig_index = check.index("rigs", "rig", rigs.iter().map(|r| r.id.into()))?;
        check.index("frames", "frame", frames.iter().map(|f| f.id.into()))?;
        for rig in rigs {
            for pose in rig.others.iter().filter_map(|(_, pose)| pose.as_ref()) {
                check.check_pose("rigs", || format!("rig {}", rig.id), pose)?;
            }
        }
        let mut data = Vec::new();
        for (number, frame) in frames.iter().enumerate() {
            let object = || format!("frame {}", frame.id);
            check.check_pose("frames", object, &frame.rig_from_world)?;
            if rig_index.get(frame.rig_id.into()).is_none() {
                return Err(check.fault("frames", object(), "a rig of the model", format!("rig {}", frame.rig_id)));
            }
            let images = frame.data.iter().enumerate().filter(|(_, (sensor, _))| sensor.kind == SENSOR_CAMERA);
            data.extend(images.map(|(place, _)| (number, place)));
        }
        let image_ids: Vec<u64> = data.iter().map(|(number, place)| frames[*number].data[*place].1).collect();
        let frame_of_image = check.index("frames", "data id", image_ids.into_iter())?;
        Ok(FramePoses { rigs, frames, rig_index, frame_of_image, data })
    }

    /// The pose that an image's frame gives it, if that is another than its own.
    pub(super) fn contradicting(&self, own: &PoseRecord, image_id: u32, camera_id: u32) -> Option<PoseRecord> {
        let (number, place) = self.data[self.frame_of_image.get(image_id.into())? as usize];
        let frame = &self.frames[number];
        let sensor = frame.data[place].0;
        let rig = &self.rigs[self.rig_index.get(frame.rig_id.into())? as usize];
        let expected = pose_by_rig(rig, sensor, frame)?;
        let (own, by_frame) = (isometry(own), isometry(&expected));
        let apart = (own.translation.vector - by_frame.translation.vector).norm();
        let is_same = own.rotation.angle_to(&by_frame.rotation) <= POSE_TOLERANCE
            && apart <= POSE_TOLERANCE * (1.0 + own.translation.vector.norm());
        (!is_same && sensor.id == camera_id).then_some(expected)
    }
}

/// `cam_from_world = cam_from_rig * rig_from_world`; `None` where the rig's calibration is not known.
fn pose_by_rig(rig: &RigRecord, sensor: SensorRecord, frame: &FrameRecord) -> Option<PoseRecord> {
    if rig.reference == Some(sensor) {
        return Some(frame.rig_from_world);
    }
    let cam_from_rig = rig.others.iter().find(|(other, _)| *other == sensor)?.1?;
    let product = isometry(&cam_from_rig) * isometry(&frame.rig_from_world);
    let q = product.rotation;
    Some(PoseRecord { quaternion_wxyz: [q.w, q.i, q.j, q.k], translation: product.translation.vector.into() })
}

fn isometry(pose: &PoseRecord) -> Isometry3<f64> {
    // Checked before: every pose has a direction.
    let rotation = unit_quaternion(&pose.quaternion_wxyz).unwrap_or_default();
    Isometry3::from_parts(Translation3::from(pose.translation), rotation)
}
