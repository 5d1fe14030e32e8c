//! Lines and words: OBJ, COLMAP's text, NVM, Bundler, tables, headers of PLY.

use crate::chance::Chance;
use crate::words::spoiled;

/// Spoils one line, or the order of lines. Bytes that are no text stay as they are.
pub fn spoil(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let mut lines: Vec<Vec<u8>> = bytes.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
    let at = line(&lines, chance);
    match chance.below(12) {
        0 => drop(lines.remove(at)),
        1 => {
            let copy = lines[at].clone();
            let copies = chance.copies(copy.len());
            lines.splice(at..at, std::iter::repeat_n(copy, copies));
        }
        2 => {
            let second = line(&lines, chance);
            lines.swap(at, second);
        }
        3 => lines.truncate(at),
        4 if at + 1 < lines.len() => {
            let next = lines.remove(at + 1);
            lines[at].push(b' ');
            lines[at].extend(next);
        }
        5 => {
            let end = chance.below(lines[at].len() + 1);
            lines[at].truncate(end);
        }
        6 if chance.one_in(4) => return dress(bytes, chance),
        _ => lines[at] = spoiled_line(&lines[at], chance),
    }
    *bytes = lines.join(&b'\n');
}

/// Half of the draws go to the first lines, where counts stand.
fn line(lines: &[Vec<u8>], chance: &mut Chance) -> usize {
    let among = if chance.one_in(2) { lines.len().min(8) } else { lines.len() };
    chance.below(among)
}

fn spoiled_line(line: &[u8], chance: &mut Chance) -> Vec<u8> {
    let text = String::from_utf8_lossy(line).into_owned();
    let separator = [',', ';', '\t'].into_iter().find(|c| text.contains(*c)).unwrap_or(' ');
    let mut words: Vec<String> = text.split(separator).map(str::to_owned).collect();
    let [at, second] = [(); 2].map(|()| chance.below(words.len()));
    match chance.below(8) {
        0 => drop(words.remove(at)),
        1 => {
            let copy = words[at].clone();
            let copies = chance.copies(copy.len());
            words.splice(at..at, std::iter::repeat_n(copy, copies));
        }
        2 => words.swap(at, second),
        3 => words.truncate(at),
        _ => words[at] = spoiled(&words[at], chance),
    }
    let joint = if chance.one_in(20) { "," } else { &*separator.to_string() };
    words.join(joint).into_bytes()
}

/// The whole in another dress: other ends of lines, a mark before it, UTF-16, no end of the last line.
fn dress(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let text = String::from_utf8_lossy(bytes).into_owned();
    *bytes = match chance.below(6) {
        0 => text.replace('\n', "\r\n").into_bytes(),
        1 => text.replace('\n', "\r").into_bytes(),
        2 => format!("\u{feff}{text}").into_bytes(),
        3 => [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect(),
        4 => text.trim_end().to_owned().into_bytes(),
        _ => text.replace('\n', " ").into_bytes(),
    };
}
