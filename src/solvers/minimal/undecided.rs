//! Which of several candidates noisy points cannot tell from the best one.

/// Candidates whose misfit is within this factor of the best one's cannot be told apart by noisy points.
const UNDECIDED: f64 = 3.0;

/// Misfit (a sine) that rounding alone leaves in coordinates a thousand times their spread, with room.
const MISFIT_OF_ROUNDING: f64 = 1e-10;

/// Whether noise or rounding may have made a candidate worse than the best.
#[inline]
pub fn undecided(misfit: f64, best: f64) -> bool {
    misfit <= UNDECIDED * best + MISFIT_OF_ROUNDING
}
