//! The records of a COLMAP model.

/// Marks an observation that belongs to no point: -1 in text.
pub const NO_POINT: u64 = u64::MAX;

/// The sensor type of cameras in rigs and frames.
pub const SENSOR_CAMERA: i32 = 0;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    Binary,
    Text,
}

impl Encoding {
    pub fn extension(self) -> &'static str {
        match self {
            Encoding::Binary => "bin",
            Encoding::Text => "txt",
        }
    }
}

/// All files of one folder.
#[derive(Clone, Debug)]
pub struct Model {
    pub encoding: Encoding,
    pub cameras: Vec<CameraRecord>,
    pub rigs: Option<Vec<RigRecord>>,
    pub frames: Option<Vec<FrameRecord>>,
    pub images: Vec<ImageRecord>,
    pub points: PointRecords,
    /// Text files that hold another number of records than they say.
    pub miscounts: Vec<Miscount>,
}

/// A file that holds another number of records than the comment before them counts: one that was cut at the end of a line, or
/// edited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Miscount {
    /// The file's name without its extension.
    pub stem: &'static str,
    pub announced: usize,
    pub found: usize,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CameraRecord {
    pub id: u32,
    /// One of [`CAMERA_MODELS`].
    pub model: &'static CameraModelRecord,
    pub width: u64,
    pub height: u64,
    /// As many as the model has.
    pub params: Vec<f64>,
}

/// How the files name a camera model, and how many parameters follow.
#[derive(Debug, PartialEq, Eq)]
pub struct CameraModelRecord {
    pub id: i32,
    pub name: &'static str,
    pub parameter_count: usize,
}

/// Every camera model up to COLMAP 4.2.
#[rustfmt::skip]
pub static CAMERA_MODELS: [CameraModelRecord; 18] = [
    CameraModelRecord { id: 0, name: "SIMPLE_PINHOLE", parameter_count: 3 },
    CameraModelRecord { id: 1, name: "PINHOLE", parameter_count: 4 },
    CameraModelRecord { id: 2, name: "SIMPLE_RADIAL", parameter_count: 4 },
    CameraModelRecord { id: 3, name: "RADIAL", parameter_count: 5 },
    CameraModelRecord { id: 4, name: "OPENCV", parameter_count: 8 },
    CameraModelRecord { id: 5, name: "OPENCV_FISHEYE", parameter_count: 8 },
    CameraModelRecord { id: 6, name: "FULL_OPENCV", parameter_count: 12 },
    CameraModelRecord { id: 7, name: "FOV", parameter_count: 5 },
    CameraModelRecord { id: 8, name: "SIMPLE_RADIAL_FISHEYE", parameter_count: 4 },
    CameraModelRecord { id: 9, name: "RADIAL_FISHEYE", parameter_count: 5 },
    CameraModelRecord { id: 10, name: "THIN_PRISM_FISHEYE", parameter_count: 12 },
    CameraModelRecord { id: 11, name: "RAD_TAN_THIN_PRISM_FISHEYE", parameter_count: 16 },
    CameraModelRecord { id: 12, name: "SIMPLE_DIVISION", parameter_count: 4 },
    CameraModelRecord { id: 13, name: "DIVISION", parameter_count: 5 },
    CameraModelRecord { id: 14, name: "SIMPLE_FISHEYE", parameter_count: 3 },
    CameraModelRecord { id: 15, name: "FISHEYE", parameter_count: 4 },
    CameraModelRecord { id: 16, name: "EUCM", parameter_count: 6 },
    CameraModelRecord { id: 17, name: "EQUIRECTANGULAR", parameter_count: 2 },
];

/// A rigid transform as the files hold it: the quaternion is not normalised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseRecord {
    pub quaternion_wxyz: [f64; 4],
    pub translation: [f64; 3],
}

/// A sensor: its type ([`SENSOR_CAMERA`], 1 for an IMU, others as later releases may add) and its id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorRecord {
    pub kind: i32,
    pub id: u32,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RigRecord {
    pub id: u32,
    /// The sensor that defines the rig's frame; `None` only for a rig without sensors.
    pub reference: Option<SensorRecord>,
    /// The other sensors, with `sensor_from_rig` where it is known.
    pub others: Vec<(SensorRecord, Option<PoseRecord>)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct FrameRecord {
    pub id: u32,
    pub rig_id: u32,
    pub rig_from_world: PoseRecord,
    /// The sensor, and the id of what it recorded (an image's id for a camera).
    pub data: Vec<(SensorRecord, u64)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ImageRecord {
    pub id: u32,
    pub cam_from_world: PoseRecord,
    pub camera_id: u32,
    /// As in the file; COLMAP does not say in which encoding.
    pub name: Vec<u8>,
    pub observations: Vec<ObservationRecord>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObservationRecord {
    pub x: f64,
    pub y: f64,
    /// [`NO_POINT`] where the keypoint belongs to none.
    pub point_id: u64,
}

/// All points, field by field.
#[derive(Clone, Debug, Default)]
pub struct PointRecords {
    pub ids: Vec<u64>,
    pub positions: Vec<[f64; 3]>,
    pub colors: Vec<[u8; 3]>,
    /// Mean reprojection error in pixels; -1 where it was not computed.
    pub errors: Vec<f64>,
    /// Start of each point's track in `track_elements`, and the end of the last.
    pub track_starts: Vec<u32>,
    /// (image id, index of the observation in that image).
    pub track_elements: Vec<(u32, u32)>,
}

impl PointRecords {
    pub fn with_capacity(points: usize, track_elements: usize) -> PointRecords {
        let mut track_starts = Vec::with_capacity(points + 1);
        track_starts.push(0);
        PointRecords {
            ids: Vec::with_capacity(points),
            positions: Vec::with_capacity(points),
            colors: Vec::with_capacity(points),
            errors: Vec::with_capacity(points),
            track_starts,
            track_elements: Vec::with_capacity(track_elements),
        }
    }
}

/// What text calls the sensor types.
pub(super) const SENSOR_NAMES: [(i32, &str); 3] = [(-1, "INVALID"), (SENSOR_CAMERA, "CAMERA"), (1, "IMU")];

/// An image without its observations, as writing takes it.
#[derive(Clone, Copy, Debug)]
pub struct ImageHead<'a> {
    pub id: u32,
    pub cam_from_world: PoseRecord,
    pub camera_id: u32,
    pub name: &'a [u8],
}

/// A point without its track, as writing takes it.
#[derive(Clone, Copy, Debug)]
pub struct PointHead {
    pub id: u64,
    pub position: [f64; 3],
    pub color: [u8; 3],
    pub error: f64,
}
