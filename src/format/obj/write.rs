//! OBJ text out.

use std::io::{self, Write};

use super::ObjFile;

/// Digits after the decimal point: nanometres, finer than any f64 can hold a national grid's coordinates.
const DECIMALS: usize = 9;

/// Writes vertices, then faces under their `o` and `g` lines.
pub fn write_obj(out: &mut impl Write, file: &ObjFile) -> io::Result<()> {
    for position in &file.positions {
        let [x, y, z] = position.map(decimal);
        writeln!(out, "v {x} {y} {z}")?;
    }
    for object in &file.objects {
        write_name(out, 'o', object.name.as_deref())?;
        for group in &object.groups {
            write_name(out, 'g', group.name.as_deref())?;
            for face in group.faces.clone() {
                write_face(out, file, face)?;
            }
        }
    }
    Ok(())
}

fn write_face(out: &mut impl Write, file: &ObjFile, face: usize) -> io::Result<()> {
    let start = if face == 0 { 0 } else { file.face_ends[face - 1] as usize };
    write!(out, "f")?;
    for corner in &file.corners[start..file.face_ends[face] as usize] {
        write!(out, " {}", u64::from(*corner) + 1)?;
    }
    writeln!(out)
}

/// A line break in a name would begin a new line of the file.
fn write_name(out: &mut impl Write, keyword: char, name: Option<&str>) -> io::Result<()> {
    match name {
        Some(name) => writeln!(out, "{keyword} {}", name.split_whitespace().collect::<Vec<_>>().join(" ")),
        None => Ok(()),
    }
}

/// Rounded to nanometres, without trailing zeros.
fn decimal(value: f64) -> String {
    let rounded = format!("{value:.DECIMALS$}");
    let short = rounded.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}
