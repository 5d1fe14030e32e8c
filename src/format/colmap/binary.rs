//! Binary record files: little-endian, packed, each led by a count of 8 bytes.

use rayon::prelude::*;

use super::Fault;
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

/// Position in a file's bytes.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn new(bytes: &'a [u8]) -> Cursor<'a> {
        Cursor { bytes, at: 0 }
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn take<const N: usize>(&mut self, object: impl Fn() -> String) -> Result<&'a [u8; N], Fault> {
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(chunk) => {
                self.at += N;
                Ok(chunk)
            }
            None => Err(Fault::new(
                self.at,
                object(),
                format!("{N} more bytes"),
                format!("the end of the file after {}", self.left()),
            )),
        }
    }

    fn u32(&mut self, object: impl Fn() -> String) -> Result<u32, Fault> {
        Ok(u32::from_le_bytes(*self.take(object)?))
    }

    fn i32(&mut self, object: impl Fn() -> String) -> Result<i32, Fault> {
        Ok(i32::from_le_bytes(*self.take(object)?))
    }

    fn u64(&mut self, object: impl Fn() -> String) -> Result<u64, Fault> {
        Ok(u64::from_le_bytes(*self.take(object)?))
    }

    fn pose(&mut self, object: impl Fn() -> String) -> Result<PoseRecord, Fault> {
        Ok(pose_at(self.take(object)?))
    }

    /// Checks that `count` records of at least `record_bytes` can follow, before memory is taken for them.
    fn counted(&self, count: u64, record_bytes: usize, of: &str, object: impl Fn() -> String) -> Result<usize, Fault> {
        let room = self.left() / record_bytes;
        usize::try_from(count).ok().filter(|count| *count <= room).ok_or_else(|| {
            Fault::new(
                self.at,
                object(),
                format!("at most {room} {of} in the {} bytes that are left", self.left()),
                format!("a count of {count}"),
            )
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
        Err(Fault::new(self.at, format!("after {count} {of}"), "the end of the file", got))
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

pub(super) fn cameras(bytes: &[u8]) -> Result<Vec<CameraRecord>, Fault> {
    let mut cursor = Cursor::new(bytes);
    let count = cursor.count(CAMERA_BYTES, "cameras")?;
    let mut cameras = Vec::with_capacity(count);
    for number in 0..count {
        let object = || format!("camera record {} of {count}", number + 1);
        let id = cursor.u32(object)?;
        let at = cursor.at;
        let model_id = cursor.i32(object)?;
        let model = CAMERA_MODELS.iter().find(|m| m.id == model_id).ok_or_else(|| {
            let known = format!("a camera model id from 0 to {}", CAMERA_MODELS.len() - 1);
            Fault::new(at, format!("camera {id}"), known, model_id.to_string())
        })?;
        let (width, height) = (cursor.u64(object)?, cursor.u64(object)?);
        let mut params = Vec::with_capacity(model.parameter_count);
        for _ in 0..model.parameter_count {
            params.push(f64::from_le_bytes(*cursor.take(object)?));
        }
        cameras.push(CameraRecord { id, model, width, height, params });
    }
    cursor.finish(count, "cameras")?;
    Ok(cameras)
}

pub(super) fn rigs(bytes: &[u8]) -> Result<Vec<RigRecord>, Fault> {
    let mut cursor = Cursor::new(bytes);
    let count = cursor.count(RIG_BYTES, "rigs")?;
    let mut rigs = Vec::with_capacity(count);
    for number in 0..count {
        rigs.push(rig(&mut cursor, || format!("rig record {} of {count}", number + 1))?);
    }
    cursor.finish(count, "rigs")?;
    Ok(rigs)
}

fn rig(cursor: &mut Cursor, object: impl Fn() -> String + Copy) -> Result<RigRecord, Fault> {
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
            [other] => return Err(Fault::new(at, object(), "0 or 1 for a sensor's pose", other.to_string())),
        };
        others.push((sensor, pose));
    }
    Ok(RigRecord { id, reference, others })
}

fn sensor(cursor: &mut Cursor, object: impl Fn() -> String + Copy) -> Result<SensorRecord, Fault> {
    Ok(SensorRecord { kind: cursor.i32(object)?, id: cursor.u32(object)? })
}

pub(super) fn frames(bytes: &[u8]) -> Result<Vec<FrameRecord>, Fault> {
    let mut cursor = Cursor::new(bytes);
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

/// Walks over the images' heads, then decodes the observations, most of the file, in parallel.
pub(super) fn images(bytes: &[u8]) -> Result<Vec<ImageRecord>, Fault> {
    let mut cursor = Cursor::new(bytes);
    let count = cursor.count(IMAGE_BYTES, "images")?;
    let mut heads = Vec::with_capacity(count);
    for number in 0..count {
        heads.push(image_head(&mut cursor, || format!("image record {} of {count}", number + 1))?);
    }
    cursor.finish(count, "images")?;
    let images = heads.into_par_iter().map(|(mut image, observations)| {
        image.observations = observations.as_chunks().0.iter().map(observation).collect();
        image
    });
    Ok(images.collect())
}

/// An image without its observations, and their bytes.
fn image_head<'a>(
    cursor: &mut Cursor<'a>,
    object: impl Fn() -> String + Copy,
) -> Result<(ImageRecord, &'a [u8]), Fault> {
    let id = cursor.u32(object)?;
    let cam_from_world = cursor.pose(object)?;
    let camera_id = cursor.u32(object)?;
    let rest = &cursor.bytes[cursor.at..];
    let Some(length) = rest.iter().position(|b| *b == 0) else {
        return Err(Fault::new(cursor.at, format!("image {id}"), "a name that ends with a zero byte", "none"));
    };
    cursor.at += length + 1;
    let count = cursor.u64(object)?;
    let count = cursor.counted(count, OBSERVATION_BYTES, "observations", || format!("image {id}"))?;
    let observations = &cursor.bytes[cursor.at..cursor.at + count * OBSERVATION_BYTES];
    cursor.at += observations.len();
    let name = rest[..length].to_vec();
    Ok((ImageRecord { id, cam_from_world, camera_id, name, observations: Vec::new() }, observations))
}

fn observation(raw: &[u8; OBSERVATION_BYTES]) -> ObservationRecord {
    ObservationRecord { x: f64_at(raw, 0), y: f64_at(raw, 8), point_id: u64_at(raw, 16) }
}

pub(super) fn points(bytes: &[u8]) -> Result<PointRecords, Fault> {
    let mut cursor = Cursor::new(bytes);
    let count = cursor.count(POINT_BYTES, "points")?;
    let track_bytes = cursor.left() - count * POINT_BYTES;
    if u32::try_from(track_bytes / TRACK_ELEMENT_BYTES).is_err() {
        return Err(Fault::new(0, "points", "fewer than 2^32 track elements", format!("{track_bytes} bytes of them")));
    }
    let mut points = PointRecords::with_capacity(count, track_bytes / TRACK_ELEMENT_BYTES);
    for number in 0..count {
        let object = || format!("point record {} of {count}", number + 1);
        let raw: &[u8; POINT_BYTES] = cursor.take(object)?;
        let id = u64_at(raw, 0);
        points.ids.push(id);
        points.positions.push(std::array::from_fn(|i| f64_at(raw, 8 + 8 * i)));
        points.colors.push([raw[32], raw[33], raw[34]]);
        points.errors.push(f64_at(raw, 35));
        let length = u64_at(raw, 43);
        let length = cursor.counted(length, TRACK_ELEMENT_BYTES, "track elements", || format!("point {id}"))?;
        let track = &cursor.bytes[cursor.at..cursor.at + length * TRACK_ELEMENT_BYTES];
        cursor.at += track.len();
        points.track_elements.extend(track.as_chunks().0.iter().map(track_element));
        points.track_starts.push(points.track_elements.len() as u32);
    }
    cursor.finish(count, "points")?;
    Ok(points)
}

fn track_element(&[a, b, c, d, e, f, g, h]: &[u8; TRACK_ELEMENT_BYTES]) -> (u32, u32) {
    (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]))
}
