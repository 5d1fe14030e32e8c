//! The program: parse, run, exit status.

mod cli {
    pub mod solve;
}

use clap::{Parser, Subcommand};
use std::process::ExitCode;

#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Solve one point-to-plane problem; `-` is standard input
    Solve { problem: String },
}

fn main() -> ExitCode {
    let Command::Solve { problem } = Arguments::parse().command;
    ExitCode::from(cli::solve::run(&problem))
}
