//! Binary record files: little-endian, packed, each led by a count of 8 bytes.

use std::io::{BufRead, ErrorKind, Read};

use super::fault::Fault;
use super::records::*;

/// Bytes of the smallest record of each kind; a count that asks for more than the file has is refused by them.
const CAMERA_BYTES: usize = 4 + 4 + 8 + 8 + 2 * 8;
const RIG_BYTES: usize = 4 + 4;
const FRAME_BYTES: usize = 4 + 4 + POSE_BYTES + 4;
const FRAME_DATA_BYTES: usize = 4 + 4 + 8;
const RIG_SENSOR_BYTES: usize = 4 + 4 + 1;
const POSE_BYTES: usize = 7 * 8;
const IMAGE_BYTES: usize = 4 + POSE_BYTES + 4 + 1 + 8;
const OBSERVATION_BYTES: usize = 3 * 8;
const POINT_BYTES: usize = 8 + 3 * 8 + 3 + 8 + 8;
const TRACK_ELEMENT_BYTES: usize = 4 + 4;

/// Longest name of an image; more is no name but a file without the zero byte that ends it.
pub(super) const MAX_NAME_BYTES: u64 = 1 << 16;

/// Reads on in a file and knows how much is left of it. Files are not read whole first: the bytes of a record go
/// through the same small buffers, which spares the machine half of the memory and most of the time to fetch it.
pub(super) struct Cursor<R> {
    reader: R,
    at: u64,
    length: u64,
    /// The bytes of one image's observations or one point's track.
    scratch: Vec<u8>,
}

impl<R: BufRead> Cursor<R> {
    /// `length` is the size of the file.
    pub(super) fn new(reader: R, length: u64) -> Cursor<R> {
        Cursor { reader, at: 0, length, scratch: Vec::new() }
    }

    fn left(&self) -> u64 {
        self.length.saturating_sub(self.at)
    }

    fn take<const N: usize>(&mut self, object: impl Fn() -> String) -> Result<[u8; N], Fault> {
        let mut raw = [0; N];
        match self.reader.read_exact(&mut raw) {
            Ok(()) => {
                self.at += N as u64;
                Ok(raw)
            }
            Err(error) => Err(self.cut_short(error, N, object())),
        }
    }

    /// The next `count * N` bytes, of which `counted` has said that they are there.
    fn take_many<const N: usize>(&mut self, count: usize, object: impl Fn() -> String) -> Result<&[[u8; N]], Fault> {
        self.scratch.resize(count * N, 0);
        match self.reader.read_exact(&mut self.scratch) {
            Ok(()) => {
                self.at += self.scratch.len() as u64;
                Ok(self.scratch.as_chunks().0)
            }
            Err(error) => Err(self.cut_short(error, count * N, object())),
        }
    }

    fn cut_short(&self, error: std::io::Error, wanted: usize, object: String) -> Fault {
        if error.kind() != ErrorKind::UnexpectedEof {
            return Fault::Unreadable(error);
        }
        let got = format!("the end of the file after {}", self.left());
        Fault::malformed(self.at, object, format!("{wanted} more bytes"), got)
    }

    fn u32(&mut self, object: impl Fn() -> String) -> Result<u32, Fault> {
        Ok(u32::from_le_bytes(self.take(object)?))
    }

    fn i32(&mut self, object: impl Fn() -> String) -> Result<i32, Fault> {
        Ok(i32::from_le_bytes(self.take(object)?))
    }

    fn u64(&mut self, object: impl Fn() -> String) -> Result<u64, Fault> {
        Ok(u64::from_le_bytes(self.take(object)?))
    }

    fn pose(&mut self, object: impl Fn() -> String) -> Result<PoseRecord, Fault> {
        Ok(pose_at(&self.take(object)?))
    }

    /// Checks that `count` records of at least `record_bytes` can follow, before memory is taken for them.
    fn counted(&self, count: u64, record_bytes: usize, of: &str, object: impl Fn() -> String) -> Result<usize, Fault> {
        let room = self.left() / record_bytes as u64;
        usize::try_from(count).ok().filter(|_| count <= room).ok_or_else(|| {
            let expected = format!("at most {room} {of} in the {} bytes that are left", self.left());
            Fault::malformed(self.at, object(), expected, format!("a count of {count}"))
        })
    }

    fn count(&mut self, record_bytes: usize, of: &str) -> Result<usize, Fault> {
        let count = self.u64(|| format!("count of {of}"))?;
        self.counted(count, record_bytes, of, || format!("count of {of}"))
    }

    fn finish(&self, count: usize, of: &str) -> Result<(), Fault> {
        if self.left() == 0 {
            return Ok(());
        }
        let got = format!("{} bytes more", self.left());
        Err(Fault::malformed(self.at, format!("after {count} {of}"), "the end of the file", got))
    }
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut raw = [0; 8];
    raw.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(raw)
}

fn f64_at(bytes: &[u8], at: usize) -> f64 {
    f64::from_bits(u64_at(bytes, at))
}

fn pose_at(raw: &[u8; POSE_BYTES]) -> PoseRecord {
    PoseRecord {
        quaternion_wxyz: std::array::from_fn(|i| f64_at(raw, 8 * i)),
        translation: std::array::from_fn(|i| f64_at(raw, 32 + 8 * i)),
    }
}

pub(super) fn cameras<R: BufRead>(mut cursor: Cursor<R>) -> Result<Vec<CameraRecord>, Fault> {
    let count = cursor.count(CAMERA_BYTES, "cameras")?;
    let mut cameras = Vec::with_capacity(count);
    for number in 0..count {
        let object = || format!("camera record {} of {count}", number + 1);
        let id = cursor.u32(object)?;
        let at = cursor.at;
        let model_id = cursor.i32(object)?;
        let model = CAMERA_MODELS.iter().find(|m| m.id == model_id).ok_or_else(|| {
            let known = format!("a camera model id from 0 to {}", CAMERA_MODELS.len() - 1);
            Fault::malformed(at, format!("camera {id}"), known, model_id.to_string())
        })?;
        let (width, height) = (cursor.u64(object)?, cursor.u64(object)?);
        let mut params = Vec::with_capacity(model.parameter_count);
        for _ in 0..model.parameter_count {
            params.push(f64::from_le_bytes(cursor.take(object)?));
        }
        cameras.push(CameraRecord { id, model, width, height, params });
    }
    cursor.finish(count, "cameras")?;
    Ok(cameras)
}

pub(super) fn rigs<R: BufRead>(mut cursor: Cursor<R>) -> Result<Vec<RigRecord>, Fault> {
    let count = cursor.count(RIG_BYTES, "rigs")?;
    let mut rigs = Vec::with_capacity(count);
    for number in 0..count {
        rigs.push(rig(&mut cursor, || format!("rig record {} of {count}", number + 1))?);
    }
    cursor.finish(count, "rigs")?;
    Ok(rigs)
}

fn rig<R: BufRead>(cursor: &mut Cursor<R>, object: impl Fn() -> String + Copy) -> Result<RigRecord, Fault> {
    let id = cursor.u32(object)?;
    let sensor_count = u64::from(cursor.u32(object)?);
    let reference = if sensor_count > 0 { Some(sensor(cursor, object)?) } else { None };
    let other_count = cursor.counted(sensor_count.saturating_sub(1), RIG_SENSOR_BYTES, "sensors", object)?;
    let mut others = Vec::with_capacity(other_count);
    for _ in 0..other_count {
        let sensor = sensor(cursor, object)?;
        let at = cursor.at;
        let pose = match cursor.take::<1>(object)? {
            [0] => None,
            [1] => Some(cursor.pose(object)?),
            [other] => return Err(Fault::malformed(at, object(), "0 or 1 for a sensor's pose", other.to_string())),
        };
        others.push((sensor, pose));
    }
    Ok(RigRecord { id, reference, others })
}

fn sensor<R: BufRead>(cursor: &mut Cursor<R>, object: impl Fn() -> String + Copy) -> Result<SensorRecord, Fault> {
    Ok(SensorRecord { kind: cursor.i32(object)?, id: cursor.u32(object)? })
}

pub(super) fn frames<R: BufRead>(mut cursor: Cursor<R>) -> Result<Vec<FrameRecord>, Fault> {
    let count = cursor.count(FRAME_BYTES, "frames")?;
    let mut frames = Vec::with_capacity(count);
    for number in 0..count {
        let object = || format!("frame record {} of {count}", number + 1);
        let (id, rig_id) = (cursor.u32(object)?, cursor.u32(object)?);
        let rig_from_world = cursor.pose(object)?;
        let data_count = u64::from(cursor.u32(object)?);
        let data_count = cursor.counted(data_count, FRAME_DATA_BYTES, "data ids", object)?;
        let mut data = Vec::with_capacity(data_count);
        for _ in 0..data_count {
            data.push((sensor(&mut cursor, object)?, cursor.u64(object)?));
        }
        frames.push(FrameRecord { id, rig_id, rig_from_world, data });
    }
    cursor.finish(count, "frames")?;
    Ok(frames)
}

pub(super) fn images<R: BufRead>(mut cursor: Cursor<R>) -> Result<Vec<ImageRecord>, Fault> {
    let count = cursor.count(IMAGE_BYTES, "images")?;
    let mut images = Vec::with_capacity(count);
    for number in 0..count {
        images.push(image(&mut cursor, || format!("image record {} of {count}", number + 1))?);
    }
    cursor.finish(count, "images")?;
    Ok(images)
}

fn image<R: BufRead>(cursor: &mut Cursor<R>, object: impl Fn() -> String + Copy) -> Result<ImageRecord, Fault> {
    let id = cursor.u32(object)?;
    let object = || format!("image {id}");
    let cam_from_world = cursor.pose(object)?;
    let camera_id = cursor.u32(object)?;
    let mut name = Vec::new();
    cursor.reader.by_ref().take(MAX_NAME_BYTES).read_until(0, &mut name).map_err(Fault::Unreadable)?;
    let at = cursor.at;
    cursor.at += name.len() as u64;
    if name.pop() != Some(0) {
        return Err(Fault::malformed(at, object(), "a name that ends with a zero byte", "none"));
    }
    let count = cursor.u64(object)?;
    let count = cursor.counted(count, OBSERVATION_BYTES, "observations", object)?;
    let observations = cursor.take_many(count, object)?.iter().map(observation).collect();
    Ok(ImageRecord { id, cam_from_world, camera_id, name, observations })
}

fn observation(raw: &[u8; OBSERVATION_BYTES]) -> ObservationRecord {
    ObservationRecord { x: f64_at(raw, 0), y: f64_at(raw, 8), point_id: u64_at(raw, 16) }
}

pub(super) fn points<R: BufRead>(mut cursor: Cursor<R>) -> Result<PointRecords, Fault> {
    let count = cursor.count(POINT_BYTES, "points")?;
    let track_bytes = cursor.left() - (count * POINT_BYTES) as u64;
    let track_count = u32::try_from(track_bytes / TRACK_ELEMENT_BYTES as u64).map_err(|_| {
        Fault::malformed(0, "points", "fewer than 2^32 track elements", format!("{track_bytes} bytes of them"))
    })?;
    let mut points = PointRecords::with_capacity(count, track_count as usize);
    for number in 0..count {
        let raw: [u8; POINT_BYTES] = cursor.take(|| format!("point record {} of {count}", number + 1))?;
        let id = u64_at(&raw, 0);
        points.ids.push(id);
        points.positions.push(std::array::from_fn(|i| f64_at(&raw, 8 + 8 * i)));
        points.colors.push([raw[32], raw[33], raw[34]]);
        points.errors.push(f64_at(&raw, 35));
        let object = || format!("point {id}");
        let length = cursor.counted(u64_at(&raw, 43), TRACK_ELEMENT_BYTES, "track elements", object)?;
        points.track_elements.extend(cursor.take_many(length, object)?.iter().map(track_element));
        points.track_starts.push(points.track_elements.len() as u32);
    }
    cursor.finish(count, "points")?;
    Ok(points)
}

fn track_element(&[a, b, c, d, e, f, g, h]: &[u8; TRACK_ELEMENT_BYTES]) -> (u32, u32) {
    (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]))
}
