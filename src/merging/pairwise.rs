//! One pair of parts: evidence, estimate, opinion.

use rayon::prelude::*;

use super::evidence::{Evidence, gather};
use super::fit::{Fit, fit};
use super::joint::{Joint, on_whole_parts, with_planes};
use super::judge::{Opinion, judge};
use super::links::shared_photos;
use super::plane_evidence::{PlaneEvidence, gather_planes};
use super::plane_judge::judge_planes;
use super::plane_search::fit_planes;
use super::{EvidenceChoice, MergeOptions, Part};

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
    let planes = gather_planes(&parts[a], &parts[b], &photos);
    let evidence = gather(&parts[a], &parts[b], photos);
    match options.evidence {
        EvidenceChoice::All => {
            Some(link_by_all([a, b], [&parts[a], &parts[b]], &evidence, planes.as_ref(), options.seed))
        }
        EvidenceChoice::Planes => {
            Some(link_by_planes([a, b], [&parts[a].name, &parts[b].name], &evidence, planes.as_ref(), options.seed))
        }
    }
}

fn link_by_all(
    [a, b]: [usize; 2],
    parts: [&Part; 2],
    evidence: &Evidence,
    planes: Option<&PlaneEvidence>,
    seed: u64,
) -> Link {
    let names = parts.map(|part| part.name.as_str());
    let by_pairs = fit(evidence, seed);
    let joint = match (by_pairs, planes) {
        (Some(by_pairs), Some(planes)) => {
            let joint = with_planes(evidence, by_pairs.clone(), planes, seed);
            Some(on_whole_parts(evidence, &by_pairs, joint, parts))
        }
        (by_pairs, _) => by_pairs.map(|fit| Joint { fit, note: None, contradiction: None }),
    };
    let opinion = match judge(evidence, joint.as_ref().map(|j| &j.fit), names, seed) {
        Opinion::Together => {
            joint.as_ref().and_then(|j| j.contradiction.clone()).map_or(Opinion::Together, Opinion::Open)
        }
        other => other,
    };
    let (fit, note) = joint.map_or((None, None), |j| (Some(j.fit), j.note));
    let left_out = fit.iter().flat_map(|f| &f.cameras_used).filter(|used| !**used).count();
    let cameras_left_out = (left_out > 0).then(|| {
        format!(
            "the poses of {left_out} of {} shared photographs disagree with the point pairs and were left out",
            evidence.cameras.len()
        )
    });
    let notes: Vec<String> = cameras_left_out.into_iter().chain(note).collect();
    let reason = match &opinion {
        Opinion::Together => (!notes.is_empty()).then(|| notes.join("; ")),
        Opinion::Open(reason) | Opinion::Apart(reason) => Some(reason.clone()),
    };
    let edge = Edge {
        a,
        b,
        source: EdgeSource::Tracks,
        shared_photos: evidence.photos.iter().map(|p| p.name.clone()).collect(),
        pairs: evidence.pairs.len(),
        inliers: fit.as_ref().map_or(0, Fit::inlier_count),
        rms: fit.as_ref().map_or(0.0, |f| f.rms),
        used: opinion == Opinion::Together,
        reason,
    };
    Link { edge, fit, opinion }
}

fn link_by_planes(
    [a, b]: [usize; 2],
    names: [&str; 2],
    evidence: &Evidence,
    planes: Option<&PlaneEvidence>,
    seed: u64,
) -> Link {
    let found = planes.and_then(|planes| fit_planes(planes, seed));
    let opinion = judge_planes(evidence, planes, found.as_ref(), names, seed);
    let reason = match &opinion {
        Opinion::Together => None,
        Opinion::Open(reason) | Opinion::Apart(reason) => Some(reason.clone()),
    };
    let fit = found.map(|f| f.fit);
    let edge = Edge {
        a,
        b,
        source: EdgeSource::Superpixels,
        shared_photos: evidence.photos.iter().map(|p| p.name.clone()).collect(),
        pairs: planes.map_or(0, PlaneEvidence::correspondences),
        inliers: fit.as_ref().map_or(0, Fit::inlier_count),
        rms: fit.as_ref().map_or(0.0, |f| f.rms),
        used: opinion == Opinion::Together,
        reason,
    };
    Link { edge, fit, opinion }
}
