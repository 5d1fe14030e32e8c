//! Arguments in each other's place: found by what lies at each path, before anything is read, and told with the line that was
//! meant. What is not known at a glance passes; its reader says what is wrong with it.

mod glance;

use std::path::Path;

use anyhow::{Result, bail};

use glance::Glance;

/// What a path is given as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    City,
    Terrain,
    Sfm,
    Part,
    /// `--city` of `merge`
    CityOption,
    Start,
    Alignment,
    Labels,
    Photos,
    Positions,
    Points,
}

/// A path and the role that it is given.
pub type Given<'a> = (Role, &'a Path);

/// Refuses paths that clearly belong elsewhere. `command` is the program's word for what is done.
pub fn check(command: &str, given: &[Given<'_>]) -> Result<()> {
    let seen: Vec<Glance> = given.iter().map(|(_, path)| Glance::at(path)).collect();
    let is_misplaced = |i: usize| seen[i].is_known() && !given[i].0.takes(&seen[i]);
    let Some(first) = (0..given.len()).find(|i| is_misplaced(*i)) else { return Ok(()) };
    if let Some(paths) = rearranged(given, &seen) {
        let meant: Vec<Given<'_>> = given.iter().zip(paths).map(|((role, _), path)| (*role, path)).collect();
        let places: Vec<&str> = moved(given, &meant).map(|(role, _)| role.name()).collect();
        let positional = if places.contains(&"CITY") { " (the city comes first)" } else { "" };
        bail!("{} are exchanged{positional}; give: {}", places.join(" and "), line(command, &meant));
    }
    let (role, path) = given[first];
    match seen[first].complaint(role) {
        Some(complaint) => bail!("{} is {complaint}: {}", role.name(), path.display()),
        None => Ok(()),
    }
}

impl Role {
    fn name(self) -> &'static str {
        match self {
            Role::City => "CITY",
            Role::Sfm => "SFM",
            Role::Part => "PART",
            option => option.option(),
        }
    }

    /// Empty for what stands without one.
    fn option(self) -> &'static str {
        match self {
            Role::City | Role::Sfm | Role::Part => "",
            Role::Terrain => "--terrain",
            Role::CityOption => "--city",
            Role::Start => "--start",
            Role::Alignment => "--alignment",
            Role::Labels => "--labels",
            Role::Photos => "--photos",
            Role::Positions => "--positions",
            Role::Points => "--points",
        }
    }

    fn takes(self, seen: &Glance) -> bool {
        match self {
            Role::City | Role::Terrain | Role::CityOption => seen.is_city,
            Role::Sfm | Role::Part => seen.is_reconstruction(),
            Role::Start | Role::Alignment => seen.json.is_some(),
            Role::Labels => seen.may_be_labels(),
            Role::Photos | Role::Positions => seen.has_images(),
            // Text; what is known at a glance is something else.
            Role::Points => false,
        }
    }
}

/// The paths in the order of the roles that they fit, where every path fits one; else nothing was merely exchanged.
fn rearranged<'a>(given: &[Given<'a>], seen: &[Glance]) -> Option<Vec<&'a Path>> {
    let fits = |role: usize, path: usize| given[role].0.takes(&seen[path]) || (role == path && !seen[path].is_known());
    let own = |role: usize| Some(role).filter(|role| fits(*role, *role));
    let mut role_of_path: Vec<Option<usize>> = (0..given.len()).map(own).collect();
    for role in (0..given.len()).filter(|role| own(*role).is_none()) {
        let mut tried = vec![false; given.len()];
        if !claim(role, &fits, &mut tried, &mut role_of_path) {
            return None;
        }
    }
    let mut paths = vec![Path::new(""); given.len()];
    for (path, role) in role_of_path.iter().enumerate() {
        paths[(*role)?] = given[path].1;
    }
    Some(paths)
}

/// One step of Kuhn's matching: finds a path for `role`, a free one if it can, or one whose role can go elsewhere.
fn claim(
    role: usize,
    fits: &impl Fn(usize, usize) -> bool,
    tried: &mut [bool],
    role_of_path: &mut [Option<usize>],
) -> bool {
    let (free, taken): (Vec<usize>, Vec<usize>) = (0..tried.len()).partition(|path| role_of_path[*path].is_none());
    for path in free.into_iter().chain(taken) {
        if tried[path] || !fits(role, path) {
            continue;
        }
        tried[path] = true;
        if role_of_path[path].is_none_or(|other| claim(other, fits, tried, role_of_path)) {
            role_of_path[path] = Some(role);
            return true;
        }
    }
    false
}

fn moved<'a>(given: &'a [Given<'a>], meant: &'a [Given<'a>]) -> impl Iterator<Item = &'a Given<'a>> {
    given.iter().zip(meant).filter(|(is, meant)| is.1 != meant.1).map(|(is, _)| is)
}

/// The command as it should be typed.
fn line(command: &str, given: &[Given<'_>]) -> String {
    let mut words = vec![format!("cityweld {command}")];
    for (role, path) in given {
        words.extend(Some(role.option().to_owned()).filter(|option| !option.is_empty()));
        words.push(path.display().to_string());
    }
    words.push("-o OUT".into());
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// A city, a model, a start, a folder of photographs and one of labels.
    fn room() -> tempfile::TempDir {
        let room = tempfile::tempdir().unwrap();
        let file = |name: &str, bytes: &[u8]| {
            let path = room.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        };
        file("city.obj", b"# a city\no house\nv 0 0 0\n");
        file("house", b"# no ending\r\nv 1 2.5 -3\r\n");
        file("city.gltf", br#"{"asset": {"version": "2.0"}}"#);
        for stem in ["cameras", "images", "points3D"] {
            file(&format!("sfm/{stem}.txt"), b"");
            file(&format!("work/dense/sparse/{stem}.bin"), b"");
        }
        file("cloud.ply", b"ply\nformat ascii 1.0\n");
        file("start.json", br#"{"scale": 1, "rotation": [], "translation": []}"#);
        file("merge.json", br#"{"schema": "cityweld.merge/1"}"#);
        file("out/alignment.json", br#"{"schema": "cityweld.alignment/1"}"#);
        for stem in ["cameras", "images", "points3D"] {
            file(&format!("out/sfm/{stem}.txt"), b"");
        }
        file("photos/a.jpg", b"");
        let grey = |kind: u8| [&b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x08\0\0\0\x08\x08"[..], &[kind]].concat();
        file("labels/a.png", &grey(0));
        file("colour/a.png", &grey(2));
        file("notes/a.txt", b"mine");
        room
    }

    fn checked(given: &[(Role, &str)]) -> String {
        let room = room();
        let paths: Vec<_> = given.iter().map(|(role, path)| (*role, room.path().join(path))).collect();
        let given: Vec<Given<'_>> = paths.iter().map(|(role, path)| (*role, path.as_path())).collect();
        let message = check("align", &given).map_or_else(|error| error.to_string(), |()| String::new());
        message.replace(&format!("{}/", room.path().display()), "")
    }

    #[test]
    fn lets_pass_what_is_in_its_place_and_what_it_does_not_know() {
        use Role::*;
        for given in [
            &[(City, "city.obj"), (Sfm, "sfm"), (Start, "start.json"), (Labels, "labels"), (Photos, "photos")][..],
            &[(City, "city.gltf"), (Sfm, "cloud.ply"), (Photos, "labels"), (Terrain, "city.obj")],
            &[(City, "city.obj"), (Sfm, "work")],
            &[(City, "notes/a.txt"), (Sfm, "notes"), (Start, "none"), (Labels, "notes"), (Photos, "notes")],
        ] {
            assert_eq!(checked(given), "");
        }
    }

    #[test]
    fn shows_the_line_that_was_meant_where_arguments_are_exchanged() {
        use Role::*;
        for (given, says) in [
            (
                &[(City, "sfm"), (Sfm, "city.obj"), (Start, "start.json")][..],
                "CITY and SFM are exchanged (the city comes first); give: cityweld align city.obj sfm --start start.json -o OUT",
            ),
            (
                &[(City, "cloud.ply"), (Sfm, "city.gltf")],
                "CITY and SFM are exchanged (the city comes first); give: cityweld align city.gltf cloud.ply -o OUT",
            ),
            (
                &[(City, "start.json"), (Sfm, "city.obj"), (Start, "sfm")],
                "CITY and SFM and --start are exchanged (the city comes first); give: \
                 cityweld align city.obj sfm --start start.json -o OUT",
            ),
            (
                &[(City, "city.obj"), (Sfm, "sfm"), (Labels, "photos"), (Photos, "labels")],
                "--labels and --photos are exchanged; give: cityweld align city.obj sfm --labels labels --photos photos -o OUT",
            ),
            (
                &[(Part, "sfm"), (Part, "city.obj"), (CityOption, "cloud.ply")],
                "PART and --city are exchanged; give: cityweld align sfm cloud.ply --city city.obj -o OUT",
            ),
        ] {
            assert_eq!(checked(given), says);
        }
    }

    #[test]
    fn says_what_a_path_is_and_where_it_belongs() {
        use Role::*;
        for (role, path, says) in [
            (
                City,
                "sfm",
                "CITY is a COLMAP model, expected a city model (CityJSON, CityGML, OBJ, glTF, 3D Tiles, ...); the city comes first, the reconstruction second",
            ),
            (City, "work", "CITY is a COLMAP model"),
            (
                City,
                "start.json",
                "CITY is a start, expected a city model (CityJSON, CityGML, OBJ, glTF, 3D Tiles, ...); give it with --start: start.json",
            ),
            (City, "photos", "CITY is a folder of images"),
            (Sfm, "city.obj", "SFM is a city model, expected"),
            (Sfm, "house", "SFM is a city model, expected"),
            (Part, "city.obj", "give a city with --city and a --start for every part: city.obj"),
            (Part, "start.json", "PART is a start"),
            (Start, "sfm", "--start is a COLMAP model, expected"),
            (City, "sfm/images.txt", "CITY is a COLMAP model"),
            (
                Start,
                "out",
                "--start is a folder, expected a start (JSON), or an alignment.json; give out/alignment.json",
            ),
            (Start, "city.obj", "--start is a city model, expected"),
            (
                Labels,
                "photos",
                "(a.jpg), expected a folder of label images (PNG, grey); give photographs with --photos: photos",
            ),
            (Labels, "colour", "grey"),
            (Photos, "sfm", "--photos is a COLMAP model, expected a folder of images"),
        ] {
            let message = checked(&[(role, path)]);
            assert!(message.contains(says), "{message} does not say {says}");
        }
    }
}
