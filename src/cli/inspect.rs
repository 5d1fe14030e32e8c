//! `cityweld inspect`

use std::fmt::Write;

use anyhow::Result;

use super::args::InspectArgs;
use super::{Outcome, Session, summary};
use crate::inspect::{Inspection, inspect};

/// Tells what is seen at each path. One that cannot be read ends it, before anything is told.
pub fn run(args: &InspectArgs, session: &Session) -> Result<Outcome> {
    let voice = &session.voice;
    let mut found: Vec<Inspection> = Vec::new();
    for (index, path) in args.paths.iter().enumerate() {
        voice.bar.show("reading", index, args.paths.len());
        found.push(inspect(path)?);
    }
    if session.common.json {
        voice.json(&(serde_json::to_string_pretty(&found)? + "\n"), None)?;
        return Ok(Outcome::Good);
    }
    let mut text = String::new();
    for inspection in &found {
        let _ = write!(text, "{}", summary::of_inspection(inspection));
    }
    voice.result(&text, None)?;
    Ok(Outcome::Good)
}
