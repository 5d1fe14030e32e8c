//! `cityweld planes`

use std::path::Path;

use crate::city::{CityError, CityModel, read_city_contents, read_city_files};
use crate::export::{Output, OutputKind, planes_report, write_planes_glb};
use crate::planes::city_planes;
use anyhow::{Context, Result, bail};

use super::args::PlanesArgs;
use super::plan::{CityFiles, keeps_inputs};
use super::print::Voice;
use super::roles::{self, Role};
use super::{Outcome, Session, summary};

/// What `-o` asks for, by the ending of its name.
enum Form {
    Glb,
    Json,
}

pub fn run(args: &PlanesArgs, session: &Session) -> Result<Outcome> {
    let terrain = args.city_options.terrain.iter().map(|path| (Role::Terrain, path.as_path()));
    let city = args.city.iter().map(|path| (Role::City, path.as_path()));
    roles::check("planes", &city.chain(terrain).collect::<Vec<_>>())?;
    let files = CityFiles::new(&args.city, &args.city_options)?;
    let output = args.output.as_deref().map(|path| begin(path, args, session)).transpose()?;
    let voice = &session.voice;

    voice.bar.show("reading the city", 0, 0);
    let city = read(&files, args, voice)?;
    voice.detail(&format!("city: {} facets of {} objects", city.facets.len(), city.objects.len()));
    voice.bar.show("planes", 0, 0);
    let planes = city_planes(&city);
    voice.detail(&format!("planes: {}", planes.planes.len()));

    let names = files.names();
    let written = args.output.as_deref();
    if let Some((output, form)) = output {
        match form {
            Form::Glb => write_planes_glb(output.path(), &city, &planes)?,
            Form::Json => std::fs::write(output.path(), planes_report(&city, &planes, &names)?)
                .with_context(|| format!("cannot write the planes: {}", output.path().display()))?,
        }
        output.commit()?;
    }
    let warnings: Vec<String> = city.warnings.iter().map(ToString::to_string).collect();
    voice.warnings(&warnings);
    if session.common.json {
        voice.json(&planes_report(&city, &planes, &names)?, written)?;
    } else {
        voice.result(&summary::of_city(&city, &planes, &names, written, voice.seconds()), written)?;
    }
    Ok(Outcome::Good)
}

/// Reads the city. One whose format names its objects, and whose objects are all without polygons, is shown as empty where nothing is
/// to be written.
fn read(files: &CityFiles, args: &PlanesArgs, voice: &Voice) -> Result<CityModel> {
    let error = match read_city_files(&files.city, &files.terrain, &files.options) {
        Err(error @ CityError::NoFaces { .. }) if args.output.is_none() => error,
        city => return Ok(city?),
    };
    let contents = read_city_contents(&files.city, &files.options)?;
    if !contents.iter().any(|(_, contents)| contents.objects > 0 && contents.polygons.is_empty()) {
        return Err(error.into());
    }
    voice.warnings(&[error.to_string()]);
    Ok(CityModel::default())
}

fn begin(path: &Path, args: &PlanesArgs, session: &Session) -> Result<(Output, Form)> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let form = match ending.as_deref() {
        Some("glb") => Form::Glb,
        Some("json") => Form::Json,
        _ => bail!("the output's name ends in neither .glb nor .json, so its form is unknown: {}", path.display()),
    };
    let inputs: Vec<_> = args.city.iter().chain(&args.city_options.terrain).collect();
    keeps_inputs(path, &inputs)?;
    let output = session.begin(path, OutputKind::File)?;
    Ok((output, form))
}
