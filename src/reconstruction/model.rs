//! A reconstruction in memory.

use crate::format::colmap::{Encoding, FrameRecord, RigRecord};
use crate::geometry::{Camera, Point3, Rotation3, Vector3};

/// Index into [`Reconstruction::images`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ImageIndex(pub u32);

/// Index into [`Reconstruction::points`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PointIndex(pub u32);

/// Index into [`Reconstruction::cameras`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CameraIndex(pub u32);

/// Points, and where known the cameras that saw them. A PLY cloud has no images.
#[derive(Clone, Debug, Default)]
pub struct Reconstruction {
    pub cameras: Vec<Camera>,
    /// COLMAP's ids, one per camera.
    pub camera_ids: Vec<u32>,
    pub images: Vec<Image>,
    /// Sfm frame, sfm units.
    pub points: Vec<Point3<f64>>,
    /// COLMAP's ids, one per point, or empty for a PLY cloud.
    pub point_ids: Vec<u64>,
    /// Mean reprojection errors in pixels, one per point (-1 where COLMAP has not computed it), or empty.
    pub point_errors_px: Vec<f64>,
    /// One per point, or empty where the file has none.
    pub colors: Vec<[u8; 3]>,
    /// Unit normals, one per point, or empty where the file has none. Zero where the file's has no direction.
    pub normals: Vec<Vector3<f64>>,
    /// Start of each point's track in `track_elements`, one more than there are points (or empty without images).
    pub track_starts: Vec<u32>,
    /// (image, index of the observation in the image).
    pub track_elements: Vec<(ImageIndex, u32)>,
    /// What only a COLMAP model has; `None` for a PLY cloud.
    pub colmap: Option<ColmapParts>,
    /// What was tolerated on reading, each kind once.
    pub warnings: Vec<ReconstructionWarning>,
}

/// The parts of a COLMAP model that are kept for writing it again.
#[derive(Clone, Debug, PartialEq)]
pub struct ColmapParts {
    pub encoding: Encoding,
    /// `None` for a model of a release before 3.12.
    pub rigs: Option<Vec<RigRecord>>,
    /// `None` for a model of a release before 3.12.
    pub frames: Option<Vec<FrameRecord>>,
}

/// A posed photograph.
#[derive(Clone, Debug, Default)]
pub struct Image {
    /// COLMAP's id.
    pub id: u32,
    pub camera: CameraIndex,
    /// With sub-folders, `/` between them.
    pub name: String,
    pub cam_from_sfm_rotation: Rotation3<f64>,
    pub cam_from_sfm_translation: Vector3<f64>,
    /// The rotation to the bits of the file (not normalised), so that it is written again as it was; only of use while
    /// `cam_from_sfm_rotation` is the rotation that was read.
    pub quaternion_wxyz: Option<[f64; 4]>,
    /// Keypoints: pixel position (x right, y down, the centre of the first pixel is (0.5, 0.5)), and the point seen.
    pub observations: Vec<Observation>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    pub x_px: f64,
    pub y_px: f64,
    pub point: Option<PointIndex>,
}

/// Something odd that real files hold, tolerated; `count` cases, the first of them named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReconstructionWarning {
    pub kind: WarningKind,
    pub count: usize,
    pub example: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WarningKind {
    /// Keypoints name points that are not in the model; they count as keypoints without a point.
    ObservationsOfMissingPoints,
    /// A track lists a keypoint that belongs to another point or to none, or lacks one.
    TracksThatImagesContradict,
    /// Points that no track supports.
    PointsWithoutTrack,
    /// Images without any keypoint.
    ImagesWithoutObservations,
    /// An image's pose is not its frame's; the frame's is taken, as COLMAP does.
    PosesThatFramesContradict,
    /// Quaternions far from unit length; they were normalised.
    UnnormalizedQuaternions,
    /// Names that are not UTF-8; they were read as Latin-1.
    NamesNotUtf8,
    /// PLY vertices without a finite position; they were left out.
    PointsWithoutPosition,
    /// PLY normals without a direction.
    NormalsWithoutDirection,
    /// The folder holds further models.
    FurtherModels,
}

impl std::fmt::Display for ReconstructionWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let what = match self.kind {
            WarningKind::ObservationsOfMissingPoints => "keypoints of points that the model does not hold, ignored",
            WarningKind::TracksThatImagesContradict => {
                "links between keypoints and points that only images or only tracks tell"
            }
            WarningKind::PointsWithoutTrack => "points without a track",
            WarningKind::ImagesWithoutObservations => "images without keypoints",
            WarningKind::PosesThatFramesContradict => "image poses that differ from their frames', the frames' taken",
            WarningKind::UnnormalizedQuaternions => "quaternions not of unit length, normalised",
            WarningKind::NamesNotUtf8 => "names that are not UTF-8, read as Latin-1",
            WarningKind::PointsWithoutPosition => "points without a finite position, left out",
            WarningKind::NormalsWithoutDirection => "normals without a direction",
            WarningKind::FurtherModels => "further models beside the one that was read",
        };
        write!(f, "{} {what} (such as {})", self.count, self.example)
    }
}

impl Reconstruction {
    /// Who saw a point: (image, index of the observation in the image). Empty where tracks are not known.
    pub fn track(&self, p: PointIndex) -> &[(ImageIndex, u32)] {
        let index = p.0 as usize;
        match (self.track_starts.get(index), self.track_starts.get(index + 1)) {
            (Some(start), Some(end)) => &self.track_elements[*start as usize..*end as usize],
            _ => &[],
        }
    }

    /// The camera that took an image.
    pub fn camera_of(&self, image: ImageIndex) -> &Camera {
        &self.cameras[self.images[image.0 as usize].camera.0 as usize]
    }
}

impl Image {
    /// The camera's centre, sfm frame.
    pub fn center(&self) -> Point3<f64> {
        Point3::from(-(self.cam_from_sfm_rotation.inverse() * self.cam_from_sfm_translation))
    }

    /// A point of the sfm frame in the camera's: x right, y down, z forward.
    pub fn cam_from_sfm(&self, x_in_sfm: &Point3<f64>) -> Point3<f64> {
        self.cam_from_sfm_rotation * x_in_sfm + self.cam_from_sfm_translation
    }
}

#[cfg(test)]
mod tests;
