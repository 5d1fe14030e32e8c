use std::fs;
use std::path::{Path, PathBuf};

use super::*;
use crate::city::{CityError, CityModel, CityOptions, PlanBox, read_city, read_city_within};
use crate::format::city_index::BlockSight;
use crate::synthetic::{Block, House};

/// A town that is wider than a block, on its ground.
fn town() -> Block {
    Block::row(&House::flat([9.0, 8.0, 7.0]), 60, 12.0).with_ground()
}

struct Room {
    folder: tempfile::TempDir,
}

impl Room {
    /// A folder with a town, and its index beside it.
    fn new() -> Room {
        let room = Room { folder: tempfile::tempdir().unwrap() };
        town().city().unwrap().write_obj(&room.city()).unwrap();
        room.index(&room.city()).unwrap();
        room
    }

    fn city(&self) -> PathBuf {
        self.folder.path().join("city.obj")
    }

    fn at(&self) -> PathBuf {
        self.folder.path().join("city.cwi")
    }

    fn index(&self, city: &Path) -> Result<(), CityError> {
        finished(IndexDraft::of_city(&[city.to_owned()], &[], &CityOptions::default(), &self.at())?)
    }
}

/// An index in which nothing is known of what can be seen.
fn finished(mut draft: IndexDraft) -> Result<(), CityError> {
    for block in 0..draft.boxes().len() {
        let triangles = {
            let around = draft.around(&[block], 0.0)?;
            let at = around.blocks.iter().position(|&other| other == block).unwrap();
            let facets = &around.city.facet_of[at];
            facets.iter().map(|&facet| around.city.model.facets[facet as usize].triangles.len()).sum::<usize>()
        };
        draft.add_sight(block, &BlockSight { exposed: vec![true; triangles], walls: Vec::new() })?;
    }
    draft.finish()
}

fn read(path: &Path) -> Result<CityModel, CityError> {
    read_city(path, &[], &CityOptions::default())
}

fn text_of(model: &CityModel) -> String {
    // Numbers are written so that they are read back to the bit.
    format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {:?}",
        model.origin, model.vertices, model.facets, model.triangles, model.objects, model.sources, model.warnings
    )
}

fn near() -> PlanBox {
    PlanBox { low: [10.0, 0.0], high: [30.0, 5.0] }
}

#[test]
fn the_model_from_an_index_is_that_from_the_text_to_the_bit() {
    let room = Room::new();
    let index = read(&room.at()).unwrap();
    assert_eq!(text_of(&read(&room.city()).unwrap()), text_of(&index));
    assert_eq!(index.exposed.len(), index.triangles.len());
    assert_eq!(index.part_of, None);
}

#[test]
fn near_a_place_only_the_blocks_it_touches_are_read_and_their_facets_are_those_of_the_whole() {
    let room = Room::new();
    let index = CityIndex::open(&room.at()).unwrap();
    let (touched, all) = index.blocks_within(&near());
    assert!(touched < all, "{touched} of {all}");
    let (whole, part) = (read(&room.city()).unwrap(), index.read_within(&near()).unwrap());
    assert!(part.facets.len() < whole.facets.len());
    assert_eq!(part.part_of.unwrap().size.facets, whole.facets.len());
    let corners = |model: &CityModel| -> Vec<String> {
        let corner = |&vertex: &u32| model.vertices[vertex as usize];
        let of = |facet: &crate::city::Facet| {
            let outline: Vec<_> = facet.outline.iter().map(corner).collect();
            format!("{} {outline:?} {:?} {}", model.object_name(facet.object), facet.plane, facet.area)
        };
        model.facets.iter().map(of).collect()
    };
    assert_eq!(part.bounds(), whole.bounds());
    let (all, some) = (corners(&whole), corners(&part));
    let mut rest = all.iter();
    assert!(some.iter().all(|facet| rest.any(|other| other == facet)), "in the order of the whole");
    // What is not touched may be spoilt without anybody noticing.
    let mut bytes = fs::read(room.at()).unwrap();
    let spoilt = (64..bytes.len() - 4096).rev().find(|&at| {
        bytes[at] ^= 1;
        fs::write(room.at(), &bytes).unwrap();
        let is_far = CityIndex::open(&room.at()).is_ok_and(|index| index.read_within(&near()).is_ok());
        bytes[at] ^= u8::from(!is_far);
        is_far
    });
    assert!(spoilt.is_some());
    assert!(read(&room.at()).unwrap_err().to_string().contains("checksum"));
}

#[test]
fn a_place_outside_the_city_gets_the_nearest_block() {
    let room = Room::new();
    let far = PlanBox { low: [1e6, 1e6], high: [1e6, 1e6] };
    let found = read_city_within(&[room.at()], &[], &CityOptions::default(), &far).unwrap();
    assert!(!found.facets.is_empty());
    // A text is read whole.
    let all = read_city_within(&[room.city()], &[], &CityOptions::default(), &far).unwrap();
    assert!(all.facets.len() > found.facets.len());
}

#[test]
fn a_changed_city_is_refused_and_a_touched_one_is_not() {
    let room = Room::new();
    let text = fs::read_to_string(room.city()).unwrap();
    fs::write(room.city(), &text).unwrap();
    assert!(read(&room.at()).is_ok(), "the same again");
    let middle = text.len() / 2;
    let digit = text[middle..].find(|c: char| c.is_ascii_digit()).unwrap() + middle;
    let other = if &text[digit..digit + 1] == "3" { "4" } else { "3" };
    fs::write(room.city(), format!("{}{other}{}", &text[..digit], &text[digit + 1..])).unwrap();
    let message = read(&room.at()).unwrap_err().to_string();
    assert!(message.contains("has changed since") && message.contains("cityweld index"), "{message}");
    fs::write(room.city(), format!("{text}# more\n")).unwrap();
    assert!(read(&room.at()).unwrap_err().to_string().contains("bytes, and has"));
    fs::remove_file(room.city()).unwrap();
    let alone = read(&room.at()).unwrap();
    assert!(alone.warnings.iter().any(|warning| warning.to_string().contains("not where it was")));
}

#[test]
fn a_new_tile_in_the_folder_is_a_change() {
    let room = Room::new();
    let tiles = room.folder.path().join("tiles");
    fs::create_dir(&tiles).unwrap();
    fs::copy(room.city(), tiles.join("a.obj")).unwrap();
    room.index(&tiles).unwrap();
    assert!(read(&room.at()).is_ok());
    fs::copy(room.city(), tiles.join("b.obj")).unwrap();
    let message = read(&room.at()).unwrap_err().to_string();
    assert!(message.contains("b.obj came into"), "{message}");
}

#[test]
fn a_cut_index_is_an_error_wherever_it_is_cut() {
    let room = Room::new();
    let bytes = fs::read(room.at()).unwrap();
    let cuts = (0..64).chain((64..bytes.len()).step_by(997)).chain([bytes.len() - 1]);
    for length in cuts {
        let cut = room.folder.path().join("cut.cwi");
        fs::write(&cut, &bytes[..length]).unwrap();
        assert!(read(&cut).is_err(), "{length} of {}", bytes.len());
    }
}

#[test]
fn an_altered_byte_is_an_error_wherever_it_is() {
    let room = Room::new();
    let bytes = fs::read(room.at()).unwrap();
    for at in (0..64).chain((64..bytes.len()).step_by(991)) {
        let altered = room.folder.path().join("altered.cwi");
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x10;
        fs::write(&altered, &bytes).unwrap();
        let message = read(&altered).err().map(|error| error.to_string());
        assert!(message.is_some_and(|message| message.contains("altered.cwi")), "byte {at}");
    }
}

#[test]
fn whatever_is_said_beside_an_index_is_refused_with_what_to_do() {
    let room = Room::new();
    let terrain = [room.city()];
    let options = CityOptions::default().with_origin([1.0, 0.0, 0.0]);
    for (terrain, options, says) in
        [(&terrain[..], CityOptions::default(), "the terrain"), (&[], options, "the options of the city")]
    {
        let message = read_city(&room.at(), terrain, &options).unwrap_err().to_string();
        assert!(message.contains(says) && message.contains("cityweld index"), "{message}");
    }
}

/// The town as a sequence of features, one of which crosses itself.
fn sequence(path: &Path) {
    let city = town().city().unwrap();
    let mut text = concat!(
        r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[85000,447000,0]},"#,
        r#""CityObjects":{},"vertices":[]}"#,
        "\n"
    )
    .to_owned();
    let mut facets: Vec<_> = city.facets.iter().collect();
    facets.sort_by_key(|facet| facet.object);
    let feature = |id: &str, surfaces: Vec<Vec<[f64; 3]>>| {
        let vertices: Vec<[i64; 3]> = surfaces.iter().flatten().map(|v| v.map(|c| (c * 1e3).round() as i64)).collect();
        let mut at = 0;
        let rings = surfaces.iter().map(|ring| {
            at += ring.len();
            vec![(at - ring.len()..at).collect::<Vec<usize>>()]
        });
        let rings: Vec<_> = rings.collect();
        format!(
            "{{\"type\":\"CityJSONFeature\",\"id\":\"{id}\",\"CityObjects\":{{\"{id}\":{{\"type\":\"Building\",\"geometry\":[{{\"type\":\
             \"MultiSurface\",\"lod\":\"2\",\"boundaries\":{rings:?}}}]}}}},\"vertices\":{vertices:?}}}\n"
        )
    };
    for building in facets.chunk_by(|a, b| a.object == b.object) {
        let corner = |&vertex: &u32| <[f64; 3]>::from(city.vertices[vertex as usize] + city.origin);
        let surfaces = building.iter().map(|facet| facet.outline.iter().map(corner).collect()).collect();
        text += &feature(&format!("house {}", building[0].object.0), surfaces);
    }
    let bow = vec![[2000.0, 0.0, 0.0], [2004.0, 4.0, 0.0], [2004.0, 0.0, 0.0], [2000.0, 4.5, 0.0]];
    text += &feature("bow", vec![bow]);
    fs::write(path, text).unwrap();
}

#[test]
fn a_sequence_that_is_read_square_by_square_gives_the_model_of_the_whole() {
    let room = Room::new();
    let city = room.folder.path().join("city.city.jsonl");
    sequence(&city);
    let whole = read(&city).unwrap();
    let options = CityOptions::default();
    finished(IndexDraft::of_long_city(std::slice::from_ref(&city), &[], &options, &room.at(), 0).unwrap()).unwrap();
    let index = read(&room.at()).unwrap();
    assert!(whole.vertices.len() > 100 && whole.warnings.len() > 1);
    assert_eq!(text_of(&whole), text_of(&index));
}

#[test]
fn a_broken_feature_of_a_long_sequence_is_told_by_its_line() {
    let room = Room::new();
    let city = room.folder.path().join("city.city.jsonl");
    sequence(&city);
    let text = fs::read_to_string(&city).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let broken = [&lines[..20], &[&lines[20][..60]], &lines[21..]].concat().join("\n");
    fs::write(&city, broken).unwrap();
    let options = CityOptions::default();
    let made = IndexDraft::of_long_city(std::slice::from_ref(&city), &[], &options, &room.at(), 0);
    let message = made.err().unwrap().to_string();
    assert!(message.contains("city.city.jsonl:21:"), "{message}");
}
