//! Results as a short table for people.

use std::fmt::Write;
use std::path::Path;

use cityweld::city::CityModel;
use cityweld::export::Lie;
use cityweld::merging::{Account, Merge};
use cityweld::planes::CityPlanes;
use cityweld::verdict::{Alignment, Freedom, Verdict};

/// Verdict, reason, scale, freedoms, support, files and time.
pub fn of_alignment(alignment: &Alignment, output: &Path, files: &[&str], seconds: f64) -> String {
    let mut text = format!("{}: {}\n", alignment.verdict.word(), alignment.reason);
    let mut row = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<13} {value}");
    };
    if let Some(best) = &alignment.best {
        let what = if alignment.verdict == Verdict::Aligned { "scale" } else { "scale (best)" };
        row(what, format!("{:.6} m per reconstruction unit", best.scale));
    }
    for (index, freedom) in alignment.freedoms.iter().enumerate() {
        row(if index == 0 { "freedoms" } else { "" }, freedom_line(freedom));
    }
    let support = &alignment.support;
    row(
        "support",
        format!(
            "{} of {} points on {} planes, median {:.3} m, rms {:.3} m",
            support.trusted_points, support.points, support.planes, support.median_m, support.rms_m
        ),
    );
    for (index, other) in alignment.alternatives.iter().enumerate() {
        let name = if index == 0 { "alternatives" } else { "" };
        row(name, format!("{} (weight {:.3})", other.differs, other.weight));
    }
    row("written", format!("{} ({})", output.display(), files.join(", ")));
    row("time", format!("{seconds:.1} s"));
    text
}

fn freedom_line(freedom: &Freedom) -> String {
    let sigma = match freedom.unit {
        // One sigma of the logarithm is a share of the scale itself.
        "1" => format!("{:.3} %", 100.0 * freedom.sigma),
        unit => format!("{:.3} {unit}", freedom.sigma),
    };
    let mark = if freedom.determined { "" } else { "   NOT determined" };
    format!("{:<32} sigma {sigma}{mark}", freedom.name)
}

/// What the program sees in a city.
pub fn of_city(city: &CityModel, planes: &CityPlanes, files: &[String], output: Option<&Path>, seconds: f64) -> String {
    let mut text = format!(
        "{}: {} objects, {} facets, {} triangles, {} planes\n",
        files.join(" + "),
        city.objects.len(),
        city.facets.len(),
        city.triangles.len(),
        planes.planes.len()
    );
    let mut row = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<11} {value}");
    };
    if let Some((low, high)) = city.bounds() {
        let (low, high) = (low + city.origin, high + city.origin);
        for (axis, name) in ["x", "y", "z (up)"].into_iter().enumerate() {
            row(name, format!("{:.2} to {:.2} m", low[axis], high[axis]));
        }
    }
    let kinds =
        [(Lie::Wall, "walls"), (Lie::Slanted, "slanted"), (Lie::LevelUp, "level, up"), (Lie::LevelDown, "level, down")];
    for (lie, name) in kinds {
        let (mut count, mut area_m2) = (0, 0.0);
        for plane in planes.planes.iter().filter(|plane| Lie::of(&plane.plane.normal) == lie) {
            count += 1;
            area_m2 += plane.area_m2;
        }
        row(name, format!("{count} planes, {area_m2:.0} m2"));
    }
    if let Some(output) = output {
        row("written", output.display().to_string());
    }
    row("time", format!("{seconds:.1} s"));
    text
}

/// Verdict, parts, ledger, files and time.
pub fn of_merge(merge: &Merge, output: &Path, files: &[&str], seconds: f64) -> String {
    let mut text = format!("{}: {}\n", merge.verdict.word(), merge.reason);
    let mut row = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<13} {value}");
    };
    for part in &merge.parts {
        let place = match (&part.merged_from_part, &part.reason) {
            (Some(pose), _) => format!("placed, scale {:.6}", pose.scale),
            (None, reason) => format!("left out: {}", reason.as_deref().unwrap_or("not placed")),
        };
        row(&part.name, place);
    }
    let accounts = [
        ("images", &merge.ledger.images),
        ("points", &merge.ledger.points),
        ("observations", &merge.ledger.observations),
    ];
    accounts.into_iter().for_each(|(name, account)| row(name, account_line(account)));
    row("written", format!("{} ({})", output.display(), files.join(", ")));
    row("time", format!("{seconds:.1} s"));
    text
}

fn account_line(account: &Account) -> String {
    let mut line = format!("{} in = {} kept + {} fused", account.given, account.kept, account.fused);
    for (reason, count) in &account.dropped {
        let _ = write!(line, " + {count} dropped ({reason})");
    }
    line
}

/// What was written again.
pub fn of_export(title: &str, output: &Path, files: &[&str], seconds: f64) -> String {
    format!("{title}\n  written       {} ({})\n  time          {seconds:.1} s\n", output.display(), files.join(", "))
}
