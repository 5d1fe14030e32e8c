//! Writes record files in either encoding. Text numbers are the shortest that read back to the same bits.

use std::io::{Result, Write};

use super::records::*;

pub fn write_cameras(out: &mut impl Write, encoding: Encoding, cameras: &[CameraRecord]) -> Result<()> {
    let head = "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
    lead(out, encoding, head, "cameras", cameras.len())?;
    for camera in cameras {
        match encoding {
            Encoding::Binary => {
                out.write_all(&camera.id.to_le_bytes())?;
                out.write_all(&camera.model.id.to_le_bytes())?;
                out.write_all(&camera.width.to_le_bytes())?;
                out.write_all(&camera.height.to_le_bytes())?;
                write_f64s(out, &camera.params)?;
            }
            Encoding::Text => {
                write!(out, "{} {} {} {}", camera.id, camera.model.name, camera.width, camera.height)?;
                write_values(out, &camera.params)?;
                out.write_all(b"\n")?;
            }
        }
    }
    Ok(())
}

pub fn write_rigs(out: &mut impl Write, encoding: Encoding, rigs: &[RigRecord]) -> Result<()> {
    let head = "# Rig calib list with one line of data per calib:\n#   RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, \
                REF_SENSOR_ID, SENSORS[] as (SENSOR_TYPE, SENSOR_ID, HAS_POSE, [QW, QX, QY, QZ, TX, TY, TZ])\n";
    lead(out, encoding, head, "rigs", rigs.len())?;
    for rig in rigs {
        let sensor_count = rig.reference.iter().count() + rig.others.len();
        match encoding {
            Encoding::Binary => {
                out.write_all(&rig.id.to_le_bytes())?;
                // A rig holds as many sensors as a count of 4 bytes told on reading.
                out.write_all(&(sensor_count as u32).to_le_bytes())?;
            }
            Encoding::Text => write!(out, "{} {sensor_count}", rig.id)?,
        }
        if let Some(sensor) = &rig.reference {
            write_sensor(out, encoding, sensor)?;
        }
        for (sensor, pose) in &rig.others {
            write_sensor(out, encoding, sensor)?;
            match encoding {
                Encoding::Binary => out.write_all(&[u8::from(pose.is_some())])?,
                Encoding::Text => write!(out, " {}", u8::from(pose.is_some()))?,
            }
            if let Some(pose) = pose {
                write_pose(out, encoding, pose)?;
            }
        }
        end_line(out, encoding)?;
    }
    Ok(())
}

pub fn write_frames(out: &mut impl Write, encoding: Encoding, frames: &[FrameRecord]) -> Result<()> {
    let head = "# Frame list with one line of data per frame:\n#   FRAME_ID, RIG_ID, RIG_FROM_WORLD[QW, QX, QY, QZ, \
                TX, TY, TZ], NUM_DATA_IDS, DATA_IDS[] as (SENSOR_TYPE, SENSOR_ID, DATA_ID)\n";
    lead(out, encoding, head, "frames", frames.len())?;
    for frame in frames {
        match encoding {
            Encoding::Binary => {
                out.write_all(&frame.id.to_le_bytes())?;
                out.write_all(&frame.rig_id.to_le_bytes())?;
            }
            Encoding::Text => write!(out, "{} {}", frame.id, frame.rig_id)?,
        }
        write_pose(out, encoding, &frame.rig_from_world)?;
        match encoding {
            Encoding::Binary => out.write_all(&(frame.data.len() as u32).to_le_bytes())?,
            Encoding::Text => write!(out, " {}", frame.data.len())?,
        }
        for (sensor, id) in &frame.data {
            write_sensor(out, encoding, sensor)?;
            match encoding {
                Encoding::Binary => out.write_all(&id.to_le_bytes())?,
                Encoding::Text => write!(out, " {id}")?,
            }
        }
        end_line(out, encoding)?;
    }
    Ok(())
}

/// Each item is an image whose own `observations` are not looked at, and its observations.
pub fn write_images<'a, O>(
    out: &mut impl Write,
    encoding: Encoding,
    images: impl ExactSizeIterator<Item = (ImageHead<'a>, O)>,
) -> Result<()>
where
    O: ExactSizeIterator<Item = ObservationRecord>,
{
    let head = "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, \
                NAME\n#   POINTS2D[] as (X, Y, POINT3D_ID)\n";
    lead(out, encoding, head, "images", images.len())?;
    for (image, observations) in images {
        match encoding {
            Encoding::Binary => write_image_binary(out, &image, observations)?,
            Encoding::Text => write_image_text(out, &image, observations)?,
        }
    }
    Ok(())
}

fn write_image_binary(
    out: &mut impl Write,
    image: &ImageHead,
    observations: impl ExactSizeIterator<Item = ObservationRecord>,
) -> Result<()> {
    out.write_all(&image.id.to_le_bytes())?;
    write_pose(out, Encoding::Binary, &image.cam_from_world)?;
    out.write_all(&image.camera_id.to_le_bytes())?;
    out.write_all(image.name)?;
    out.write_all(&[0])?;
    out.write_all(&(observations.len() as u64).to_le_bytes())?;
    for observation in observations {
        let mut raw = [0; 24];
        raw[..8].copy_from_slice(&observation.x.to_le_bytes());
        raw[8..16].copy_from_slice(&observation.y.to_le_bytes());
        raw[16..].copy_from_slice(&observation.point_id.to_le_bytes());
        out.write_all(&raw)?;
    }
    Ok(())
}

fn write_image_text(
    out: &mut impl Write,
    image: &ImageHead,
    observations: impl ExactSizeIterator<Item = ObservationRecord>,
) -> Result<()> {
    write!(out, "{}", image.id)?;
    write_pose(out, Encoding::Text, &image.cam_from_world)?;
    write!(out, " {} ", image.camera_id)?;
    out.write_all(image.name)?;
    let mut gap = "\n";
    for observation in observations {
        write!(out, "{gap}{} {} ", Value(observation.x), Value(observation.y))?;
        match observation.point_id {
            NO_POINT => out.write_all(b"-1")?,
            id => write!(out, "{id}")?,
        }
        gap = " ";
    }
    // An image without observations still has its second line.
    out.write_all(if gap == " " { b"\n" } else { b"\n\n" })
}

/// One point and its track as (image id, index of the observation).
pub fn write_points<T>(
    out: &mut impl Write,
    encoding: Encoding,
    points: impl ExactSizeIterator<Item = (PointHead, T)>,
) -> Result<()>
where
    T: ExactSizeIterator<Item = (u32, u32)>,
{
    let head = "# 3D point list with one line of data per point:\n#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as \
                (IMAGE_ID, POINT2D_IDX)\n";
    lead(out, encoding, head, "points", points.len())?;
    for (point, track) in points {
        match encoding {
            Encoding::Binary => {
                out.write_all(&point.id.to_le_bytes())?;
                write_f64s(out, &point.position)?;
                out.write_all(&point.color)?;
                out.write_all(&point.error.to_le_bytes())?;
                out.write_all(&(track.len() as u64).to_le_bytes())?;
                for (image_id, index) in track {
                    out.write_all(&image_id.to_le_bytes())?;
                    out.write_all(&index.to_le_bytes())?;
                }
            }
            Encoding::Text => {
                write!(out, "{}", point.id)?;
                write_values(out, &point.position)?;
                let [r, g, b] = point.color;
                write!(out, " {r} {g} {b} {}", Value(point.error))?;
                for (image_id, index) in track {
                    write!(out, " {image_id} {index}")?;
                }
                out.write_all(b"\n")?;
            }
        }
    }
    Ok(())
}

/// What stands before the records.
fn lead(out: &mut impl Write, encoding: Encoding, head: &str, of: &str, count: usize) -> Result<()> {
    match encoding {
        Encoding::Binary => out.write_all(&(count as u64).to_le_bytes()),
        Encoding::Text => write!(out, "{head}# Number of {of}: {count}\n"),
    }
}

fn end_line(out: &mut impl Write, encoding: Encoding) -> Result<()> {
    match encoding {
        Encoding::Binary => Ok(()),
        Encoding::Text => out.write_all(b"\n"),
    }
}

fn write_sensor(out: &mut impl Write, encoding: Encoding, sensor: &SensorRecord) -> Result<()> {
    match (encoding, SENSOR_NAMES.iter().find(|(kind, _)| *kind == sensor.kind)) {
        (Encoding::Binary, _) => {
            out.write_all(&sensor.kind.to_le_bytes())?;
            out.write_all(&sensor.id.to_le_bytes())
        }
        (Encoding::Text, Some((_, name))) => write!(out, " {name} {}", sensor.id),
        (Encoding::Text, None) => write!(out, " {} {}", sensor.kind, sensor.id),
    }
}

fn write_pose(out: &mut impl Write, encoding: Encoding, pose: &PoseRecord) -> Result<()> {
    match encoding {
        Encoding::Binary => {
            write_f64s(out, &pose.quaternion_wxyz)?;
            write_f64s(out, &pose.translation)
        }
        Encoding::Text => {
            write_values(out, &pose.quaternion_wxyz)?;
            write_values(out, &pose.translation)
        }
    }
}

fn write_f64s(out: &mut impl Write, values: &[f64]) -> Result<()> {
    values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
}

fn write_values(out: &mut impl Write, values: &[f64]) -> Result<()> {
    values.iter().try_for_each(|value| write!(out, " {}", Value(*value)))
}

/// A number in text: with an exponent where it would need many zeros otherwise.
struct Value(f64);

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && !(1e-5..1e17).contains(&size) { write!(f, "{:e}", self.0) } else { write!(f, "{}", self.0) }
    }
}
