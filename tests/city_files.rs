//! City files as a whole: the real models, and damaged ones.

use std::path::{Path, PathBuf};

use cityweld::city::{CityModel, CityOptions, read_city};

/// The folder of shared data, where there is one.
fn shared() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let found = std::env::var_os("CITYWELD_SHARED").map_or(beside, PathBuf::from);
    let found = found.join("data/city");
    if !found.is_dir() {
        println!("skipped: no shared data at {}", found.display());
        return None;
    }
    Some(found)
}

fn read(path: &Path) -> CityModel {
    read_city(path, &[], &CityOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn shared_models_load_with_their_counts() {
    let Some(shared) = shared() else { return };
    let table = [
        ("model_denhaag/city.obj", 1990, 16209, 35592),
        ("model_denhaag/terrain.obj", 1, 5595, 5595),
        ("model_rotterdam/city.obj", 853, 14743, 37398),
        ("model_rotterdam/city_raw.obj", 134, 1686, 4153),
        ("model_delft/city.obj", 160, 5556, 5556),
        ("model_delft/terrain.obj", 6, 30481, 30481),
        ("model_ingolstadt/city.obj", 23, 43070, 71782),
        ("model_symmetric/city.obj", 1, 9, 16),
    ];
    for (name, objects, faces, triangles) in table {
        let model = read(&shared.join(name));
        println!(
            "{name} {} {} {} {} {:?}",
            model.objects.len(),
            model.facets.len(),
            model.triangles.len(),
            model.origin,
            model.sources
        );
        for warning in &model.warnings {
            println!("   {warning}");
        }
        println!("   {objects} {faces} {triangles} area {}", model.facets.iter().map(|f| f.area).sum::<f64>());
    }
}
