//! What the program shows never steers the terminal, nor forges a line, whatever files are called and hold.

#![cfg(unix)]

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Clears the screen, turns the direction of writing, and forges a line.
const EVIL: &str = "a\u{1b}[2J\u{202e}\u{9b}31m\nerror: b\r\t\u{7f}";

const START: &str = r#"{"scale": 1, "rotation": [[1,0,0],[0,1,0],[0,0,1]], "translation": [0,0,0]}"#;

const CITY: &str = "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nf 1 2 3 4\n";

/// A city, a start, a cloud, a model with an image of that name, an alignment that failed: all called by `EVIL`.
fn room() -> TempDir {
    let room = tempfile::tempdir().unwrap();
    let file = |ending: &str, text: &str| {
        let path = room.path().join(format!("{EVIL}{ending}"));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    file(".obj", CITY);
    file(".bad", "neither\n");
    file(".json", START);
    file(".alignment", &format!(r#"{{"verdict": "aligned", "transform": {START}}}"#));
    file(".failed", &format!("{{\"verdict\": {}, \"transform\": null}}", serde_json::json!(EVIL)));
    file(".key", &format!("{{{}: 1}}", serde_json::json!(EVIL)));
    file(".ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n");
    for folder in ["", "2"] {
        let name = EVIL.split('\n').next().unwrap();
        file(&format!("{folder}/cameras.txt"), "1 PINHOLE 64 48 50 50 32 24\n");
        file(&format!("{folder}/images.txt"), &format!("1 1 0 0 0 0 0 5 1 {name}.jpg\n1 1 1 2 2 2\n"));
        file(&format!("{folder}/points3D.txt"), "1 0 0 0 1 2 3 0.5 1 0\n2 1 0 0 1 2 3 0.5 1 1\n");
    }
    file("3/x", "");
    room
}

fn cityweld(room: &Path, args: &[&str]) -> Output {
    let args = args.iter().map(|word| word.replace("EVIL", EVIL));
    Command::new(assert_cmd::cargo::cargo_bin!("cityweld")).current_dir(room).args(args).output().unwrap()
}

fn steers(c: char) -> bool {
    (c.is_control() && c != '\n') || matches!(c, '\u{202a}'..='\u{202e}')
}

#[test]
fn nothing_that_is_shown_steers_the_terminal() {
    for (status, line) in [
        (0, "planes EVIL.obj"),
        (0, "planes EVIL.obj --json"),
        (0, "planes EVIL.obj -v -o EVIL.glb"),
        (2, "planes EVIL.obj -o EVIL"),
        (2, "planes EVIL.bad"),
        (2, "planes EVIL"),
        (2, "planes EVILnone"),
        (2, "planes EVIL.obj --terrain EVIL.bad"),
        (2, "align EVIL EVIL.obj --start EVIL.json -o out"),
        (2, "align EVIL.obj EVIL --start EVIL.key -o out"),
        (2, "align EVIL.obj EVIL --start EVIL.failed -o out"),
        (2, "align EVIL.obj EVIL --start EVIL.bad -o out"),
        (2, "align EVIL.obj EVIL --start EVIL.json --labels EVIL3 -o out"),
        (2, "align EVIL.obj EVIL.ply --start EVIL.json -o out"),
        (2, "align EVIL.obj EVIL3 --start EVIL.json -o out"),
        (1, "align EVIL.obj EVIL --start EVIL.json -v -o EVILout"),
        (0, "export EVIL.obj EVIL --alignment EVIL.alignment -o EVILout"),
        (0, "export EVIL.obj EVIL --alignment EVIL.alignment -o EVILout --json"),
        (1, "merge EVIL EVIL2 -o EVILout"),
        (1, "merge EVIL EVIL2 -o EVILout --json"),
        (2, "merge EVIL EVIL3 -o out"),
        (2, "solve EVIL.bad"),
        (2, "solve EVIL.json"),
        (2, "solve EVILnone"),
        (2, "demo -o EVIL"),
        (2, "demo -o EVIL3 --force"),
        (2, "demo -o EVILnone/x"),
        (2, "demo --EVIL"),
        (2, "EVIL"),
        (2, "demo --threads EVIL"),
    ] {
        let room = room();
        let output = cityweld(room.path(), &line.split(' ').collect::<Vec<_>>());
        let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap());
        assert_eq!(output.status.code(), Some(status), "{line}: {err}");
        assert!(!out.contains(steers) && !err.contains(steers), "{line}: {out:?} {err:?}");
        let errors = err.lines().filter(|line| line.starts_with("error:")).count();
        let refused_on_output = usize::from(out.contains("\"refused\""));
        assert_eq!(errors + refused_on_output, usize::from(status == 2), "{line}: {err}");
    }
}

#[test]
fn a_name_without_end_is_cut_in_its_middle() {
    let room = tempfile::tempdir().unwrap();
    std::fs::write(room.path().join("city.obj"), format!("{CITY}f 1 2 {}\n", "x".repeat(1_000_000))).unwrap();
    let output = cityweld(room.path(), &["planes", "city.obj"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(message.len() < 5000, "{} bytes", message.len());
    assert!(message.starts_with("error: face corner `xxx") && message.contains("city.obj:6"), "{message}");
}
