//! What was typed.

use std::path::PathBuf;

use crate::formats::{FORMATS, Format, named};

pub const USAGE: &str = "\
Damages files of every format and holds the readers of cityweld to their promises.

  fuzz [--seconds 30] [--seed 1] [--limit 10] [FORMAT..]    every format, or these, so long each
  fuzz --seed 1 --case 4711 FORMAT                          one case again; its files stay in fuzz/found
  fuzz --list                                               the names of the formats

A case that takes longer than --limit seconds hangs. Exit status: 0 no promise was broken, 1 some were (files in fuzz/found), 2 error.";

pub struct Args {
    pub seconds: f64,
    pub seed: u64,
    /// A case that takes longer hangs.
    pub limit_secs: f64,
    pub formats: Vec<&'static Format>,
    pub task: Task,
}

pub enum Task {
    Help,
    List,
    All,
    /// One case again.
    Case(u64),
    /// Cases from a number on, in this process; the number of the present one stands in a file of the folder.
    Worker {
        from: u64,
        folder: PathBuf,
    },
}

impl Args {
    pub fn parse(words: impl Iterator<Item = String>) -> Result<Args, String> {
        let mut args = Args { seconds: 30.0, seed: 1, limit_secs: 10.0, formats: Vec::new(), task: Task::All };
        let mut from = 0;
        let mut words = words;
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("a value is missing after {word}"));
            match word.as_str() {
                "--help" | "-h" => args.task = Task::Help,
                "--list" => args.task = Task::List,
                "--seconds" => args.seconds = number(&value()?)?,
                "--seed" => args.seed = number(&value()?)?,
                "--limit" => args.limit_secs = number(&value()?)?,
                "--case" => args.task = Task::Case(number(&value()?)?),
                "--from" => from = number(&value()?)?,
                "--worker" => args.task = Task::Worker { from: 0, folder: value()?.into() },
                name => args.formats.push(named(name)?),
            }
        }
        if let Task::Worker { from: start, .. } = &mut args.task {
            *start = from;
        }
        let takes_one = matches!(args.task, Task::Case(_) | Task::Worker { .. });
        if takes_one && args.formats.len() != 1 {
            return Err("one format is needed".to_owned());
        }
        if args.formats.is_empty() {
            args.formats = FORMATS.iter().collect();
        }
        Ok(args)
    }
}

fn number<T: std::str::FromStr>(word: &str) -> Result<T, String> {
    word.parse().map_err(|_| format!("`{word}` is no number of the kind that is expected"))
}
