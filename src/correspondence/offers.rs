//! What patches may lie on, each with its likelihood, kept as far as memory allows.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::planes::PlaneId;

/// All that a patch may lie on.
#[derive(Default)]
pub(super) struct Offers {
    /// Rising sums of the likelihoods.
    pub sums: Vec<f64>,
    /// The targets, and whether the patch is turned over.
    pub what: Vec<(PlaneId, bool)>,
    /// That a draw takes the right one.
    pub chance: f64,
}

/// The offers of each patch, found when first asked.
pub(super) struct FirstOffers {
    of_patch: Vec<OnceLock<Offers>>,
    /// Offers kept in `of_patch`.
    kept: AtomicUsize,
}

/// Offers beyond so many are found anew with each draw: what a city without a start would offer must not fill the memory. Chosen: 32 MB.
const MOST_OFFERS_KEPT: usize = 2_000_000;

impl FirstOffers {
    pub fn of(patches: usize) -> FirstOffers {
        FirstOffers { of_patch: (0..patches).map(|_| OnceLock::new()).collect(), kept: AtomicUsize::new(0) }
    }

    /// What a patch is offered, kept where it was asked before or there is room; `use_them` is given it.
    pub fn with<T>(&self, patch: usize, find: impl FnOnce() -> Offers, use_them: impl FnOnce(&Offers) -> T) -> T {
        let kept = &self.of_patch[patch];
        if kept.get().is_some() || self.kept.load(Ordering::Relaxed) < MOST_OFFERS_KEPT {
            return use_them(kept.get_or_init(|| self.counted(find())));
        }
        use_them(&find())
    }

    /// As if there were no room left.
    #[cfg(test)]
    pub fn keep_no_more(&self) {
        self.kept.store(MOST_OFFERS_KEPT, Ordering::Relaxed);
    }

    fn counted(&self, offers: Offers) -> Offers {
        self.kept.fetch_add(offers.what.len(), Ordering::Relaxed);
        offers
    }
}

impl Offers {
    pub fn add(&mut self, likelihood: f64, what: (PlaneId, bool)) {
        let before = self.sums.last().copied().unwrap_or(0.0);
        self.sums.push(before + likelihood);
        self.what.push(what);
        self.chance += likelihood * likelihood;
    }

    pub fn finish(mut self) -> Offers {
        self.sums.shrink_to_fit();
        self.what.shrink_to_fit();
        let total = self.sums.last().copied().unwrap_or(0.0);
        Offers { chance: self.chance / (total * total), ..self }
    }
}

#[cfg(test)]
mod tests;
