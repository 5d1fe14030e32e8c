//! From what was typed to an exit status: the command line is parsed, its command carried out in a pool of threads.

use std::io::Write;
use std::process::ExitCode;

use anyhow::Context;
use clap::Parser;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use super::args::{Args, Command};
use super::interrupt::{self, Interrupt};
use super::print::{self, Voice};
use super::session::{Outcome, Session};
use super::{align, completions, demo, export, index, inspect, merge, planes, solve};
use crate::format::escaped;

/// Bad input or use, or a place that cannot be written.
const EXIT_BAD_INPUT: u8 = 2;

/// All work is done by threads of the pool; they have as much room as a main thread usually has.
const STACK_BYTES: usize = 8 << 20;

/// Parses the command line and carries it out.
pub fn run() -> ExitCode {
    interrupt::outlive_file_limits();
    match Args::try_parse() {
        Ok(args) => carry_out(args),
        Err(message) => print_message(message),
    }
}

/// Prints help, the version, or what is wrong with the command line.
fn print_message(mut message: clap::Error) -> ExitCode {
    if message.kind() == ErrorKind::UnknownArgument {
        // No value here begins with a dash; "to pass it as a value" would lead away.
        message.remove(ContextKind::Suggested);
    }
    escape_what_was_typed(&mut message);
    let printed = message.print().and_then(|()| std::io::stdout().flush());
    match print::heard(printed) {
        Ok(()) => ExitCode::from(u8::try_from(message.exit_code()).unwrap_or(EXIT_BAD_INPUT)),
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: cannot write to standard output: {error}");
            ExitCode::from(EXIT_BAD_INPUT)
        }
    }
}

/// A shell's `*` types names of files, which may hold anything.
fn escape_what_was_typed(message: &mut clap::Error) {
    let typed: Vec<_> = message.context().map(|(kind, value)| (kind, value.clone())).collect();
    for (kind, value) in typed {
        if let ContextValue::String(text) = value {
            message.insert(kind, ContextValue::String(escaped(&text).to_string()));
        }
    }
}

fn carry_out(args: Args) -> ExitCode {
    let interrupt = Interrupt::listen();
    let session = Session { voice: Voice::new(&args.common), interrupt: interrupt.clone(), common: args.common };
    let outcome = in_pool(&session, || dispatch(&args.command, &session));
    interrupt.give_way();
    match outcome {
        Ok(Outcome::Good) => ExitCode::SUCCESS,
        Ok(Outcome::Doubtful) => ExitCode::from(1),
        Ok(Outcome::Refused) => ExitCode::from(EXIT_BAD_INPUT),
        Err(error) => {
            session.voice.error(&error);
            ExitCode::from(EXIT_BAD_INPUT)
        }
    }
}

fn dispatch(command: &Command, session: &Session) -> anyhow::Result<Outcome> {
    match command {
        Command::Align(args) => align::run(args, session),
        Command::Merge(args) => merge::run(args, session),
        Command::Index(args) => index::run(args, session),
        Command::Planes(args) => planes::run(args, session),
        Command::Inspect(args) => inspect::run(args, session),
        Command::Completions(args) => completions::completions(args, session),
        Command::Man(args) => completions::man(args, session),
        Command::Solve(args) => solve::run(args, session),
        Command::Demo(args) => demo::run(args, session),
        Command::Export(args) => export::run(args, session),
    }
}

/// Runs `work` in a pool of its own, so that `--threads` holds for all of it.
fn in_pool<T: Send>(session: &Session, work: impl FnOnce() -> anyhow::Result<T> + Send) -> anyhow::Result<T> {
    let threads = session.common.threads.map_or(0, std::num::NonZeroUsize::get);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK_BYTES)
        .build()
        .with_context(|| format!("cannot start {threads} threads; give fewer with --threads"))?;
    pool.install(work)
}
