//! Nothing is lost in silence: what went in is kept, fused or dropped with a reason, and the sum is checked.

use std::collections::BTreeMap;

use super::part::Part;
use crate::reconstruction::Reconstruction;

/// Why something of a part is not in the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DropReason {
    BehindCamera,
    FarFromKeypoint,
    NoObservationLeft,
    PartNotPlaced,
    SecondKeypoint,
}

impl DropReason {
    /// The words that the report uses.
    pub fn words(self) -> &'static str {
        match self {
            DropReason::BehindCamera => "behind camera",
            DropReason::FarFromKeypoint => "far from its keypoint in the fused photograph",
            DropReason::NoObservationLeft => "no observation left",
            DropReason::PartNotPlaced => "part not placed",
            DropReason::SecondKeypoint => "second keypoint of one point in a photograph",
        }
    }
}

/// What became of one kind of thing: `given = kept + fused + sum(dropped)`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Account {
    pub given: usize,
    /// What stands in the result on its own.
    pub kept: usize,
    /// What became part of one that is kept.
    pub fused: usize,
    /// What is not in the result, by reason.
    pub dropped: BTreeMap<DropReason, usize>,
}

/// The accounts of all parts, the ones left out too.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ledger {
    pub images: Account,
    pub points: Account,
    /// Keypoints that see a point.
    pub observations: Account,
}

/// A defect of the program: nothing is written then.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the ledger of {what} does not balance ({given} in; {kept} kept, {fused} fused, {dropped} dropped, {counted} in the \
     result); please report this as a defect of cityweld"
)]
pub struct Unbalanced {
    pub what: &'static str,
    pub given: usize,
    pub kept: usize,
    pub fused: usize,
    pub dropped: usize,
    pub counted: usize,
}

impl Account {
    pub(super) fn drop(&mut self, reason: DropReason, count: usize) {
        if count > 0 {
            *self.dropped.entry(reason).or_default() += count;
        }
    }
}

impl Ledger {
    /// What goes in; parts without a place are dropped at once.
    pub(super) fn open(parts: &[Part], is_placed: impl Fn(usize) -> bool) -> Ledger {
        let mut ledger = Ledger::default();
        for (index, part) in parts.iter().enumerate() {
            let [images, points, observations] = counts(&part.sfm);
            let accounts = [&mut ledger.images, &mut ledger.points, &mut ledger.observations];
            for (account, count) in accounts.into_iter().zip([images, points, observations]) {
                account.given += count;
                if !is_placed(index) {
                    account.drop(DropReason::PartNotPlaced, count);
                }
            }
        }
        ledger
    }

    pub(super) fn nothing_placed(parts: &[Part]) -> Ledger {
        Ledger::open(parts, |_| false)
    }

    /// The accounts balance, with each other, with the parts and with the model itself.
    pub(super) fn check(&self, parts: &[Part], model: Option<&Reconstruction>) -> Result<(), Unbalanced> {
        let in_model = model.map_or([0; 3], counts);
        let given = parts.iter().map(|p| counts(&p.sfm)).fold([0; 3], |s, c| [s[0] + c[0], s[1] + c[1], s[2] + c[2]]);
        let accounts = [("images", &self.images), ("points", &self.points), ("observations", &self.observations)];
        for ((what, account), (counted, given)) in accounts.into_iter().zip(in_model.into_iter().zip(given)) {
            let dropped = account.dropped.values().sum();
            let sum = account.kept + account.fused + dropped;
            if account.given != sum || account.kept != counted || account.given != given {
                let Account { kept, fused, .. } = *account;
                return Err(Unbalanced { what, given, kept, fused, dropped, counted });
            }
        }
        Ok(())
    }
}

/// Images, points, keypoints that see a point.
fn counts(sfm: &Reconstruction) -> [usize; 3] {
    let linked = sfm.images.iter().map(|i| i.observations.iter().filter(|o| o.point.is_some()).count()).sum();
    [sfm.images.len(), sfm.points.len(), linked]
}

#[cfg(test)]
mod tests;
