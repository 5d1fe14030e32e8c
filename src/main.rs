//! The program `cityweld`: what was typed goes to [`cityweld::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    cityweld::cli::run()
}
