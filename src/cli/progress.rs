//! Progress of long stages, on a terminal only.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::observer::{Observer, Stage};
use indicatif::{ProgressBar, ProgressStyle};

/// One line that is drawn anew for every stage and gone at the end.
pub struct Bar {
    bar: ProgressBar,
    stage: Mutex<String>,
}

impl Bar {
    /// A bar that is drawn where standard error is a terminal.
    pub fn on_terminal() -> Bar {
        if !std::io::stderr().is_terminal() {
            return Bar::silent();
        }
        let bar = ProgressBar::new_spinner();
        bar.enable_steady_tick(Duration::from_millis(100));
        Bar { bar, stage: Mutex::new(String::new()) }
    }

    /// A bar that is never drawn.
    pub fn silent() -> Bar {
        Bar { bar: ProgressBar::hidden(), stage: Mutex::new(String::new()) }
    }

    /// Stage `name` has done `done` of `all`; zero of `all` where that is not known.
    pub fn show(&self, name: &str, done: usize, all: usize) {
        if self.bar.is_hidden() {
            return;
        }
        let mut stage = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        if *stage != name {
            *stage = name.to_owned();
            self.bar.reset();
            self.bar.set_style(if all > 0 { measured() } else { unmeasured() });
            self.bar.set_message(name.to_owned());
        }
        self.bar.set_length(all as u64);
        self.bar.set_position(done as u64);
    }

    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Bar {
    fn progress(&self, stage: Stage, done: usize, all: usize) {
        if !self.bar.is_hidden() {
            self.show(&stage.to_string(), done, all);
        }
    }
}

fn measured() -> ProgressStyle {
    let template = "{spinner} {msg:26} [{bar:20}] {pos}/{len} {eta} left";
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> ")
}

fn unmeasured() -> ProgressStyle {
    ProgressStyle::with_template("{spinner} {msg:26} {elapsed}").unwrap_or_else(|_| ProgressStyle::default_spinner())
}
