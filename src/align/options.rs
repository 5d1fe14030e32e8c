//! What the user may set.

use std::time::Duration;

use crate::geometry::{Start, Vector3};
use crate::limits::Limits;
use crate::place_search::PlacePrior;

/// Which way is up in the reconstruction.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Up {
    /// Estimated from walls, floors and cameras.
    #[default]
    Auto,
    /// Not used: the search turns freely, as far as three sigmas of the start's tilt. Without a start as [`Up::Auto`], since walls are told by it.
    None,
    /// Given, in the sfm frame (any length but zero).
    Given(Vector3<f64>),
}

/// What is known beforehand of where the reconstruction stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Roughly a pose, to absolute city coordinates: searched as far as three of its sigmas.
    Start(Start),
    /// Anywhere in the city that this allows, in absolute city coordinates: found by the walls of the reconstruction.
    Anywhere(PlacePrior),
}

impl Default for Place {
    /// Nothing is known.
    fn default() -> Place {
        Place::Anywhere(PlacePrior::default())
    }
}

/// What the user may set.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct AlignOptions {
    pub place: Place,
    /// Metres per sfm unit, held fixed, in place of the start's; free where `None`.
    pub fixed_scale: Option<f64>,
    pub up: Up,
    /// What a freedom must be held to, metres at the scene's radius; where `None`, as the limits say.
    pub accuracy_m: Option<f64>,
    /// Same seed, same answer, whatever the number of threads.
    pub seed: u64,
    /// Without a start: time after which no more of the city is searched. What was left out is told, and then nothing is `aligned`.
    pub budget: Option<Duration>,
    pub(crate) limits: Limits,
}

impl AlignOptions {
    /// From a start on; everything else as most users want it.
    pub fn new(start: Start) -> AlignOptions {
        AlignOptions::at(Place::Start(start))
    }

    /// Without a start: anywhere in the city, or where the little that is known allows. Everything else as most users want it.
    pub fn anywhere(prior: PlacePrior) -> AlignOptions {
        AlignOptions::at(Place::Anywhere(prior))
    }

    pub(crate) fn at(place: Place) -> AlignOptions {
        AlignOptions {
            place,
            fixed_scale: None,
            up: Up::Auto,
            accuracy_m: None,
            seed: 0,
            budget: None,
            limits: Limits::default(),
        }
    }

    /// Holds the scale, metres per sfm unit; `None` leaves it free.
    pub fn with_fixed_scale(self, metres_per_unit: impl Into<Option<f64>>) -> AlignOptions {
        AlignOptions { fixed_scale: metres_per_unit.into(), ..self }
    }

    pub fn with_up(self, up: Up) -> AlignOptions {
        AlignOptions { up, ..self }
    }

    /// What a freedom must be held to in order to be determined, metres at the scene's radius.
    pub fn with_accuracy(self, accuracy_m: f64) -> AlignOptions {
        AlignOptions { accuracy_m: Some(accuracy_m), ..self }
    }

    /// The chance of a wrong `aligned` that may be taken, between zero and one.
    pub fn with_false_alarm(mut self, chance: f64) -> AlignOptions {
        self.limits.verdict.false_alarm = chance;
        self
    }

    /// Without a start: ends the search of the city after this time. A search that is done before then has the same answer as without.
    pub fn with_budget(self, budget: impl Into<Option<Duration>>) -> AlignOptions {
        AlignOptions { budget: budget.into(), ..self }
    }

    #[doc(hidden)]
    pub fn with_limits(self, limits: Limits) -> AlignOptions {
        AlignOptions { limits, ..self }
    }

    pub fn with_seed(self, seed: u64) -> AlignOptions {
        AlignOptions { seed, ..self }
    }
}

#[cfg(test)]
mod tests;
