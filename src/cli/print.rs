//! What is said on standard output and standard error. A closed pipe is no error.

use std::io::Write;
use std::time::Instant;

use super::args::Common;
use super::progress::Bar;

/// Speaks to the person at the terminal.
pub struct Voice {
    pub bar: Bar,
    quiet: bool,
    verbose: bool,
    begun: Instant,
}

impl Voice {
    pub fn new(common: &Common) -> Voice {
        Voice { bar: Bar::new(common.quiet), quiet: common.quiet, verbose: common.verbose, begun: Instant::now() }
    }

    /// The result, on standard output.
    pub fn result(&self, text: &str) {
        self.bar.clear();
        let mut out = std::io::stdout().lock();
        let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
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
        self.line(&format!("error: {error:#}"));
    }

    /// Since the command began.
    pub fn seconds(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    fn line(&self, text: &str) {
        self.bar.clear();
        let _ = writeln!(std::io::stderr(), "{text}");
    }
}
