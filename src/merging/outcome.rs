//! What comes out of a merge: a verdict, every part's place, the edges between them, one model.

use super::fault::EdgeFault;
use super::ledger::Ledger;
use crate::geometry::Similarity;
use crate::reconstruction::Reconstruction;
use crate::verdict::{Freedom, Support};

/// The outcome of a merge.
#[derive(Clone, Debug)]
pub struct Merge {
    pub verdict: MergeVerdict,
    /// One sentence with figures.
    pub reason: String,
    pub frame: MergedFrame,
    /// In the order in which the parts were given.
    pub parts: Vec<PartPlace>,
    pub edges: Vec<Edge>,
    pub ledger: Ledger,
    pub warnings: Vec<String>,
    /// The joined model; `None` where no two parts were placed.
    pub model: Option<Fused>,
}

/// How sure the program is that the parts are one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MergeVerdict {
    /// Every part is placed.
    Merged,
    /// Two or more parts are placed, but not all.
    Partial,
    /// The parts seem to belong together, but the data do not fix how.
    Undetermined,
    /// Two or more ways to join them explain the data.
    Ambiguous,
    /// Nothing joins any two parts.
    Failed,
}

impl MergeVerdict {
    /// The word that the report uses.
    pub fn word(self) -> &'static str {
        match self {
            MergeVerdict::Merged => "merged",
            MergeVerdict::Partial => "partial",
            MergeVerdict::Undetermined => "undetermined",
            MergeVerdict::Ambiguous => "ambiguous",
            MergeVerdict::Failed => "failed",
        }
    }
}

/// Whose frame the joined parts are in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MergedFrame {
    City,
    /// The frame of the part of this name.
    Part(String),
    /// No part has a place.
    Nobodys,
}

impl MergedFrame {
    /// The words that the report uses.
    pub fn words(&self) -> String {
        match self {
            MergedFrame::City => "the city's".to_owned(),
            MergedFrame::Part(name) => format!("{name}'s"),
            MergedFrame::Nobodys => "none".to_owned(),
        }
    }
}

/// Where a part went.
#[derive(Clone, Debug)]
pub struct PartPlace {
    pub name: String,
    /// Its place, only where the program stands behind it.
    pub merged_from_part: Option<Similarity>,
    /// What fits best where it does not.
    pub best_candidate: Option<Similarity>,
    /// Why it is not placed.
    pub reason: Option<String>,
    /// How firmly the edges hold it in the merged frame, the loosest first; of a part without a place what the city, or the one
    /// edge that suggests its place, leaves open. Empty where nothing is known, and of the part that gives the frame.
    pub freedoms: Vec<Freedom>,
    pub support: PartSupport,
}

/// What a part brings, and what holds it.
#[derive(Clone, Debug, Default)]
pub struct PartSupport {
    pub images: usize,
    pub points: usize,
    /// Edges in use.
    pub edges: usize,
    /// Photographs that these edges share, each once.
    pub shared_photos: usize,
    /// Point pairs that agree, over these edges.
    pub inliers: usize,
    /// How well it lies on the city, where one was given.
    pub city: Option<Support>,
}

/// A measured relation of two parts, as the report tells it.
#[derive(Clone, Debug)]
pub struct Edge {
    /// Indices of the parts in the order given.
    pub a: usize,
    pub b: usize,
    pub source: EdgeSource,
    pub shared_photos: Vec<String>,
    pub pairs: usize,
    pub inliers: usize,
    /// Root mean square of the inliers, in the merged frame's units where the parts are placed, else in those of `a`.
    pub rms: f64,
    /// Why it is not used; `None` where it is.
    pub refusal: Option<EdgeFault>,
    /// Which of its sources was left out, or disagrees with the others.
    pub note: Option<String>,
}

/// What an edge was measured on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeSource {
    /// Tracks that meet in shared photographs.
    Tracks,
    /// Superpixels of shared photographs alone.
    Superpixels,
    /// Surfaces of parts that stand in the city.
    City,
}

impl EdgeSource {
    /// The word that the report uses.
    pub fn word(self) -> &'static str {
        match self {
            EdgeSource::Tracks => "tracks",
            EdgeSource::Superpixels => "superpixels",
            EdgeSource::City => "city",
        }
    }
}

impl Edge {
    /// Whether it helps to place the parts.
    pub fn is_used(&self) -> bool {
        self.refusal.is_none()
    }

    /// Why it is not used, or else what is to be said of its sources.
    pub fn reason(&self) -> Option<String> {
        self.refusal.as_ref().map(ToString::to_string).or_else(|| self.note.clone())
    }

    pub(super) fn touches(&self, part: usize) -> bool {
        self.a == part || self.b == part
    }
}

/// One model out of several.
#[derive(Clone, Debug)]
pub struct Fused {
    pub sfm: Reconstruction,
    /// For each point the part (in the order given) that it comes from; of a fused one the first.
    pub part_of_point: Vec<u32>,
}

#[cfg(test)]
mod tests;
