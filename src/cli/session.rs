//! What every command is given, and how it may end.

use std::path::Path;

use super::args::Common;
use super::interrupt::Interrupt;
use super::print::Voice;
use super::sample::SAMPLE;
use crate::export::{Output, OutputError, OutputKind, Replace};

/// How a command ended that was carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// Done, and the answer is one to rely on.
    Good,
    /// Done, with any other verdict.
    Doubtful,
    /// Bad input, told already.
    Refused,
}

/// What every command is given besides its own options.
pub(super) struct Session {
    pub common: Common,
    pub voice: Voice,
    pub interrupt: Interrupt,
}

impl Session {
    /// Begins the output of a command; `--force` and interruptions are seen to.
    pub fn begin(&self, target: &Path, kind: OutputKind) -> Result<Output, OutputError> {
        let replace = if self.common.force { Replace::EarlierRun(SAMPLE) } else { Replace::Nothing };
        self.interrupt.begin(target, kind, replace)
    }
}
