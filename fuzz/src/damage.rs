//! Chooses how a file is damaged, by what it holds.

use crate::chance::Chance;
use crate::{bytes, e57, glb, json, text, tree, xml};

/// Most places that are damaged in one case: one alone goes deepest, several meet what only their combination does.
const MOST_PLACES: usize = 4;

/// A file that has grown beyond this is cut, bytes: many small cases find more than few large ones.
const LARGEST_BYTES: usize = 1 << 20;

/// What a file is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Json,
    /// A JSON in each line.
    JsonLines,
    Xml,
    /// Text before, binary after the line `end_header`.
    Ply,
    Text,
    Container,
    E57,
    Binary,
}

/// Damages one to a few places of a file.
pub fn damage(file: &mut Vec<u8>, chance: &mut Chance) {
    let form = form_of(file);
    for _ in 0..1 + chance.below(MOST_PLACES).min(chance.below(MOST_PLACES)) {
        // Bytes anywhere, now and then, whatever the form.
        let by_form = if chance.one_in(8) { None } else { damaged_by_form(file, form, chance) };
        match by_form {
            Some(changed) => *file = changed,
            None if matches!(form, Form::Binary | Form::E57 | Form::Container) => bytes::spoil(file, chance),
            None if chance.one_in(2) => text::spoil(file, chance),
            None => bytes::spoil(file, chance),
        }
        file.truncate(LARGEST_BYTES);
    }
}

fn form_of(file: &[u8]) -> Form {
    let start = file.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(file).trim_ascii_start();
    let is_text = std::str::from_utf8(file).is_ok_and(|text| !text.contains('\0'));
    match start.first() {
        _ if glb::is_container(file) => Form::Container,
        _ if e57::is_e57(file) => Form::E57,
        _ if file.starts_with(b"ply") => Form::Ply,
        _ if !is_text => Form::Binary,
        Some(b'<') => Form::Xml,
        Some(b'{' | b'[') if std::str::from_utf8(file).ok().and_then(json::parse).is_some() => Form::Json,
        Some(b'{') => Form::JsonLines,
        _ => Form::Text,
    }
}

/// `None` where an earlier damage has left nothing of the form.
fn damaged_by_form(file: &[u8], form: Form, chance: &mut Chance) -> Option<Vec<u8>> {
    let mut changed = file.to_vec();
    match form {
        Form::Json => return damaged_json(file, chance),
        Form::JsonLines => {
            let lines: Vec<&[u8]> = file.split(|byte| *byte == b'\n').collect();
            let at = chance.below(lines.len());
            let line = damaged_json(lines.get(at)?, chance)?;
            let mut lines: Vec<Vec<u8>> = lines.into_iter().map(<[u8]>::to_vec).collect();
            lines[at] = line;
            return Some(lines.join(&b'\n'));
        }
        Form::Xml => {
            let mut root = xml::parse(std::str::from_utf8(file).ok()?)?;
            tree::spoil(&mut root, xml::written, chance);
            return Some(xml::written(&root).into_bytes());
        }
        Form::Ply => return damaged_ply(file, chance),
        Form::Text => text::spoil(&mut changed, chance),
        Form::Container => glb::spoil(&mut changed, chance),
        Form::E57 => e57::spoil(&mut changed, chance),
        Form::Binary => bytes::spoil(&mut changed, chance),
    }
    Some(changed)
}

fn damaged_json(text: &[u8], chance: &mut Chance) -> Option<Vec<u8>> {
    let mut root = json::parse(std::str::from_utf8(text).ok()?)?;
    tree::spoil(&mut root, json::written, chance);
    Some(json::written(&root).into_bytes())
}

/// The header as text, or what follows it as text or as records.
fn damaged_ply(file: &[u8], chance: &mut Chance) -> Option<Vec<u8>> {
    const END: &[u8] = b"end_header\n";
    let end = file.windows(END.len()).position(|window| window == END)? + END.len();
    let (mut head, mut body) = (file[..end].to_vec(), file[end..].to_vec());
    match chance.below(2) {
        0 => text::spoil(&mut head, chance),
        _ if std::str::from_utf8(&body).is_ok() => text::spoil(&mut body, chance),
        _ => bytes::spoil(&mut body, chance),
    }
    Some([head, body].concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_are_told_by_content() {
        for (file, form) in [
            (&b"{\"a\": [1]}"[..], Form::Json),
            (b"{\"a\": 1}\n{\"b\": 2}\n", Form::JsonLines),
            (b"\xEF\xBB\xBF <a/>", Form::Xml),
            (b"ply\nformat", Form::Ply),
            (b"v 0 0 0\nf 1 2 3", Form::Text),
            (b"glTF....", Form::Container),
            (b"ASTM-E57", Form::E57),
            (b"\0\x01\x02", Form::Binary),
        ] {
            assert_eq!(form_of(file), form);
        }
    }

    #[test]
    fn the_same_case_is_damaged_in_the_same_way() {
        let sound = include_bytes!("../seeds/cityjson/house.city.json").to_vec();
        let damaged = |case| {
            let mut file = sound.clone();
            damage(&mut file, &mut Chance::of_case(1, "cityjson", case));
            file
        };
        assert!((0..200).all(|case| damaged(case) == damaged(case)));
        assert!((0..200).filter(|case| damaged(*case) != sound).count() > 150);
    }
}
