//! Record files in either encoding. Text numbers are the shortest that read back to the same bits.
//!
//! Records are put together in memory, many at once in parallel, and written in their order.

use std::io::{Result, Write};

use rayon::prelude::*;

use super::binary::MAX_NAME_BYTES;
use super::records::*;

/// Pieces of a file that are put together at once, and records in a piece; any numbers give the same file.
const PIECES_AT_ONCE: usize = 16;
const IMAGES_IN_PIECE: usize = 2;
const POINTS_IN_PIECE: usize = 1 << 12;

/// Whether an image's name, written in this encoding, is read again as it is: in binary a zero byte ends it, in text its
/// line's end, and blanks around it are lost.
pub fn can_be_named(encoding: Encoding, name: &[u8]) -> bool {
    match encoding {
        Encoding::Binary => !name.contains(&0) && (name.len() as u64) < MAX_NAME_BYTES,
        Encoding::Text => !name.contains(&b'\n') && name.trim_ascii() == name,
    }
}

/// The file of the cameras.
pub fn cameras_file(encoding: Encoding, cameras: &[CameraRecord]) -> Vec<u8> {
    let head = "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
    let mut file = Record::lead(encoding, head, "cameras", cameras.len());
    for camera in cameras {
        file.u32(camera.id);
        match encoding {
            Encoding::Binary => file.i32(camera.model.id),
            Encoding::Text => file.word(camera.model.name),
        }
        file.u64(camera.width);
        file.u64(camera.height);
        file.f64s(&camera.params);
        file.end_line();
    }
    file.bytes
}

/// The file of the rigs.
pub fn rigs_file(encoding: Encoding, rigs: &[RigRecord]) -> Vec<u8> {
    let head = "# Rig calib list with one line of data per calib:\n#   RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, \
                REF_SENSOR_ID, SENSORS[] as (SENSOR_TYPE, SENSOR_ID, HAS_POSE, [QW, QX, QY, QZ, TX, TY, TZ])\n";
    let mut file = Record::lead(encoding, head, "rigs", rigs.len());
    for rig in rigs {
        file.u32(rig.id);
        // No more sensors than a count of 4 bytes told on reading.
        file.u32((rig.reference.iter().count() + rig.others.len()) as u32);
        if let Some(reference) = rig.reference {
            file.sensor(reference);
        }
        for (sensor, pose) in &rig.others {
            file.sensor(*sensor);
            file.u8(u8::from(pose.is_some()));
            if let Some(pose) = pose {
                file.pose(pose);
            }
        }
        file.end_line();
    }
    file.bytes
}

/// The file of the frames.
pub fn frames_file(encoding: Encoding, frames: &[FrameRecord]) -> Vec<u8> {
    let head = "# Frame list with one line of data per frame:\n#   FRAME_ID, RIG_ID, RIG_FROM_WORLD[QW, QX, QY, QZ, \
                TX, TY, TZ], NUM_DATA_IDS, DATA_IDS[] as (SENSOR_TYPE, SENSOR_ID, DATA_ID)\n";
    let mut file = Record::lead(encoding, head, "frames", frames.len());
    for frame in frames {
        file.u32(frame.id);
        file.u32(frame.rig_id);
        file.pose(&frame.rig_from_world);
        file.u32(frame.data.len() as u32);
        for (sensor, id) in &frame.data {
            file.sensor(*sensor);
            file.u64(*id);
        }
        file.end_line();
    }
    file.bytes
}

/// `image` gives the n-th image and its observations.
pub fn write_images<'a, O>(
    out: &mut impl Write,
    encoding: Encoding,
    count: usize,
    image: impl Fn(usize) -> (ImageHead<'a>, O) + Sync,
) -> Result<()>
where
    O: ExactSizeIterator<Item = ObservationRecord>,
{
    let head = "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, \
                NAME\n#   POINTS2D[] as (X, Y, POINT3D_ID)\n";
    out.write_all(&Record::lead(encoding, head, "images", count).bytes)?;
    write_records(out, encoding, count, IMAGES_IN_PIECE, |number, file| {
        let (head, observations) = image(number);
        file.u32(head.id);
        file.pose(&head.cam_from_world);
        file.u32(head.camera_id);
        file.name(head.name);
        if encoding == Encoding::Binary {
            file.u64(observations.len() as u64);
        }
        for observation in observations {
            file.f64s(&[observation.x, observation.y]);
            match observation.point_id {
                NO_POINT if encoding == Encoding::Text => file.word("-1"),
                id => file.u64(id),
            }
        }
        file.end_line();
    })
}

/// `point` gives the n-th point and its track as (image id, index of the observation).
pub fn write_points<T>(
    out: &mut impl Write,
    encoding: Encoding,
    count: usize,
    point: impl Fn(usize) -> (PointHead, T) + Sync,
) -> Result<()>
where
    T: ExactSizeIterator<Item = (u32, u32)>,
{
    let head = "# 3D point list with one line of data per point:\n#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as \
                (IMAGE_ID, POINT2D_IDX)\n";
    out.write_all(&Record::lead(encoding, head, "points", count).bytes)?;
    write_records(out, encoding, count, POINTS_IN_PIECE, |number, file| {
        let (head, track) = point(number);
        file.u64(head.id);
        file.f64s(&head.position);
        head.color.into_iter().for_each(|value| file.u8(value));
        file.f64s(&[head.error]);
        if encoding == Encoding::Binary {
            file.u64(track.len() as u64);
        }
        for (image_id, index) in track {
            file.u32(image_id);
            file.u32(index);
        }
        file.end_line();
    })
}

fn write_records(
    out: &mut impl Write,
    encoding: Encoding,
    count: usize,
    records_in_piece: usize,
    put: impl Fn(usize, &mut Record) + Sync,
) -> Result<()> {
    let mut pieces: Vec<_> = (0..PIECES_AT_ONCE).map(|_| Record::new(encoding)).collect();
    for start in (0..count).step_by(PIECES_AT_ONCE * records_in_piece) {
        pieces.par_iter_mut().enumerate().for_each(|(number, piece)| {
            piece.bytes.clear();
            let first = (start + number * records_in_piece).min(count);
            let end = (first + records_in_piece).min(count);
            (first..end).for_each(|number| put(number, piece));
        });
        pieces.iter().try_for_each(|piece| out.write_all(&piece.bytes))?;
    }
    Ok(())
}

/// Bytes of records; in text, values are set apart by blanks.
struct Record {
    encoding: Encoding,
    bytes: Vec<u8>,
    is_line_start: bool,
}

impl Record {
    fn new(encoding: Encoding) -> Record {
        Record { encoding, bytes: Vec::new(), is_line_start: true }
    }

    /// What stands before the records of a file.
    fn lead(encoding: Encoding, head: &str, of: &str, count: usize) -> Record {
        let mut record = Record::new(encoding);
        match encoding {
            Encoding::Binary => record.u64(count as u64),
            Encoding::Text => record.bytes = format!("{head}# Number of {of}: {count}\n").into_bytes(),
        }
        record
    }

    fn word(&mut self, word: &str) {
        if !std::mem::take(&mut self.is_line_start) {
            self.bytes.push(b' ');
        }
        self.bytes.extend_from_slice(word.as_bytes());
    }

    fn integer(&mut self, value: impl itoa::Integer) {
        self.word(itoa::Buffer::new().format(value));
    }

    fn u8(&mut self, value: u8) {
        match self.encoding {
            Encoding::Binary => self.bytes.push(value),
            Encoding::Text => self.integer(value),
        }
    }

    fn i32(&mut self, value: i32) {
        match self.encoding {
            Encoding::Binary => self.bytes.extend_from_slice(&value.to_le_bytes()),
            Encoding::Text => self.integer(value),
        }
    }

    fn u32(&mut self, value: u32) {
        match self.encoding {
            Encoding::Binary => self.bytes.extend_from_slice(&value.to_le_bytes()),
            Encoding::Text => self.integer(value),
        }
    }

    fn u64(&mut self, value: u64) {
        match self.encoding {
            Encoding::Binary => self.bytes.extend_from_slice(&value.to_le_bytes()),
            Encoding::Text => self.integer(value),
        }
    }

    fn f64s(&mut self, values: &[f64]) {
        for value in values {
            match self.encoding {
                Encoding::Binary => self.bytes.extend_from_slice(&value.to_le_bytes()),
                Encoding::Text => self.word(zmij::Buffer::new().format(*value)),
            }
        }
    }

    fn pose(&mut self, pose: &PoseRecord) {
        self.f64s(&pose.quaternion_wxyz);
        self.f64s(&pose.translation);
    }

    fn sensor(&mut self, sensor: SensorRecord) {
        match SENSOR_NAMES.iter().find(|(kind, _)| *kind == sensor.kind) {
            Some((_, name)) if self.encoding == Encoding::Text => self.word(name),
            _ => self.i32(sensor.kind),
        }
        self.u32(sensor.id);
    }

    /// Ends with what follows a name: a zero byte, or the line's end.
    fn name(&mut self, name: &[u8]) {
        match self.encoding {
            Encoding::Binary => {
                self.bytes.extend_from_slice(name);
                self.bytes.push(0);
            }
            Encoding::Text => {
                self.bytes.push(b' ');
                self.bytes.extend_from_slice(name);
                self.end_line();
            }
        }
    }

    fn end_line(&mut self) {
        if self.encoding == Encoding::Text {
            self.bytes.push(b'\n');
            self.is_line_start = true;
        }
    }
}

#[cfg(test)]
mod tests;
