//! A long CityJSONSeq looked through once, feature by feature: what decides the frame, what each feature holds and where it stands.
//!
//! What is kept is some sixty bytes a feature, so that a file of any length is surveyed in the memory of its features' places.

use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use rayon::prelude::*;

use crate::city::frame::FrameEvidence;
use crate::city::levels::choose;
use crate::city::{CityContents, CityError, CityOptions, CityRole};
use crate::format::cityjson::{CityJsonError, read_cityjson};
use crate::format::file::open_regular;
use crate::format::surfaces::SurfaceFile;

/// Bytes of lines that are parsed together. Chosen: work enough for all threads.
const BATCH_BYTES: usize = 8 << 20;

/// A header that is longer is no header of a sequence.
const LONGEST_HEADER: u64 = 64 << 20;

/// What was seen of a sequence.
pub(super) struct Survey {
    /// The first line.
    pub header: Vec<u8>,
    /// What it says: format, reference system, step.
    pub beginning: SurfaceFile,
    pub features: Vec<Feature>,
    pub evidence: FrameEvidence,
    pub contents: CityContents,
}

/// A line of the file, and what is taken of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feature {
    pub at: u64,
    pub length: u32,
    pub objects: u32,
    pub faces: u32,
    pub corners: u32,
    /// Middle of the box of its corners; file coordinates.
    pub middle: [f64; 3],
}

/// The header of a file that is a sequence of features, one a line; `None` where it is anything else, or short.
fn header_of(path: &Path, least_bytes: u64) -> Option<(Vec<u8>, SurfaceFile)> {
    let file = open_regular(path).ok()?;
    if file.metadata().ok()?.len() < least_bytes {
        return None;
    }
    let mut header = Vec::new();
    BufReader::new(file).take(LONGEST_HEADER).read_until(b'\n', &mut header).ok()?;
    let is_json = header.trim_ascii_start().starts_with(b"{");
    let beginning =
        read_cityjson(&header).ok().filter(|file| is_json && file.step.is_some() && file.objects.is_empty())?;
    Some((header, beginning))
}

impl Survey {
    /// Looks through a file that is a sequence of at least so many bytes; `None` where it is anything else.
    pub fn of(path: &Path, options: &CityOptions, least_bytes: u64) -> Result<Option<Survey>, CityError> {
        let unreadable = |reason| CityError::Unreadable { path: path.to_owned(), reason };
        let Some((header, beginning)) = header_of(path, least_bytes) else { return Ok(None) };
        let mut contents = CityContents::of(&beginning);
        contents.format.push_str(" Seq");
        let at = header.len() as u64;
        let mut survey =
            Survey { header, beginning, features: Vec::new(), evidence: FrameEvidence::default(), contents };
        let mut file = BufReader::new(open_regular(path).map_err(unreadable)?);
        file.seek(SeekFrom::Start(at)).map_err(unreadable)?;
        let mut next = Next { at, line: 2 };
        loop {
            let lines = next.batch(&mut file).map_err(unreadable)?;
            if lines.is_empty() {
                return Ok(Some(survey));
            }
            let seen = lines.par_iter().map(|line| survey.look(line, options));
            let seen: Vec<Seen> =
                seen.collect::<Result<_, _>>().map_err(|error| CityError::CityJson { path: path.to_owned(), error })?;
            for Seen { feature, evidence, contents } in seen {
                survey.features.push(feature);
                survey.evidence.add(&evidence);
                survey.contents.add(&contents);
            }
        }
    }

    /// Some lines as one file.
    pub fn parsed(&self, lines: &[u8]) -> Result<SurfaceFile, CityJsonError> {
        read_cityjson(&[&self.header, lines].concat())
    }

    fn look(&self, line: &Line, options: &CityOptions) -> Result<Seen, Box<CityJsonError>> {
        let file = self.parsed(line.text.trim_ascii_end()).map_err(|error| {
            // It stands behind the header here, and farther down in the file.
            Box::new(CityJsonError { line: error.line + line.number as usize - 2, ..error })
        })?;
        let chosen = choose(&file, options.lod, CityRole::City);
        let mut feature = Feature {
            at: line.at,
            length: line.text.len() as u32,
            objects: 0,
            faces: chosen.surfaces.len() as u32,
            corners: 0,
            middle: [0.0; 3],
        };
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut roots = Vec::new();
        for &surface in &chosen.surfaces {
            let surface = file.surfaces[surface as usize];
            roots.push(crate::city::from_surfaces::root_of(&file.objects, surface.object as usize));
            for ring in surface.first_ring..surface.first_ring + surface.ring_count {
                feature.corners += file.ring(ring).len() as u32;
                for position in file.ring(ring).iter().map(|&at| file.positions[at as usize]) {
                    low = [0, 1, 2].map(|k| position[k].min(low[k]));
                    high = [0, 1, 2].map(|k| position[k].max(high[k]));
                }
            }
        }
        roots.sort_unstable();
        roots.dedup();
        feature.objects = roots.len() as u32;
        if feature.corners > 0 {
            feature.middle = [0, 1, 2].map(|k| (low[k] + high[k]) / 2.0);
        }
        let mut contents = CityContents::of(&file);
        contents.format.clear();
        Ok(Seen { feature, evidence: FrameEvidence::of(&[&file]), contents })
    }
}

/// What one line tells.
struct Seen {
    feature: Feature,
    evidence: FrameEvidence,
    contents: CityContents,
}

struct Line {
    at: u64,
    number: u32,
    text: Vec<u8>,
}

/// Where the next line begins.
struct Next {
    at: u64,
    line: u32,
}

impl Next {
    /// The next lines that are not empty; none at the end.
    fn batch(&mut self, file: &mut impl BufRead) -> std::io::Result<Vec<Line>> {
        let (mut lines, mut bytes) = (Vec::new(), 0);
        while bytes < BATCH_BYTES {
            let mut text = Vec::new();
            // Longer lines are no features; the rest of one is told as broken.
            if file.take(u64::from(u32::MAX)).read_until(b'\n', &mut text)? == 0 {
                break;
            }
            let (at, number) = (self.at, self.line);
            self.at += text.len() as u64;
            self.line += 1;
            bytes += text.len();
            if !text.trim_ascii().is_empty() {
                lines.push(Line { at, number, text });
            }
        }
        Ok(lines)
    }
}
