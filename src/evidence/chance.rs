//! How often witnesses meet the city by chance: measured on poses that were fitted to other places.

use super::outcomes::{KINDS, Outcomes};
use super::witnesses::{CLASSES, Witnesses};

/// Rates of what is met, by class of witness.
#[derive(Clone, Debug)]
pub struct Chance {
    pub rates: [[f64; KINDS]; CLASSES],
    /// Shares of the cloud that the city hides under contenders, ascending.
    pub hidden: Vec<f64>,
}

impl Chance {
    /// The mean over contenders, of whom `unseen` more met everything alike; `hidden` is what the city hides under each.
    pub fn new(witnesses: &Witnesses, contenders: &[Outcomes], mut hidden: Vec<f64>, unseen: f64) -> Chance {
        let mut rates = [[unseen / KINDS as f64; KINDS]; CLASSES];
        let mut of_class = [0.0; CLASSES];
        for piece in &witnesses.pieces {
            of_class[witnesses.class_of(piece)] += piece.share;
        }
        for outcomes in contenders {
            for (piece, shares) in witnesses.pieces.iter().zip(outcomes) {
                let class = witnesses.class_of(piece);
                let weight = piece.share / of_class[class];
                rates[class].iter_mut().zip(shares).for_each(|(rate, share)| *rate += weight * share);
            }
        }
        let total = unseen + contenders.len() as f64;
        for (rates, _) in rates.iter_mut().zip(of_class).filter(|(_, weight)| *weight > 0.0) {
            rates.iter_mut().for_each(|rate| *rate /= total);
        }
        hidden.sort_by(f64::total_cmp);
        Chance { rates, hidden }
    }
}
