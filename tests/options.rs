//! What each option does, and what of it is refused: exit status 2, nothing written.

mod program;

use std::fs;
use std::path::Path;

use program::{Align, cityweld, names, refused, repository, room, sample, stderr, stdout};
use serde_json::Value;
use tempfile::TempDir;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// A house, 10 by 8 by 6 in whatever unit its reader takes it to be in, corner at `low`, all sides outwards.
fn house(low: [f64; 3]) -> String {
    let corner = |i: usize| [low[0] + [0.0, 10.0][i & 1], low[1] + [0.0, 8.0][i >> 1 & 1], low[2] + [0.0, 6.0][i >> 2]];
    let mut text = String::from("o house\n");
    for [x, y, z] in (0..8).map(corner) {
        text += &format!("v {x} {y} {z}\n");
    }
    text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 2 4 8 6\nf 4 3 7 8\nf 3 1 5 7\n"
}

/// Lowest and highest of each axis, as `planes` tells them of a city.
fn extent(room: &TempDir, args: &[&str]) -> [[f64; 2]; 3] {
    let output = cityweld(room, &[&["planes", "--quiet"], args].concat());
    let said = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", stderr(&output));
    ["x  ", "y  ", "z (up)"].map(|axis| {
        let line = said.lines().find(|line| line.trim_start().starts_with(axis)).unwrap_or_else(|| panic!("{said}"));
        let line = line.replace("z (up)", "");
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        numbers.try_into().unwrap_or_else(|_| panic!("{said}"))
    })
}

fn house_of(text: &str) -> TempDir {
    let room = room();
    fs::write(room.path().join("house.obj"), text).unwrap();
    room
}

#[test]
fn a_unit_of_the_city_is_that_many_metres() {
    let room = house_of(&house([1000.0, 2000.0, 0.0]));
    for (unit, metres) in [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("ft", 0.3048), ("us-ft", 1200.0 / 3937.0)] {
        let found = extent(&room, &["house.obj", "--city-unit", unit]);
        let expected = [[1000.0, 1010.0], [2000.0, 2008.0], [0.0, 6.0]];
        for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
            // Two decimals are printed.
            assert!((found - expected * metres).abs() < 0.0051, "{unit}: {found}, expected {}", expected * metres);
        }
    }
}

#[test]
fn an_axis_that_is_up_is_turned_to_z_and_the_side_of_no_facet_changes() {
    let room = house_of(&house([0.0; 3]));
    assert_eq!(extent(&room, &["house.obj", "--city-up", "z"]), [[0.0, 10.0], [0.0, 8.0], [0.0, 6.0]]);
    // y up, x right: z comes towards whoever looks, so north is minus z.
    assert_eq!(extent(&room, &["house.obj", "--city-up", "y"]), [[0.0, 10.0], [-6.0, 0.0], [0.0, 8.0]]);
    let output = cityweld(&room, &["planes", "house.obj", "--city-up", "y", "--json"]);
    let report = json(&stdout(&output));
    let planes = report["planes"].as_array().unwrap();
    assert_eq!(planes.len(), 6, "{report}");
    assert!(!stderr(&output).contains("turned"), "{}", stderr(&output));
}

#[test]
fn an_origin_is_added_after_axes_and_units() {
    let room = house_of(&house([0.0; 3]));
    let found = extent(&room, &["house.obj", "--city-unit", "cm", "--city-origin", "100,-200,7.5"]);
    assert_eq!(found, [[100.0, 100.1], [-200.0, -199.92], [7.5, 7.56]]);
    let turned = extent(&room, &["house.obj", "--city-up", "y", "--city-origin", "0,0,50"]);
    assert_eq!(turned[2], [50.0, 58.0]);
}

#[test]
fn terrain_is_read_in_the_frame_of_the_city_and_is_no_object_of_it() {
    let room = house_of(&house([0.0; 3]));
    let ground = "v -50 -50 -1\nv 50 -50 -1\nv 50 50 -1\nv -50 50 -1\nf 1 2 3 4\n";
    fs::write(room.path().join("ground.obj"), ground).unwrap();
    fs::write(room.path().join("more.obj"), ground.replace("50", "60")).unwrap();
    let found = extent(&room, &["house.obj", "--terrain", "ground.obj", "--terrain", "more.obj"]);
    assert_eq!(found, [[-60.0, 60.0], [-60.0, 60.0], [-1.0, 6.0]]);
    let scaled = extent(&room, &["house.obj", "--terrain", "ground.obj", "--city-unit", "cm"]);
    assert_eq!(scaled[0], [-0.5, 0.5]);
    refused(&room, &["planes", "house.obj", "--terrain", "ground.obj", "--terrain", "none.obj"], &["none.obj"]);
}

#[test]
fn a_level_of_detail_is_the_highest_that_is_taken() {
    let room = room();
    let city = repository("tests/data/formats/city/small.city.jsonl");
    let facets = |level: &str| {
        let said = stdout(&cityweld(&room, &["planes", "--quiet", &city, "--lod", level]));
        said.lines().next().unwrap().to_owned()
    };
    assert!(facets("1.2").contains("22 facets"), "{}", facets("1.2"));
    assert!(facets("2.2").contains("33 facets"), "{}", facets("2.2"));
    // A whole number takes all of its steps.
    assert_eq!(facets("2"), facets("2.2"));
    assert_eq!(facets("1"), facets("1.3"));
    assert_eq!(facets("9.9"), facets("2.2"));
    for wrong in ["0", "0.5", "1.x", "256", "1.2.3", "", "-1"] {
        refused(&room, &["planes", &city, &format!("--lod={wrong}")], &["--lod", "expected a level above 0"]);
    }
}

#[test]
fn numbers_of_the_verdict_are_refused_where_they_are_none() {
    let room = room();
    for option in ["--scale", "--accuracy"] {
        for wrong in ["0", "-1", "NaN", "inf", "1e400", "1,2", "", "one", "0x10"] {
            Align::with(&[option, wrong]).refused(&room, &[option, "expected a finite number above 0"]);
        }
    }
    for wrong in ["0", "1", "-0.5", "2", "NaN", "inf", "", "1%"] {
        Align::with(&["--false-alarm", wrong]).refused(&room, &["--false-alarm", "above 0 and below 1"]);
    }
    for wrong in ["", "up", "1,2", "0,0,0", "NaN,0,1", "1,2,3,4", "inf,0,0"] {
        Align::with(&["--up", wrong]).refused(&room, &["--up"]);
    }
}

#[test]
fn classes_are_whole_numbers_that_a_cloud_can_have() {
    let room = room();
    for wrong in ["256", "-1", "x", "2;6", "2,,6", "1.5"] {
        Align::with(&["--classes", wrong]).refused(&room, &["classes"]);
    }
    // A COLMAP model has none.
    Align::with(&["--classes", "2"]).refused(&room, &["leave --classes out"]);
    let cloud = repository("tests/data/formats/autzen.las");
    let inspected = stdout(&cityweld(&room, &["inspect", &cloud]));
    assert!(inspected.contains("points"), "{inspected}");
    Align { sfm: cloud, ..Align::with(&["--classes", "99"]) }.refused(&room, &["no points of the classes 99"]);
}

#[test]
fn a_place_and_a_radius_stand_alone() {
    let room = room();
    let start = |more: &[&str]| Align { start: None, ..Align::with(more) };
    for wrong in ["1,2", "1,2,0", "1,2,-3", "1,2,3,4,5", "x,2,3", "91,4,300m", "51,181,300m", "51,4,0m", "51,4,1,9m"] {
        start(&["--near", wrong]).refused(&room, &["--near", "letter m"]);
    }
    Align::with(&["--near", "460,280,50"]).refused(&room, &["--near", "cannot be used with", "--start"]);
    start(&["--near", "460,280,50", "--points", "gcp.txt"]).refused(&room, &["--points"]);
    start(&["--near", "460,280,50", "--positions", "geo.txt"]).refused(&room, &["--positions"]);
    // Degrees need a reference system to become metres.
    start(&["--near", "51.9,4.4,300m"]).refused(&room, &["--near", "--crs"]);
    start(&["--near", "51.9,4.4,300m", "--crs", "EPSG:99999999"]).refused(&room, &["99999999", "EPSG:<code>"]);
}

#[test]
fn a_dry_run_tells_the_start_and_writes_nothing() {
    let room = room();
    let align = |more: &[&str]| {
        let align = Align::with(more);
        let args: Vec<&str> = align.args().into_iter().filter(|word| !["-o", "out"].contains(word)).collect();
        let output = cityweld(&room, &args);
        assert_eq!(names(room.path()), Vec::<String>::new(), "{more:?}");
        (output.status.code(), stdout(&output), stderr(&output))
    };
    let (code, said, _) = align(&["--dry-run", "--quiet"]);
    assert_eq!(code, Some(0), "{said}");
    for word in ["start (start.json)", "2.3 m from the city's nearest facet", "sigma 10.00 m horizontally", "15.0 %"] {
        assert!(said.contains(word), "{said}");
    }
    let (code, said, _) = align(&["--dry-run", "--json"]);
    assert_eq!(code, Some(0));
    assert!(json(&said).is_object(), "{said}");
    // Everything is checked as if it were meant.
    let (code, _, message) = align(&["--dry-run", "--labels", "none"]);
    assert_eq!(code, Some(2));
    assert!(message.contains("none"), "{message}");
    // Without it, a place to write to must be named.
    let (code, _, message) = align(&["--quiet"]);
    assert_eq!(code, Some(2));
    assert!(message.contains("--output <OUT>"), "{message}");
}

#[test]
fn a_dry_run_names_the_disc_that_would_be_searched() {
    let room = room();
    let (city, sfm) = (sample("city.obj"), sample("sfm"));
    for (near, more) in [("460,280,50", &[][..]), ("460,280,3,50", &[]), ("51.90,4.43,300m", &["--crs", "EPSG:28992"])]
    {
        let args = [&["align", &city, &sfm, "--near", near, "--dry-run", "--quiet"], more].concat();
        let output = cityweld(&room, &args);
        assert_eq!(output.status.code(), Some(0), "{near}: {}", stderr(&output));
        let radius = if near.ends_with('m') { "300" } else { "50" };
        let said = stdout(&output);
        assert!(said.contains(radius) && !said.contains("the city would be searched"), "{near}: {said}");
    }
    let output = cityweld(&room, &["align", &city, &sfm, "--dry-run", "--quiet"]);
    assert!(stdout(&output).contains("the city would be searched"), "{}", stdout(&output));
    assert_eq!(names(room.path()), Vec::<String>::new());
}

/// The report of a run on the sample with its labels.
fn report(room: &TempDir, out: &'static str, more: &[&str]) -> (Option<i32>, Value, String) {
    let labels = sample("labels");
    let align = Align { out, ..Align::with(&[&["--labels", &labels], more].concat()) };
    let output = cityweld(room, &align.args());
    let path = room.path().join(out).join("alignment.json");
    let written = fs::read_to_string(path).unwrap_or_else(|error| panic!("{error}: {}", stderr(&output)));
    (output.status.code(), json(&written), stderr(&output))
}

#[test]
fn an_accuracy_decides_what_is_determined_and_moves_no_pose() {
    let room = room();
    let (code, loose, _) = report(&room, "loose", &["--accuracy", "5", "--quiet"]);
    assert_eq!((code, &loose["verdict"]), (Some(0), &Value::from("aligned")), "{}", loose["reason"]);
    let (code, strict, _) = report(&room, "strict", &["--accuracy", "1e-5", "--quiet"]);
    assert_eq!((code, &strict["verdict"]), (Some(1), &Value::from("undetermined")), "{}", strict["reason"]);
    assert_eq!(strict["transform"], Value::Null);
    assert_eq!(strict["best_candidate"], loose["transform"]);
}

#[test]
fn a_chance_of_false_alarms_sets_how_much_evidence_is_needed() {
    let room = room();
    let needed = |out, chance: &str| {
        let (_, report, _) = report(&room, out, &["--false-alarm", chance, "--quiet"]);
        let reason = report["reason"].as_str().unwrap().to_owned();
        let bits = reason.split("bits where ").nth(1).and_then(|rest| rest.split(' ').next()).map(str::to_owned);
        bits.and_then(|bits| bits.parse::<f64>().ok()).unwrap_or_else(|| panic!("{reason}"))
    };
    // A chance a thousand times smaller asks for log2 1000 bits more, printed in whole bits.
    let (usual, rare) = (needed("usual", "0.001"), needed("rare", "0.000001"));
    assert!((rare - usual - 1000_f64.log2()).abs() <= 1.0, "{usual} and {rare}");
}

#[test]
fn a_given_scale_is_held_exactly_or_denied_by_the_data() {
    let room = room();
    let (_, free, _) = report(&room, "free", &["--quiet"]);
    let scale = free["transform"]["scale"].as_f64().unwrap().to_string();
    let (code, held, _) = report(&room, "held", &["--scale", &scale, "--quiet"]);
    assert_eq!(code, Some(0), "{}", held["reason"]);
    assert_eq!(held["transform"]["scale"].to_string(), scale);
    let (code, denied, _) = report(&room, "denied", &["--scale", "8.7", "--quiet"]);
    assert_eq!((code, &denied["transform"]), (Some(1), &Value::Null));
    assert!(denied["reason"].as_str().unwrap().contains("8.7"), "{}", denied["reason"]);
}

#[test]
fn verbose_tells_each_step_on_standard_error_and_changes_no_byte() {
    let room = room();
    let (_, plain, said_plainly) = report(&room, "plain", &[]);
    let (_, told, said) = report(&room, "told", &["--verbose"]);
    assert_eq!(plain, told);
    for step in ["s] city: 7920 facets of 527 objects", "s] reconstruction: 3512 points, 24 images", "told written"] {
        assert!(said.contains(step), "{said}");
        assert!(!said_plainly.contains(step), "{said_plainly}");
    }
    Align::with(&["--quiet", "--verbose"]).refused(&room, &["--quiet", "--verbose"]);
}

#[test]
fn force_replaces_what_an_earlier_run_made_and_nothing_else() {
    let room = house_of(&house([0.0; 3]));
    let write = |more: &[&str]| cityweld(&room, &[&["planes", "house.obj", "-o", "planes.json"], more].concat());
    assert_eq!(write(&[]).status.code(), Some(0));
    let first = fs::read(room.path().join("planes.json")).unwrap();
    refused(&room, &["planes", "house.obj", "-o", "planes.json"], &["--force"]);
    assert_eq!(write(&["--force"]).status.code(), Some(0));
    assert_eq!(fs::read(room.path().join("planes.json")).unwrap(), first);
    fs::write(room.path().join("planes.json"), "mine").unwrap();
    refused(&room, &["planes", "house.obj", "-o", "planes.json", "--force"], &["planes.json"]);
    assert_eq!(fs::read_to_string(room.path().join("planes.json")).unwrap(), "mine");
}

#[test]
fn every_shell_gets_its_words_and_other_shells_are_refused() {
    let room = room();
    for (shell, word) in [
        ("bash", "complete -F _cityweld"),
        ("zsh", "#compdef cityweld"),
        ("fish", "complete -c cityweld"),
        ("powershell", "Register-ArgumentCompleter"),
        ("elvish", "edit:completion:arg-completer[cityweld]"),
    ] {
        let output = cityweld(&room, &["completions", shell]);
        assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
        let script = stdout(&output);
        assert!(script.contains(word) && script.contains("false-alarm") && script.contains("city-unit"), "{shell}");
    }
    refused(&room, &["completions", "tcsh"], &["tcsh", "bash"]);
    refused(&room, &["completions"], &["<SHELL>"]);
}

#[test]
fn bash_takes_its_completions_and_proposes_an_option_of_the_command() {
    let script = "source /dev/stdin || exit 3\nCOMP_WORDS=(cityweld align --acc); COMP_CWORD=2\n\
                  _cityweld cityweld --acc align; echo \"${COMPREPLY[*]}\"";
    let room = room();
    let words = stdout(&cityweld(&room, &["completions", "bash"]));
    fs::write(room.path().join("words"), words).unwrap();
    let script = script.replace("/dev/stdin", "./words");
    let Ok(bash) = std::process::Command::new("bash").current_dir(room.path()).args(["-c", &script]).output() else {
        return;
    };
    assert_eq!(stdout(&bash).trim(), "--accuracy", "{}", stderr(&bash));
}

#[test]
fn manual_pages_name_every_option_and_go_to_a_folder() {
    let room = room();
    let page = stdout(&cityweld(&room, &["man", "align"]));
    for option in ["accuracy", "false\\-alarm", "near", "dry\\-run", "city\\-unit", "height\\-field", "seed"] {
        assert!(page.contains(&format!("\\-\\-{option}")), "{option}");
    }
    refused(&room, &["man", "weld"], &["no command weld"]);
    refused(&room, &["man", "align", "-o", "pages"], &["--output"]);
    let output = cityweld(&room, &["man", "-o", "pages"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let pages = names(&room.path().join("pages"));
    for command in ["align", "completions", "demo", "export", "index", "inspect", "man", "merge", "planes", "solve"] {
        let name = format!("cityweld-{command}.1");
        assert!(pages.contains(&name), "{pages:?}");
        let text = fs::read_to_string(room.path().join("pages").join(name)).unwrap();
        assert!(text.starts_with(".ie") || text.starts_with(".TH"), "{command}: {}", &text[..40]);
    }
    assert_eq!(fs::read_to_string(room.path().join("pages/cityweld-align.1")).unwrap(), page);
    fs::write(room.path().join("file"), "mine").unwrap();
    refused(&room, &["man", "-o", "file/pages"], &["file/pages"]);
    assert_eq!(fs::read_to_string(room.path().join("file")).unwrap(), "mine");
}

#[test]
fn options_of_a_city_are_said_when_it_is_indexed_and_not_again() {
    let room = house_of(&house([0.0; 3]));
    let made = cityweld(&room, &["index", "house.obj", "-o", "house.cwi", "--city-unit", "cm", "--quiet"]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    assert_eq!(extent(&room, &["house.cwi"])[0], [0.0, 0.1]);
    for more in [["--city-unit", "cm"], ["--city-up", "y"], ["--city-origin", "1,2,3"], ["--lod", "1"]] {
        let says = ["give the options of the city to `cityweld index`", "house.cwi"];
        refused(&room, &[&["planes", "house.cwi"], &more[..]].concat(), &says);
    }
    refused(&room, &["index", "house.obj", "-o", "house.cwi"], &["--force"]);
    fs::write(room.path().join("house.obj"), house([1.0; 3])).unwrap();
    refused(&room, &["planes", "house.cwi"], &["house.obj"]);
}

#[test]
fn seeds_are_whole_numbers_up_to_the_largest() {
    let room = room();
    for wrong in ["-1", "1.5", "18446744073709551616", "", "x"] {
        Align::with(&["--dry-run", "--seed", wrong]).refused(&room, &["--seed"]);
    }
    let largest = Align::with(&["--dry-run", "--quiet", "--seed", "18446744073709551615", "--threads", "1"]);
    assert_eq!(cityweld(&room, &largest.args()).status.code(), Some(0));
    for wrong in ["0", "-1", "x", "1.5", ""] {
        Align::with(&["--threads", wrong]).refused(&room, &["--threads"]);
    }
}

#[test]
fn an_option_that_touches_nothing_of_the_city_is_told() {
    let room = house_of(&house([0.0; 3]));
    for more in [["--height-field", "height"], ["--base-field", "base"], ["--lod", "2.2"]] {
        let output = cityweld(&room, &[&["planes", "house.obj"], &more[..]].concat());
        assert!(stderr(&output).contains(more[0]), "{more:?} is passed over without a word: {}", stderr(&output));
    }
}

#[test]
fn a_reference_system_has_a_code_in_any_spelling() {
    let room = house_of(&house([0.0; 3]));
    for spelling in ["EPSG:28992", "epsg:25832+7837", "urn:ogc:def:crs:EPSG::7415", "Amersfoort / RD New", "2056"] {
        let output = cityweld(&room, &["planes", "house.obj", "--crs", spelling]);
        assert_eq!(output.status.code(), Some(0), "{spelling}: {}", stderr(&output));
        assert!(stdout(&output).contains("EPSG:"), "{spelling}: {}", stdout(&output));
    }
    for wrong in ["", "RD", "EPSG:", "EPSG:x", "EPSG:1", "EPSG:99999999", "-1"] {
        refused(&room, &["planes", "house.obj", &format!("--crs={wrong}")], &["--crs", "EPSG:<code>"]);
    }
}

#[test]
fn merge_holds_its_options_against_each_other() {
    let room = room();
    let (sfm, city, start) = (sample("sfm"), sample("city.obj"), sample("start.json"));
    let merge = |more: &[&str], says: &[&str]| {
        refused(&room, &[&["merge", &sfm, &sfm, "-o", "out"], more].concat(), says);
    };
    merge(&["--evidence", "half"], &["--evidence", "planes"]);
    merge(&["--false-alarm", "1"], &["--false-alarm"]);
    merge(&["--start", &start], &["--city"]);
    merge(&["--city", &city, "--start", &start], &["--start"]);
    merge(&["--terrain", &city], &["--terrain", "--city"]);
    merge(&["--labels", "none"], &["none"]);
    assert!(!Path::new(&room.path().join("out")).exists());
}
