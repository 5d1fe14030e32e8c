//! Why parts could not be joined at all.

use super::ledger::Unbalanced;
use crate::imagery::ImageryError;
use crate::observer::Cancelled;
use crate::reconstruction::AmbiguousName;

/// A file that cannot be read, a sum that does not come out, or a cancellation. Why a pair was *refused* stands in the edge's and the part's
/// `reason`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    #[error(transparent)]
    Imagery(#[from] ImageryError),
    /// A photograph that may be either of two.
    #[error("part {part}: {ambiguous}")]
    AmbiguousName { part: String, ambiguous: AmbiguousName },
    #[error(transparent)]
    Unbalanced(#[from] Unbalanced),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
