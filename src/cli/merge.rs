//! `cityweld merge`

use std::path::PathBuf;

use crate::Place;
use crate::city::{CityModel, read_city_files};
use crate::export::{OutputKind, merge_report, write_merge};
use crate::imagery::SuperpixelSource;
use crate::merge::{MergeOptions, MergePart, merge};
use crate::merging::{JoinOptions, Merge, MergeVerdict, PairSources};
use crate::planes::PreparedCity;
use crate::reconstruction::read_reconstruction_with;
use anyhow::{Context, Result, ensure};

use super::args::{EvidenceArg, MergeArgs};
use super::parts::parts;
use super::place::PartPlaces;
use super::plan::{CityFiles, existing_reconstruction, keeps_inputs, sfm_options};
use super::roles::{self, Given, Role};
use super::{Outcome, Session, summary};

pub fn run(args: &MergeArgs, session: &Session) -> Result<Outcome> {
    let args = &MergeArgs { parts: parts(&args.parts)?, ..args.clone() };
    check(args)?;
    let output = session.begin(&args.output, OutputKind::Folder)?;
    let voice = &session.voice;
    let city = read_the_city(args, session)?;
    let sources = match args.evidence {
        EvidenceArg::All => PairSources::All,
        EvidenceArg::Planes => PairSources::Planes,
    };
    let mut join = JoinOptions { seed: session.common.seed, sources, ..JoinOptions::default() };
    join.limits.verdict.false_alarm = args.false_alarm.0;
    let options = MergeOptions { superpixels: superpixel_source(args), join };
    // The parts go before the files are written: a model is as large as they are.
    let (parts, warnings) = read_parts(args, city.as_ref().map(|city| &city.model), session)?;
    let mut merged = merge(parts, city.as_ref(), &options, voice)?;
    merged.warnings.splice(0..0, warnings);
    voice.detail(&format!("{}: {}", merged.verdict.word(), merged.reason));

    voice.bar.show("writing", 0, 0);
    let files = write_merge(output.path(), &merged, city.as_ref().map(|city| &city.model))?;
    output.commit()?;
    voice.warnings(&merged.warnings);
    tell(&merged, args, &files, session)?;
    Ok(if merged.verdict == MergeVerdict::Merged { Outcome::Good } else { Outcome::Doubtful })
}

fn tell(merged: &Merge, args: &MergeArgs, files: &[&str], session: &Session) -> Result<()> {
    let voice = &session.voice;
    if session.common.json {
        voice.json(&merge_report(merged)?, Some(&args.output))
    } else {
        voice.result(&summary::of_merge(merged, &args.output, files, voice.seconds()), Some(&args.output))
    }
}

fn check(args: &MergeArgs) -> Result<()> {
    for part in &args.parts {
        existing_reconstruction(part, "the part")?;
    }
    roles::check("merge", &paths_with_roles(args))?;
    let mut inputs: Vec<&PathBuf> = args.parts.iter().collect();
    inputs.extend(
        args.city.iter().chain(&args.city_options.terrain).chain(&args.start).chain(&args.labels).chain(&args.photos),
    );
    inputs.extend(&args.positions);
    keeps_inputs(&args.output, &inputs)?;
    ensure!(
        args.evidence == EvidenceArg::All || superpixel_source(args).is_some(),
        "--evidence planes needs superpixels; give their label images with --labels, or the photographs with --photos"
    );
    if args.city.is_empty() {
        ensure!(args.start.is_empty(), "--start says where the parts are in a city; give the city with --city");
        ensure!(args.positions.is_none(), "--positions says where the parts are in a city; give the city with --city");
        let option = args.city_options.first_given();
        ensure!(option.is_none(), "{} belongs to a city; give the city with --city", option.unwrap_or_default());
        return Ok(());
    }
    ensure!(
        args.start.is_empty() || args.start.len() == args.parts.len(),
        "--start is given for every part or for none, in their order: {} parts, {} starts",
        args.parts.len(),
        args.start.len()
    );
    Ok(())
}

fn paths_with_roles(args: &MergeArgs) -> Vec<Given<'_>> {
    let mut given: Vec<Given<'_>> = args.parts.iter().map(|path| (Role::Part, path.as_path())).collect();
    given.extend(args.city.iter().map(|path| (Role::CityOption, path.as_path())));
    given.extend(args.city_options.terrain.iter().map(|path| (Role::Terrain, path.as_path())));
    given.extend(args.labels.iter().map(|path| (Role::Labels, path.as_path())));
    given.extend(args.photos.iter().map(|path| (Role::Photos, path.as_path())));
    given.extend(args.start.iter().map(|path| (Role::Start, path.as_path())));
    given.extend(args.positions.iter().map(|path| (Role::Positions, path.as_path())));
    given
}

fn read_the_city(args: &MergeArgs, session: &Session) -> Result<Option<PreparedCity>> {
    if args.city.is_empty() {
        return Ok(None);
    }
    session.voice.bar.show("reading the city", 0, 0);
    let files = CityFiles::new(&args.city, &args.city_options)?;
    Ok(Some(PreparedCity::new(read_city_files(&files.city, &files.terrain, &files.options)?)))
}

/// The parts, and what is to be said of their places.
fn read_parts(args: &MergeArgs, city: Option<&CityModel>, session: &Session) -> Result<(Vec<MergePart>, Vec<String>)> {
    let (mut parts, mut warnings) = (Vec::new(), Vec::new());
    let sources = city.map(|city| PartPlaces::read(args, city)).transpose()?;
    for (index, (path, name)) in args.parts.iter().zip(unique_names(&args.parts)).enumerate() {
        session.voice.bar.show("reading the parts", index, args.parts.len());
        let sfm = read_reconstruction_with(path, &sfm_options(&args.classes))?;
        session.voice.detail(&format!("{name}: {} points, {} images", sfm.points.len(), sfm.images.len()));
        let place = match &sources {
            None => Place::default(),
            Some(sources) => {
                let (place, told) = sources.of_part(index, &sfm).with_context(|| name.clone())?;
                warnings.extend(told.into_iter().map(|text| format!("{name}: {text}")));
                place
            }
        };
        parts.push(MergePart { name, sfm, place });
    }
    Ok((parts, warnings))
}

fn superpixel_source(args: &MergeArgs) -> Option<SuperpixelSource> {
    let labels = args.labels.clone().map(SuperpixelSource::Labels);
    labels.or_else(|| args.photos.clone().map(SuperpixelSource::Photos))
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
