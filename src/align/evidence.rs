//! What speaks for the best pose and holds it, and what its rivals have.

use crate::correspondence::{Candidate, ProbeOnPlane, Refiner, candidate_at, settled};
use crate::geometry::Similarity;
use crate::robust::{Chart, Matrix7};
use crate::verdict::{Evidence, GivenScale, Hold, Rival};

/// The evidence, and the points that it rests on.
pub(super) struct Gathered {
    pub evidence: Evidence,
    /// Which points lie on which planes in the best pose, sorted by plane.
    pub rows: Vec<ProbeOnPlane>,
    /// Points that belong to a patch.
    pub firm: usize,
}

/// Gathers what the verdict reads of a search's candidates; `given_scale` where the scale was given.
pub(super) fn gather(refiner: &Refiner, candidates: &[Candidate], given_scale: Option<GivenScale>) -> Gathered {
    let scene = refiner.scene;
    let rows = candidates.first().map_or(Vec::new(), |best| rows(refiner, &best.refined.city_from_level));
    let chart = candidates.first().map_or(chart_of_prior(refiner), |best| best.refined.chart);
    let hold = Hold {
        chart: Chart { center: chart.center + scene.city.model.origin, ..chart },
        by_plane: by_plane(refiner, &chart, &rows),
        prior: scene.prior.information(&chart),
        given_scale,
    };
    let rivals = candidates.iter().map(|c| rival(refiner, c)).collect();
    let evidence = Evidence { rivals, hold, has_cameras: !scene.votes.cameras.is_empty() };
    Gathered { evidence, rows, firm: scene.votes.firm }
}

fn rows(refiner: &Refiner, pose: &Similarity) -> Vec<ProbeOnPlane> {
    let all: Vec<u32> = (0..refiner.scene.votes.probes.len() as u32).collect();
    refiner.probes_on_planes(&all, pose, refiner.scene.unit_m)
}

/// The information of each plane with enough points.
fn by_plane(refiner: &Refiner, chart: &Chart, rows: &[ProbeOnPlane]) -> Vec<Matrix7> {
    let fewest = refiner.scene.limits.verdict.fewest_on_plane;
    let planes = rows.chunk_by(|a, b| a.hit.plane == b.hit.plane).filter(|plane| plane.len() >= fewest);
    planes.map(|plane| refiner.equations_of_plane(chart, plane).full()).collect()
}

fn rival(refiner: &Refiner, candidate: &Candidate) -> Rival {
    let scene = refiner.scene;
    let local = scene.city_from_sfm(&candidate.refined.city_from_level);
    Rival {
        city_from_sfm: Similarity { translation: local.translation + scene.city.model.origin, ..local },
        share: candidate.share,
        blocked: candidate.blocked,
        balance: candidate.balance(),
        lead_sigmas: candidate.lead_sigmas,
    }
}

/// Where nothing was found: about the place that is expected.
fn chart_of_prior(refiner: &Refiner) -> Chart {
    refiner.assess(&[], &refiner.scene.prior.expected(), 0.0).chart
}

/// The scale that the data would have, were it free, from a pose of the given scale on.
pub(super) fn scale_from(refiner: &Refiner, candidate: &Candidate) -> GivenScale {
    let (scene, free) = (refiner.scene, refiner.with_free_scale());
    let firm: Vec<u32> = (0..scene.votes.firm as u32).collect();
    let gates_m: Vec<f64> = scene.limits.verdict.scale_gates_units.iter().map(|gate| gate * scene.unit_m).collect();
    let near = free.refine(&firm, &candidate.refined.city_from_level, &gates_m).city_from_level;
    scale_at(&free, &settled(&free, &near).city_from_level)
}

/// The scale of a pose that was found with the scale free, beside the given one.
pub(super) fn scale_at(free: &Refiner, pose: &Similarity) -> GivenScale {
    let scene = free.scene;
    let chart = free.assess(&[], pose, 0.0).chart;
    // What is known beforehand of all else keeps an open height from opening the scale.
    let mut information = scene.prior.information(&chart);
    information[(6, 6)] = 0.0;
    information += by_plane(free, &chart, &rows(free, pose)).iter().sum::<Matrix7>();
    let variance = information.try_inverse().map_or(0.0, |covariance| covariance[(6, 6)]);
    let given = scene.votes.level_from_sfm.scale;
    GivenScale {
        given,
        of_data: given * pose.scale,
        log_sigma: if variance > 0.0 { variance.sqrt() / chart.radius } else { f64::INFINITY },
        balance: candidate_at(free, pose).balance(),
    }
}
