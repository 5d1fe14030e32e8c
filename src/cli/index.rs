//! `cityweld index`

use std::path::Path;

use anyhow::{Result, ensure};

use super::args::IndexArgs;
use super::plan::{CityFiles, file_name, keeps_inputs};
use super::roles::{self, Role};
use super::{Outcome, Session, summary};
use crate::city::{CityIndex, is_index_at};
use crate::city_index::write_city_index;
use crate::export::OutputKind;

pub fn run(args: &IndexArgs, session: &Session) -> Result<Outcome> {
    let terrain = &args.city_options.terrain;
    let given = args.city.iter().map(|path| (Role::City, path.as_path()));
    let given = given.chain(terrain.iter().map(|path| (Role::Terrain, path.as_path())));
    roles::check("index", &given.collect::<Vec<_>>())?;
    let files = CityFiles::new(&args.city, &args.city_options)?;
    for path in &files.city {
        ensure!(!is_index_at(path), "this is an index already, give the city's own files: {}", path.display());
    }
    keeps_inputs(&args.output, &args.city.iter().chain(terrain).collect::<Vec<_>>())?;
    let output = session.begin(&args.output, OutputKind::File)?;
    let voice = &session.voice;

    voice.bar.show("reading the city", 0, 0);
    write_city_index(&files.city, &files.terrain, &files.options, output.path(), &voice.bar)?;
    output.commit()?;
    tell(&args.output, args, session)
}

/// Opens what was written, as whoever uses it will.
fn tell(path: &Path, args: &IndexArgs, session: &Session) -> Result<Outcome> {
    let voice = &session.voice;
    let index = CityIndex::open(path)?;
    let overview = index.overview();
    voice.warnings(&overview.warnings);
    if session.common.json {
        voice.json(&(serde_json::to_string_pretty(&overview)? + "\n"), Some(path))?;
    } else {
        let names: Vec<String> = args.city.iter().map(|path| file_name(path)).collect();
        voice.result(&summary::of_index(&overview, &names, path, voice.seconds()), Some(path))?;
    }
    Ok(Outcome::Good)
}
