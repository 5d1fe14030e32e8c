//! A reconstruction in memory.

use super::warning::ReconstructionWarning;
use crate::format::colmap::{Encoding, FrameRecord, RigRecord};
use crate::format::crs::Crs;
use crate::format::ply::CloudField;
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

/// Points, and where known the cameras that saw them. A cloud has no images.
#[derive(Clone, Debug, Default)]
pub struct Reconstruction {
    /// What it was read from.
    pub format: SfmFormat,
    /// The coordinate reference system that the file names, as it names it.
    pub crs: Option<Crs>,
    pub cameras: Vec<Camera>,
    /// COLMAP's ids, one per camera.
    pub camera_ids: Vec<u32>,
    pub images: Vec<Image>,
    /// Sfm frame, sfm units.
    pub points: Vec<Point3<f64>>,
    /// COLMAP's ids, one per point, or empty for a cloud.
    pub point_ids: Vec<u64>,
    /// Mean reprojection errors in pixels, one per point (-1 where COLMAP has not computed it), or empty.
    pub point_errors_px: Vec<f64>,
    /// One per point, or empty where the file has none.
    pub colors: Vec<[u8; 3]>,
    /// Unit normals, one per point, or empty where the file has none. Zero where the file's has no direction.
    pub normals: Vec<Vector3<f64>>,
    /// Further properties of the points of a cloud, each with a value per point, written out again as they are.
    pub fields: Vec<CloudField>,
    /// Start of each point's track in `track_elements`, one more than there are points (or empty without images).
    pub track_starts: Vec<u32>,
    /// (image, index of the observation in the image).
    pub track_elements: Vec<(ImageIndex, u32)>,
    /// Whether who saw a point may be relied on.
    pub sight: Sight,
    /// Where the cameras stood by their own positioning, if the file tells.
    pub positions: Option<KnownPositions>,
    /// What only a COLMAP model has; `None` for a PLY cloud.
    pub colmap: Option<ColmapParts>,
    /// What was tolerated on reading, each kind once.
    pub warnings: Vec<ReconstructionWarning>,
}

/// What a reconstruction was read from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SfmFormat {
    /// Put together in memory.
    #[default]
    Memory,
    Colmap,
    Ply,
    /// With the version, such as 1.4; `packed` names the packing: LAZ, or COPC.
    Las {
        version: (u8, u8),
        packing: LasPacking,
    },
    E57,
    OpenSfm,
    Nerfstudio,
    OpenMvg,
    Bundler,
    Nvm,
}

/// How the points of a LAS file are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LasPacking {
    Las,
    Laz,
    Copc,
}

impl std::fmt::Display for SfmFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let name = match self {
            SfmFormat::Memory => "memory",
            SfmFormat::Colmap => "COLMAP",
            SfmFormat::Ply => "PLY",
            SfmFormat::Las { version: (major, minor), packing } => {
                let name = match packing {
                    LasPacking::Las => "LAS",
                    LasPacking::Laz => "LAZ",
                    LasPacking::Copc => "COPC",
                };
                return write!(f, "{name} {major}.{minor}");
            }
            SfmFormat::E57 => "E57",
            SfmFormat::OpenSfm => "OpenSfM",
            SfmFormat::Nerfstudio => "nerfstudio",
            SfmFormat::OpenMvg => "OpenMVG",
            SfmFormat::Bundler => "Bundler",
            SfmFormat::Nvm => "NVM",
        };
        f.write_str(name)
    }
}

/// Camera positions that came with a reconstruction.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownPositions {
    /// What they count from: latitude and longitude in degrees, metres above the ellipsoid.
    pub reference_lla: Option<[f64; 3]>,
    /// East, north, up in metres, one for each image.
    pub of_images: Vec<Option<[f64; 3]>>,
}

/// Whether tracks tell who saw a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sight {
    #[default]
    Believed,
    /// Points, poses and keypoints contradict each other; tracks are kept, and nothing is concluded from them.
    Denied,
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

impl Reconstruction {
    /// Who saw a point: (image, index of the observation in the image). Empty where tracks are not known.
    pub fn track(&self, p: PointIndex) -> &[(ImageIndex, u32)] {
        let index = p.0 as usize;
        match (self.track_starts.get(index), self.track_starts.get(index + 1)) {
            (Some(start), Some(end)) => &self.track_elements[*start as usize..*end as usize],
            _ => &[],
        }
    }

    /// Who saw a point for certain: its track, unless the reconstruction contradicts itself.
    pub fn seen_by(&self, p: PointIndex) -> &[(ImageIndex, u32)] {
        match self.sight {
            Sight::Believed => self.track(p),
            Sight::Denied => &[],
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
