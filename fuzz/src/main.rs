//! `fuzz`: see `args.rs`.

use std::process::ExitCode;

use cityweld_fuzz::args::{Args, Task, USAGE};
use cityweld_fuzz::formats::FORMATS;
use cityweld_fuzz::memory::Counting;
use cityweld_fuzz::parent::{all, one_case};
use cityweld_fuzz::worker::{Work, work};

#[global_allocator]
static COUNTING: Counting = Counting;

fn main() -> ExitCode {
    // The stack of a thread, which is smaller than a program's first: readers are called from threads, too.
    let done = std::thread::spawn(run).join();
    match done {
        Ok(Ok(true)) => ExitCode::SUCCESS,
        Ok(Ok(false)) => ExitCode::from(1),
        Ok(Err(error)) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
        Err(_) => ExitCode::from(2),
    }
}

fn run() -> Result<bool, String> {
    let args = Args::parse(std::env::args().skip(1))?;
    match &args.task {
        Task::Help => println!("{USAGE}"),
        Task::List => FORMATS.iter().for_each(|format| println!("{}", format.name)),
        Task::All => return all(&args),
        Task::Case(number) => return one_case(args.formats[0], args.seed, *number),
        Task::Worker { from, folder } => {
            let Args { seconds, seed, limit_secs, .. } = args;
            return work(&Work { format: args.formats[0], seed, from: *from, seconds, limit_secs, folder });
        }
    }
    Ok(true)
}
