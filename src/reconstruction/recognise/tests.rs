use super::*;

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    folder
}

const PLY: &str = "ply\nformat ascii 1.0\n";
const OPENSFM: &str = "\u{feff} [{\"cameras\": {\"c\": {\"projection_type\": \"brown\"}}}]";
const NERFSTUDIO: &str = "{\"frames\": [{\"transform_matrix\": []}]}";
const OPENMVG: &str = "{\"sfm_data_version\": \"0.3\"}";

fn model(at: &str) -> [(String, &'static str); 3] {
    ["cameras.txt", "images.txt", "points3D.txt"].map(|name| (format!("{at}{name}"), ""))
}

#[test]
fn content_decides_whatever_the_name() {
    let made = folder(&[
        ("ply", PLY),
        ("las", "LASF...."),
        ("e57", "ASTM-E57"),
        ("nvm", "NVM_V3\n"),
        ("out", "# Bundle file v0.3\n"),
        ("opensfm", OPENSFM),
        ("nerfstudio", NERFSTUDIO),
        ("openmvg", OPENMVG),
    ]);
    type Kind = fn(PathBuf) -> SfmSource;
    let expected: [(&str, Kind); 8] = [
        ("ply", SfmSource::Ply),
        ("las", SfmSource::Las),
        ("e57", SfmSource::E57),
        ("nvm", SfmSource::Nvm),
        ("out", SfmSource::Bundler),
        ("opensfm", SfmSource::OpenSfm),
        ("nerfstudio", SfmSource::Nerfstudio),
        ("openmvg", SfmSource::OpenMvg),
    ];
    for (name, kind) in expected {
        let path = made.path().join(name);
        assert_eq!(recognise(&path).unwrap(), kind(path.clone()), "{name}");
    }
}

#[test]
fn folders_of_tools_are_known_and_a_model_of_colmap_goes_first() {
    for (file, content) in [
        ("opensfm/reconstruction.json", OPENSFM),
        ("transforms.json", NERFSTUDIO),
        ("sfm_data.json", OPENMVG),
        ("bundle/bundle.out", "# Bundle file v0.3\n"),
    ] {
        let made = folder(&[(file, content), ("other/cloud.txt", "")]);
        assert_eq!(recognise(made.path()).unwrap().path(), made.path().join(file), "{file}");
    }
    let both = model("colmap/sparse/0/");
    let files: Vec<(&str, &str)> = both.iter().map(|(name, text)| (name.as_str(), *text)).collect();
    let made = folder(&[&files[..], &[("transforms.json", NERFSTUDIO)]].concat());
    assert_eq!(recognise(made.path()).unwrap(), SfmSource::Colmap(made.path().join("colmap/sparse/0")));
}

#[test]
fn a_file_of_a_known_name_that_is_something_else_is_passed_over() {
    let made = folder(&[("transforms.json", "{}"), ("sub/cloud.las", "LASF")]);
    assert_eq!(recognise(made.path()).unwrap(), SfmSource::Las(made.path().join("sub/cloud.las")));
}

#[test]
fn several_are_named_and_none_is_told() {
    let made = folder(&[("a.ply", PLY), ("b/c.las", "LASF")]);
    let message = recognise(made.path()).unwrap_err().to_string();
    assert!(message.contains("2 of them") && message.contains("a.ply") && message.contains("c.las"), "{message}");
    let made = folder(&[("notes.txt", "x")]);
    assert!(recognise(made.path()).unwrap_err().to_string().contains("without any of these"));
}

#[test]
fn a_file_of_a_model_stands_for_its_folder() {
    let files = model("");
    let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (name.as_str(), *text)).collect();
    let made = folder(&files);
    assert_eq!(recognise(&made.path().join("images.txt")).unwrap(), SfmSource::Colmap(made.path().into()));
}
