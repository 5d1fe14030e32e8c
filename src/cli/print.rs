//! What is said on standard output and standard error. A reader that has gone away is no error.
//!
//! Names of files and what files hold may be anything; nothing of it steers the terminal.

use std::io::{ErrorKind, Result, Write};
use std::path::Path;
use std::time::Instant;

use crate::format::{escaped, escaped_json};
use crate::observer::{Observer, Stage};
use anyhow::Context;

use super::args::Common;
use super::progress::Bar;

/// Speaks to the person at the terminal.
pub struct Voice {
    pub bar: Bar,
    quiet: bool,
    verbose: bool,
    begun: Instant,
}

/// What became of a write to standard output; a reader that needed no more is content.
pub fn heard(written: Result<()>) -> Result<()> {
    written.or_else(|error| if error.kind() == ErrorKind::BrokenPipe { Ok(()) } else { Err(error) })
}

/// An error and its causes; those that its own message quotes are not told again.
fn in_one_line(error: &anyhow::Error) -> String {
    error.chain().map(ToString::to_string).fold(String::new(), |told, cause| match told {
        told if told.is_empty() => cause,
        told if told.contains(&cause) => told,
        told => format!("{told}: {cause}"),
    })
}

/// The longest line, in characters; two paths as long as systems allow would go beyond. Chosen: a screen full of text.
const LONGEST_LINE: usize = 2000;

/// One line, whatever text from files and paths is in it. What is wrong stands at its beginning, and where at its end, so
/// a name without end is cut in the middle.
fn line_of(text: &str) -> String {
    let line = escaped(text).to_string();
    let at = |index| line.char_indices().nth(index).map(|(at, _)| at);
    let Some(_) = at(LONGEST_LINE) else { return line };
    let from_end = line.char_indices().rev().nth(LONGEST_LINE / 2 - 1).map(|(at, _)| at);
    let (head, tail) = (at(LONGEST_LINE / 2).unwrap_or_default(), from_end.unwrap_or_default());
    let [head, tail] = [line.get(..head), line.get(tail..)].map(Option::unwrap_or_default);
    format!("{head} ... {tail}")
}

impl Observer for Voice {
    fn progress(&self, stage: Stage, done: usize, all: usize) {
        self.bar.progress(stage, done, all);
    }

    fn detail(&self, text: &str) {
        Voice::detail(self, text);
    }
}

impl Voice {
    pub fn new(common: &Common) -> Voice {
        let bar = if common.quiet { Bar::silent() } else { Bar::on_terminal() };
        Voice { bar, quiet: common.quiet, verbose: common.verbose, begun: Instant::now() }
    }

    /// The result as JSON, on standard output. `written` is as for [`Voice::result`].
    pub fn json(&self, json: &str, written: Option<&Path>) -> anyhow::Result<()> {
        self.result(&escaped_json(json), written)
    }

    /// The result, on standard output; names in it are escaped already. `written` is what stands on the disk whether or not that succeeds.
    pub fn result(&self, text: &str, written: Option<&Path>) -> anyhow::Result<()> {
        self.bar.clear();
        let mut out = std::io::stdout().lock();
        let told = heard(out.write_all(text.as_bytes()).and_then(|()| out.flush()));
        told.with_context(|| match written {
            Some(path) => format!("{} is written, but not what standard output should tell", path.display()),
            None => "cannot write to standard output".into(),
        })
    }

    /// What was tolerated, once each.
    pub fn warnings<'a>(&self, warnings: impl IntoIterator<Item = &'a String>) {
        if self.quiet {
            return;
        }
        for warning in warnings {
            self.line(&format!("warning: {warning}"));
        }
    }

    /// A step that is done, for those who asked with `-v`.
    pub fn detail(&self, text: &str) {
        if self.verbose {
            self.line(&format!("[{:7.2} s] {text}", self.seconds()));
        }
    }

    pub fn error(&self, error: &anyhow::Error) {
        self.line(&format!("error: {}", in_one_line(error)));
    }

    /// Since the command began.
    pub fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    fn line(&self, text: &str) {
        self.bar.clear();
        let _ = writeln!(std::io::stderr(), "{}", line_of(text));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stays_one_and_ends() {
        assert_eq!(line_of("no file: a\nerror: \x1b[2J"), "no file: a\\u{a}error: \\u{1b}[2J");
        let long = format!("`{}` is no index (ß.obj:7)", "ü".repeat(1_000_000));
        let line = line_of(&long);
        assert!(line.starts_with("`üü") && line.ends_with("ü` is no index (ß.obj:7)"), "{line}");
        assert_eq!(line.chars().count(), LONGEST_LINE + 5);
        let just = "x".repeat(LONGEST_LINE);
        assert_eq!(line_of(&just), just);
    }

    #[test]
    fn an_error_tells_each_of_its_causes_once() {
        #[derive(Debug, thiserror::Error)]
        #[error("cannot read it: {source}: start.json")]
        struct Quoting {
            source: std::io::Error,
        }
        let error = anyhow::Error::from(Quoting { source: std::io::Error::other("no such file") });
        assert_eq!(in_one_line(&error), "cannot read it: no such file: start.json");
        let error = error.context("part 2 is no reconstruction");
        assert_eq!(in_one_line(&error), "part 2 is no reconstruction: cannot read it: no such file: start.json");
    }
}
