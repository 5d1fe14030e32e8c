//! `cityweld merge`

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use cityweld::AlignOptions;
use cityweld::city::read_city;
use cityweld::export::{OutputKind, merge_report, write_merge};
use cityweld::format::read_start;
use cityweld::imagery::{
    ImageryError, ImageryWarning, LiftedSuperpixels, SuperpixelOptions, SuperpixelSource, lift_superpixels,
    lift_superpixels_of,
};
use cityweld::merging::{Anchor, EvidenceChoice, JoinOptions, Merge, MergeVerdict, Part, join};
use cityweld::planes::PreparedCity;
use cityweld::reconstruction::{Image, read_reconstruction};

use super::args::{EvidenceArg, MergeArgs};
use super::plan::{CityFiles, existing_reconstruction, keeps_inputs};
use super::roles::{self, Given, Role};
use super::{Outcome, Session, summary};

pub fn run(args: &MergeArgs, session: &Session) -> Result<Outcome> {
    check(args)?;
    let output = session.begin(&args.output, OutputKind::Folder)?;
    let voice = &session.voice;
    let city = read_the_city(args, session)?;
    let evidence = match args.evidence {
        EvidenceArg::All => EvidenceChoice::All,
        EvidenceArg::Planes => EvidenceChoice::Planes,
    };
    let options = JoinOptions { seed: session.common.seed, evidence, ..JoinOptions::default() };
    // The parts go before the files are written: a model is as large as they are.
    let merged = join(&read_parts(args, city.as_ref(), session)?, &options, &|stage| voice.detail(stage))?;
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
    inputs.extend(args.city.iter().chain(&args.terrain).chain(&args.start).chain(&args.labels).chain(&args.photos));
    keeps_inputs(&args.output, &inputs)?;
    ensure!(
        args.evidence == EvidenceArg::All || superpixel_source(args).is_some(),
        "--evidence planes needs superpixels; give their label images with --labels, or the photographs with --photos"
    );
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

fn paths_with_roles(args: &MergeArgs) -> Vec<Given<'_>> {
    let mut given: Vec<Given<'_>> = args.parts.iter().map(|path| (Role::Part, path.as_path())).collect();
    given.extend(args.city.iter().map(|path| (Role::CityOption, path.as_path())));
    given.extend(args.terrain.iter().map(|path| (Role::Terrain, path.as_path())));
    given.extend(args.labels.iter().map(|path| (Role::Labels, path.as_path())));
    given.extend(args.photos.iter().map(|path| (Role::Photos, path.as_path())));
    given.extend(args.start.iter().map(|path| (Role::Start, path.as_path())));
    given
}

fn read_the_city(args: &MergeArgs, session: &Session) -> Result<Option<PreparedCity>> {
    let Some(city) = &args.city else { return Ok(None) };
    session.voice.bar.show("reading the city", 0, 0);
    let files = CityFiles::new(city, &args.terrain, args.city_up)?;
    Ok(Some(PreparedCity::new(read_city(&files.city, &files.terrain, &files.options)?)))
}

fn read_parts(args: &MergeArgs, city: Option<&PreparedCity>, session: &Session) -> Result<Vec<Part>> {
    let mut parts = Vec::new();
    for (index, (path, name)) in args.parts.iter().zip(unique_names(&args.parts)).enumerate() {
        session.voice.bar.show("reading the parts", index, args.parts.len());
        let sfm = read_reconstruction(path)?;
        session.voice.detail(&format!("{name}: {} points, {} images", sfm.points.len(), sfm.images.len()));
        parts.push(Part { name, sfm, superpixels: None, anchor: None });
    }
    let Some(source) = superpixel_source(args) else {
        anchor_all(&mut parts, None, args, city, session)?;
        return Ok(parts);
    };
    lift_shared(&mut parts, &source, session)?;
    anchor_all(&mut parts, Some(&source), args, city, session)?;
    Ok(parts)
}

fn superpixel_source(args: &MergeArgs) -> Option<SuperpixelSource> {
    let labels = args.labels.clone().map(SuperpixelSource::Labels);
    labels.or_else(|| args.photos.clone().map(SuperpixelSource::Photos))
}

/// Superpixels of a photograph where parts are joined: so small that most show one piece of surface, and still hold a handful
/// of points.
const JOINING_SUPERPIXELS: usize = 1100;

/// Superpixels of the photographs that several parts have; the others join nothing.
fn lift_shared(parts: &mut [Part], source: &SuperpixelSource, session: &Session) -> Result<()> {
    let mut parts_with: HashMap<String, usize> = HashMap::new();
    for part in parts.iter() {
        let names: BTreeSet<&String> = part.sfm.images.iter().map(|image| &image.name).collect();
        names.into_iter().for_each(|name| *parts_with.entry(name.clone()).or_default() += 1);
    }
    let is_shared = |image: &Image| parts_with.get(&image.name).is_some_and(|count| *count > 1);
    for part in parts.iter_mut() {
        session.voice.bar.show("superpixels", 0, 0);
        // Both parts must see the same superpixels, whatever keypoints each of them has.
        let options = SuperpixelOptions { count: JOINING_SUPERPIXELS, by_keypoints: false };
        part.superpixels = given(lift_superpixels_of(&part.sfm, &is_shared, source, &options, &|_, _| ()))?;
    }
    // Where no photograph is shared, labels and photographs are for the city.
    let any_is_shared = parts_with.values().any(|count| *count > 1);
    if any_is_shared && parts.iter().all(|part| part.superpixels.is_none()) {
        let folder = source.folder().display();
        let text =
            format!("no file there is that of a photograph that two parts share, so no plane joins them: {folder}");
        session.voice.warnings([&text]);
    }
    Ok(())
}

/// A part of whose photographs none is there has nothing to add.
fn given(lifted: Result<LiftedSuperpixels, ImageryError>) -> Result<Option<LiftedSuperpixels>> {
    match lifted {
        Err(ImageryError::NothingFound { .. } | ImageryError::NoImages { .. }) => Ok(None),
        lifted => Ok(Some(without_missing(lifted?))),
    }
}

fn anchor_all(
    parts: &mut [Part],
    source: Option<&SuperpixelSource>,
    args: &MergeArgs,
    city: Option<&PreparedCity>,
    session: &Session,
) -> Result<()> {
    let Some(city) = city else { return Ok(()) };
    for (part, start) in parts.iter_mut().zip(&args.start) {
        let lift = |source| given(lift_superpixels(&part.sfm, source, &SuperpixelOptions::default(), &|_, _| ()));
        let superpixels = source.map(lift).transpose()?.flatten();
        part.anchor = Some(anchor(part, superpixels.as_ref(), city, start, session)?);
    }
    Ok(())
}

/// Photographs of which only the shared ones were given are the normal case, no matter for a warning.
fn without_missing(mut lifted: LiftedSuperpixels) -> LiftedSuperpixels {
    lifted.warnings.retain(|w| !matches!(w, ImageryWarning::Missing { .. }));
    lifted
}

fn anchor(
    part: &Part,
    superpixels: Option<&LiftedSuperpixels>,
    city: &PreparedCity,
    start: &Path,
    session: &Session,
) -> Result<Anchor> {
    let options = AlignOptions { seed: session.common.seed, ..AlignOptions::new(read_start(start)?) };
    let progress = |stage, done, all| session.voice.bar.show(stage, done, all);
    let found = cityweld::align(city, &part.sfm, superpixels, &options, &progress);
    let anchor = Anchor::of(&found, &part.sfm, *options.start.city_from_sfm());
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
