//! `alignment.json`: the verdict and the transform for scripts; `assets/alignment.schema.json` describes it.

use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};

use super::prior::{PriorJson, residuals};
use super::report_input::InputSummary;
use super::similarity::SimilarityJson;
use crate::city::Crs;
use crate::geometry::Similarity;
use crate::georeference::{ControlUse, Estimate};
use crate::verdict::{Alignment, Certainty, Freedom, ModelErrors, PlaneSupport, Support, Verdict};

const SCHEMA: &str = "cityweld.alignment/1";

/// Why a result cannot be reported.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// JSON has no word for it, and a null would be read as something else.
    #[error("the result's {field} is not a finite number; please report this as a defect of cityweld")]
    NotFinite { field: &'static str },
    #[error("cannot put the result into JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// The report as JSON text. Keys stand in the order in which a person asks; matrices and list entries on one line.
pub fn alignment_report(alignment: &Alignment, input: &InputSummary) -> Result<String, ReportError> {
    check_finite(alignment)?;
    let best = alignment.best_candidate.as_ref().map(SimilarityJson::of).transpose()?;
    let (transform, best_candidate) = match alignment.verdict {
        Verdict::Aligned => (best, None),
        _ => (None, best),
    };
    let prior = input.prior.as_ref().map(PriorJson::of).transpose()?;
    let report = AlignmentJson {
        schema: SCHEMA,
        verdict: alignment.verdict.word(),
        reason: &alignment.reason,
        transform,
        best_candidate,
        alternatives: alignment
            .alternatives
            .iter()
            .map(|other| {
                let transform = SimilarityJson::of(&other.city_from_sfm)?;
                Ok(AlternativeJson { transform, weight: other.weight, differs: &other.differs })
            })
            .collect::<Result<_, serde_json::Error>>()?,
        certainty: CertaintyJson::of(&alignment.certainty),
        crs: input.city.crs.as_ref(),
        origin: to_raw_value(&alignment.origin.as_slice())?,
        center: to_raw_value(&alignment.center.coords.as_slice())?,
        radius: alignment.radius,
        accuracy: alignment.accuracy_m,
        model_errors: model_errors_json(&alignment.model_errors)?,
        freedoms: alignment.freedoms.iter().map(freedom_json).collect::<Result<_, _>>()?,
        covariance: alignment.covariance.iter().map(to_raw_value).collect::<Result<_, _>>()?,
        support: SupportJson::of(&alignment.support),
        prior,
        control_points: residuals(alignment, input, |use_of| use_of != ControlUse::Check)?,
        check_points: residuals(alignment, input, |use_of| use_of == ControlUse::Check)?,
        evidence: alignment.evidence.iter().map(evidence_json).collect::<Result<_, _>>()?,
        search: SearchJson {
            solver: &alignment.search.solver,
            samples: alignment.search.samples,
            seed: alignment.search.seed,
        },
        warnings: &alignment.warnings,
        input,
        program: concat!("cityweld ", env!("CARGO_PKG_VERSION")),
    };
    Ok(serde_json::to_string_pretty(&report)? + "\n")
}

/// The start alone, as `align --dry-run --json` tells it, with the distance from its middle to the city's nearest facet, metres; `null` without one.
pub fn start_report(start: Option<(&Estimate, f64)>) -> Result<String, ReportError> {
    #[derive(Serialize)]
    struct StartJson<'a> {
        #[serde(flatten)]
        prior: PriorJson<'a>,
        /// From the middle to the city's nearest facet, metres.
        distance: f64,
        warnings: &'a [String],
    }
    let json = |(estimate, distance): (&'_ Estimate, f64)| -> Result<_, serde_json::Error> {
        serde_json::to_value(StartJson { prior: PriorJson::of(estimate)?, distance, warnings: &estimate.warnings })
    };
    let report = start.map(json).transpose()?;
    Ok(serde_json::to_string_pretty(&report)? + "\n")
}

#[derive(Serialize)]
struct AlignmentJson<'a> {
    schema: &'static str,
    verdict: &'static str,
    reason: &'a str,
    transform: Option<SimilarityJson>,
    best_candidate: Option<SimilarityJson>,
    alternatives: Vec<AlternativeJson<'a>>,
    certainty: CertaintyJson,
    /// Of city coordinates; null where neither the files nor the user say it.
    crs: Option<&'a Crs>,
    origin: Box<RawValue>,
    /// What `covariance` is about.
    center: Box<RawValue>,
    radius: f64,
    /// What a freedom must be held to, metres.
    accuracy: f64,
    model_errors: Box<RawValue>,
    freedoms: Vec<Box<RawValue>>,
    covariance: Vec<Box<RawValue>>,
    support: SupportJson,
    prior: Option<PriorJson<'a>>,
    control_points: Vec<Box<RawValue>>,
    check_points: Vec<Box<RawValue>>,
    evidence: Vec<Box<RawValue>>,
    search: SearchJson<'a>,
    warnings: &'a [String],
    input: &'a InputSummary,
    program: &'static str,
}

#[derive(Serialize)]
struct CertaintyJson {
    bits: f64,
    needed_bits: f64,
    search_bits: f64,
    probability: f64,
    false_alarm: f64,
    witnesses: usize,
    speaking: usize,
    by_chance: usize,
    most_bits_by_chance: f64,
}

impl CertaintyJson {
    fn of(certainty: &Certainty) -> CertaintyJson {
        CertaintyJson {
            bits: certainty.bits,
            needed_bits: certainty.needed_bits,
            search_bits: certainty.search_bits,
            probability: certainty.probability,
            false_alarm: certainty.false_alarm,
            witnesses: certainty.witnesses,
            speaking: certainty.speaking,
            by_chance: certainty.by_chance,
            most_bits_by_chance: certainty.most_bits_by_chance,
        }
    }
}

#[derive(Serialize)]
struct AlternativeJson<'a> {
    transform: SimilarityJson,
    weight: f64,
    differs: &'a str,
}

#[derive(Serialize)]
pub(super) struct SupportJson {
    points: usize,
    trusted_points: usize,
    planes: usize,
    rms_m: f64,
    median_m: f64,
}

impl SupportJson {
    pub(super) fn of(support: &Support) -> SupportJson {
        let Support { points, trusted_points, planes, rms_m, median_m } = *support;
        SupportJson { points, trusted_points, planes, rms_m, median_m }
    }
}

#[derive(Serialize)]
struct SearchJson<'a> {
    solver: &'a str,
    samples: u64,
    seed: u64,
}

pub(super) fn freedom_json(freedom: &Freedom) -> Result<Box<RawValue>, serde_json::Error> {
    #[derive(Serialize)]
    struct FreedomJson<'a> {
        name: &'a str,
        direction: [f64; 3],
        sigma: f64,
        unit: &'a str,
        determined: bool,
        given: bool,
    }
    let Freedom { kind: _, name, direction, sigma, unit, determined, given } = freedom;
    let unit = unit.symbol();
    let (direction, sigma) = ((*direction).into(), *sigma);
    to_raw_value(&FreedomJson { name, direction, sigma, unit, determined: *determined, given: *given })
}

fn model_errors_json(errors: &ModelErrors) -> Result<Box<RawValue>, serde_json::Error> {
    #[derive(Serialize)]
    struct ModelErrorsJson {
        walls_inset: [f64; 2],
        tops_lower: [f64; 2],
        buildings: f64,
        fronts: f64,
        bending: f64,
    }
    let ModelErrors { walls_inset, tops_lower, buildings, fronts, bending } = *errors;
    to_raw_value(&ModelErrorsJson { walls_inset, tops_lower, buildings, fronts, bending })
}

fn evidence_json(evidence: &PlaneSupport) -> Result<Box<RawValue>, serde_json::Error> {
    #[derive(Serialize)]
    struct EvidenceJson<'a> {
        plane: u32,
        object: &'a str,
        points: usize,
        rms_m: f64,
    }
    let PlaneSupport { plane, object, points, rms_m } = evidence;
    to_raw_value(&EvidenceJson { plane: *plane, object, points: *points, rms_m: *rms_m })
}

/// serde_json writes `null` for NaN and infinity; a script would take it for something left out.
fn check_finite(alignment: &Alignment) -> Result<(), ReportError> {
    let similarity =
        |s: &Similarity| s.scale.is_finite() && s.rotation.matrix().iter().chain(&s.translation).all(|v| v.is_finite());
    let (support, errors) = (&alignment.support, &alignment.model_errors);
    let spreads = [errors.buildings, errors.fronts, errors.bending];
    let checks = [
        ("transform", alignment.best_candidate.iter().all(similarity)),
        ("alternatives", alignment.alternatives.iter().all(|a| a.weight.is_finite() && similarity(&a.city_from_sfm))),
        ("origin", alignment.origin.iter().all(|v| v.is_finite())),
        ("center", alignment.center.iter().all(|v| v.is_finite())),
        ("radius", alignment.radius.is_finite()),
        ("accuracy", alignment.accuracy_m.is_finite()),
        ("model_errors", errors.walls_inset.iter().chain(&errors.tops_lower).chain(&spreads).all(|v| v.is_finite())),
        (
            "freedoms",
            alignment.freedoms.iter().all(|f| f.sigma.is_finite() && f.direction.iter().all(|v| v.is_finite())),
        ),
        ("covariance", alignment.covariance.iter().flatten().all(|v| v.is_finite())),
        ("support", support.rms_m.is_finite() && support.median_m.is_finite()),
        ("evidence", alignment.evidence.iter().all(|e| e.rms_m.is_finite())),
    ];
    match checks.iter().find(|(_, finite)| !finite) {
        Some((field, _)) => Err(ReportError::NotFinite { field }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
