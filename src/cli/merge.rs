//! `cityweld merge`

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use cityweld::city::{CityModel, read_city};
use cityweld::export::{OutputKind, merge_report, write_merge};
use cityweld::format::read_start;
use cityweld::imagery::{ImageryError, SuperpixelOptions, SuperpixelSource, lift_superpixels};
use cityweld::merging::{Anchor, Merge, MergeOptions, MergeVerdict, Part, merge};
use cityweld::reconstruction::read_reconstruction;
use cityweld::{AlignOptions, Up};

use super::args::MergeArgs;
use super::plan::{CityFiles, keeps_inputs};
use super::{Outcome, Session, summary};

pub fn run(args: &MergeArgs, session: &Session) -> Result<Outcome> {
    check(args)?;
    let output = session.begin(&args.output, OutputKind::Folder)?;
    let voice = &session.voice;
    let city = read_the_city(args, session)?;
    let options = MergeOptions { seed: session.common.seed };
    // The parts go before the files are written: a model is as large as they are.
    let merged = merge(&read_parts(args, city.as_ref(), session)?, &options, &|stage| voice.detail(stage))?;
    voice.detail(&format!("{}: {}", merged.verdict.word(), merged.reason));

    voice.bar.show("writing", 0, 0);
    let files = write_merge(&output.path(), &merged, city.as_ref())?;
    output.commit()?;
    voice.warnings(&merged.warnings);
    tell(&merged, args, &files, session)?;
    Ok(if merged.verdict == MergeVerdict::Merged { Outcome::Good } else { Outcome::Doubtful })
}

fn tell(merged: &Merge, args: &MergeArgs, files: &[&str], session: &Session) -> Result<()> {
    let voice = &session.voice;
    if session.common.json {
        voice.result(&merge_report(merged)?);
    } else {
        voice.result(&summary::of_merge(merged, &args.output, files, voice.seconds()));
    }
    Ok(())
}

fn check(args: &MergeArgs) -> Result<()> {
    for part in &args.parts {
        std::fs::metadata(part).with_context(|| {
            format!("cannot read the part, expected a COLMAP folder or a PLY file: {}", part.display())
        })?;
    }
    let mut inputs: Vec<&PathBuf> = args.parts.iter().collect();
    inputs.extend(args.city.iter().chain(&args.terrain).chain(&args.start).chain(&args.labels).chain(&args.photos));
    keeps_inputs(&args.output, &inputs)?;
    if args.city.is_none() {
        ensure!(args.start.is_empty(), "--start says where the parts are in a city; give the city with --city");
        ensure!(args.terrain.is_empty(), "--terrain belongs to a city; give the city with --city");
        return Ok(());
    }
    ensure!(
        args.start.len() == args.parts.len(),
        "--city needs one --start for every part, in their order: {} parts, {} starts",
        args.parts.len(),
        args.start.len()
    );
    Ok(())
}

fn read_the_city(args: &MergeArgs, session: &Session) -> Result<Option<CityModel>> {
    let Some(city) = &args.city else { return Ok(None) };
    session.voice.bar.show("reading the city", 0, 0);
    let files = CityFiles::new(city, &args.terrain, args.city_up)?;
    Ok(Some(read_city(&files.city, &files.terrain, &files.options)?))
}

fn read_parts(args: &MergeArgs, city: Option<&CityModel>, session: &Session) -> Result<Vec<Part>> {
    if city.is_none() && (args.labels.is_some() || args.photos.is_some()) {
        let text = "superpixels do not join parts yet, only --city uses --labels and --photos; keypoints and poses do";
        session.voice.warnings([&text.to_owned()]);
    }
    let names = unique_names(&args.parts);
    let mut parts = Vec::new();
    for (index, (path, name)) in args.parts.iter().zip(names).enumerate() {
        session.voice.bar.show("reading the parts", index, args.parts.len());
        let sfm = read_reconstruction(path)?;
        session.voice.detail(&format!("{name}: {} points, {} images", sfm.points.len(), sfm.images.len()));
        let labels = args.labels.clone().map(SuperpixelSource::Labels);
        let source = labels.or_else(|| args.photos.clone().map(SuperpixelSource::Photos));
        let superpixels = match source.filter(|_| city.is_some()) {
            None => None,
            Some(source) => match lift_superpixels(&sfm, &source, &SuperpixelOptions::default(), &|_, _| ()) {
                // Only shared photographs matter; a part without any file there has nothing to add.
                Err(ImageryError::NothingFound { .. } | ImageryError::NoImages { .. }) => None,
                lifted => Some(without_missing(lifted?)),
            },
        };
        let mut part = Part { name, sfm, superpixels, anchor: None };
        if let Some(city) = city {
            part.anchor = Some(anchor(&part, city, &args.start[index], session)?);
        }
        parts.push(part);
    }
    Ok(parts)
}

/// Photographs of which only the shared ones were given are the normal case, no matter for a warning.
fn without_missing(mut lifted: cityweld::imagery::LiftedSuperpixels) -> cityweld::imagery::LiftedSuperpixels {
    lifted.warnings.retain(|w| !matches!(w, cityweld::imagery::ImageryWarning::Missing { .. }));
    lifted
}

fn anchor(part: &Part, city: &CityModel, start: &Path, session: &Session) -> Result<Anchor> {
    let options =
        AlignOptions { start: read_start(start)?, fixed_scale: None, up: Up::Auto, seed: session.common.seed };
    let progress = |stage, done, all| session.voice.bar.show(stage, done, all);
    let found = cityweld::align(city, &part.sfm, part.superpixels.as_ref(), &options, &progress);
    let anchor = Anchor::of(&found, &part.sfm, options.start.city_from_sfm);
    session.voice.detail(&format!("{}: {}", part.name, anchor.reason));
    Ok(anchor)
}

/// The last components of the paths, with as many of their parents as it takes to tell them apart.
fn unique_names(paths: &[PathBuf]) -> Vec<String> {
    let full: Vec<Vec<String>> = paths
        .iter()
        .map(|path| {
            let path = path.canonicalize().unwrap_or_else(|_| path.clone());
            path.iter().map(|part| part.to_string_lossy().into_owned()).collect()
        })
        .collect();
    let longest = full.iter().map(Vec::len).max().unwrap_or(0);
    for depth in 1..=longest {
        let names: Vec<String> =
            full.iter().map(|parts| parts[parts.len().saturating_sub(depth)..].join("/")).collect();
        let distinct: std::collections::BTreeSet<&String> = names.iter().collect();
        if distinct.len() == names.len() {
            return names;
        }
    }
    // One folder given twice is told apart by number.
    let number = |i: usize| 1 + full[..i].iter().filter(|other| **other == full[i]).count();
    let name = |i: usize| full[i].last().cloned().unwrap_or_default();
    (0..full.len()).map(|i| format!("{} ({})", name(i), number(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_grow_by_their_parents_until_they_differ() {
        let paths = ["/none/x/sfm", "/none/y/sfm"].map(PathBuf::from);
        assert_eq!(unique_names(&paths), ["x/sfm", "y/sfm"]);
        assert_eq!(unique_names(&["/none/a", "/none/b"].map(PathBuf::from)), ["a", "b"]);
        assert_eq!(unique_names(&["/none/a", "/none/a"].map(PathBuf::from)), ["a (1)", "a (2)"]);
    }
}
