//! `cityweld demo`: the sample that is inside the program, unpacked beside its own result.

use std::path::Path;

use crate::export::OutputKind;
use crate::format::escaped;
use crate::limits::Limits;
use anyhow::{Context, Result};

use super::align::carry_out;
use super::args::{AlignArgs, CityArgs, DemoArgs, Probability, UpArg};
use super::plan::{AlignPlan, keeps_inputs};
use super::sample::{SAMPLE, SAMPLE_FOLDER};
use super::{Outcome, Session};

pub fn run(args: &DemoArgs, session: &Session) -> Result<Outcome> {
    keeps_inputs(&args.output, &[])?;
    let output = session.begin(&args.output, OutputKind::Folder)?;
    unpack(output.path())?;
    let sample = output.path().join(SAMPLE_FOLDER);
    let plan =
        AlignPlan { output: Some(args.output.clone()), ..AlignPlan::new(&align_args(&sample), session.common.seed)? };
    let outcome = carry_out(&plan, Some(output), session)?;
    if !session.common.json {
        session.voice.result(&what_next(&args.output), Some(&args.output))?;
    }
    Ok(outcome)
}

fn unpack(output: &Path) -> Result<()> {
    for (path, content) in SAMPLE {
        let path = output.join(path);
        let written =
            path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(&path, content));
        written.with_context(|| format!("cannot unpack the sample: {}", path.display()))?;
    }
    Ok(())
}

fn align_args(sample: &Path) -> AlignArgs {
    AlignArgs {
        near: None,
        city: vec![sample.join("city.obj")],
        scale_range: None,
        budget: None,
        sfm: sample.join("sfm"),
        // Within the sample, so that it never is a place that exists: the true one is set aside already.
        output: Some(sample.join("out")),
        dry_run: false,
        positions: None,
        points: None,
        start: Some(sample.join("start.json")),
        classes: Vec::new(),
        labels: Some(sample.join("labels")),
        photos: None,
        scale: None,
        accuracy: None,
        up: UpArg::Auto,
        false_alarm: Probability(Limits::default().verdict.false_alarm),
        city_options: CityArgs::default(),
    }
}

fn what_next(output: &Path) -> String {
    let [out, sample] = [output, &output.join(SAMPLE_FOLDER)].map(|path| escaped(&path.to_string_lossy()).to_string());
    format!(
        "\nOpen {out}/scene.glb in any glTF viewer: the city in grey, the points in their colours, the cameras in red.\n\
         The same by hand:\n  \
         cityweld align {sample}/city.obj {sample}/sfm --labels {sample}/labels --start {sample}/start.json -o again\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_program_holds_every_file_of_the_sample() {
        fn files(folder: &Path, found: &mut BTreeSet<String>, root: &Path) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    files(&path, found, root);
                } else {
                    found.insert(path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/"));
                }
            }
        }
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample");
        let mut found = BTreeSet::new();
        files(&root, &mut found, &root);
        let inner = |path: &str| path.strip_prefix(SAMPLE_FOLDER).unwrap().trim_start_matches('/').to_owned();
        assert_eq!(found, SAMPLE.iter().map(|(path, _)| inner(path)).collect());
    }
}
