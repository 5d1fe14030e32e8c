//! What is meant: paths that exist, options that go together. Traps are found here, before any long work.

use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::city::{CityIndex, CityModel, CityOptions, PlanBox, is_index_at, read_city_files, read_city_within};
use crate::geometry::Vector3;
use crate::imagery::SuperpixelSource;
use crate::reconstruction::SfmOptions;
use crate::{AlignOptions, Place, Up};
use anyhow::{Context, Result, ensure};

use super::args::{AlignArgs, CityArgs, UpArg};
use super::place::PlaceSources;
use super::roles::{self, Given, Role};

/// An alignment ready to be carried out.
pub struct AlignPlan {
    pub city: CityFiles,
    pub sfm: PathBuf,
    pub sfm_options: SfmOptions,
    pub superpixels: Option<SuperpixelSource>,
    pub place: PlaceSources,
    pub settings: Settings,
    /// `None` where nothing is to be written.
    pub output: Option<PathBuf>,
    pub warnings: Vec<String>,
}

/// What is set besides the start.
pub struct Settings {
    fixed_scale: Option<f64>,
    up: Up,
    accuracy_m: Option<f64>,
    seed: u64,
    false_alarm: f64,
    budget: Option<Duration>,
}

/// The files of a city model.
pub struct CityFiles {
    /// Files and folders that are one city.
    pub city: Vec<PathBuf>,
    pub terrain: Vec<PathBuf>,
    pub options: CityOptions,
}

impl AlignPlan {
    pub fn new(args: &AlignArgs, seed: u64) -> Result<AlignPlan> {
        existing_sfm(&args.sfm, &args.city)?;
        let mut given: Vec<Given<'_>> = args.city.iter().map(|path| (Role::City, path.as_path())).collect();
        given.push((Role::Sfm, &args.sfm));
        given.extend(args.city_options.terrain.iter().map(|path| (Role::Terrain, path.as_path())));
        given.extend(args.labels.iter().map(|path| (Role::Labels, path.as_path())));
        given.extend(args.photos.iter().map(|path| (Role::Photos, path.as_path())));
        given.extend(args.start.iter().map(|path| (Role::Start, path.as_path())));
        given.extend(args.positions.iter().map(|path| (Role::Positions, path.as_path())));
        given.extend(args.points.iter().map(|path| (Role::Points, path.as_path())));
        roles::check("align", &given)?;
        let city = CityFiles::new(&args.city, &args.city_options)?;
        let mut warnings = Vec::new();
        let superpixels = superpixel_source(args, &mut warnings)?;
        let mut inputs: Vec<&PathBuf> = args.city.iter().chain([&args.sfm]).collect();
        inputs.extend(args.city_options.terrain.iter().chain(&args.start).chain(&args.labels).chain(&args.photos));
        inputs.extend(args.positions.iter().chain(&args.points));
        let output = args.output.clone().filter(|_| !args.dry_run);
        if let Some(output) = &output {
            keeps_inputs(output, &inputs)?;
        }
        Ok(AlignPlan {
            place: PlaceSources::read(args)?,
            settings: Settings::new(args, seed),
            city,
            sfm: args.sfm.clone(),
            sfm_options: sfm_options(&args.classes),
            superpixels,
            output,
            warnings,
        })
    }

    pub fn fixed_scale(&self) -> Option<f64> {
        self.settings.fixed_scale
    }

    pub fn has_budget(&self) -> bool {
        self.settings.budget.is_some()
    }

    /// Everything that `align` takes, from that place on.
    pub fn options(&self, place: Place) -> AlignOptions {
        let Settings { fixed_scale, up, accuracy_m, seed, false_alarm, budget } = self.settings;
        let options = AlignOptions { fixed_scale, up, accuracy_m, seed, ..AlignOptions::at(place) };
        options.with_false_alarm(false_alarm).with_budget(budget)
    }
}

impl Settings {
    fn new(args: &AlignArgs, seed: u64) -> Settings {
        let up = match args.up {
            UpArg::Auto => Up::Auto,
            UpArg::None => Up::None,
            UpArg::Given(up) => Up::Given(Vector3::from(up)),
        };
        let fixed_scale = args.scale.map(|scale| scale.0);
        let accuracy_m = args.accuracy.map(|accuracy| accuracy.0);
        let budget = args.budget.map(|budget| budget.0);
        Settings { fixed_scale, up, accuracy_m, seed, false_alarm: args.false_alarm.0, budget }
    }
}

impl CityFiles {
    pub fn new(city: &[PathBuf], args: &CityArgs) -> Result<CityFiles> {
        for (i, path) in city.iter().enumerate() {
            existing_city(path, "the city")?;
            for earlier in &city[..i] {
                ensure!(!holds(earlier, path) && !holds(path, earlier), given_twice(earlier, path));
            }
        }
        for path in &args.terrain {
            existing_city(path, "the terrain")?;
            let is_city = city.iter().any(|city| same(path, city));
            ensure!(!is_city, "the city is given again as terrain, leave one out: {}", path.display());
        }
        Ok(CityFiles { city: city.into(), terrain: args.terrain.clone(), options: args.options() })
    }

    /// The index that the city is, where it is one.
    pub fn index(&self) -> Result<Option<CityIndex>> {
        // Beside other files an index is refused when the city is read.
        let [alone] = self.city.as_slice() else { return Ok(None) };
        is_index_at(alone).then(|| Ok(CityIndex::open(alone)?)).transpose()
    }

    /// Reads the city; where it is an index, only what matters of it.
    pub fn read(&self, within: Option<&PlanBox>) -> Result<CityModel> {
        Ok(match within {
            Some(within) => read_city_within(&self.city, &self.terrain, &self.options, within)?,
            None => read_city_files(&self.city, &self.terrain, &self.options)?,
        })
    }

    /// City and terrain, by their names alone.
    pub fn names(&self) -> Vec<String> {
        self.city.iter().chain(&self.terrain).map(|path| file_name(path)).collect()
    }
}

/// Last component of a path, as a report names a file.
pub fn file_name(path: &Path) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    // "." and ".." have no name of their own.
    name.or_else(|| Some(path.canonicalize().ok()?.file_name()?.to_string_lossy().into_owned())).unwrap_or_default()
}

/// No classes named are all but noise.
pub fn sfm_options(classes: &[u8]) -> SfmOptions {
    let options = SfmOptions::default();
    if classes.is_empty() { options } else { options.with_classes(classes) }
}

pub fn existing_sfm(sfm: &Path, city: &[PathBuf]) -> Result<()> {
    let place = sfm.display();
    existing_reconstruction(sfm, "the reconstruction")?;
    ensure!(!city.iter().any(|city| same(sfm, city)), "city and reconstruction are the same file: {place}");
    Ok(())
}

/// A folder or a file, whatever is in it; a pipe might never end.
pub fn existing_reconstruction(path: &Path, what: &str) -> Result<()> {
    let place = path.display();
    let found = std::fs::metadata(path).with_context(|| {
        format!("cannot read {what}, expected a COLMAP folder or a file of a reconstruction: {place}")
    })?;
    let is_one = found.is_dir() || found.is_file();
    ensure!(is_one, "{what} is a pipe or a device, expected a COLMAP folder or a file of a reconstruction: {place}");
    Ok(())
}

/// Refuses an output that is one of the inputs or holds one: replacing it would delete what was read.
pub fn keeps_inputs(output: &Path, inputs: &[&PathBuf]) -> Result<()> {
    let Ok(real_output) = output.canonicalize() else { return Ok(()) };
    for input in inputs {
        let inside = input.canonicalize().is_ok_and(|real_input| real_input.starts_with(&real_output));
        ensure!(
            !inside,
            "the output would replace an input ({}); name another place with -o: {}",
            input.display(),
            output.display()
        );
    }
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    ensure!(
        !here.is_ok_and(|here| here.starts_with(&real_output)),
        "the output would replace the folder that you are in; name another place with -o: {}",
        output.display()
    );
    Ok(())
}

fn superpixel_source(args: &AlignArgs, warnings: &mut Vec<String>) -> Result<Option<SuperpixelSource>> {
    for (folder, option) in [(&args.labels, "--labels"), (&args.photos, "--photos")] {
        let Some(folder) = folder else { continue };
        let place = folder.display();
        let mut entries = std::fs::read_dir(folder)
            .with_context(|| format!("cannot read the folder of {option}, expected a folder of images: {place}"))?;
        ensure!(
            entries.next().is_some(),
            "the folder of {option} is empty; give one with images, or leave it out: {place}"
        );
    }
    if args.labels.is_some() && args.photos.is_some() {
        warnings.push("--photos is not used: --labels says already what belongs together".into());
    }
    let labels = args.labels.clone().map(SuperpixelSource::Labels);
    Ok(labels.or_else(|| args.photos.clone().map(SuperpixelSource::Photos)))
}

/// A file, or a folder of them, whatever is in it; a pipe might never end.
fn existing_city(path: &Path, what: &str) -> Result<()> {
    let place = path.display();
    let found = std::fs::metadata(path).with_context(|| format!("cannot read {what}: {place}"))?;
    let is_one = found.is_dir() || found.is_file();
    ensure!(is_one, "{what} is a pipe or a device, expected a file or a folder of files: {place}");
    Ok(())
}

/// Whether `inner` is read where `outer` is: the same path, or a file in that folder (folders within are not entered).
fn holds(outer: &Path, inner: &Path) -> bool {
    let parent = || Some(inner.canonicalize().ok()?.parent()?.to_owned());
    same(outer, inner) || inner.is_file() && parent().is_some_and(|parent| same(outer, &parent))
}

fn given_twice(earlier: &Path, path: &Path) -> String {
    format!("a file of the city is given twice, leave one out: {} and {}", earlier.display(), path.display())
}

fn same(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

#[cfg(test)]
mod tests;
