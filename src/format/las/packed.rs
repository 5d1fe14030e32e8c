//! Lengths within packed points (LAZ), which the `laz` crate takes memory for before it looks whether so many bytes are there: the number
//! of chunks, and in layered chunks (point formats 6 to 10, COPC) the bytes of every layer.
//!
//! Chunks lie one behind the other. A layered one is its first point as it is, the number of its points, the length of each layer, the layers.

use std::io::{Read, Result as IoResult, Seek, SeekFrom};

use las::laz::is_laszip_vlr;
use laz::laszip::ChunkTable;
use laz::{LazItemType, LazVlr};

/// Layers of a point of the formats from 6 on: returns and plan, height, class, flags, intensity, angle, user's byte, source, time.
const LAYERS_OF_A_POINT: u64 = 9;

const U32_BYTES: u64 = 4;
/// Before the first chunk stands where the table of chunks lies; a writer that could not go back has put it at the file's end.
const OFFSET_BYTES: u64 = 8;

/// How points are packed, as the record of LAZ begins: one after the other in chunks, or in layers.
const IN_CHUNKS: u8 = 2;
const IN_LAYERS: u8 = 3;

/// Items from this version on are packed in layers.
const FIRST_LAYERED: u16 = 3;

/// `Ok` as well where there is nothing to check: the crate says what is missing.
pub(super) fn check_packed(file: &mut (impl Read + Seek), header: &las::Header, length: u64) -> Result<(), String> {
    let record =
        header.vlrs().iter().find(|record| is_laszip_vlr(record)).filter(|_| header.point_format().is_compressed);
    let Some(record) = record else { return Ok(()) };
    let (Ok(packing), Some(way)) = (LazVlr::from_buffer(&record.data), record.data.first()) else { return Ok(()) };
    let points_at = points_at(file).map_err(|_| format!("{length} bytes are too few for a LAS header"))?;
    if [IN_CHUNKS, IN_LAYERS].contains(way) {
        check_table(file, &packing, points_at, length)?;
    }
    // The crate goes by the versions of the items, whatever the record says.
    match (*way, is_layered(&packing)) {
        (IN_LAYERS, _) => {}
        (_, true) => return Err("points are packed in layers, and said not to be".into()),
        (_, false) => return Ok(()),
    }
    let chunks = chunks_of(file, &packing, points_at, header.number_of_points());
    let chunks = chunks.ok_or("the table of the packed chunks cannot be read")?;
    check_layers(file, &packing, points_at + OFFSET_BYTES, chunks, length)
}

pub(super) fn is_layered(packing: &LazVlr) -> bool {
    packing.items().iter().any(|item| item.version() >= FIRST_LAYERED)
}

pub(super) fn points_at(file: &mut (impl Read + Seek)) -> IoResult<u64> {
    file.seek(SeekFrom::Start(96))?;
    u32_of(file).map(u64::from)
}

fn u32_of(file: &mut impl Read) -> IoResult<u32> {
    let mut bytes = [0; U32_BYTES as usize];
    file.read_exact(&mut bytes)?;
    Ok(u32::from_le_bytes(bytes))
}

fn u64_at(file: &mut (impl Read + Seek), at: SeekFrom) -> IoResult<u64> {
    let mut bytes = [0; OFFSET_BYTES as usize];
    file.seek(at)?;
    file.read_exact(&mut bytes)?;
    Ok(u64::from_le_bytes(bytes))
}

/// The number of chunks, where the crate will look for it.
fn check_table(file: &mut (impl Read + Seek), packing: &LazVlr, points_at: u64, length: u64) -> Result<(), String> {
    let mut offset = |place| u64_at(file, place).ok().filter(|at| at.cast_signed() > points_at.cast_signed());
    let table_at = offset(SeekFrom::Start(points_at)).or_else(|| offset(SeekFrom::End(-OFFSET_BYTES.cast_signed())));
    let count_at = table_at.and_then(|at| at.checked_add(U32_BYTES));
    let count = count_at.and_then(|at| file.seek(SeekFrom::Start(at)).and_then(|_| u32_of(file)).ok());
    // The first point of each chunk stands there as it is.
    let most = length / packing.items_size().max(1);
    match count {
        Some(count) if u64::from(count) > most => {
            Err(format!("it says {count} chunks of packed points, of which at most {most} fit into {length} bytes"))
        }
        _ => Ok(()),
    }
}

/// Chunks that are decoded to come to all points; `None` where the table cannot be read, after which the crate would begin anywhere.
fn chunks_of(file: &mut (impl Read + Seek), packing: &LazVlr, points_at: u64, points: u64) -> Option<u64> {
    file.seek(SeekFrom::Start(points_at)).ok()?;
    let table = ChunkTable::read_from(file, packing).ok()?;
    if !packing.uses_variable_size_chunks() {
        return Some(points.div_ceil(u64::from(packing.chunk_size().max(1))));
    }
    let mut left = points;
    let is_needed = |chunk: &u64| {
        let is_needed = left > 0;
        left = left.saturating_sub(*chunk);
        is_needed
    };
    let needed = table.as_ref().iter().map(|chunk| chunk.point_count).take_while(is_needed).count() as u64;
    // The decoder looks into one more, where the table knows fewer points.
    Some(needed + u64::from(left > 0))
}

fn check_layers(
    file: &mut (impl Read + Seek),
    packing: &LazVlr,
    first_at: u64,
    chunks: u64,
    length: u64,
) -> Result<(), String> {
    let layers: u64 = packing.items().iter().map(|item| layers_of(item.item_type())).sum();
    let head_bytes = packing.items_size() + U32_BYTES;
    let mut at = first_at;
    for chunk in 1..=chunks {
        let beyond = || format!("chunk {chunk} of {chunks}, at byte {at}, ends beyond the file's {length} bytes");
        let mut end = at + head_bytes + layers * U32_BYTES;
        file.seek(SeekFrom::Start(at + head_bytes)).map_err(|_| beyond())?;
        for _ in 0..layers {
            end += u64::from(u32_of(file).map_err(|_| beyond())?);
        }
        if end > length {
            return Err(beyond());
        }
        at = end;
    }
    Ok(())
}

fn layers_of(item: LazItemType) -> u64 {
    match item {
        LazItemType::Point14 => LAYERS_OF_A_POINT,
        LazItemType::RGB14 | LazItemType::WavePacket14 => 1,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(bytes) => bytes.into(),
        // Items of the formats before 6 are not packed in layers; the crate refuses them here.
        _ => 0,
    }
}
