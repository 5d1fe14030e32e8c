use super::*;
use crate::city::{CityIndex, read_city};
use crate::synthetic::{Block, House};

/// Rows of houses, some wall to wall, over two squares of blocks, on their ground.
fn index() -> (tempfile::TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let [city, index] = ["city.obj", "city.cwi"].map(|name| folder.path().join(name));
    let houses = Block::row(&House::flat([9.0, 8.0, 7.0]), 130, 9.0).with_ground();
    houses.city().unwrap().write_obj(&city).unwrap();
    write_city_index(std::slice::from_ref(&city), &[], &CityOptions::default(), &index, &()).unwrap();
    (folder, city, index)
}

#[test]
fn what_can_be_seen_is_told_as_it_is_found_in_the_whole_city() {
    let (_folder, city, index) = index();
    let [of_text, of_index] = [city, index].map(|path| read_city(&path, &[], &CityOptions::default()).unwrap());
    let told = of_index.exposed.clone();
    let found = PreparedCity::new(of_text);
    let found: Vec<bool> = (0..told.len() as u32).map(|triangle| found.is_exposed(triangle)).collect();
    assert!(found.contains(&true) && found.contains(&false));
    assert_eq!(told, found);
    // Other limits ask anew.
    let limits = crate::limits::FacetVisibilityLimits { open_m: 1e-3, ..Limits::default().facet_visibility };
    let all_open = PreparedCity::with_limits(of_index, &limits);
    assert!((0..told.len() as u32).filter(|&triangle| !told[triangle as usize]).any(|t| all_open.is_exposed(t)));
}

#[test]
fn the_walls_of_all_blocks_are_those_of_the_whole_city() {
    let (_folder, city, index) = index();
    let whole = PreparedCity::new(read_city(&city, &[], &CityOptions::default()).unwrap());
    let found = walls_of_planes(&whole, |_| true, &Limits::default());
    let text = |wall: WallRecord| format!("{wall:?}");
    let mut found: Vec<String> = found.iter().flat_map(|(_, walls)| walls).map(|wall| text(record(wall))).collect();
    let everywhere = PlanBox { low: [-1e6; 2], high: [1e6; 2] };
    let told = CityIndex::open(&index).unwrap().walls_within(&everywhere).unwrap();
    let mut told: Vec<String> = told.into_iter().map(text).collect();
    found.sort();
    told.sort();
    assert!(told.len() > 200, "{}", told.len());
    assert_eq!(told, found);
}
