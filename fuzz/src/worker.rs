//! Case after case of one format, until the time is over.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

use crate::case::Case;
use crate::formats::Format;
use crate::found;
use crate::seeds::cases;
use crate::trial::{Seen, case, keep_panics, tried};

/// Exit status of a process whose case hangs.
pub const HANGS: i32 = 3;

/// The name of the file in which the number of the present case stands.
pub const NUMBER_FILE: &str = "number";

/// Findings of different kinds that are kept of one run.
const MOST_KINDS: usize = 12;

pub struct Work<'a> {
    pub format: &'static Format,
    pub seed: u64,
    pub from: u64,
    pub seconds: f64,
    pub limit_secs: f64,
    /// On a fast disk: two folders of it are filled and emptied for every case.
    pub folder: &'a Path,
}

#[derive(Default)]
struct Tally {
    cases: u64,
    read: u64,
    broken: u64,
    kinds: BTreeSet<String>,
    slowest: (Duration, u64),
    /// Bytes beyond four times the input; the case.
    most: (usize, u64),
}

/// Tries cases; true where no promise was broken.
pub fn work(work: &Work) -> Result<bool, String> {
    keep_panics();
    let seeds = cases(work.format.seeds)?;
    let began = Instant::now();
    let beginning = watched(work.limit_secs);
    let mut tally = Tally::default();
    let mut number = work.from;
    while began.elapsed().as_secs_f64() < work.seconds || number < seeds.len() as u64 {
        beginning.store(began.elapsed().as_millis() as u64 + 1, Relaxed);
        one(work, &seeds, number, &mut tally)?;
        beginning.store(0, Relaxed);
        number += 1;
    }
    tally.tell(work.format.name, began.elapsed());
    Ok(tally.broken == 0)
}

/// Ends the process where a case takes too long. The number that is returned is set to the time at which one began, and to 0 after.
fn watched(limit_secs: f64) -> &'static AtomicU64 {
    static BEGINNING: AtomicU64 = AtomicU64::new(0);
    let began = Instant::now();
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_millis(100));
            let beginning = BEGINNING.load(Relaxed);
            let took_ms = (began.elapsed().as_millis() as u64).saturating_sub(beginning);
            if beginning > 0 && took_ms as f64 > 1000.0 * limit_secs {
                std::process::exit(HANGS);
            }
        }
    });
    &BEGINNING
}

fn one(work: &Work, seeds: &[Case], number: u64, tally: &mut Tally) -> Result<(), String> {
    let unwritable = |error| format!("cannot write into {}: {error}", work.folder.display());
    let spare = work.folder.join("spare");
    std::fs::create_dir_all(&spare).map_err(unwritable)?;
    std::fs::write(work.folder.join(NUMBER_FILE), number.to_string()).map_err(unwritable)?;
    let case = case(work.format, seeds, work.seed, number);
    let (meter, seen) = tried(work.format, &case, &work.folder.join("case"), &spare);
    let is_seed = number < seeds.len() as u64;
    let seen = match seen {
        Ok(Seen::Refused) if is_seed => Err("the seed itself is refused".to_owned()),
        seen => seen,
    };
    tally.cases += 1;
    tally.slowest = tally.slowest.max((meter.took, number));
    tally.most = tally.most.max((meter.most_bytes.saturating_sub(4 * case.bytes()), number));
    match seen {
        Ok(Seen::Read) => tally.read += 1,
        Ok(Seen::Refused) => {}
        Err(broken) => tally.note(work, number, &case, &broken)?,
    }
    Ok(())
}

impl Tally {
    /// Tells a finding, once of each kind.
    fn note(&mut self, work: &Work, number: u64, case: &Case, broken: &str) -> Result<(), String> {
        self.broken += 1;
        // Numbers and paths differ from case to case.
        let kind: String = broken.chars().filter(|c| !c.is_ascii_digit()).take(70).collect();
        if self.kinds.len() < MOST_KINDS && self.kinds.insert(kind) {
            let name = work.format.name;
            let folder = found::keep(name, work.seed, number, case, broken).map_err(|error| error.to_string())?;
            println!("FOUND {name} case {number}: {broken}\n  kept in {}", folder.display());
            println!("  again: {}", found::command(name, work.seed, number));
        }
        Ok(())
    }

    fn tell(&self, name: &str, took: Duration) {
        println!(
            "{name:14} {:8} cases {:7.0} /s {:3.0} % read, slowest {:6.1} ms ({}), memory beyond 4 x input {:6} KiB ({}), {} broken",
            self.cases,
            self.cases as f64 / took.as_secs_f64(),
            100.0 * self.read as f64 / self.cases.max(1) as f64,
            1000.0 * self.slowest.0.as_secs_f64(),
            self.slowest.1,
            self.most.0 / 1024,
            self.most.1,
            self.broken,
        );
    }
}
