//! The entry points of cargo-fuzz: the same readers and promises, the same damage as one of libFuzzer's mutators.

use std::path::PathBuf;
use std::sync::OnceLock;

use crate::case::Case;
use crate::chance::Chance;
use crate::damage::damage;
use crate::formats::named;
use crate::seeds::cases;
use crate::trial::tried;

/// Gives bytes to the reader of a format, beside the other files of its first seed; panics where a promise is broken.
pub fn hold(name: &str, bytes: &[u8]) {
    static SEED: OnceLock<(Case, PathBuf)> = OnceLock::new();
    let format = named(name).unwrap_or_else(|error| panic!("{error}"));
    let (seed, folder) = SEED.get_or_init(|| {
        let seeds = cases(format.seeds).unwrap_or_else(|error| panic!("{error}"));
        // Left behind: libFuzzer ends its process without a word.
        let folder = std::env::temp_dir().join(format!("cityweld-fuzz-{name}-{}", std::process::id()));
        (seeds[0].clone(), folder)
    });
    let mut case = seed.clone();
    let at = case.files.iter().position(|(name, _)| *name == case.entry).unwrap_or_else(|| largest(&case));
    case.files[at].1 = bytes.to_vec();
    let spare = folder.join("spare");
    std::fs::create_dir_all(&spare).unwrap_or_else(|error| panic!("{error}"));
    if let (_, Err(broken)) = tried(format, &case, &folder.join("case"), &spare) {
        panic!("{broken}");
    }
}

/// Of a folder that is read whole.
fn largest(case: &Case) -> usize {
    (0..case.files.len()).max_by_key(|at| case.files[*at].1.len()).unwrap_or(0)
}

/// Damages the first `size` bytes of the buffer, and gives how many there are then.
pub fn damaged(buffer: &mut [u8], size: usize, largest: usize, seed: u32) -> usize {
    let mut bytes = buffer[..size].to_vec();
    damage(&mut bytes, &mut Chance::of_case(seed.into(), "libfuzzer", 0));
    let size = bytes.len().min(largest).min(buffer.len());
    buffer[..size].copy_from_slice(&bytes[..size]);
    size
}

/// A target of cargo-fuzz for a format.
#[macro_export]
macro_rules! fuzz_format {
    ($name:literal) => {
        libfuzzer_sys::fuzz_target!(|bytes: &[u8]| { $crate::target::hold($name, bytes) });
        libfuzzer_sys::fuzz_mutator!(|buffer: &mut [u8], size: usize, largest: usize, seed: u32| {
            $crate::target::damaged(buffer, size, largest, seed)
        });
    };
}
