//! One pair of parts: evidence, estimate, opinion.

use rayon::prelude::*;

use super::evidence::gather;
use super::fit::{Fit, fit};
use super::judge::{Opinion, judge};
use super::links::shared_photos;
use super::{MergeOptions, Part};

/// What joins two parts, as the report tells it.
#[derive(Clone, Debug)]
pub struct Edge {
    /// Indices of the parts in the order given.
    pub a: usize,
    pub b: usize,
    pub source: EdgeSource,
    pub shared_photos: Vec<String>,
    pub pairs: usize,
    pub inliers: usize,
    /// Of the inliers, in the merged frame's units where the parts are placed, else in those of `a`.
    pub rms: f64,
    pub used: bool,
    /// Why it is not used, or which of its sources was left out.
    pub reason: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeSource {
    Tracks,
    Superpixels,
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

/// An edge with its estimate.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub edge: Edge,
    pub fit: Option<Fit>,
    pub opinion: Opinion,
}

/// All pairs of parts that share photographs.
pub(super) fn all_pairs(parts: &[Part], order: &[usize], options: &MergeOptions) -> Vec<Link> {
    let mut couples = Vec::new();
    for (i, &a) in order.iter().enumerate() {
        couples.extend(order[i + 1..].iter().map(|&b| (a, b)));
    }
    couples.into_par_iter().filter_map(|(a, b)| link(parts, a, b, options)).collect()
}

fn link(parts: &[Part], a: usize, b: usize, options: &MergeOptions) -> Option<Link> {
    let photos = shared_photos(&parts[a].sfm, &parts[b].sfm);
    if photos.is_empty() {
        return None;
    }
    let names = photos.iter().map(|p| p.name.clone()).collect();
    let evidence = gather(&parts[a], &parts[b], photos);
    let fit = fit(&evidence, options.seed);
    let opinion = judge(&evidence, fit.as_ref(), [&parts[a].name, &parts[b].name], options.seed);
    let left_out = fit.iter().flat_map(|f| &f.cameras_used).filter(|used| !**used).count();
    let reason = match &opinion {
        Opinion::Together if left_out > 0 => Some(format!(
            "the poses of {left_out} of {} shared photographs disagree with the point pairs and were left out",
            evidence.cameras.len()
        )),
        Opinion::Together => None,
        Opinion::Open(reason) | Opinion::Apart(reason) => Some(reason.clone()),
    };
    let edge = Edge {
        a,
        b,
        source: EdgeSource::Tracks,
        shared_photos: names,
        pairs: evidence.pairs.len(),
        inliers: fit.as_ref().map_or(0, Fit::inlier_count),
        rms: fit.as_ref().map_or(0.0, |f| f.rms),
        used: opinion == Opinion::Together,
        reason,
    };
    Some(Link { edge, fit, opinion })
}
