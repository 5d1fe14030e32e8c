use super::*;

/// Files and folders of these names in a folder of their own; a name that ends with a stroke is a folder.
fn room(names: &[&str]) -> tempfile::TempDir {
    let room = tempfile::tempdir().unwrap();
    for name in names {
        let path = room.path().join(name);
        match name.strip_suffix('/') {
            Some(_) => std::fs::create_dir_all(path).unwrap(),
            None => std::fs::write(path, "x").unwrap(),
        }
    }
    room
}

#[test]
fn an_output_that_is_or_holds_an_input_is_refused() {
    let room = room(&["data/", "data/sfm/", "data/city.obj", "out/"]);
    let at = |name: &str| room.path().join(name);
    let (city, sfm) = (at("data/city.obj"), at("data/sfm"));
    let inputs = [&city, &sfm];
    for wrong in ["data", "data/city.obj", "data/sfm", "out/../data"] {
        let error = keeps_inputs(&at(wrong), &inputs).unwrap_err().to_string();
        assert!(error.contains("would replace an input") && error.contains("-o"), "{error}");
    }
    for right in ["out", "not/there/yet", "data/result"] {
        assert!(keeps_inputs(&at(right), &inputs).is_ok(), "{right}");
    }
    let here = std::env::current_dir().unwrap();
    assert!(keeps_inputs(&here, &[]).unwrap_err().to_string().contains("the folder that you are in"));
}

#[test]
fn what_is_no_city_and_no_reconstruction_is_named_with_its_place() {
    let room = room(&["folder/", "city.obj", "cloud.ply"]);
    let at = |name: &str| room.path().join(name);
    let city = |name: &str, terrain: &[PathBuf]| {
        let args = CityArgs { terrain: terrain.to_vec(), ..CityArgs::default() };
        CityFiles::new(&[at(name)], &args).map(|files| files.names())
    };
    assert_eq!(city("city.obj", &[]).unwrap(), ["city.obj"]);
    assert!(city("absent.obj", &[]).unwrap_err().to_string().contains("cannot read the city"));
    assert!(city("city.obj", &[at("city.obj")]).unwrap_err().to_string().contains("given again as terrain"));
    assert_eq!(city("city.obj", &[at("cloud.ply")]).unwrap(), ["city.obj", "cloud.ply"]);
    assert!(existing_sfm(&at("folder"), &[at("city.obj")]).is_ok());
    let same = existing_sfm(&at("city.obj"), &[at("folder/../city.obj")]).unwrap_err().to_string();
    assert!(same.contains("the same file"), "{same}");
    assert!(existing_reconstruction(&at("absent"), "part 2").unwrap_err().to_string().contains("cannot read part 2"));
}

#[test]
fn a_path_without_a_name_of_its_own_is_told_by_the_folder_that_it_is() {
    let room = room(&["folder/"]);
    assert_eq!(file_name(&room.path().join("folder")), "folder");
    assert_eq!(file_name(&room.path().join("folder/.")), "folder");
    assert_eq!(file_name(&room.path().join("folder/sub/..")), "");
    assert_eq!(file_name(Path::new("a/b.ply")), "b.ply");
}
