//! Points a piece at a time, from whatever packing.
//!
//! Layered points (formats 6 to 10, COPC) are unpacked without their times, of which the `laz` crate goes a call deeper for every change between
//! four clocks (`read_gps_time` in its `las/point6.rs`). Nothing bounds the depth: a byte of the layer may hold tens of thousands of changes,
//! and the layer is read whole before, so that the source cannot see it. What an alignment has no use for stays packed as well.

use std::fs::File;
use std::io::{Seek, SeekFrom};

use las::{Header, PointData, PointDataBuilder, Reader};
use laz::{DecompressionSelection, LasZipDecompressor};

use super::depth::Shallow;
use super::packed::{is_layered, points_at};

/// The points of a file, in their order.
pub(super) enum Pieces {
    Any(Reader),
    Layered { unpacker: LasZipDecompressor<'static, Shallow<File>>, piece: PointDataBuilder, left: u64 },
}

impl Pieces {
    pub fn of(mut file: File, header: &Header) -> las::Result<Pieces> {
        let packing =
            header.laz_vlr().ok().filter(|packing| header.point_format().is_compressed && is_layered(packing));
        let Some(packing) = packing else {
            file.seek(SeekFrom::Start(0))?;
            return Ok(Pieces::Any(Reader::new(Shallow::new(file))?));
        };
        let points_at = points_at(&mut file)?;
        file.seek(SeekFrom::Start(points_at))?;
        let unpacker = LasZipDecompressor::selective(Shallow::new(file), packing, wanted())?;
        let piece = PointDataBuilder::new().for_header(header);
        Ok(Pieces::Layered { unpacker, piece, left: header.number_of_points() })
    }

    /// The next points, at most so many; none at the end.
    pub fn next(&mut self, at_most: u64) -> las::Result<PointData> {
        match self {
            Pieces::Any(reader) => reader.read_points(at_most),
            Pieces::Layered { unpacker, piece, left } => {
                let count = at_most.min(*left);
                let mut points = piece.clone().build();
                unpacker.decompress_many(points.resize_for(count as usize))?;
                *left -= count;
                Ok(points)
            }
        }
    }

    /// Whether the time of each point is its own.
    pub fn have_times(&self) -> bool {
        matches!(self, Pieces::Any(_))
    }
}

/// Layers that are unpacked beside the coordinates in plan, the returns and the channel, which always are.
fn wanted() -> DecompressionSelection {
    DecompressionSelection::base()
        .decompress_z()
        .decompress_classification()
        .decompress_flags()
        .decompress_intensity()
        .decompress_point_source_id()
        .decompress_rgb()
        .decompress_nir()
}
