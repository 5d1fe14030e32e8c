//! The commands of the README, taken from its text, each run as it stands there.

mod pieces;
mod readme_room;

use std::path::Path;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;
use tempfile::TempDir;

use pieces::similarity;
use readme_room::{room, write_scan};

/// The commands of a section, each with what the README says of it.
fn commands(section: &str) -> Vec<String> {
    let readme = include_str!("../README.md");
    let begin = readme.find(&format!("\n## {section}\n")).expect("the section stands in the README");
    let rest = &readme[begin + 4..];
    let section = &rest[..rest.find("\n## ").unwrap_or(rest.len())];
    let lines = section.lines().filter(|line| line.starts_with("cityweld "));
    lines.map(|line| line.split('#').next().unwrap_or_default().trim().to_owned()).collect()
}

fn run(room: &TempDir, command: &str) -> Output {
    let args = command.split_whitespace().skip(1);
    cargo_bin_cmd!("cityweld").current_dir(room.path()).args(args).arg("--force").output().unwrap()
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&[&output.stdout[..], &output.stderr].concat()).into_owned()
}

fn transform(room: &Path) -> cityweld::Similarity {
    let report: Value = serde_json::from_slice(&std::fs::read(room.join("out/alignment.json")).unwrap()).unwrap();
    similarity(&report["transform"])
}

#[test]
fn all_three_ways_to_come_end_aligned_in_the_same_place() {
    let room = room();
    let ways = commands("Come as you are");
    assert_eq!(ways.len(), 3, "{ways:?}");
    let sample = pieces::sample();
    let mut first = None;
    for way in &ways {
        if way.contains("scan.laz") {
            write_scan(&room.path().join("scan.laz"), first.as_ref().unwrap());
        }
        let output = run(&room, way);
        assert_eq!(output.status.code(), Some(0), "{way}: {}", message(&output));
        let found = transform(room.path());
        let Some(truth) = &first else {
            first = Some(found);
            continue;
        };
        let places = sample.points.iter().map(|point| truth.apply(point));
        let found: Vec<_> = match way.contains("scan.laz") {
            true => places.clone().map(|place| found.apply(&place)).collect(),
            false => sample.points.iter().map(|point| found.apply(point)).collect(),
        };
        let mut off: Vec<f64> = places.zip(&found).map(|(place, found)| (place - found).norm()).collect();
        off.sort_by(f64::total_cmp);
        // The sample's own error is some centimetres.
        assert!(off[off.len() / 2] < 0.1, "{way}: {} m off", off[off.len() / 2]);
    }
}

#[test]
fn every_command_that_the_readme_shows_is_understood_and_carried_out() {
    let room = room();
    for command in commands("Use it") {
        let output = run(&room, &command);
        // 1: another verdict than the best; 2 would be a command that is not taken.
        assert!(matches!(output.status.code(), Some(0 | 1)), "{command}: {}", message(&output));
        if let Some(written) = command.split(" -o ").nth(1) {
            assert!(room.path().join(written.trim()).exists(), "{command}");
        }
    }
}
