//! `alignment.json`: the verdict and the transform for scripts; `assets/alignment.schema.json` describes it.

use serde::Serialize;
use serde_json::value::{RawValue, to_raw_value};

use crate::city::CityModel;
use crate::geometry::Similarity;
use crate::reconstruction::Reconstruction;
use crate::verdict::{Alignment, Certainty, Freedom, ModelErrors, PlaneSupport, Support, Verdict};

const SCHEMA: &str = "cityweld.alignment/1";

/// What went in, for the record. Files by their names alone, so that a moved data set gives the same report.
#[derive(Clone, Debug, Serialize)]
pub struct InputSummary {
    pub city: CityCounts,
    pub sfm: SfmCounts,
}

#[derive(Clone, Debug, Serialize)]
pub struct CityCounts {
    pub files: Vec<String>,
    pub objects: usize,
    pub facets: usize,
    pub triangles: usize,
}

#[derive(Clone, Debug, Serialize)]
pub struct SfmCounts {
    pub file: String,
    pub images: usize,
    pub points: usize,
    pub observations: usize,
    /// Those of labels or photographs that points fall on; `None` where neither was given.
    pub superpixels: Option<usize>,
}

impl CityCounts {
    pub fn of(city: &CityModel, files: Vec<String>) -> CityCounts {
        CityCounts { files, objects: city.objects.len(), facets: city.facets.len(), triangles: city.triangles.len() }
    }
}

impl SfmCounts {
    pub fn of(sfm: &Reconstruction, file: String, superpixels: Option<usize>) -> SfmCounts {
        SfmCounts {
            file,
            images: sfm.images.len(),
            points: sfm.points.len(),
            observations: sfm.track_elements.len(),
            superpixels,
        }
    }
}

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
        origin: to_raw_value(&alignment.origin.as_slice())?,
        center: to_raw_value(&alignment.center.coords.as_slice())?,
        radius: alignment.radius,
        accuracy: alignment.accuracy_m,
        model_errors: model_errors_json(&alignment.model_errors)?,
        freedoms: alignment.freedoms.iter().map(freedom_json).collect::<Result<_, _>>()?,
        covariance: alignment.covariance.iter().map(to_raw_value).collect::<Result<_, _>>()?,
        support: SupportJson::of(&alignment.support),
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

#[derive(Serialize)]
struct AlignmentJson<'a> {
    schema: &'static str,
    verdict: &'static str,
    reason: &'a str,
    transform: Option<SimilarityJson>,
    best_candidate: Option<SimilarityJson>,
    alternatives: Vec<AlternativeJson<'a>>,
    certainty: CertaintyJson,
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
    evidence: Vec<Box<RawValue>>,
    search: SearchJson<'a>,
    warnings: &'a [String],
    input: &'a InputSummary,
    program: &'static str,
}

#[derive(Serialize)]
pub(super) struct SimilarityJson {
    scale: f64,
    rotation: Vec<Box<RawValue>>,
    translation: Box<RawValue>,
}

impl SimilarityJson {
    pub(super) fn of(similarity: &Similarity) -> Result<SimilarityJson, serde_json::Error> {
        let r = similarity.rotation.matrix();
        let rows = (0..3).map(|i| to_raw_value(&[r[(i, 0)], r[(i, 1)], r[(i, 2)]]));
        Ok(SimilarityJson {
            scale: similarity.scale,
            rotation: rows.collect::<Result<_, _>>()?,
            translation: to_raw_value(&similarity.translation.as_slice())?,
        })
    }
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
mod tests {
    use super::*;
    use crate::geometry::{Point3, Rotation3, Vector3};
    use crate::verdict::{Alternative, FreedomKind, FreedomUnit, SearchSummary};
    use serde_json::{Value, json};

    fn example(verdict: Verdict) -> Alignment {
        let best = Similarity {
            scale: 0.1 + 0.2,
            rotation: Rotation3::from_euler_angles(0.3, -0.4, 1.9),
            translation: Vector3::new(90_851.453_312_345_67, 435_670.470_5, 1.0 / 3.0),
        };
        Alignment {
            verdict,
            reason: "all seven freedoms are held by 23 planes".into(),
            best_candidate: (verdict != Verdict::Failed).then_some(best),
            alternatives: vec![Alternative { city_from_sfm: best, weight: 0.02, differs: "turned".into() }],
            certainty: Certainty { bits: 31.5, needed_bits: 12.0, probability: 0.999, ..Certainty::default() },
            origin: Vector3::new(90000.0, 435_000.0, 0.0),
            center: Point3::new(1.0, 2.0, 3.0),
            radius: 12.5,
            accuracy_m: 0.35,
            model_errors: ModelErrors { walls_inset: [0.31, 0.04], buildings: 0.08, ..ModelErrors::default() },
            freedoms: vec![Freedom {
                name: "up".into(),
                direction: Vector3::z(),
                sigma: 0.04,
                kind: FreedomKind::Shift,
                unit: FreedomUnit::Metre,
                determined: true,
                given: false,
            }],
            covariance: [[1e-9; 7]; 7],
            support: Support { points: 9, trusted_points: 7, planes: 3, rms_m: 0.11, median_m: 0.06 },
            evidence: vec![PlaneSupport { plane: 17, object: "building \"42\"".into(), points: 4, rms_m: 0.08 }],
            search: SearchSummary { solver: "similarity (3,2,1,1)".into(), samples: 1830, seed: u64::MAX },
            warnings: vec!["one".into()],
        }
    }

    fn input() -> InputSummary {
        InputSummary {
            city: CityCounts::of(&CityModel::default(), vec!["city.obj".into()]),
            sfm: SfmCounts::of(&Reconstruction::default(), "sfm".into(), None),
        }
    }

    fn report(alignment: &Alignment) -> Value {
        serde_json::from_str(&alignment_report(alignment, &input()).unwrap()).unwrap()
    }

    #[test]
    fn keeps_every_digit_of_the_transform() {
        let alignment = example(Verdict::Aligned);
        let best = alignment.best_candidate.unwrap();
        let value = report(&alignment);
        assert_eq!(value["transform"]["scale"].as_f64(), Some(best.scale));
        for row in 0..3 {
            assert_eq!(value["transform"]["translation"][row].as_f64(), Some(best.translation[row]));
            for column in 0..3 {
                let written = value["transform"]["rotation"][row][column].as_f64();
                assert_eq!(written, Some(best.rotation[(row, column)]));
            }
        }
        assert_eq!(value["search"]["seed"].as_u64(), Some(u64::MAX));
        assert_eq!(value["covariance"].as_array().unwrap().len(), 7);
    }

    #[test]
    fn gives_a_transform_only_where_the_program_stands_behind_it() {
        let aligned = report(&example(Verdict::Aligned));
        assert!(aligned["transform"].is_object() && aligned["best_candidate"].is_null());
        for verdict in [Verdict::Undetermined, Verdict::Ambiguous] {
            let value = report(&example(verdict));
            assert!(value["transform"].is_null() && value["best_candidate"].is_object());
        }
        let failed = report(&example(Verdict::Failed));
        assert!(failed["transform"].is_null() && failed["best_candidate"].is_null());
    }

    #[test]
    fn refuses_to_write_what_json_has_no_word_for() {
        let mut alignment = example(Verdict::Aligned);
        alignment.covariance[3][4] = f64::NAN;
        let error = alignment_report(&alignment, &input()).unwrap_err();
        assert!(error.to_string().contains("covariance"), "{error}");
        let mut alignment = example(Verdict::Aligned);
        alignment.freedoms[0].sigma = f64::INFINITY;
        assert!(alignment_report(&alignment, &input()).is_err());
    }

    /// The schema is what other people's programs hold on to: it must know every key that is written, and no other.
    #[test]
    fn has_the_keys_of_the_published_schema() {
        let schema: Value = serde_json::from_str(include_str!("../../assets/alignment.schema.json")).unwrap();
        let mut alignment = example(Verdict::Aligned);
        alignment.reason = "x".into();
        compare(&report(&alignment), &schema, &schema, "report");
        compare(&report(&example(Verdict::Ambiguous)), &schema, &schema, "report");
        assert_eq!(schema["properties"]["schema"]["const"], json!(SCHEMA));
    }

    fn compare(value: &Value, schema: &Value, root: &Value, place: &str) {
        let schema = match schema["$ref"].as_str() {
            Some(name) => root.pointer(name.trim_start_matches('#')).expect("the schema's references lead somewhere"),
            None => schema,
        };
        if let Some(choices) = schema["anyOf"].as_array() {
            // Either null or the object.
            let choice = choices.iter().find(|c| (c["type"] == json!("null")) == value.is_null()).unwrap();
            return compare(value, choice, root, place);
        }
        match value {
            Value::Object(fields) => {
                let mut written: Vec<_> = fields.keys().collect();
                let mut known: Vec<_> = schema["properties"].as_object().expect(place).keys().collect();
                let mut required: Vec<_> =
                    schema["required"].as_array().expect(place).iter().map(|v| v.as_str().unwrap()).collect();
                written.sort();
                known.sort();
                required.sort();
                assert_eq!(written, known, "{place}");
                assert_eq!(written, required, "{place}");
                for (key, field) in fields {
                    compare(field, &schema["properties"][key], root, &format!("{place}.{key}"));
                }
            }
            Value::Array(items) => items.iter().for_each(|item| compare(item, &schema["items"], root, place)),
            other => {
                let kind = match other {
                    Value::Null => "null",
                    Value::Bool(_) => "boolean",
                    Value::Number(_) => "number",
                    _ => "string",
                };
                let allowed = schema["type"].to_string();
                let fits = allowed.contains(kind) || (kind == "number" && allowed.contains("integer"));
                assert!(fits || schema.get("const").is_some() || schema.get("enum").is_some(), "{place}: {allowed}");
            }
        }
    }
}
