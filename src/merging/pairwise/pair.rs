//! Two parts that share photographs, compared: what they share, the estimate, the decision.

use rayon::prelude::*;

use super::decision::{PairDecision, decide};
use super::fit::{Fit, OwnFit};
use super::joint::TrackEstimate;
use super::plane_checks::PlaneChecks;
use super::plane_search::fit_planes;
use super::planes::SharedPlanes;
use super::shared_tracks::{SharedTracks, shared_tracks};
use super::superpixel_planes::superpixel_planes;
use super::track_checks::TrackChecks;
use super::track_fit::fit_tracks;
use crate::merging::fault::EdgeFault;
use crate::merging::limits::MergeLimits;
use crate::merging::outcome::{Edge, EdgeSource};
use crate::merging::prepared::PreparedPart;
use crate::merging::shared_photos::{SharedPhoto, shared_photos};
use crate::observer::{Cancelled, Observer, check_cancelled};

/// What is taken from the shared photographs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PairSources {
    /// Point pairs, camera poses, and planes where the parts have superpixels.
    #[default]
    All,
    /// The planes of superpixels alone, to study them.
    Planes,
}

/// Two parts after they were compared.
#[derive(Clone, Debug)]
pub(in crate::merging) struct Pair {
    /// What is told of it.
    pub edge: Edge,
    pub fit: Option<Fit>,
    pub decision: PairDecision,
}

/// What is compared, and how.
pub(in crate::merging) struct Comparison<'a> {
    pub parts: &'a [PreparedPart<'a>],
    /// The parts by their content.
    pub order: &'a [usize],
    pub sources: PairSources,
    pub limits: &'a MergeLimits,
    pub seed: u64,
    pub observer: &'a dyn Observer,
}

/// Two parts that share photographs.
struct Couple {
    a: usize,
    b: usize,
    photos: Vec<SharedPhoto>,
}

impl Comparison<'_> {
    /// All pairs of parts that share photographs.
    pub fn pairs(&self) -> Result<Vec<Pair>, Cancelled> {
        let couples: Vec<Couple> = self.couples();
        self.prepare_surfaces(&couples);
        let compare = |couple| check_cancelled(self.observer).map(|()| self.compare(couple));
        couples.into_par_iter().map(compare).collect()
    }

    fn couples(&self) -> Vec<Couple> {
        let mut couples = Vec::new();
        for (i, &a) in self.order.iter().enumerate() {
            for &b in &self.order[i + 1..] {
                let photos = shared_photos(self.parts[a].sfm(), self.parts[b].sfm());
                if !photos.is_empty() {
                    couples.push(Couple { a, b, photos });
                }
            }
        }
        couples
    }

    /// Makes the surfaces of the parts whose planes will be used, each part's once.
    fn prepare_surfaces(&self, couples: &[Couple]) {
        if self.sources == PairSources::Planes {
            return;
        }
        let has_superpixels =
            |couple: &&Couple| [couple.a, couple.b].map(|p| self.parts[p].has_superpixels()) == [true; 2];
        let mut wanted: Vec<usize> = couples.iter().filter(has_superpixels).flat_map(|c| [c.a, c.b]).collect();
        wanted.sort_unstable();
        wanted.dedup();
        wanted.into_par_iter().for_each(|p| {
            self.parts[p].surfaces();
        });
    }

    fn compare(&self, Couple { a, b, photos }: Couple) -> Pair {
        let parts = [&self.parts[a], &self.parts[b]];
        let planes = superpixel_planes(parts, &photos, self.limits);
        let tracks = shared_tracks(parts, photos, self.limits);
        let found = match self.sources {
            PairSources::All => self.by_all(parts, &tracks, planes.as_ref()),
            PairSources::Planes => self.by_planes(parts, &tracks, planes.as_ref()),
        };
        let edge = Edge {
            a,
            b,
            source: found.source,
            shared_photos: tracks.photos.into_iter().map(|p| p.name).collect(),
            pairs: found.pairs,
            inliers: found.fit.as_ref().map_or(0, Fit::inlier_count),
            rms: found.fit.as_ref().map_or(0.0, |f| f.rms),
            refusal: found.decision.fault().cloned().map(EdgeFault::from),
            note: (!found.notes.is_empty()).then(|| found.notes.join("; ")),
        };
        Pair { edge, fit: found.fit, decision: found.decision }
    }

    fn by_all(&self, parts: [&PreparedPart<'_>; 2], tracks: &SharedTracks, planes: Option<&SharedPlanes>) -> Found {
        let (limits, seed) = (self.limits, self.seed);
        let by_tracks = fit_tracks(tracks, limits, seed);
        let joint = by_tracks.as_ref().map(|found| {
            let estimate = TrackEstimate { tracks, found, limits };
            match planes {
                Some(planes) => estimate.on_whole_parts(estimate.with_planes(planes, seed), parts),
                None => estimate.alone(None),
            }
        });
        let checks = TrackChecks { tracks, fit: joint.as_ref().map(|j| &j.fit), limits, seed };
        let decision = decide(&checks, tracks, parts.map(PreparedPart::name), limits);
        let contradiction = joint.as_ref().and_then(|j| j.contradiction.clone());
        let decision = match (decision, contradiction) {
            (PairDecision::Accepted, Some(contradiction)) => PairDecision::Open(contradiction),
            (decision, _) => decision,
        };
        let cameras_used = by_tracks.iter().flat_map(|t| &t.cameras_used);
        let left_out = cameras_left_out(cameras_used.filter(|used| !**used).count(), tracks.cameras.len());
        let (fit, note) = joint.map_or((None, None), |j| (Some(j.fit), j.note));
        let notes = left_out.into_iter().chain(note).collect();
        Found { source: EdgeSource::Tracks, pairs: tracks.pairs.len(), fit, decision, notes }
    }

    fn by_planes(&self, parts: [&PreparedPart<'_>; 2], tracks: &SharedTracks, planes: Option<&SharedPlanes>) -> Found {
        let (limits, seed) = (self.limits, self.seed);
        let found: Option<OwnFit> = planes.and_then(|planes| fit_planes(planes, limits, seed));
        let checks = PlaneChecks { planes, found: found.as_ref(), limits, seed };
        let decision = decide(&checks, tracks, parts.map(PreparedPart::name), limits);
        let pairs = planes.map_or(0, SharedPlanes::correspondences);
        Found { source: EdgeSource::Superpixels, pairs, fit: found.map(|f| f.fit), decision, notes: Vec::new() }
    }
}

/// What was found out about a couple.
struct Found {
    source: EdgeSource,
    pairs: usize,
    fit: Option<Fit>,
    decision: PairDecision,
    /// What is to be said although the parts are joined.
    notes: Vec<String>,
}

fn cameras_left_out(count: usize, all: usize) -> Option<String> {
    (count > 0).then(|| {
        format!("the poses of {count} of {all} shared photographs disagree with the point pairs and were left out")
    })
}
