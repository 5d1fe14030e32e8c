//! Counts, offsets and lengths of a LAS header, against the length of the file.

use std::io::{Read, Seek, SeekFrom};

/// Points that a byte of a compressed file may hold. Chosen: clouds as they are come to one in two to four bytes; a file of the
/// same point again and again, which is none, to a thousand in one.
const MOST_POINTS_OF_A_BYTE: u64 = 8;

/// Points of any compressed file that are not asked about.
const POINTS_OF_ANY_FILE: u64 = 1 << 16;

/// Records before the points, with the name of what they hold, and their length.
const RECORD_HEAD_BYTES: u64 = 54;

/// Those behind the points have longer ones (LAS 1.4 R15, table 9): the version that brought them, and where the header says where they
/// begin and how many there are.
const RECORDS_BEHIND_SINCE: [u8; 2] = [1, 4];
const RECORDS_BEHIND_AT: u64 = 235;
const LONG_RECORD_HEAD_BYTES: u64 = 60;

/// The format of the points, and the bit of it that says that they are packed.
const FORMAT_AT: usize = 104;
const PACKED_BIT: u8 = 0x80;

/// How the points lie in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Plain,
    Packed,
}

/// Offsets and lengths that the crate takes memory for, against the length of the file; and whether its points are packed.
pub(super) fn check_head(file: &mut (impl Read + Seek), length: u64) -> Result<Packing, String> {
    let mut head = [0; FORMAT_AT + 1];
    file.read_exact(&mut head).map_err(|_| format!("{length} bytes are too few for a LAS header"))?;
    let u16_at = |at: usize| u64::from(u16::from_le_bytes([head[at], head[at + 1]]));
    let u32_at = |at: usize| u64::from(u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]));
    let (header_bytes, points_at, records) = (u16_at(94), u32_at(96), u32_at(100));
    if header_bytes > points_at || points_at > length {
        return Err(format!("points begin at byte {points_at} of {length}, after a header of {header_bytes}"));
    }
    if records.saturating_mul(RECORD_HEAD_BYTES) > points_at - header_bytes {
        return Err(format!("{records} records cannot lie before the points, at byte {points_at}"));
    }
    // Whatever length it says of its header.
    if head[24..26] >= RECORDS_BEHIND_SINCE[..] {
        check_records_behind(file, length)?;
    }
    Ok(if head[FORMAT_AT] & PACKED_BIT == 0 { Packing::Plain } else { Packing::Packed })
}

/// Records behind the points, whose lengths have 64 bits.
fn check_records_behind(file: &mut (impl Read + Seek), length: u64) -> Result<(), String> {
    let mut place = [0; 12];
    let cut = |_| format!("{length} bytes are too few for the header of LAS 1.4");
    file.seek(SeekFrom::Start(RECORDS_BEHIND_AT)).and_then(|_| file.read_exact(&mut place)).map_err(cut)?;
    let [low, middle, high] =
        [0, 4, 8].map(|at| u32::from_le_bytes([place[at], place[at + 1], place[at + 2], place[at + 3]]));
    let mut at = u64::from(low) | u64::from(middle) << 32;
    for number in 1..=high {
        let beyond = || {
            format!("record {number} of {high} behind the points, at byte {at}, ends beyond the file's {length} bytes")
        };
        let mut head = [0; LONG_RECORD_HEAD_BYTES as usize];
        file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(&mut head)).map_err(|_| beyond())?;
        let bytes = head[20..28].iter().rev().fold(0, |bytes, byte| bytes << 8 | u64::from(*byte));
        let end = bytes.checked_add(at + LONG_RECORD_HEAD_BYTES).filter(|end| *end <= length);
        at = end.ok_or_else(beyond)?;
    }
    Ok(())
}

pub(super) fn check_count(header: &las::Header, length: u64) -> Result<(), String> {
    let count = header.number_of_points();
    let format = header.point_format();
    let most = if format.is_compressed {
        length.saturating_mul(MOST_POINTS_OF_A_BYTE).max(POINTS_OF_ANY_FILE)
    } else {
        length / u64::from(format.len().max(1))
    };
    if count > most {
        return Err(format!("it says {count} points, of which at most {most} fit into the file's {length} bytes"));
    }
    let packed = header.laz_vlr().map(|record| record.items_size()).ok().filter(|_| format.is_compressed);
    if packed.is_some_and(|bytes| bytes != u64::from(format.len())) {
        return Err(format!("points of {} bytes, packed as others of {packed:?}", format.len()));
    }
    let transforms = header.transforms();
    // Coordinates are whole numbers of 32 bits, scaled and shifted.
    let farthest = |t: las::Transform| t.scale.abs() * f64::from(u32::MAX) + t.offset.abs();
    if ![transforms.x, transforms.y, transforms.z].into_iter().map(farthest).all(f64::is_finite) {
        return Err("a scale or an offset is not a finite number, or beyond all numbers".into());
    }
    Ok(())
}
