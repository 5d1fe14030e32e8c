//! Findings: the files of the case, with what was broken and how to see it again.

use std::path::{Path, PathBuf};

use crate::case::Case;

/// Writes a finding into `fuzz/found`, and gives its folder.
pub fn keep(format: &str, seed: u64, number: u64, case: &Case, broken: &str) -> std::io::Result<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("found").join(format!("{format}-{seed}-{number}"));
    case.write(&folder)?;
    let again = command(format, seed, number);
    std::fs::write(folder.join("FOUND.txt"), format!("{broken}\n\nAgain: {again}\n"))?;
    Ok(folder)
}

/// How to see a case again.
pub fn command(format: &str, seed: u64, number: u64) -> String {
    format!("cargo run --release --manifest-path fuzz/Cargo.toml -- --seed {seed} --case {number} {format}")
}
