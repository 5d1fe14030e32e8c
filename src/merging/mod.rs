//! Several reconstructions of one place become one.
//!
//! Question     which similarities carry the parts into one frame, do they belong together at all, and which cameras, images,
//!              points and observations are the same?
//! Input        parts as they were reconstructed, each in a frame of its own; photographs are told by name alone
//! Output       [`Merge`]: a verdict, every part's place or the reason why it has none, one model, and a balanced [`Ledger`]
//! Method       shared photographs give point pairs, camera poses and, with superpixels, planes of one part and points of the other on
//!              them, which are fitted together and judged for each two parts; accepted pairs
//!              form a graph that is solved as a whole; what was placed is fused
//! Assumptions  a photograph of one name shows the same pixels in both parts, at whatever size
//! Fails when   two parts share no photograph and no anchor, or their shared photographs have too few keypoints in common

mod adjust;
mod cycles;
mod design_effect;
mod disagreement;
mod evidence;
mod fit;
mod freedoms;
mod fuse;
mod graph;
mod joint;
mod judge;
mod ledger;
mod links;
mod meeting;
mod pairwise;
mod plane_evidence;
mod plane_fit;
mod plane_judge;
#[cfg(test)]
mod plane_scene;
mod plane_search;
mod sigma;
mod whole_planes;

pub use ledger::{Account, Ledger, Unbalanced};
pub use pairwise::{Edge, EdgeSource};

use crate::geometry::Similarity;
use crate::imagery::LiftedSuperpixels;
use crate::reconstruction::Reconstruction;
use crate::robust::{Chart, Matrix7};
use crate::verdict::{Alignment, Freedom, Support, Verdict};

/// One of the reconstructions to be joined.
#[derive(Clone, Debug)]
pub struct Part {
    /// Unique among the parts.
    pub name: String,
    pub sfm: Reconstruction,
    /// Of the photographs that it shares with others, where labels or photographs were given.
    pub superpixels: Option<LiftedSuperpixels>,
    /// Where the part stands in a common frame already (a city's), and how far that is to be relied on.
    pub anchor: Option<Anchor>,
}

/// A part's place in a frame that all anchored parts share.
#[derive(Clone, Debug)]
pub struct Anchor {
    pub common_from_part: Similarity,
    /// Of the alignment: only where it says so is the place relied on.
    pub verdict: Verdict,
    /// Centre and radius that make the seven unknowns of `information` lengths, common frame.
    pub chart: Chart,
    /// Inverse of the alignment's covariance, in the chart's unknowns.
    pub information: Matrix7,
    /// What the alignment said.
    pub reason: String,
    pub freedoms: Vec<Freedom>,
    pub support: Support,
}

impl Anchor {
    pub fn is_determined(&self) -> bool {
        self.verdict == Verdict::Aligned
    }

    /// Where an alignment puts a part; `fallback` where it found nothing.
    pub fn of(alignment: &Alignment, sfm: &Reconstruction, fallback: Similarity) -> Anchor {
        let common_from_part = alignment.best_candidate.unwrap_or(fallback);
        let radius = common_from_part.scale * sigma::extent(&sfm.points).1;
        let chart = Chart::of_similarity(alignment.center, radius);
        // The report's covariance is in radians, metres and log scale.
        let lengths = Matrix7::from_diagonal(&[radius, radius, radius, 1.0, 1.0, 1.0, radius].into());
        let covariance = Matrix7::from_fn(|i, j| alignment.covariance[i][j]);
        Anchor {
            common_from_part,
            verdict: alignment.verdict,
            chart,
            information: (lengths * covariance * lengths).try_inverse().unwrap_or_else(Matrix7::zeros),
            reason: format!("in the city {}: {}", alignment.verdict.word(), alignment.reason),
            freedoms: alignment.freedoms.clone(),
            support: alignment.support.clone(),
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub struct MergeOptions {
    pub seed: u64,
    pub evidence: EvidenceChoice,
}

/// What is taken from the shared photographs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EvidenceChoice {
    /// Point pairs, camera poses, and planes where the parts have superpixels.
    #[default]
    All,
    /// The planes of superpixels alone, to study them.
    Planes,
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

/// Where a part went.
#[derive(Clone, Debug)]
pub struct PartPlace {
    pub name: String,
    /// Only where the program stands behind it.
    pub merged_from_part: Option<Similarity>,
    /// What fits best where it does not.
    pub best_candidate: Option<Similarity>,
    /// Why it is not placed.
    pub reason: Option<String>,
    /// How firmly the ties hold it in the merged frame, the loosest first; of a part without a place what the city, or the one
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

/// The outcome of a merge.
#[derive(Clone, Debug)]
pub struct Merge {
    pub verdict: MergeVerdict,
    /// One sentence with figures.
    pub reason: String,
    pub frame: String,
    /// True where that is the city's.
    pub in_city: bool,
    /// In the order in which the parts were given.
    pub parts: Vec<PartPlace>,
    pub edges: Vec<Edge>,
    pub ledger: Ledger,
    pub warnings: Vec<String>,
    /// The joined model; `None` where no two parts were placed.
    pub model: Option<Fused>,
}

/// One model out of several.
#[derive(Clone, Debug)]
pub struct Fused {
    pub sfm: Reconstruction,
    /// For each point the part (in the order given) that it comes from; of a fused one the first.
    pub part_of_point: Vec<u32>,
}

/// Joins the parts. The order in which they are given changes nothing but the frame.
pub fn merge(parts: &[Part], options: &MergeOptions, progress: &dyn Fn(&str)) -> Result<Merge, Unbalanced> {
    let order = canonical_order(parts);
    progress("comparing the parts");
    let pairs = pairwise::all_pairs(parts, &order, options);
    let solved = graph::solve(parts, &order, pairs);
    let placed: Vec<usize> = order.iter().copied().filter(|&p| solved.places[p].merged_from_part.is_some()).collect();
    progress("joining the parts");
    let (model, ledger) = if placed.len() > 1 {
        let places: Vec<Option<Similarity>> = solved.places.iter().map(|p| p.merged_from_part).collect();
        let (model, ledger) = fuse::fuse(parts, &placed, &places);
        (Some(model), ledger)
    } else {
        (None, Ledger::nothing_placed(parts))
    };
    ledger.check(parts, model.as_ref())?;
    let disagreements = solved.edges.iter().filter_map(|edge| disagreement(parts, edge));
    let warnings = parts.iter().flat_map(|part| {
        let own = part.sfm.warnings.iter().map(ToString::to_string);
        let imagery = part.superpixels.iter().flat_map(|s| s.warnings.iter().map(ToString::to_string));
        own.chain(imagery).map(|text| format!("{}: {text}", part.name)).collect::<Vec<_>>()
    });
    let warnings = warnings.chain(disagreements).collect();
    Ok(Merge {
        verdict: solved.verdict,
        reason: solved.reason,
        frame: solved.frame,
        in_city: solved.in_city,
        parts: solved.places,
        edges: solved.edges,
        ledger,
        warnings,
        model,
    })
}

/// What is to be said of an edge although it is used.
fn disagreement(parts: &[Part], edge: &Edge) -> Option<String> {
    let (a, b) = (&parts[edge.a], &parts[edge.b]);
    let has_planes = a.superpixels.is_some() && b.superpixels.is_some();
    let told = edge.reason.as_ref().filter(|_| edge.used && has_planes)?;
    Some(format!("{} and {}: {told}", a.name, b.name))
}

/// The parts by their content, so that neither names of folders nor the order of the arguments decide anything.
fn canonical_order(parts: &[Part]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (&parts[a].sfm, &parts[b].sfm);
        let bits = |r: &Reconstruction| r.points.first().map(|p| [p.x, p.y, p.z].map(f64::to_bits));
        (b.images.len(), b.points.len()).cmp(&(a.images.len(), a.points.len())).then_with(|| bits(a).cmp(&bits(b)))
    });
    order
}
