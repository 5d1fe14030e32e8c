//! `--height-field` and `--base-field`: houses of footprints, from a Shapefile as a person has it.

mod program;

use std::fs;

use program::{cityweld, refused, room, stderr, stdout};
use tempfile::TempDir;

/// Corner, sides, and the three attributes of a house: height, base, storeys.
type House = ([f64; 2], [f64; 2], [f64; 3]);

const HOUSES: [House; 2] = [([0.0, 0.0], [10.0, 8.0], [6.5, 2.0, 2.0]), ([30.0, -5.0], [12.0, 9.0], [9.25, -1.5, 3.0])];

/// The half with the outlines, clockwise.
fn shp(houses: &[House]) -> Vec<u8> {
    let mut bytes = vec![0; 100];
    bytes[..4].copy_from_slice(&9994_u32.to_be_bytes());
    bytes[28..32].copy_from_slice(&1000_u32.to_le_bytes());
    bytes[32..36].copy_from_slice(&5_u32.to_le_bytes());
    for (number, ([x, y], [across, along], _)) in (1_u32..).zip(houses) {
        let ring = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        let mut content = 5_u32.to_le_bytes().to_vec();
        content.extend([0; 32]);
        content.extend([1_u32, 5, 0].iter().flat_map(|count| count.to_le_bytes()));
        let corners = ring.iter().flat_map(|[u, v]| [x + u * across, y + v * along]);
        content.extend(corners.flat_map(f64::to_le_bytes));
        bytes.extend(number.to_be_bytes());
        bytes.extend((content.len() as u32 / 2).to_be_bytes());
        bytes.extend(content);
    }
    let words = bytes.len() as u32 / 2;
    bytes[24..28].copy_from_slice(&words.to_be_bytes());
    bytes
}

/// The half with the attributes: a name, and three numbers.
fn dbf(houses: &[House]) -> Vec<u8> {
    let fields: [(&[u8], u8, u8); 4] =
        [(b"name", b'C', 4), (b"HEIGHT", b'N', 8), (b"base", b'N', 8), (b"storeys", b'N', 4)];
    let mut bytes = vec![0; 32];
    bytes[4..8].copy_from_slice(&(houses.len() as u32).to_le_bytes());
    bytes[8..10].copy_from_slice(&(32 + 32 * 4 + 1_u16).to_le_bytes());
    bytes[10..12].copy_from_slice(&25_u16.to_le_bytes());
    for (name, kind, length) in fields {
        let mut field = [0; 32];
        field[..name.len()].copy_from_slice(name);
        (field[11], field[16]) = (kind, length);
        bytes.extend(field);
    }
    bytes.push(0x0D);
    for (_, _, [height, base, storeys]) in houses {
        bytes.extend(format!(" h   {height:8.2}{base:8.2}{storeys:4.0}").bytes());
    }
    bytes
}

fn houses() -> TempDir {
    let room = room();
    fs::write(room.path().join("houses.shp"), shp(&HOUSES)).unwrap();
    fs::write(room.path().join("houses.dbf"), dbf(&HOUSES)).unwrap();
    room
}

/// Lowest and highest z of the houses.
fn heights(room: &TempDir, more: &[&str]) -> [f64; 2] {
    let output = cityweld(room, &[&["planes", "houses.shp", "--quiet"], more].concat());
    let said = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{more:?}: {}", stderr(&output));
    assert!(said.starts_with("houses.shp: 2 objects, 12 facets"), "{said}");
    let line = said.lines().find_map(|line| line.trim_start().strip_prefix("z (up)")).unwrap();
    let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    numbers.try_into().unwrap()
}

#[test]
fn houses_stand_on_their_base_as_high_as_their_field_says() {
    let room = houses();
    assert_eq!(heights(&room, &["--height-field", "HEIGHT"]), [0.0, 9.25]);
    assert_eq!(heights(&room, &["--height-field", "HEIGHT", "--base-field", "base"]), [-1.5, 8.5]);
    // In any case of letters, and any field with numbers.
    assert_eq!(heights(&room, &["--height-field", "height"]), [0.0, 9.25]);
    assert_eq!(heights(&room, &["--height-field", "storeys"]), [0.0, 3.0]);
}

#[test]
fn heights_are_in_the_unit_of_the_coordinates() {
    let room = houses();
    assert_eq!(heights(&room, &["--height-field", "HEIGHT", "--city-unit", "cm"]), [0.0, 0.09]);
    let help = stdout(&cityweld(&room, &["planes", "--help"]));
    let words: String = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("heights of houses above their base, in the unit of the coordinates"), "{help}");
}

#[test]
fn a_field_that_is_not_there_or_holds_no_numbers_is_refused_with_those_that_do() {
    let room = houses();
    let planes = ["planes", "houses.shp"];
    refused(&room, &planes, &["--height-field", "HEIGHT, base, storeys", "houses.dbf"]);
    for (option, wrong) in [("--height-field", "eaves"), ("--height-field", "name"), ("--height-field", "")] {
        refused(&room, &[&planes[..], &[option, wrong]].concat(), &["HEIGHT, base, storeys", &format!("`{wrong}`")]);
    }
    let more = ["--height-field", "HEIGHT", "--base-field", "floor"];
    refused(&room, &[&planes[..], &more].concat(), &["`floor`", "HEIGHT, base, storeys"]);
    refused(&room, &[&planes[..], &["--base-field", "base"]].concat(), &["--height-field"]);
}

#[test]
fn an_index_of_footprints_keeps_their_heights() {
    let room = houses();
    let index = ["index", "houses.shp", "-o", "houses.cwi", "--height-field", "HEIGHT", "--base-field", "base"];
    let made = cityweld(&room, &index);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let said = stdout(&cityweld(&room, &["planes", "houses.cwi"]));
    assert!(said.contains("-1.50 to 8.50 m"), "{said}");
    // The half with the attributes is a file of the city, too.
    let mut changed = HOUSES;
    changed[0].2[0] = 20.0;
    fs::write(room.path().join("houses.dbf"), dbf(&changed)).unwrap();
    refused(&room, &["planes", "houses.cwi"], &["houses.dbf"]);
}

#[test]
fn a_half_that_is_cut_or_of_another_file_is_refused_with_its_name() {
    let room = houses();
    let path = |name: &str| room.path().join(name);
    let planes = ["planes", "houses.shp", "--height-field", "HEIGHT"];
    for (name, whole) in [("houses.shp", shp(&HOUSES)), ("houses.dbf", dbf(&HOUSES))] {
        for length in [0, 10, 31, 40, 99, 100, 108, 150, whole.len() / 2, whole.len() - 30, whole.len() - 1] {
            fs::write(path(name), &whole[..length.min(whole.len() - 1)]).unwrap();
            refused(&room, &planes, &["houses."]);
        }
        fs::write(path(name), whole).unwrap();
    }
    fs::write(path("houses.dbf"), dbf(&HOUSES[..1])).unwrap();
    refused(&room, &planes, &["2 shapes, but 1 rows"]);
    fs::remove_file(path("houses.dbf")).unwrap();
    refused(&room, &planes, &["houses"]);
}
