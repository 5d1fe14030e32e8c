//! `cityweld solve PROBLEM.json`: all poses of one point-to-plane problem.

use std::path::Path;

use crate::format::{JsonKind, read_text, text_from};
use crate::problem::{LARGEST_PROBLEM_BYTES, Refusal, answer_json, solve_json};
use anyhow::{Context, Result, bail};

use super::args::SolveArgs;
use super::{Outcome, Session};

/// Solves the problem in a file (`-`: standard input) and prints the answer, a refusal included.
pub fn run(args: &SolveArgs, session: &Session) -> Result<Outcome> {
    let path = &args.problem;
    let read = if path == "-" {
        text_from(std::io::stdin(), LARGEST_PROBLEM_BYTES)
    } else {
        read_text(Path::new(path), LARGEST_PROBLEM_BYTES)
    };
    let text = read.with_context(|| format!("cannot read the problem: {path}"))?;
    if let Some(kind @ (JsonKind::Start | JsonKind::Alignment | JsonKind::Merge | JsonKind::Planes)) =
        JsonKind::of(&text)
    {
        bail!("this is {}, expected a problem (assets/problem.schema.json describes one): {path}", kind.words());
    }
    let answer = solve_json(&text);
    session.voice.json(&format!("{}\n", answer_json(&answer)), None)?;
    Ok(match answer {
        Ok(_) => Outcome::Good,
        Err(Refusal::Degenerate(_)) => Outcome::Doubtful,
        Err(Refusal::IllFormed(_)) => Outcome::Refused,
    })
}
