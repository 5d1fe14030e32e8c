//! What one run of search, evidence and estimate found.

use super::evidence::VerdictInput;
use crate::correspondence::Hypotheses;
use crate::verdict::Decision;

/// Evidence, decision and search statistics of one run.
pub(super) struct Outcome {
    pub decision: Decision,
    pub found: VerdictInput,
    pub hypotheses: Hypotheses,
}
