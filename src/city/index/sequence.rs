//! A long CityJSONSeq to the blocks of an index in bounded memory: one look through all of it (`survey.rs`), then a square kilometre at a time.
//!
//! Question     which model would the whole file give, block by block, without holding it?
//! Method       what is decided for the whole (frame, origin, sense of winding) is found in the survey; the features of a square are read again
//!              and built as any city is; each facet, object and vertex gets its place among those of the whole by counting
//! Assumptions  a feature stands in one place; facets that stand twice are counted within a square only

use std::collections::BTreeMap;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use rayon::prelude::*;

use super::counted::Counted;
use super::draft::written;
use super::pack::{Orders, packed};
use super::plan::block_plans;
use super::survey::{Feature, Survey};
use super::tally::Tally;
use super::words::{VertexNumbers, Words};
use crate::city::build::build_part;
use crate::city::frame::Frame;
use crate::city::levels::choose;
use crate::city::orientation::FileSense;
use crate::city::origin::{origin_of, sample_step};
use crate::city::source::Source;
use crate::city::{CityError, CityOptions, CityRole, CityUnit, CityUp};
use crate::format::city_index::{BlockEntry, IndexWriter};
use crate::format::file::open_regular;
use crate::geometry::{Point3, Vector3};

/// Side of what is built together, metres, and the text that it is at most. Chosen: some thousand houses.
const SQUARE_M: f64 = 1000.0;
const SQUARE_BYTES: u64 = 32 << 20;

/// A sequence whose frame and origin are known.
pub(super) struct Sequence<'a> {
    path: &'a Path,
    options: &'a CityOptions,
    survey: Survey,
    frame: Frame,
    /// Faces, objects and corners before each feature.
    before: Vec<[u64; 3]>,
    origin: Vector3<f64>,
}

/// A block in its bytes.
pub(super) struct PackedBlock {
    pub bytes: Vec<u8>,
    pub entry: BlockEntry,
}

impl<'a> Sequence<'a> {
    /// Surveys a file that is a sequence of at least so many bytes; `None` where it is anything else, or nothing in it is to be built.
    pub fn of(path: &'a Path, options: &'a CityOptions, least_bytes: u64) -> Result<Option<Sequence<'a>>, CityError> {
        let Some(survey) = Survey::of(path, options, least_bytes)? else { return Ok(None) };
        let frame = Frame::of_evidence(&survey.beginning, &survey.evidence, options);
        let mut sums = [0; 3];
        let before = survey.features.iter().map(|feature| {
            let before = sums;
            let own = [feature.faces, feature.objects, feature.corners];
            sums = [0, 1, 2].map(|k| sums[k] + u64::from(own[k]));
            before
        });
        let before: Vec<[u64; 3]> = before.collect();
        if sums[0] == 0 {
            return Ok(None);
        }
        if sums[0] > u64::from(u32::MAX) {
            return Err(CityError::TooLarge { path: path.to_owned() });
        }
        let mut sequence = Sequence { path, options, survey, frame, before, origin: Vector3::zeros() };
        sequence.origin = sequence.common_origin(sums[2] as usize)?;
        Ok(Some(sequence))
    }

    /// Writes the blocks of all squares, and tells of the whole.
    pub fn write(self, writer: &mut IndexWriter, words: Words) -> Result<Words, CityError> {
        let beginning = writer.position();
        let mut tally = self.write_as(writer, FileSense::Known { turned: false })?;
        if tally.told.is_mostly_inward() {
            // Only the whole tells it.
            written(writer.rewind(beginning), self.path)?;
            tally = self.write_as(writer, FileSense::Known { turned: true })?;
        }
        let (objects, faces) = self.sums();
        let (size, precision_m, bounds) = (tally.size(objects as usize), tally.precision_m, tally.bounds());
        let warnings = tally.warnings(&self.frame, self.path, self.options);
        let contents = self.survey.contents.clone();
        let source = super::words::SourceWords {
            path: self.path.to_string_lossy().into_owned(),
            role: CityRole::City,
            facets: [0, faces],
            objects: [0, objects],
            precision_m,
            contents,
        };
        let (crs, origin) = (self.frame.crs.clone(), self.origin.into());
        Ok(Words {
            crs,
            origin,
            size,
            bounds,
            warnings,
            sources: vec![source],
            vertices: VertexNumbers::ByPlace,
            ..words
        })
    }

    fn sums(&self) -> (u32, u32) {
        let last = self.before.last().zip(self.survey.features.last());
        last.map_or((0, 0), |(before, own)| (before[1] as u32 + own.objects, before[0] as u32 + own.faces))
    }

    fn write_as(&self, writer: &mut IndexWriter, sense: FileSense) -> Result<Tally, CityError> {
        let mut tally = Tally::default();
        let squares = self.squares();
        for some in squares.chunks(rayon::current_num_threads()) {
            let built = some.par_iter().map(|square| self.blocks_of(square, sense));
            for (blocks, own) in built.collect::<Result<Vec<_>, _>>()? {
                for PackedBlock { bytes, entry } in blocks {
                    written(writer.add_block(&bytes, entry), self.path)?;
                }
                tally.add(own);
            }
        }
        Ok(tally)
    }

    /// Features by the squares that they stand in, in the order of the file.
    fn squares(&self) -> Vec<Vec<u32>> {
        let mut squares: BTreeMap<[i64; 2], Vec<u32>> = BTreeMap::new();
        for (at, feature) in (0..).zip(&self.survey.features) {
            let place = self.placed(feature.middle) - self.origin;
            squares.entry([place.x, place.y].map(|value| (value / SQUARE_M).floor() as i64)).or_default().push(at);
        }
        let mut all = Vec::new();
        for square in squares.into_values() {
            let mut bytes = 0;
            all.push(Vec::new());
            for at in square {
                let length = u64::from(self.feature(at).length);
                if bytes > 0 && bytes + length > SQUARE_BYTES {
                    bytes = 0;
                    all.push(Vec::new());
                }
                bytes += length;
                all.last_mut().into_iter().for_each(|square| square.push(at));
            }
        }
        all
    }

    fn feature(&self, at: u32) -> &Feature {
        &self.survey.features[at as usize]
    }

    /// Where a place of the file is in the city.
    fn placed(&self, position: [f64; 3]) -> Point3<f64> {
        let at = self.frame.placed(position);
        let at = if self.up() == CityUp::Y { Point3::new(at.x, -at.z, at.y) } else { at };
        at * self.metres() + Vector3::from(self.options.origin)
    }

    fn up(&self) -> CityUp {
        self.options.up.unwrap_or(CityUp::Z)
    }

    fn metres(&self) -> f64 {
        let unit =
            if self.frame.projection.is_some() { CityUnit::Metre } else { self.options.unit.unwrap_or_default() };
        unit.metres()
    }

    /// Some features as the file of a city.
    fn source_of(&self, features: &[u32]) -> Result<Source, CityError> {
        let unreadable = |reason| CityError::Unreadable { path: self.path.to_owned(), reason };
        let mut file = open_regular(self.path).map_err(unreadable)?;
        let mut lines = Vec::new();
        for &at in features {
            let Feature { at, length, .. } = *self.feature(at);
            let start = lines.len();
            lines.resize(start + length as usize, 0);
            file.seek(SeekFrom::Start(at)).map_err(unreadable)?;
            file.read_exact(&mut lines[start..]).map_err(unreadable)?;
            lines.push(b'\n');
        }
        let of_path = |error| CityError::CityJson { path: self.path.to_owned(), error: Box::new(error) };
        let parsed = self.survey.parsed(&lines).map_err(of_path)?;
        let chosen = choose(&parsed, self.options.lod, CityRole::City);
        let mut source = Source::from_surfaces(self.path, CityRole::City, parsed, &chosen, &self.frame);
        source.turn(self.up());
        source.scale_and_shift(self.metres(), self.options.origin);
        source.check_reach()?;
        Ok(source)
    }

    /// As that of the whole read at once: by the same corners.
    fn common_origin(&self, corners: usize) -> Result<Vector3<f64>, CityError> {
        let wanted: Vec<u64> = (0..corners as u64).step_by(sample_step(corners)).collect();
        let feature_of = |corner: &u64| self.before.partition_point(|before| before[2] <= *corner) - 1;
        let runs: Vec<&[u64]> = wanted.chunk_by(|a, b| feature_of(a) == feature_of(b)).collect();
        let sampled = runs.par_iter().map(|run| {
            let feature = feature_of(&run[0]);
            let source = self.source_of(&[feature as u32])?;
            let place =
                |corner: &u64| source.positions[source.corners[(corner - self.before[feature][2]) as usize] as usize];
            Ok(run.iter().map(place).collect::<Vec<_>>())
        });
        Ok(origin_of(&sampled.collect::<Result<Vec<_>, CityError>>()?.concat()))
    }

    fn blocks_of(&self, features: &[u32], sense: FileSense) -> Result<(Vec<PackedBlock>, Tally), CityError> {
        let source = self.source_of(features)?;
        let Some(part) = build_part(&source, self.origin, sense)? else {
            return Ok((Vec::new(), Tally::of_source(&source, &|_| 0)));
        };
        let of_features: Vec<_> = features.iter().map(|&at| (*self.feature(at), self.before[at as usize])).collect();
        let counted = Counted::new(&of_features, &source, &part);
        let orders = Orders {
            facet: &|facet| counted.faces[part.facet_faces[facet as usize] as usize],
            object: &|object| counted.objects[object as usize],
            vertex: &|vertex| counted.vertices[vertex as usize],
        };
        let tally = Tally::of_part(&source, &part, orders.object);
        let blocks = block_plans(&part.model).into_iter().map(|plan| {
            let (parts, entry) = packed(&part.model, &plan, &orders);
            let bytes = parts.to_bytes().map_err(|fault| CityError::Index { path: self.path.to_owned(), fault })?;
            Ok(PackedBlock { bytes, entry })
        });
        Ok((blocks.collect::<Result<_, CityError>>()?, tally))
    }
}
