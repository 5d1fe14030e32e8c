//! What the stages found, put together as an [`Alignment`].

use super::evidence::VerdictInput;
use super::obstacle::Obstacle;
use super::options::AlignOptions;
use super::outcome::Outcome;
use crate::city::CityModel;
use crate::correspondence::{NO_SOLVER, PointPlaneMatch};
use crate::geometry::Point3;
use crate::planes::{Patches, PreparedCity, UpCandidate};
use crate::uncertainty::SystematicErrors;
use crate::verdict::{Alignment, Certainty, ModelErrors, PlaneSupport, SearchSummary, Support, Verdict, freedoms};

/// Builds the [`Alignment`] from an outcome.
pub(super) fn tell(
    outcome: Outcome,
    patches: &Patches,
    up_elsewhere: Option<UpCandidate>,
    city: &PreparedCity,
    options: &AlignOptions,
) -> Alignment {
    let Outcome { decision, found, hypotheses } = outcome;
    let VerdictInput { evidence, rows, patch_points, findings } = found;
    let (rivals, hold) = (&evidence.rivals, &evidence.hold);
    Alignment {
        verdict: decision.verdict,
        reason: decision.reason + &up_elsewhere.map_or(String::new(), words_of_up),
        best_candidate: rivals.first().map(|r| r.city_from_sfm),
        alternatives: decision.alternatives,
        certainty: decision.certainty,
        origin: city.model.origin,
        center: hold.parameters.center,
        radius: hold.parameters.radius,
        accuracy_m: hold.accuracy_m,
        model_errors: model_errors(&findings),
        freedoms: if rivals.is_empty() { Vec::new() } else { freedoms(hold, &options.limits.verdict) },
        covariance: hold.covariance(),
        support: support(&rows, patch_points),
        evidence: evidence_of_planes(&rows, city),
        search: SearchSummary { solver: hypotheses.solver, samples: hypotheses.samples as u64, seed: options.seed },
        warnings: warnings(patches).into_iter().chain(findings.notable(&options.limits.uncertainty)).collect(),
    }
}

fn model_errors(findings: &SystematicErrors) -> ModelErrors {
    ModelErrors {
        walls_inset: [findings.walls_inset_m, findings.walls_inset_sigma_m],
        tops_lower: [findings.tops_lower_m, findings.tops_lower_sigma_m],
        buildings: findings.buildings_m,
        fronts: findings.fronts_m,
        bending: findings.bending_m,
    }
}

/// The alignment where there was nothing to search.
pub(super) fn refused(obstacle: &Obstacle, city: &CityModel, patches: &Patches, options: &AlignOptions) -> Alignment {
    Alignment {
        verdict: Verdict::Failed,
        reason: obstacle.to_string(),
        best_candidate: None,
        alternatives: Vec::new(),
        certainty: Certainty { false_alarm: options.limits.verdict.false_alarm, ..Certainty::default() },
        origin: city.origin,
        center: Point3::from(city.origin),
        radius: 0.0,
        accuracy_m: options.accuracy_m.unwrap_or(options.limits.verdict.default_accuracy_m),
        model_errors: ModelErrors::default(),
        freedoms: Vec::new(),
        covariance: [[0.0; 7]; 7],
        support: Support::default(),
        evidence: Vec::new(),
        search: SearchSummary { solver: NO_SOLVER.to_owned(), samples: 0, seed: options.seed },
        warnings: warnings(patches),
    }
}

fn words_of_up(up: UpCandidate) -> String {
    format!(
        "; walls and cameras see up {:.0} sigmas of the start's tilt away from the start's up: give a larger tilt_sigma_deg, or --up",
        up.off_start
    )
}

fn support(rows: &[PointPlaneMatch], patch_points: usize) -> Support {
    let mut across: Vec<f64> = rows.iter().map(|r| r.hit.across_m.abs()).collect();
    across.sort_by(f64::total_cmp);
    Support {
        points: patch_points,
        trusted_points: rows.len(),
        planes: rows.chunk_by(|a, b| a.hit.plane == b.hit.plane).count(),
        rms_m: rms(&across),
        median_m: across.get(across.len() / 2).copied().unwrap_or(0.0),
    }
}

/// The planes by falling number of points.
fn evidence_of_planes(rows: &[PointPlaneMatch], city: &PreparedCity) -> Vec<PlaneSupport> {
    let of_plane = |rows: &[PointPlaneMatch]| {
        let plane = rows[0].hit.plane;
        let across: Vec<f64> = rows.iter().map(|r| r.hit.across_m).collect();
        let object = city.planes().planes[plane.0 as usize].object;
        let object = city.model.object_name(object).to_owned();
        PlaneSupport { plane: plane.0, object, points: rows.len(), rms_m: rms(&across) }
    };
    let mut evidence: Vec<PlaneSupport> = rows.chunk_by(|a, b| a.hit.plane == b.hit.plane).map(of_plane).collect();
    evidence.sort_by(|a, b| b.points.cmp(&a.points).then(a.plane.cmp(&b.plane)));
    evidence
}

fn warnings(patches: &Patches) -> Vec<String> {
    let mut warnings = Vec::new();
    let Patches { too_few_points, not_planar, support, repeated, cameras, .. } = patches;
    if *repeated as f64 > ORDINARY_COPIES * (*repeated + support.len()) as f64 {
        warnings.push(format!("{repeated} points stand at the place of another and count once"));
    }
    if *too_few_points + *not_planar > 0 {
        warnings.push(format!(
            "superpixels without a plane: {too_few_points} with too few points, {not_planar} not planar"
        ));
    }
    if cameras.is_empty() {
        warnings.push(
            "the reconstruction has no cameras: nothing tells from which side a surface was seen, nor speaks against a pose but the \
             points that it leaves unexplained"
                .to_owned(),
        );
    }
    warnings
}

/// Copies of points are told of above this share of all. Measured on COLMAP's own models, which hold 1 to 5 %, since SIFT gives a keypoint
/// for each orientation.
const ORDINARY_COPIES: f64 = 0.1;

fn rms(values: &[f64]) -> f64 {
    // An empty sum is -0.
    (values.iter().map(|v| v * v).sum::<f64>().abs() / values.len().max(1) as f64).sqrt()
}
