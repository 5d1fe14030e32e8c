//! `cityweld solve PROBLEM.json`: all poses of one point-to-plane problem.

use cityweld::format::file::{read_at_most, read_regular};
use cityweld::solvers::problem::{LARGEST_PROBLEM_BYTES, Refusal, answer_json, solve_json};
use std::io::Write;

/// Solves the problem in a file (`-`: standard input) and prints the answer; returns the exit status: 0 an answer, 1
/// degenerate, 2 ill-formed or unreadable.
pub fn run(path: &str) -> u8 {
    let text = match read(path) {
        Ok(text) => text,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: cannot read the problem: {error}: {path}");
            return 2;
        }
    };
    let answer = solve_json(&text);
    // A reader that has gone away is no error.
    let _ = writeln!(std::io::stdout(), "{}", answer_json(&answer));
    match answer {
        Ok(_) => 0,
        Err(Refusal::Degenerate(_)) => 1,
        Err(Refusal::IllFormed(_)) => 2,
    }
}

fn read(path: &str) -> std::io::Result<String> {
    let bytes = match path {
        "-" => read_at_most(std::io::stdin().lock(), 0, LARGEST_PROBLEM_BYTES)?,
        path => read_regular(path.as_ref(), LARGEST_PROBLEM_BYTES)?,
    };
    String::from_utf8(bytes).map_err(|_| std::io::Error::new(std::io::ErrorKind::InvalidData, "it is not UTF-8"))
}
