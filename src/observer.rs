//! Progress of long work, and the wish to end it.

use std::fmt;

/// Watches long work from any thread. Every method has a default: [`()`](unit) watches nothing.
pub trait Observer: Sync {
    /// So many steps of a stage are done, of how many; zero of zero where that is not known.
    fn progress(&self, stage: Stage, done: usize, all: usize) {
        let _ = (stage, done, all);
    }

    /// What was found on the way, one line.
    fn detail(&self, text: &str) {
        let _ = text;
    }

    /// Whether the work should end; it then ends with [`Cancelled`]. Asked between stages, after each round of samples, before each
    /// photograph and between pairs of parts.
    fn is_cancelled(&self) -> bool {
        false
    }
}

impl Observer for () {}

/// What is being done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// Label images or photographs are read; steps are images.
    Superpixels,
    /// Planar groups of points are taken out of the cloud.
    Patches,
    /// The planes of the city are made ready.
    City,
    /// What can be seen of a city is found out for its index; steps are blocks.
    Index,
    /// A place is sought in the whole city; steps are its walls.
    Places,
    /// Minimal samples are drawn; steps are samples.
    Search,
    /// Poses are held against chance.
    Evidence,
    /// Parts are held against each other.
    ComparingParts,
    /// Parts are put into one frame and fused.
    JoiningParts,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Stage::Superpixels => "superpixels",
            Stage::Patches => "patches",
            Stage::City => "city",
            Stage::Index => "what can be seen of the city",
            Stage::Places => "looking through the city",
            Stage::Search => "search",
            Stage::Evidence => "evidence",
            Stage::ComparingParts => "comparing the parts",
            Stage::JoiningParts => "joining the parts",
        })
    }
}

/// The work was ended by its observer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("ended before it was done")]
pub struct Cancelled;

/// An error where the observer asks for the end.
pub fn check_cancelled(observer: &dyn Observer) -> Result<(), Cancelled> {
    if observer.is_cancelled() { Err(Cancelled) } else { Ok(()) }
}

#[cfg(test)]
mod tests;
