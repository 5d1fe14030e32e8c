//! The folder that a merge becomes: `merge.json`, one model, one picture with a colour for every part.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use serde::Serialize;
use serde_json::value::RawValue;

use super::colmap::write_colmap;
use super::file::{ExportError, write_file};
use super::folder::{COLMAP_FOLDER, POINTS_FILE, SCENE_FILE};
use super::gltf::{Placed, Scene, write_scene};
use super::ply::write_ply;
use super::report::{ReportError, SupportJson, freedom_json};
use super::similarity::SimilarityJson;
use crate::city::CityModel;
use crate::geometry::Similarity;
use crate::merging::{Account, Edge, Merge, MergedFrame, PartPlace, PartSupport};
use crate::verdict::Freedom;

pub const MERGE_REPORT_FILE: &str = "merge.json";

const SCHEMA: &str = "cityweld.merge/1";

/// Colours of the parts, sRGB, told apart by people who see red and green alike too (after Okabe and Ito 2008); repeated
/// beyond their number.
const PART_COLORS: [[u8; 3]; 8] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [0, 114, 178],
    [213, 94, 0],
    [204, 121, 167],
    [153, 153, 153],
];

/// Writes everything that a merge is told by into an existing folder; returns the names of what it wrote. `city` is shown
/// where the model stands in its frame.
pub fn write_merge(folder: &Path, merge: &Merge, city: Option<&CityModel>) -> Result<Vec<&'static str>, ExportError> {
    let report = merge_report(merge)?;
    write_file(&folder.join(MERGE_REPORT_FILE), |out| out.write_all(report.as_bytes()))?;
    let mut files = vec![MERGE_REPORT_FILE];
    let Some(model) = &merge.model else { return Ok(files) };
    let colors: Vec<[u8; 3]> =
        model.part_of_point.iter().map(|p| PART_COLORS[*p as usize % PART_COLORS.len()]).collect();
    let city = city.filter(|_| merge.frame == MergedFrame::City);
    let placed =
        Some(Placed { reconstruction: &model.sfm, point_colors: &colors, city_from_sfm: Similarity::identity() });
    let title = format!("{}: {}", merge.verdict.word(), merge.reason);
    write_scene(&folder.join(SCENE_FILE), &Scene { title: &title, city, placed })?;
    files.push(SCENE_FILE);
    if !model.sfm.images.is_empty() {
        write_colmap(&folder.join(COLMAP_FOLDER), &model.sfm)?;
        files.push(COLMAP_FOLDER);
    }
    write_ply(&folder.join(POINTS_FILE), &model.sfm)?;
    files.push(POINTS_FILE);
    Ok(files)
}

/// The report as JSON text.
pub fn merge_report(merge: &Merge) -> Result<String, ReportError> {
    let poses = merge.parts.iter().flat_map(|p| p.merged_from_part.iter().chain(&p.best_candidate));
    let is_finite =
        |s: &Similarity| s.scale.is_finite() && s.rotation.matrix().iter().chain(&s.translation).all(|v| v.is_finite());
    if !poses.into_iter().all(is_finite) {
        return Err(ReportError::NotFinite { field: "transform" });
    }
    let is_known = |f: &Freedom| f.sigma.is_finite() && f.direction.iter().all(|v| v.is_finite());
    if !merge.parts.iter().flat_map(|p| &p.freedoms).all(is_known) {
        return Err(ReportError::NotFinite { field: "freedoms" });
    }
    if !merge.edges.iter().all(|e| e.rms.is_finite()) {
        return Err(ReportError::NotFinite { field: "edges" });
    }
    let report = MergeJson {
        schema: SCHEMA,
        verdict: merge.verdict.word(),
        reason: &merge.reason,
        frame: merge.frame.words(),
        parts: merge.parts.iter().map(PartJson::of).collect::<Result<_, _>>()?,
        edges: merge.edges.iter().map(|e| EdgeJson::of(e, &merge.parts)).collect(),
        ledger: LedgerJson {
            images: AccountJson::of(&merge.ledger.images),
            points: AccountJson::of(&merge.ledger.points),
            observations: AccountJson::of(&merge.ledger.observations),
        },
        warnings: &merge.warnings,
        program: concat!("cityweld ", env!("CARGO_PKG_VERSION")),
    };
    Ok(serde_json::to_string_pretty(&report)? + "\n")
}

#[derive(Serialize)]
struct MergeJson<'a> {
    schema: &'static str,
    verdict: &'static str,
    reason: &'a str,
    frame: String,
    parts: Vec<PartJson<'a>>,
    edges: Vec<EdgeJson<'a>>,
    ledger: LedgerJson,
    warnings: &'a [String],
    program: &'static str,
}

#[derive(Serialize)]
struct PartJson<'a> {
    name: &'a str,
    placed: bool,
    transform: Option<SimilarityJson>,
    best_candidate: Option<SimilarityJson>,
    reason: Option<&'a str>,
    freedoms: Vec<Box<RawValue>>,
    support: PartSupportJson,
}

#[derive(Serialize)]
struct PartSupportJson {
    images: usize,
    points: usize,
    edges: usize,
    shared_photos: usize,
    inliers: usize,
    city: Option<SupportJson>,
}

impl PartSupportJson {
    fn of(support: &PartSupport) -> PartSupportJson {
        let PartSupport { images, points, edges, shared_photos, inliers, ref city } = *support;
        PartSupportJson { images, points, edges, shared_photos, inliers, city: city.as_ref().map(SupportJson::of) }
    }
}

impl PartJson<'_> {
    fn of(place: &PartPlace) -> Result<PartJson<'_>, serde_json::Error> {
        Ok(PartJson {
            name: &place.name,
            placed: place.merged_from_part.is_some(),
            transform: place.merged_from_part.as_ref().map(SimilarityJson::of).transpose()?,
            best_candidate: place.best_candidate.as_ref().map(SimilarityJson::of).transpose()?,
            reason: place.reason.as_deref(),
            freedoms: place.freedoms.iter().map(freedom_json).collect::<Result<_, _>>()?,
            support: PartSupportJson::of(&place.support),
        })
    }
}

#[derive(Serialize)]
struct EdgeJson<'a> {
    a: &'a str,
    b: &'a str,
    source: &'static str,
    shared_photos: &'a [String],
    pairs: usize,
    inliers: usize,
    rms: f64,
    used: bool,
    reason: Option<String>,
}

impl EdgeJson<'_> {
    fn of<'a>(edge: &'a Edge, parts: &'a [PartPlace]) -> EdgeJson<'a> {
        EdgeJson {
            a: &parts[edge.a].name,
            b: &parts[edge.b].name,
            source: edge.source.word(),
            shared_photos: &edge.shared_photos,
            pairs: edge.pairs,
            inliers: edge.inliers,
            rms: edge.rms,
            used: edge.is_used(),
            reason: edge.reason(),
        }
    }
}

#[derive(Serialize)]
struct LedgerJson {
    images: AccountJson,
    points: AccountJson,
    observations: AccountJson,
}

#[derive(Serialize)]
struct AccountJson {
    #[serde(rename = "in")]
    given: usize,
    kept: usize,
    fused: usize,
    dropped: BTreeMap<&'static str, usize>,
}

impl AccountJson {
    fn of(account: &Account) -> AccountJson {
        let dropped = account.dropped.iter().map(|(reason, count)| (reason.words(), *count)).collect();
        AccountJson { given: account.given, kept: account.kept, fused: account.fused, dropped }
    }
}
