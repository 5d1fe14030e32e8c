//! What some tests need and a clone alone does not have: data beside the project, programs in other languages.
//!
//! A test whose need is not there is skipped and says so on standard error, past the capture of output. With CITYWELD_REQUIRE_DATA=1
//! missing data fail it instead; a missing program fails it where the variable that names its folder is set.
#![allow(dead_code, reason = "no test file needs all of it")]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A file or folder of the data beside the project, by its path there; `None` where the test is to be skipped. The data
/// are in `../shared`, or where CITYWELD_SHARED says.
pub fn shared(path: &str) -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let found = std::env::var_os("CITYWELD_SHARED").map_or(beside, PathBuf::from).join(path);
    if found.exists() {
        return Some(found);
    }
    let lacks = format!("{} is not there", found.display());
    let remedy = "put the data there, or name their folder in CITYWELD_SHARED";
    assert!(!is_required("CITYWELD_REQUIRE_DATA"), "{lacks}, and CITYWELD_REQUIRE_DATA is set; {remedy}");
    skip(&lacks)
}

/// python3 with pycolmap, in the folder that CITYWELD_PYTHONPATH names or where python3 finds it.
pub fn pycolmap() -> Option<Command> {
    program("python3", ["-c", "import numpy, pycolmap"], "PYTHONPATH", "CITYWELD_PYTHONPATH")
}

/// node with the npm package gltf-validator, in the folder that CITYWELD_NODE_MODULES names or where node finds it.
pub fn gltf_validator() -> Option<Command> {
    program("node", ["-e", "require('gltf-validator')"], "NODE_PATH", "CITYWELD_NODE_MODULES")
}

fn program(name: &str, trial: [&str; 2], path: &str, variable: &str) -> Option<Command> {
    let command = || {
        let mut command = Command::new(name);
        if let Some(folder) = std::env::var_os(variable) {
            command.env(path, folder);
        }
        command
    };
    if command().args(trial).output().is_ok_and(|output| output.status.success()) {
        return Some(command());
    }
    let lacks = format!("{name} fails to run: {}", trial[1]);
    assert!(std::env::var_os(variable).is_none(), "{lacks}, and {variable} is set");
    skip(&lacks)
}

fn is_required(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| !value.is_empty() && value != "0")
}

fn skip<T>(lacks: &str) -> Option<T> {
    let thread = std::thread::current();
    // Not by a macro, whose output is shown for tests that fail.
    let _ = writeln!(std::io::stderr(), "skipped: {}: {lacks}", thread.name().unwrap_or("a test"));
    None
}
