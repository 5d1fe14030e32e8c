//! One case: made, given to its reader, measured and judged.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use crate::case::Case;
use crate::chance::Chance;
use crate::damage::damage;
use crate::formats::Format;
use crate::memory;

/// What a reader may hold whatever the input, bytes: buffers, pieces of clouds, stacks of pools. Measured: see the README.
const FREE_BYTES: usize = 8 << 20;

/// What became of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    Read,
    Refused,
}

/// What a reader took.
#[derive(Default)]
pub struct Meter {
    pub most_bytes: usize,
    pub took: Duration,
}

impl Meter {
    /// Measures one call of a reader; of several the most.
    pub fn reading<T>(&mut self, read: impl FnOnce() -> T) -> T {
        let before = memory::begin();
        let began = Instant::now();
        let answer = read();
        self.took = self.took.max(began.elapsed());
        self.most_bytes = self.most_bytes.max(memory::most().saturating_sub(before));
        answer
    }
}

/// The case of a number: the first are the seeds themselves, the others damaged.
pub fn case(format: &Format, seeds: &[Case], seed: u64, number: u64) -> Case {
    if let Some(sound) = usize::try_from(number).ok().and_then(|number| seeds.get(number)) {
        return sound.clone();
    }
    let mut chance = Chance::of_case(seed, format.name, number);
    let Some(mut case) = chance.pick(seeds).cloned() else { return Case { files: Vec::new(), entry: String::new() } };
    let damaged = if chance.one_in(8) { 2 } else { 1 };
    for _ in 0..damaged {
        let at = chance.below(case.files.len());
        damage(&mut case.files[at].1, &mut chance);
    }
    if case.files.len() > 1 && chance.one_in(50) {
        case.files.remove(chance.below(case.files.len()));
    }
    case
}

/// Gives a case to its reader. `Err`: the promise that was broken. Files lie in `folder`; what a check writes, in `spare`.
pub fn tried(format: &Format, case: &Case, folder: &Path, spare: &Path) -> (Meter, Result<Seen, String>) {
    let mut meter = Meter::default();
    let path = match case.write(folder) {
        Ok(path) => path,
        // A file cannot be written where a folder stands: no case at all.
        Err(_) => return (meter, Ok(Seen::Refused)),
    };
    let answer = catch_unwind(AssertUnwindSafe(|| (format.read)(&path, spare, &mut meter)));
    let seen = answer.unwrap_or_else(|_| Err(format!("panic: {}", last_panic())));
    let allowed = format.bulk.bytes_of_a_byte() * case.bytes() + FREE_BYTES;
    let seen = seen.and_then(|seen| match meter.most_bytes > allowed {
        true => Err(format!("memory: {} bytes for a file of {}", meter.most_bytes, case.bytes())),
        false => Ok(seen),
    });
    (meter, seen)
}

static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

/// Panics are kept instead of told: some are caught by the readers themselves, and are no finding.
pub fn keep_panics() {
    std::panic::set_hook(Box::new(|panic| {
        if let Ok(mut last) = LAST_PANIC.lock() {
            *last = panic.to_string();
        }
    }));
}

fn last_panic() -> String {
    LAST_PANIC.lock().map_or(String::new(), |last| last.replace('\n', " "))
}
