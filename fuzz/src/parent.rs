//! Starts a process for each format, and tells which case took it down.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::time::Instant;

use crate::args::Args;
use crate::formats::Format;
use crate::found;
use crate::seeds::cases;
use crate::trial::{case, keep_panics, tried};
use crate::worker::{HANGS, NUMBER_FILE};

/// Processes of one format that may be taken down before the rest of its time is given up.
const MOST_DEATHS: usize = 4;

/// Tries all formats; true where no promise was broken.
pub fn all(args: &Args) -> Result<bool, String> {
    let mut is_sound = true;
    for format in &args.formats {
        is_sound &= of_format(format, args)?;
    }
    Ok(is_sound)
}

fn of_format(format: &'static Format, args: &Args) -> Result<bool, String> {
    let folder = folder()?;
    let began = Instant::now();
    let (mut from, mut is_sound) = (0, true);
    for _ in 0..MOST_DEATHS {
        let left = args.seconds - began.elapsed().as_secs_f64();
        let status = run(format, args, from, left.max(0.0), folder.path())?;
        match status.code() {
            Some(0) => return Ok(is_sound),
            Some(1) => return Ok(false),
            Some(2) => return Err(format!("{}: its process could not work", format.name)),
            _ => {}
        }
        is_sound = false;
        from = 1 + told_death(format, args, status, folder.path())?;
    }
    println!("{}: given up after {MOST_DEATHS} processes", format.name);
    Ok(is_sound)
}

fn run(format: &Format, args: &Args, from: u64, seconds: f64, folder: &Path) -> Result<ExitStatus, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut command = Command::new(program);
    command.arg("--worker").arg(folder).arg(format.name);
    for (option, value) in [
        ("--seed", args.seed.to_string()),
        ("--from", from.to_string()),
        ("--seconds", seconds.to_string()),
        ("--limit", args.limit_secs.to_string()),
    ] {
        command.arg(option).arg(value);
    }
    command.status().map_err(|error| format!("cannot start a process: {error}"))
}

/// Keeps the case that took the process down, and gives its number.
fn told_death(format: &'static Format, args: &Args, status: ExitStatus, folder: &Path) -> Result<u64, String> {
    let number = std::fs::read_to_string(folder.join(NUMBER_FILE)).map_err(|error| error.to_string())?;
    let number: u64 = number.parse().map_err(|_| "no number of a case is kept".to_owned())?;
    let broken = match status.code() {
        Some(HANGS) => format!("hang: longer than {} s", args.limit_secs),
        _ => format!("the process ended with {status}: a stack or the memory ran out"),
    };
    let case = case(format, &cases(format.seeds)?, args.seed, number);
    let kept = found::keep(format.name, args.seed, number, &case, &broken).map_err(|error| error.to_string())?;
    println!("FOUND {} case {number}: {broken}\n  kept in {}", format.name, kept.display());
    println!("  again: {}", found::command(format.name, args.seed, number));
    Ok(number)
}

/// One case again, in this process; its files stay.
pub fn one_case(format: &'static Format, seed: u64, number: u64) -> Result<bool, String> {
    let case = case(format, &cases(format.seeds)?, seed, number);
    let kept = found::keep(format.name, seed, number, &case, "made again").map_err(|error| error.to_string())?;
    println!("files in {}", kept.display());
    keep_panics();
    let folder = folder()?;
    let (meter, seen) = tried(format, &case, &folder.path().join("case"), folder.path());
    println!("{seen:?}; {} bytes for a file of {}, {:?}", meter.most_bytes, case.bytes(), meter.took);
    Ok(seen.is_ok())
}

/// In memory where the system has a disk there: each case is written and read.
fn folder() -> Result<tempfile::TempDir, String> {
    let memory = PathBuf::from("/dev/shm");
    let at = if memory.is_dir() { memory } else { std::env::temp_dir() };
    tempfile::Builder::new().prefix("cityweld-fuzz").tempdir_in(at).map_err(|error| error.to_string())
}
