//! How far a verdict and its sigmas may be trusted: made-up captures with all faults of real ones, at right places and wrong.
//!
//!     cargo run --release --example calibration -- --minutes 30 --seed 1
//!
//! `--cure CAPTURE` tells which fault makes one of them wrong. `docs/calibration.md` says what is measured and how to read it. Same seed, same captures; more minutes, more of them.

mod cures;
mod rates;
mod runs;
mod tables;

use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use cityweld::synthetic::Errand;
use clap::Parser;
use rayon::prelude::*;

use runs::{Questions, Run, runs_of};

/// Captures between two looks at the clock; a few for each core, so that none waits long for the last one.
const AT_ONCE: u64 = 16;

/// In the capture's own town and in another one, nothing of the place told.
const NO_START: Questions = Questions { errands: &[Errand::RightPlace, Errand::ForeignTown], with_start: false };

#[derive(Parser)]
struct Arguments {
    /// Ends after so many minutes ...
    #[arg(long, default_value_t = 30.0)]
    minutes: f64,
    /// ... or so many captures
    #[arg(long, default_value_t = u64::MAX)]
    captures: u64,
    /// Draws everything
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The first capture
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Asks about the right place alone: more captures in the same time
    #[arg(long)]
    right_place: bool,
    /// Asks with nothing known of the place, in the capture's own town and in another one
    #[arg(long, conflicts_with = "right_place")]
    no_start: bool,
    /// Takes one fault after the other away from this capture, instead
    #[arg(long, value_name = "CAPTURE")]
    cure: Option<u64>,
    /// Writes a line for each run
    #[arg(long)]
    runs: Option<PathBuf>,
}

fn main() -> std::io::Result<()> {
    let arguments = Arguments::parse();
    if let Some(index) = arguments.cure {
        cures::print(arguments.seed, index);
        return Ok(());
    }
    let begun = Instant::now();
    let questions = match (arguments.right_place, arguments.no_start) {
        (_, true) => NO_START,
        (true, false) => Questions::ALL.of_first(),
        (false, false) => Questions::ALL,
    };
    let mut file = arguments.runs.as_ref().map(std::fs::File::create).transpose()?;
    let end = arguments.first.saturating_add(arguments.captures);
    let (mut runs, mut next) = (Vec::new(), arguments.first);
    while next < end && begun.elapsed() < Duration::from_secs_f64(60.0 * arguments.minutes) {
        let until = end.min(next + AT_ONCE);
        let made: Vec<Vec<Run>> =
            (next..until).into_par_iter().map(|index| runs_of(arguments.seed, index, questions)).collect();
        for run in made.iter().flatten() {
            if let Some(file) = &mut file {
                writeln!(file, "{}", run.line())?;
            }
        }
        runs.extend(made.into_iter().flatten());
        next = until;
        eprint!("\r{next} captures, {} runs, {:.0} s ", runs.len(), begun.elapsed().as_secs_f64());
    }
    eprintln!();
    println!("seed {}, captures {} to {}, {} runs\n", arguments.seed, arguments.first, next.max(1) - 1, runs.len());
    tables::print(&runs);
    Ok(())
}
