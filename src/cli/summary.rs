//! Results as a short table for people.

use std::fmt::{Display, Write};
use std::path::Path;

use crate::city::{CityContents, CityModel, IndexOverview};
use crate::export::PlaneAttitude;
use crate::format::escaped;
use crate::georeference::Estimate;
use crate::inspect::Inspection;
use crate::merging::{Account, Merge};
use crate::place_search::Disc;
use crate::planes::CityPlanes;
use crate::verdict::{Alignment, Freedom, FreedomUnit, Verdict};

/// A title and rows of a name and a value; names of files and parts are in both.
struct Table {
    text: String,
    name_width: usize,
}

impl Table {
    fn new(title: &str, name_width: usize) -> Table {
        Table { text: format!("{}\n", escaped(title)), name_width }
    }

    fn row(&mut self, name: &str, value: impl Display) {
        let (name, value) = (escaped(name).to_string(), value.to_string());
        let _ = writeln!(self.text, "  {name:<width$} {}", escaped(&value), width = self.name_width);
    }
}

/// Verdict, reason, scale, freedoms, support, files and time.
pub fn of_alignment(alignment: &Alignment, output: &Path, files: &[&str], seconds: f64) -> String {
    let mut table = Table::new(&format!("{}: {}", alignment.verdict.word(), alignment.reason), 13);
    if let Some(best) = &alignment.best_candidate {
        let what = if alignment.verdict == Verdict::Aligned { "scale" } else { "scale (best)" };
        table.row(what, format!("{:.6} m per reconstruction unit", best.scale));
    }
    for (index, freedom) in alignment.freedoms.iter().enumerate() {
        table.row(if index == 0 { "freedoms" } else { "" }, freedom_line(freedom));
    }
    let certainty = &alignment.certainty;
    if certainty.witnesses > 0 {
        table.row(
            "evidence",
            format!(
                "{:.1} bits, {:.1} needed; {} of {} planes of the cloud speak for it; by chance {:.1} at most",
                certainty.bits,
                certainty.needed_bits,
                certainty.speaking,
                certainty.witnesses,
                certainty.most_bits_by_chance
            ),
        );
    }
    let support = &alignment.support;
    if support.trusted_points > 0 {
        table.row(
            "support",
            format!(
                "{} of {} points on {} planes, median {:.3} m, rms {:.3} m",
                support.trusted_points, support.points, support.planes, support.median_m, support.rms_m
            ),
        );
    }
    for (index, other) in alignment.alternatives.iter().enumerate() {
        let name = if index == 0 { "alternatives" } else { "" };
        table.row(name, format!("{} (weight {:.3})", other.differs, other.weight));
    }
    table.row("written", format!("{} ({})", output.display(), files.join(", ")));
    table.row("time", format!("{seconds:.1} s"));
    table.text
}

/// What an index holds.
pub fn of_index(index: &IndexOverview, names: &[String], written: &Path, seconds: f64) -> String {
    let mut table = Table::new(&format!("index of {}", names.join(", ")), 13);
    table.row("objects", index.objects);
    table.row("facets", format!("{} ({} triangles)", index.facets, index.triangles));
    table.row("walls", format!("{} stretches that can be seen", index.walls));
    let ([west, south], [east, north]) = (index.low, index.high);
    table.row("plan", format!("{west:.0}, {south:.0} to {east:.0}, {north:.0}, in {} blocks", index.blocks));
    table.row("written", written.display());
    table.row("time", format!("{seconds:.1} s"));
    table.text
}

/// Where the search would begin; without a start, within the disc, or anywhere in the city.
pub fn of_start(start: Option<(&Estimate, f64)>, near: Option<Disc>, seconds: f64) -> String {
    let Some((estimate, distance_m)) = start else {
        let searched = near.map_or("the city".to_owned(), |Disc { center: [x, y], radius_m }| {
            format!("what lies within {radius_m} m of {x:.2}, {y:.2}")
        });
        let mut table = Table::new(&format!("start: none, {searched} would be searched"), 13);
        table.row("time", format!("{seconds:.1} s"));
        return table.text;
    };
    let mut table = Table::new(&format!("start: {}", estimate.source), 13);
    let (pose, sigmas) = (estimate.start.city_from_sfm(), estimate.start.sigmas());
    let middle = pose.apply(&estimate.middle);
    table.row("middle", format!("{:.2}, {:.2}, {:.2} m", middle.x, middle.y, middle.z));
    table.row("distance", format!("{distance_m:.1} m from the city's nearest facet"));
    table.row("position", format!("sigma {:.2} m horizontally, {:.2} m of height", sigmas.position_m, sigmas.height_m));
    let [heading, tilt] = [sigmas.heading_rad, sigmas.tilt_rad].map(f64::to_degrees);
    table.row("rotation", format!("sigma {heading:.1} deg of heading, {tilt:.1} deg of tilt"));
    table.row("scale", format!("{:.6} m per reconstruction unit, sigma {:.1} %", pose.scale, 100.0 * sigmas.log_scale));
    table.row("time", format!("{seconds:.1} s"));
    table.text
}

/// What is seen in an input.
pub fn of_inspection(seen: &Inspection) -> String {
    let mut table = Table::new(&format!("{}: {}", seen.path, seen.format), 13);
    let counts = [
        ("objects", seen.objects),
        ("parts", seen.parts),
        ("triangles", seen.triangles),
        ("holes", seen.holes),
        ("images", seen.images),
        ("points", seen.points),
        ("observations", seen.observations),
    ];
    counts
        .into_iter()
        .filter_map(|(name, count)| Some((name, count?)))
        .for_each(|(name, count)| table.row(name, count));
    for (lod, kinds) in &seen.polygons {
        let kinds: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        table.row("polygons", format!("level {lod}: {}", kinds.join(", ")));
    }
    if let Some(crs) = &seen.crs {
        table.row("crs", &crs.text);
    }
    if let (Some(low), Some(high)) = (seen.low, seen.high) {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            table.row(name, format!("{} to {}", low[axis], high[axis]));
        }
    }
    if let Some([x, y, z]) = seen.up_guess {
        table.row("up", format!("{x:.3}, {y:.3}, {z:.3} (by the cameras)"));
    }
    if let Some(unit) = &seen.unit_guess {
        table.row("unit", unit);
    }
    seen.warnings.iter().for_each(|warning| table.row("warning", warning));
    table.text
}

fn freedom_line(freedom: &Freedom) -> String {
    if freedom.given {
        let mark = if freedom.determined { "" } else { "   CONTRADICTED by the data" };
        return format!("{:<32} given{mark}", freedom.name);
    }
    let sigma = match freedom.unit {
        // One sigma of the logarithm is a share of the scale itself.
        FreedomUnit::LogScale => format!("{:.3} %", 100.0 * freedom.sigma),
        unit => format!("{:.3} {}", freedom.sigma, unit.symbol()),
    };
    let mark = if freedom.determined { "" } else { "   NOT determined" };
    format!("{:<32} sigma {sigma}{mark}", freedom.name)
}

/// What the program sees in a city.
pub fn of_city(city: &CityModel, planes: &CityPlanes, files: &[String], output: Option<&Path>, seconds: f64) -> String {
    let title = format!(
        "{}: {} objects, {} facets, {} triangles, {} planes",
        files.join(" + "),
        city.objects.len(),
        city.facets.len(),
        city.triangles.len(),
        planes.planes.len()
    );
    let mut table = Table::new(&title, 11);
    // Formats without levels and parts have nothing to tell that the title does not.
    for source in city.sources.iter().filter(|source| source.contents.polygons.keys().any(Option::is_some)) {
        contents_rows(&mut table, &source.contents);
    }
    if let Some(crs) = &city.crs {
        let code = crs.epsg.map_or(String::new(), |code| format!("EPSG:{code}, "));
        let heights = crs.vertical.as_ref().map_or(String::new(), |heights| format!("{heights}, "));
        table.row("crs", format!("{code}{heights}{}", crs.text));
    }
    if let Some((low, high)) = city.bounds() {
        let (low, high) = (low + city.origin, high + city.origin);
        for (axis, name) in ["x", "y", "z (up)"].into_iter().enumerate() {
            table.row(name, format!("{:.2} to {:.2} m", low[axis], high[axis]));
        }
    }
    let kinds = [
        (PlaneAttitude::Wall, "walls"),
        (PlaneAttitude::Slanted, "slanted"),
        (PlaneAttitude::LevelUp, "level, up"),
        (PlaneAttitude::LevelDown, "level, down"),
    ];
    for (lie, name) in kinds {
        let (mut count, mut area_m2) = (0, 0.0);
        for plane in planes.planes.iter().filter(|plane| PlaneAttitude::of(&plane.plane.normal) == lie) {
            count += 1;
            area_m2 += plane.area_m2;
        }
        table.row(name, format!("{count} planes, {area_m2:.0} m2"));
    }
    if let Some(output) = output {
        table.row("written", output.display());
    }
    table.row("time", format!("{seconds:.1} s"));
    table.text
}

/// What a file of the city holds, a row for each level of detail.
fn contents_rows(table: &mut Table, contents: &CityContents) {
    let CityContents { format, objects, parts, polygons, holes, .. } = contents;
    table.row("format", format!("{format}: {objects} objects, {parts} parts, {holes} polygons with holes"));
    for (lod, counts) in polygons {
        let level = lod.map_or_else(|| "unsaid".to_owned(), |lod| lod.to_string());
        let kinds = counts.named().filter(|(_, count)| *count > 0).map(|(kind, count)| format!("{count} {kind}"));
        let kinds = kinds.collect::<Vec<_>>().join(", ");
        table.row("  level", format!("{level}: {} polygons ({kinds})", counts.total()));
    }
}

/// Verdict, parts, ledger, files and time.
pub fn of_merge(merge: &Merge, output: &Path, files: &[&str], seconds: f64) -> String {
    let mut table = Table::new(&format!("{}: {}", merge.verdict.word(), merge.reason), 13);
    for part in &merge.parts {
        let place = match (&part.merged_from_part, &part.reason) {
            (Some(pose), _) => format!("placed, scale {:.6}", pose.scale),
            (None, reason) => format!("left out: {}", reason.as_deref().unwrap_or("not placed")),
        };
        table.row(&part.name, place);
    }
    let accounts = [
        ("images", &merge.ledger.images),
        ("points", &merge.ledger.points),
        ("observations", &merge.ledger.observations),
    ];
    accounts.into_iter().for_each(|(name, account)| table.row(name, account_line(account)));
    table.row("written", format!("{} ({})", output.display(), files.join(", ")));
    table.row("time", format!("{seconds:.1} s"));
    table.text
}

fn account_line(account: &Account) -> String {
    let mut line = format!("{} in = {} kept + {} fused", account.given, account.kept, account.fused);
    for (reason, count) in &account.dropped {
        let _ = write!(line, " + {count} dropped ({})", reason.words());
    }
    line
}

/// What was written again.
pub fn of_export(title: &str, output: &Path, files: &[&str], seconds: f64) -> String {
    let mut table = Table::new(title, 13);
    table.row("written", format!("{} ({})", output.display(), files.join(", ")));
    table.row("time", format!("{seconds:.1} s"));
    table.text
}
