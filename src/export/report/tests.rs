use super::super::report_input::{CityCounts, SfmCounts};
use super::*;
use crate::city::CityModel;
use crate::geometry::{Point3, Rotation3, Start, Vector3};
use crate::georeference::ControlPoint;
use crate::reconstruction::Reconstruction;
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
        prior: None,
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
    let schema: Value = serde_json::from_str(include_str!("../../../assets/alignment.schema.json")).unwrap();
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

#[test]
fn the_start_that_was_used_is_told_with_its_source_and_the_residuals_of_its_points() {
    let alignment = example(Verdict::Aligned);
    let best = alignment.best_candidate.unwrap();
    let in_sfm = Point3::new(1.0, 2.0, 3.0);
    let point = |name: &str, use_of| ControlPoint {
        name: name.into(),
        use_of,
        in_sfm,
        in_city: best.apply(&in_sfm) + Vector3::new(0.0, 0.3, 0.4),
        sigma_m: 0.02,
    };
    let start = Start::with_default_sigmas(best);
    let points = vec![point("a", ControlUse::Control), point("b", ControlUse::Check), point("c", ControlUse::LeftOut)];
    let prior = Estimate { points, ..Estimate::given(start, &[in_sfm], "by hand".into()) };
    let told: Value = serde_json::from_str(
        &alignment_report(&alignment, &InputSummary { prior: Some(prior.clone()), ..input() }).unwrap(),
    )
    .unwrap();
    assert_eq!((&told["prior"]["source"], &told["prior"]["position_sigma"]), (&json!("by hand"), &json!(10.0)));
    assert_eq!(told["prior"]["scale"].as_f64(), Some(best.scale));
    let names = |key: &str| told[key].as_array().unwrap().iter().map(|p| p["name"].clone()).collect::<Vec<_>>();
    assert_eq!((names("control_points"), names("check_points")), (vec![json!("a"), json!("c")], vec![json!("b")]));
    assert!((told["check_points"][0]["distance"].as_f64().unwrap() - 0.5).abs() < 1e-9);
    assert!((told["check_points"][0]["residual"][2].as_f64().unwrap() - 0.4).abs() < 1e-9);
    let none = Alignment { best_candidate: None, ..example(Verdict::Failed) };
    let told: Value =
        serde_json::from_str(&alignment_report(&none, &InputSummary { prior: Some(prior), ..input() }).unwrap())
            .unwrap();
    assert!(told["check_points"][0]["distance"].is_null() && told["prior"]["source"] == "by hand");
    assert!(report(&alignment)["prior"].is_null());
}
