//! GLB, and tiles around it (b3dm): a header with lengths, JSON, binary. Lengths are mended.

use crate::bytes;
use crate::chance::Chance;
use crate::{json, tree};

const GLB_HEAD: usize = 12;
const CHUNK_HEAD: usize = 8;
const TILE_HEAD: usize = 28;

pub fn is_container(file: &[u8]) -> bool {
    file.starts_with(b"glTF") || file.starts_with(b"b3dm")
}

/// Spoils one part; where the file is too damaged to be taken apart, any byte.
pub fn spoil(file: &mut Vec<u8>, chance: &mut Chance) {
    let changed =
        if file.starts_with(b"b3dm") { with_spoiled_tile(file, chance) } else { with_spoiled_chunk(file, chance) };
    match changed {
        Some(changed) => *file = changed,
        None => bytes::spoil(file, chance),
    }
}

fn number(file: &[u8], at: usize) -> Option<usize> {
    Some(u32::from_le_bytes(*file.get(at..)?.first_chunk()?) as usize)
}

fn put(file: &mut [u8], at: usize, value: usize) {
    file[at..at + 4].copy_from_slice(&(value as u32).to_le_bytes());
}

/// The JSON, or the chunk after it.
fn with_spoiled_chunk(file: &[u8], chance: &mut Chance) -> Option<Vec<u8>> {
    let length = number(file, GLB_HEAD)?;
    let start = GLB_HEAD + CHUNK_HEAD;
    let (json, mut rest) = (file.get(start..start.checked_add(length)?)?, file[start + length..].to_vec());
    let text = if chance.one_in(4) {
        bytes::spoil(&mut rest, chance);
        json.to_vec()
    } else {
        spoiled_json(json, chance)?
    };
    let mut changed = [&file[..start], &text].concat();
    changed.resize(changed.len().next_multiple_of(4), b' ');
    let json_bytes = changed.len() - start;
    put(&mut changed, GLB_HEAD, json_bytes);
    changed.extend(rest);
    let whole = changed.len();
    put(&mut changed, 8, whole);
    Some(changed)
}

/// The tables of the features, or the GLB behind them.
fn with_spoiled_tile(file: &[u8], chance: &mut Chance) -> Option<Vec<u8>> {
    let mut lengths = [12, 16, 20, 24].map(|at| number(file, at).unwrap_or(usize::MAX));
    let mut parts: Vec<Vec<u8>> = Vec::new();
    let mut at = TILE_HEAD;
    for length in lengths {
        let end = at.checked_add(length)?;
        parts.push(file.get(at..end)?.to_vec());
        at = end;
    }
    let mut glb = file.get(at..)?.to_vec();
    match chance.below(5) {
        table @ (0 | 2) => parts[table] = spoiled_json(&parts[table], chance)?,
        table @ (1 | 3) if !parts[table].is_empty() => bytes::spoil(&mut parts[table], chance),
        _ => glb = with_spoiled_chunk(&glb, chance)?,
    }
    lengths = [0, 1, 2, 3].map(|table| parts[table].len());
    let mut changed = [&file[..TILE_HEAD], &parts.concat(), &glb].concat();
    [12, 16, 20, 24].into_iter().zip(lengths).for_each(|(at, length)| put(&mut changed, at, length));
    let whole = changed.len();
    put(&mut changed, 8, whole);
    Some(changed)
}

fn spoiled_json(json: &[u8], chance: &mut Chance) -> Option<Vec<u8>> {
    let mut root = json::parse(std::str::from_utf8(json).ok()?)?;
    tree::spoil(&mut root, json::written, chance);
    Some(json::written(&root).into_bytes())
}
