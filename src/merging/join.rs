//! The joining of parts on one page: parts, pairs, network, fuse.

use super::error::MergeError;
use super::fuse::fuse;
use super::ledger::Ledger;
use super::limits::MergeLimits;
use super::network::solve;
use super::outcome::{Edge, Merge};
use super::pairwise::{Comparison, PairSources};
use super::part::Part;
use super::prepared::PreparedPart;
use crate::geometry::Similarity;
use crate::observer::{Observer, Stage, check_cancelled};
use crate::reconstruction::Reconstruction;

/// What the user may set.
#[derive(Clone, Copy, Debug, Default)]
pub struct JoinOptions {
    /// Same seed, same answer, whatever the number of threads.
    pub seed: u64,
    pub sources: PairSources,
    pub limits: MergeLimits,
}

/// Joins the parts. The order in which they are given changes nothing but the frame.
pub fn join(parts: &[Part], options: &JoinOptions, observer: &dyn Observer) -> Result<Merge, MergeError> {
    let limits = &options.limits;
    observer.progress(Stage::ComparingParts, 0, 0);
    let order = canonical_order(parts);
    let prepared: Vec<PreparedPart<'_>> = parts.iter().map(|part| PreparedPart::of(part, limits)).collect();
    let JoinOptions { seed, sources, .. } = *options;
    let pairs = Comparison { parts: &prepared, order: &order, sources, limits, seed, observer }.pairs()?;
    let solved = solve(&prepared, &order, pairs, limits);
    drop(prepared);

    check_cancelled(observer)?;
    observer.progress(Stage::JoiningParts, 0, 0);
    let places: Vec<Option<Similarity>> = solved.places.iter().map(|p| p.merged_from_part).collect();
    let placed: Vec<usize> = order.into_iter().filter(|&p| places[p].is_some()).collect();
    let (model, ledger) = if placed.len() > 1 {
        let (model, ledger) = fuse(parts, &placed, &places, limits);
        (Some(model), ledger)
    } else {
        (None, Ledger::nothing_placed(parts))
    };
    ledger.check(parts, model.as_ref().map(|fused| &fused.sfm))?;
    Ok(Merge {
        verdict: solved.verdict,
        reason: solved.reason,
        frame: solved.frame,
        parts: solved.places,
        warnings: warnings(parts, &solved.edges),
        edges: solved.edges,
        ledger,
        model,
    })
}

/// What readers found in the parts, and what is to be said of edges although they are used.
fn warnings(parts: &[Part], edges: &[Edge]) -> Vec<String> {
    let of_part = |part: &Part| {
        let own = part.sfm.warnings.iter().map(ToString::to_string);
        let names: Vec<&str> = part.sfm.fields.iter().map(|field| field.name.as_str()).collect();
        let fields = (!names.is_empty()).then(|| {
            format!(
                "{} further properties of points are not carried into what is joined ({})",
                names.len(),
                names.join(", ")
            )
        });
        let imagery = part.superpixels.iter().flat_map(|s| s.warnings.iter().map(ToString::to_string));
        own.chain(fields).chain(imagery).map(|text| format!("{}: {text}", part.name)).collect::<Vec<_>>()
    };
    parts.iter().flat_map(of_part).chain(edges.iter().filter_map(|edge| disagreement(parts, edge))).collect()
}

fn disagreement(parts: &[Part], edge: &Edge) -> Option<String> {
    let (a, b) = (&parts[edge.a], &parts[edge.b]);
    let has_planes = a.superpixels.is_some() && b.superpixels.is_some();
    let told = edge.note.as_ref().filter(|_| edge.is_used() && has_planes)?;
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
