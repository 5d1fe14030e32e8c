//! Text record files: one record a line (two for images), values apart by blanks, comments led by `#`.
//!
//! Scripts write these files too: values apart by commas as kapture does it (COLMAP up to 3.13 reads that), and whole numbers
//! as `960.0`. Both are read.

use std::io::BufRead;

use rayon::prelude::*;

use super::fault::Fault;
use super::records::*;

/// Points are parsed in parallel in pieces of about this many bytes; any size gives the same result.
const PIECE_BYTES: usize = 1 << 20;

/// Characters of a file that a message repeats at most.
const SHOWN_BYTES: usize = 40;

/// One line of a file, read value by value.
struct Line<'a> {
    whole: &'a [u8],
    /// What is left of the line.
    rest: &'a [u8],
    /// Position of `rest` in the file.
    at: usize,
    kind: &'static str,
    /// The record's id, for messages, once it is known.
    id: Option<u64>,
}

impl<'a> Line<'a> {
    fn new(bytes: &'a [u8], at: usize, kind: &'static str) -> Line<'a> {
        Line { whole: bytes, rest: bytes, at, kind, id: None }
    }

    fn fault(&self, expected: &str, got: &[u8]) -> Fault {
        let got = match got {
            [] => "the end of the line".to_string(),
            token => {
                let shown = &token[..token.len().min(SHOWN_BYTES)];
                format!("`{}`", String::from_utf8_lossy(shown).escape_debug())
            }
        };
        let object = self.id.map_or(self.kind.to_string(), |id| format!("{} {id}", self.kind));
        Fault::malformed(self.at as u64, object, expected, got)
    }

    fn skip(&mut self, count: usize) {
        self.rest = &self.rest[count..];
        self.at += count;
    }

    fn skip_blanks(&mut self) {
        let blanks = self.rest.iter().position(|b| !is_gap(b)).unwrap_or(self.rest.len());
        self.skip(blanks);
    }

    fn is_at_end(&mut self) -> bool {
        self.skip_blanks();
        self.rest.is_empty()
    }

    /// The next value, not yet taken.
    fn peek(&mut self) -> &'a [u8] {
        self.skip_blanks();
        self.token()
    }

    /// What stands here up to the next gap.
    fn token(&self) -> &'a [u8] {
        let length = self.rest.iter().position(is_gap).unwrap_or(self.rest.len());
        &self.rest[..length]
    }

    /// Takes a number of `length` bytes off the line, unless a comma within it may be a decimal one: `0,5` beside blanks.
    fn take_number(&mut self, length: usize) -> Result<(), Fault> {
        let [number, rest] = [&self.rest[..length], &self.rest[length..]];
        if rest.first() == Some(&b',') && rest.get(1).is_some_and(u8::is_ascii_digit) && !number.contains(&b'.') {
            let has_blanks = self.whole.trim_ascii().windows(2).any(|w| w[0] != b',' && w[1].is_ascii_whitespace());
            if has_blanks {
                let digits = rest[1..].iter().take_while(|b| b.is_ascii_digit()).count();
                return Err(self.fault(
                    "numbers with a decimal point and blanks between them (0.5 for 0,5)",
                    &self.rest[..length + 1 + digits],
                ));
            }
        }
        self.skip(length);
        Ok(())
    }

    fn f64(&mut self, expected: &str) -> Result<f64, Fault> {
        self.skip_blanks();
        match fast_float2::parse_partial::<f64, _>(self.rest) {
            Ok((value, length)) if self.rest.get(length).is_none_or(is_gap) => {
                self.take_number(length)?;
                Ok(value)
            }
            _ => Err(self.fault(expected, self.token())),
        }
    }

    fn u64(&mut self, expected: &str) -> Result<u64, Fault> {
        self.skip_blanks();
        let mut value = 0u64;
        let mut length = 0;
        for digit in self.rest.iter().map_while(|b| b.is_ascii_digit().then(|| u64::from(b - b'0'))) {
            match value.checked_mul(10).and_then(|v| v.checked_add(digit)) {
                Some(next) => value = next,
                None => return Err(self.fault(expected, self.token())),
            }
            length += 1;
        }
        if length == 0 {
            return Err(self.fault(expected, self.token()));
        }
        // `960.0` is a whole number, too.
        if self.rest.get(length) == Some(&b'.') {
            length += 1 + self.rest[length + 1..].iter().take_while(|b| **b == b'0').count();
        }
        if self.rest.get(length).is_some_and(|b| !is_gap(b)) {
            return Err(self.fault(expected, self.token()));
        }
        self.take_number(length)?;
        Ok(value)
    }

    fn u32(&mut self, expected: &str) -> Result<u32, Fault> {
        let value = self.u64(expected)?;
        u32::try_from(value).map_err(|_| self.fault(&format!("{expected} below 2^32"), value.to_string().as_bytes()))
    }

    fn u8(&mut self, expected: &str) -> Result<u8, Fault> {
        let value = self.u64(expected)?;
        u8::try_from(value).map_err(|_| self.fault(expected, value.to_string().as_bytes()))
    }

    fn record_id(&mut self, expected: &str) -> Result<u32, Fault> {
        let id = self.u32(expected)?;
        self.id = Some(id.into());
        Ok(id)
    }

    fn pose(&mut self) -> Result<PoseRecord, Fault> {
        let mut pose = PoseRecord { quaternion_wxyz: [0.0; 4], translation: [0.0; 3] };
        for value in &mut pose.quaternion_wxyz {
            *value = self.f64("a quaternion QW QX QY QZ")?;
        }
        for value in &mut pose.translation {
            *value = self.f64("a translation TX TY TZ")?;
        }
        Ok(pose)
    }

    fn sensor(&mut self) -> Result<SensorRecord, Fault> {
        let name = self.peek();
        let kind = SENSOR_NAMES.iter().find(|(_, known)| known.as_bytes() == name).map(|(kind, _)| *kind);
        let kind = kind.or_else(|| std::str::from_utf8(name).ok()?.parse().ok());
        let kind = kind.ok_or_else(|| self.fault("a sensor type, CAMERA or IMU", name))?;
        self.skip(name.len());
        Ok(SensorRecord { kind, id: self.u32("a sensor id")? })
    }

    fn finish(&mut self) -> Result<(), Fault> {
        match self.peek() {
            [] => Ok(()),
            token => Err(self.fault("the end of the line", token)),
        }
    }
}

/// What stands between two values.
fn is_gap(byte: &u8) -> bool {
    byte.is_ascii_whitespace() || *byte == b','
}

/// How many records the comment that COLMAP puts before them counts: `# Number of points: 745, mean track length: ...`.
pub(super) fn announced(bytes: &[u8]) -> Option<usize> {
    let comments = lines(bytes).map(|(_, line)| line).take_while(|line| line.first() == Some(&b'#'));
    comments.filter_map(|line| std::str::from_utf8(line).ok()).find_map(|line| {
        let count = line.strip_prefix("# Number of ")?.split_once(": ")?.1;
        count.split([',', ' ']).next()?.parse().ok()
    })
}

/// The lines of `bytes` with their positions; `skip_until` finds line ends faster than a loop over bytes.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let line = rest;
        // Reading from a slice cannot fail.
        let length = rest.skip_until(b'\n').unwrap_or(0);
        (length > 0).then(|| (bytes.len() - line.len(), line[..length].trim_ascii_end()))
    })
}

fn is_record((_, line): &(usize, &[u8])) -> bool {
    let line = line.trim_ascii_start();
    !line.is_empty() && line[0] != b'#'
}

pub(super) fn cameras(bytes: &[u8]) -> Result<Vec<CameraRecord>, Fault> {
    lines(bytes).filter(is_record).map(|(at, line)| camera(Line::new(line, at, "camera"))).collect()
}

fn camera(mut line: Line) -> Result<CameraRecord, Fault> {
    let id = line.record_id("a camera id")?;
    let name = line.peek();
    let model = CAMERA_MODELS.iter().find(|m| m.name.as_bytes() == name).ok_or_else(|| {
        let known: Vec<_> = CAMERA_MODELS.iter().map(|m| m.name).collect();
        line.fault(&format!("one of the camera models {}", known.join(", ")), name)
    })?;
    line.skip(name.len());
    let (width, height) = (line.u64("a width in pixels")?, line.u64("a height in pixels")?);
    let mut params = Vec::with_capacity(model.parameter_count);
    for _ in 0..model.parameter_count {
        params.push(line.f64(&format!("{} parameters of {}", model.parameter_count, model.name))?);
    }
    line.finish()?;
    Ok(CameraRecord { id, model, width, height, params })
}

pub(super) fn rigs(bytes: &[u8]) -> Result<Vec<RigRecord>, Fault> {
    lines(bytes).filter(is_record).map(|(at, line)| rig(Line::new(line, at, "rig"))).collect()
}

fn rig(mut line: Line) -> Result<RigRecord, Fault> {
    let id = line.record_id("a rig id")?;
    let sensor_count = line.u64("a number of sensors")?;
    let reference = if sensor_count > 0 { Some(line.sensor()?) } else { None };
    let mut others = Vec::new();
    for _ in 1..sensor_count {
        let sensor = line.sensor()?;
        let pose = match line.u64("0 or 1 for a sensor's pose")? {
            0 => None,
            1 => Some(line.pose()?),
            other => return Err(line.fault("0 or 1 for a sensor's pose", other.to_string().as_bytes())),
        };
        others.push((sensor, pose));
    }
    line.finish()?;
    Ok(RigRecord { id, reference, others })
}

pub(super) fn frames(bytes: &[u8]) -> Result<Vec<FrameRecord>, Fault> {
    lines(bytes).filter(is_record).map(|(at, line)| frame(Line::new(line, at, "frame"))).collect()
}

fn frame(mut line: Line) -> Result<FrameRecord, Fault> {
    let id = line.record_id("a frame id")?;
    let rig_id = line.u32("a rig id")?;
    let rig_from_world = line.pose()?;
    let data_count = line.u64("a number of data ids")?;
    let mut data = Vec::new();
    for _ in 0..data_count {
        data.push((line.sensor()?, line.u64("a data id")?));
    }
    line.finish()?;
    Ok(FrameRecord { id, rig_id, rig_from_world, data })
}

/// Pairs up the lines, then parses the images in parallel.
pub(super) fn images(bytes: &[u8]) -> Result<Vec<ImageRecord>, Fault> {
    let mut pairs = Vec::new();
    let mut rest = lines(bytes);
    while let Some(head) = rest.by_ref().find(is_record) {
        // The second line may be empty, and at the end of the file it may be missing.
        pairs.push((head, rest.next().unwrap_or((bytes.len(), &[]))));
    }
    let images: Vec<_> =
        pairs.into_par_iter().map(|((at, head), points)| image(Line::new(head, at, "image"), points)).collect();
    // In order, so that of several faults the first is told, whatever the threads did.
    images.into_iter().collect()
}

fn image(mut line: Line, (at, points): (usize, &[u8])) -> Result<ImageRecord, Fault> {
    let id = line.record_id("an image id")?;
    let cam_from_world = line.pose()?;
    let camera_id = line.u32("a camera id")?;
    line.skip_blanks();
    let name = line.rest.to_vec();
    let mut line = Line { id: line.id, ..Line::new(points, at, "observations (second line) of image") };
    let mut observations = Vec::with_capacity(points.len() / TYPICAL_OBSERVATION_CHARS);
    while !line.is_at_end() {
        let x = line.f64("a keypoint X Y POINT3D_ID")?;
        let y = line.f64("a keypoint X Y POINT3D_ID")?;
        let token = line.peek();
        let point_id = if token == b"-1" || token == b"-1.0" {
            line.skip(token.len());
            NO_POINT
        } else {
            line.u64("a point id or -1")?
        };
        observations.push(ObservationRecord { x, y, point_id });
    }
    observations.shrink_to_fit();
    Ok(ImageRecord { id, cam_from_world, camera_id, name, observations })
}

/// A keypoint written with all its digits takes about 36 characters, with few digits about 20: a guess that spares
/// most growing.
const TYPICAL_OBSERVATION_CHARS: usize = 24;

pub(super) fn points(bytes: &[u8]) -> Result<PointRecords, Fault> {
    let parts: Vec<_> = pieces(bytes).into_par_iter().map(|(at, piece)| points_of_piece(at, piece)).collect();
    let parts: Vec<_> = parts.into_iter().collect::<Result<_, _>>()?;
    let track_count: usize = parts.iter().map(|p| p.track_elements.len()).sum();
    if u32::try_from(track_count).is_err() {
        return Err(Fault::malformed(0, "points", "fewer than 2^32 track elements", track_count.to_string()));
    }
    let mut all = PointRecords::with_capacity(parts.iter().map(|p| p.ids.len()).sum(), track_count);
    for part in parts {
        let shift = all.track_elements.len() as u32;
        all.ids.extend(part.ids);
        all.positions.extend(part.positions);
        all.colors.extend(part.colors);
        all.errors.extend(part.errors);
        all.track_starts.extend(part.track_starts[1..].iter().map(|start| start + shift));
        all.track_elements.extend(part.track_elements);
    }
    Ok(all)
}

/// Cuts at line ends.
fn pieces(bytes: &[u8]) -> Vec<(usize, &[u8])> {
    let mut pieces = Vec::new();
    let mut start = 0;
    while start < bytes.len() {
        let mut end = (start + PIECE_BYTES).min(bytes.len());
        end += (&bytes[end..]).skip_until(b'\n').unwrap_or(0);
        pieces.push((start, &bytes[start..end]));
        start = end;
    }
    pieces
}

fn points_of_piece(start: usize, piece: &[u8]) -> Result<PointRecords, Fault> {
    let mut points = PointRecords::with_capacity(0, 0);
    for (at, line) in lines(piece).filter(is_record) {
        point(Line::new(line, start + at, "point"), &mut points)?;
    }
    Ok(points)
}

fn point(mut line: Line, points: &mut PointRecords) -> Result<(), Fault> {
    let id = line.u64("a point id")?;
    line.id = Some(id);
    points.ids.push(id);
    let mut position = [0.0; 3];
    for value in &mut position {
        *value = line.f64("a position X Y Z")?;
    }
    points.positions.push(position);
    let mut color = [0; 3];
    for value in &mut color {
        *value = line.u8("a colour R G B, each from 0 to 255")?;
    }
    points.colors.push(color);
    points.errors.push(line.f64("a reprojection error")?);
    while !line.is_at_end() {
        let image_id = line.u32("an image id of the track")?;
        points.track_elements.push((image_id, line.u32("an observation's index of the track")?));
    }
    points.track_starts.push(points.track_elements.len() as u32);
    Ok(())
}

#[cfg(test)]
mod tests;
