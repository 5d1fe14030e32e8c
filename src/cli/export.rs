//! `cityweld export`

use crate::city::read_city_files;
use crate::export::{Formats, OutputKind, write_placed};
use crate::format::{StoredAlignment, read_alignment};
use crate::reconstruction::read_reconstruction_with;
use anyhow::{Result, ensure};

use super::args::{ExportArgs, FormatArg};
use super::plan::{CityFiles, existing_sfm, keeps_inputs, sfm_options};
use super::roles::{self, Given, Role};
use super::{Outcome, Session, summary};

pub fn run(args: &ExportArgs, session: &Session) -> Result<Outcome> {
    existing_sfm(&args.sfm, &args.city)?;
    let mut given: Vec<Given<'_>> = args.city.iter().map(|path| (Role::City, path.as_path())).collect();
    given.extend([(Role::Sfm, args.sfm.as_path()), (Role::Alignment, &args.alignment)]);
    given.extend(args.city_options.terrain.iter().map(|path| (Role::Terrain, path.as_path())));
    roles::check("export", &given)?;
    let files = CityFiles::new(&args.city, &args.city_options)?;
    let inputs: Vec<_> =
        args.city.iter().chain([&args.sfm, &args.alignment]).chain(&args.city_options.terrain).collect();
    keeps_inputs(&args.output, &inputs)?;
    let stored = read_alignment(&args.alignment)?;
    let output = session.begin(&args.output, OutputKind::Folder)?;
    let voice = &session.voice;

    voice.bar.show("reading the city", 0, 0);
    let city = read_city_files(&files.city, &files.terrain, &files.options)?;
    voice.bar.show("reading the reconstruction", 0, 0);
    let sfm = read_reconstruction_with(&args.sfm, &sfm_options(&args.classes))?;
    ensure!(
        !sfm.images.is_empty() || !args.format.contains(&FormatArg::Colmap),
        "the reconstruction is a cloud without images, which COLMAP's formats cannot hold; leave colmap out of --format: {}",
        args.sfm.display()
    );
    voice.bar.show("writing", 0, 0);
    let written =
        write_placed(output.path(), &title(&stored), &city, &sfm, &stored.city_from_sfm, formats(&args.format))?;
    output.commit()?;

    let warnings = city.warnings.iter().map(ToString::to_string).chain(sfm.warnings.iter().map(ToString::to_string));
    voice.warnings(&warnings.collect::<Vec<_>>());
    if session.common.json {
        let answer = serde_json::json!({ "output": args.output.to_string_lossy(), "files": written });
        voice.json(&format!("{answer:#}\n"), Some(&args.output))?;
    } else {
        let table = summary::of_export(&title(&stored), &args.output, &written, voice.seconds());
        voice.result(&table, Some(&args.output))?;
    }
    Ok(Outcome::Good)
}

/// All formats where none is named.
fn formats(named: &[FormatArg]) -> Formats {
    let wanted = |format| named.is_empty() || named.contains(&format);
    Formats { glb: wanted(FormatArg::Glb), colmap: wanted(FormatArg::Colmap), ply: wanted(FormatArg::Ply) }
}

/// Only a transform was stood behind; who edits a file by hand may leave the verdict out.
fn title(stored: &StoredAlignment) -> String {
    match (stored.is_transform, stored.verdict.as_str()) {
        (true, "" | "aligned") => "aligned".into(),
        (true, verdict) => format!("given transform (the verdict beside it: {verdict})"),
        (false, verdict) => format!("best candidate, NOT aligned ({verdict})"),
    }
}
