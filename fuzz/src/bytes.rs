//! Binary records: numbers at any place to extreme values, blocks cut, doubled and moved, single bits.

use crate::chance::Chance;

/// Where headers and first records stand.
const HEAD_BYTES: usize = 256;

const WHOLE: [u64; 16] = [
    0,
    1,
    2,
    0x7F,
    0x80,
    0xFF,
    0x7FFF,
    0xFFFF,
    0x1_0000,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    0x1_0000_0000,
    i64::MAX as u64,
    1 << 63,
    u64::MAX,
];

const REAL: [f64; 10] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN_POSITIVE, 5e-324, -0.0, 1e154, -1e19, 1e-9];

/// Spoils one place.
pub fn spoil(bytes: &mut Vec<u8>, chance: &mut Chance) {
    if bytes.is_empty() {
        return bytes.push(chance.bits() as u8);
    }
    let among = if chance.one_in(2) { bytes.len().min(HEAD_BYTES) } else { bytes.len() };
    let at = chance.below(among);
    match chance.below(12) {
        0 | 1 => bytes[at] ^= 1 << chance.below(8),
        2 => bytes[at] = chance.bits() as u8,
        3..=5 => put_number(bytes, at, chance),
        6 => step(bytes, at, chance),
        7 => bytes.truncate(at),
        8 => {
            let end = (at + chance.few()).min(bytes.len());
            bytes.drain(at..end);
        }
        9 => {
            let end = (at + chance.few()).min(bytes.len());
            let block = bytes[at..end].to_vec();
            let to = chance.below(bytes.len());
            bytes.splice(to..to, block);
        }
        10 => {
            let end = (at + chance.few()).min(bytes.len());
            bytes[at..end].fill(*chance.pick(&[0, 0xFF, b' ']).unwrap_or(&0));
        }
        _ => {
            let span = chance.span(bytes.len());
            let length = span.len().min(bytes.len() - at);
            bytes.copy_within(span.start..span.start + length, at);
        }
    }
}

/// A number at the edge of a type, of 1 to 8 bytes, in either order of bytes.
fn put_number(bytes: &mut [u8], at: usize, chance: &mut Chance) {
    let size = 1 << chance.below(4);
    let mut number = match chance.below(3) {
        0 if size == 8 => chance.pick(&REAL).map_or(0, |v| v.to_bits()).to_le_bytes(),
        0 if size == 4 => u64::from(chance.pick(&REAL).map_or(0, |v| (*v as f32).to_bits())).to_le_bytes(),
        _ => chance.pick(&WHOLE).map_or(0, |v| *v).to_le_bytes(),
    };
    if chance.one_in(4) {
        number[..size].reverse();
    }
    // Records are mostly aligned to their size.
    let at = if chance.one_in(2) { at - at % size } else { at };
    let end = (at + size).min(bytes.len());
    bytes[at..end].copy_from_slice(&number[..end - at]);
}

/// One more or fewer than what stands there, as when a record was left out.
fn step(bytes: &mut [u8], at: usize, chance: &mut Chance) {
    let Some(place) = bytes.get_mut(at..at + 4) else { return };
    let number = u32::from_le_bytes([place[0], place[1], place[2], place[3]]);
    let by = chance.few() as u32;
    let changed = if chance.one_in(2) { number.wrapping_add(by) } else { number.wrapping_sub(by) };
    place.copy_from_slice(&changed.to_le_bytes());
}
