//! E57: pages of 1020 bytes with a check sum behind each, XML at the end that tells where records lie (ASTM E2807).

use crate::bytes;
use crate::chance::Chance;
use crate::checksum::{CASTAGNOLI, crc32};
use crate::{tree, xml};

const PAGE: usize = 1020;
const SUM: usize = 4;

pub fn is_e57(file: &[u8]) -> bool {
    file.starts_with(b"ASTM-E57")
}

/// Spoils what the pages hold, or the XML; sums and lengths are mended.
pub fn spoil(file: &mut Vec<u8>, chance: &mut Chance) {
    let mut content: Vec<u8> =
        file.chunks(PAGE + SUM).flat_map(|page| &page[..page.len().min(PAGE)]).copied().collect();
    let spoiled_xml = if chance.one_in(3) { None } else { with_spoiled_xml(&content, chance) };
    match spoiled_xml {
        Some(changed) => content = changed,
        None => bytes::spoil(&mut content, chance),
    }
    *file = paged(&content);
}

/// Bytes of pages that stand before a byte of the content.
fn physical(at: usize) -> u64 {
    (at + at / PAGE * SUM) as u64
}

fn with_spoiled_xml(content: &[u8], chance: &mut Chance) -> Option<Vec<u8>> {
    let number = |at: usize| Some(u64::from_le_bytes(*content.get(at..)?.first_chunk()?) as usize);
    let (offset, length) = (number(24)?, number(32)?);
    let start = offset.checked_sub(offset / (PAGE + SUM) * SUM)?;
    let text = std::str::from_utf8(content.get(start..start.checked_add(length)?)?).ok()?;
    let mut root = xml::parse(text)?;
    tree::spoil(&mut root, xml::written, chance);
    let text = xml::written(&root);
    let mut changed = content[..start].to_vec();
    changed.extend(text.bytes());
    changed.resize(changed.len().next_multiple_of(PAGE), 0);
    let file_length = physical(changed.len());
    for (at, value) in [(16, file_length), (32, text.len() as u64)] {
        changed.get_mut(at..at + 8)?.copy_from_slice(&value.to_le_bytes());
    }
    Some(changed)
}

fn paged(content: &[u8]) -> Vec<u8> {
    let page = |page: &[u8]| [page, &crc32(CASTAGNOLI, page).to_be_bytes()].concat();
    content.chunks(PAGE).flat_map(page).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_of_a_sound_file_are_the_same_again() {
        let file = include_bytes!("../seeds/e57/two_scans.e57");
        let content: Vec<u8> = file.chunks(PAGE + SUM).flat_map(|page| &page[..PAGE]).copied().collect();
        assert_eq!(paged(&content), file);
    }
}
