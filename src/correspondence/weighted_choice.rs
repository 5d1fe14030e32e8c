//! One of a stream of weighted offers, drawn in one pass.

use crate::robust::Random;

/// One of a stream of offers, drawn with probability proportional to their weights.
///
/// An offer takes the place of those before it with the share that it has of the total so far. So the one that is taken stays until
/// the total exceeds its own, divided by an even draw: one random number for each change and not for each offer (Efraimidis and
/// Spirakis 2006, with jumps).
pub(super) struct Choice<T> {
    pub total: f64,
    pub total_of_squares: f64,
    /// The total at which the next offer is taken.
    pub next: f64,
    pub taken: Option<T>,
}

/// What was drawn, and the chance that it is the right offer.
pub(super) struct Drawn<T> {
    pub what: T,
    pub chance: f64,
}

impl<T> Default for Choice<T> {
    fn default() -> Self {
        Choice { total: 0.0, total_of_squares: 0.0, next: 0.0, taken: None }
    }
}

impl<T> Choice<T> {
    pub fn offer(&mut self, weight: f64, what: T, random: &mut Random) {
        self.total += weight;
        self.total_of_squares += weight * weight;
        if self.total > self.next {
            self.taken = Some(what);
            self.next = self.total / (1.0 - random.unit());
        }
    }

    pub fn drawn(self) -> Option<Drawn<T>> {
        let chance = self.total_of_squares / (self.total * self.total);
        self.taken.map(|what| Drawn { what, chance })
    }
}

#[cfg(test)]
mod tests;
