//! Faults and warnings of one COLMAP model, each with its place.

use std::path::PathBuf;

use super::ids::{IdFault, IdIndex};
use super::transform::rotation_of;
use super::{ReconstructionError, ReconstructionWarning, WarningKind};
use crate::format::colmap::{PoseRecord, record_file};

/// Gathers faults and warnings of one model.
pub(super) struct Checker {
    pub folder: PathBuf,
    pub warnings: Vec<ReconstructionWarning>,
}

impl Checker {
    pub(super) fn fault(
        &self,
        stem: &str,
        object: impl Into<String>,
        expected: &str,
        got: impl std::fmt::Display,
    ) -> ReconstructionError {
        let path = record_file(&self.folder, stem);
        ReconstructionError::Inconsistent {
            path,
            object: object.into(),
            expected: expected.into(),
            got: got.to_string(),
        }
    }

    pub(super) fn warn(&mut self, kind: WarningKind, count: usize, example: impl FnOnce() -> String) {
        if count == 0 {
            return;
        }
        match self.warnings.iter_mut().find(|w| w.kind == kind) {
            Some(warning) => warning.count += count,
            None => self.warnings.push(ReconstructionWarning { kind, count, example: example() }),
        }
    }

    pub(super) fn index(
        &self,
        stem: &str,
        of: &str,
        ids: impl ExactSizeIterator<Item = u64> + Clone,
    ) -> Result<IdIndex, ReconstructionError> {
        IdIndex::new(ids).map_err(|fault| match fault {
            IdFault::Twice(id) => self.fault(stem, format!("{of} {id}"), "ids that differ", "this id twice"),
            IdFault::TooMany => self.fault(stem, format!("{of}s"), "fewer than 2^32", "more"),
        })
    }

    pub(super) fn check_pose(
        &self,
        stem: &str,
        object: impl Fn() -> String,
        pose: &PoseRecord,
    ) -> Result<(), ReconstructionError> {
        if rotation_of(&pose.quaternion_wxyz).is_none() {
            let got = format!("{:?}", pose.quaternion_wxyz);
            return Err(self.fault(stem, object(), "a finite quaternion other than zero", got));
        }
        if !pose.translation.iter().all(|v| v.is_finite()) {
            return Err(self.fault(stem, object(), "a finite translation", format!("{:?}", pose.translation)));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
