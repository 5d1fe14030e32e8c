//! A folder with every file that the README's commands name: the sample's block of Rotterdam, its reconstruction and its cloud, each in the forms
//! that users have. The city stands in EPSG:28992.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use cityweld::{Point3, Reconstruction, Similarity};
use las::point::Format;
use las::{Builder, Point, Transform, Vector, Writer};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::pieces::{piece, sample, write_part};

/// From the sample's coordinates to EPSG:28992 (tests/data/positions/README.md).
const TO_GRID: [f64; 3] = [90_400.0, 435_400.0, 0.0];

fn of_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Faces of an OBJ by object: each the corners of one polygon.
type Houses = Vec<(String, Vec<Vec<[f64; 3]>>)>;

pub fn room() -> TempDir {
    let room = tempfile::tempdir().unwrap();
    let at = |name: &str| room.path().join(name);
    let houses = houses();
    let (north, south) = houses.split_at(houses.len() / 2);
    fs::write(at("city.obj"), obj(&houses)).unwrap();
    for (name, houses) in [("city.gml", &houses[..]), ("north.gml", north), ("south.gml", south)] {
        fs::write(at(name), citygml(houses)).unwrap();
    }
    fs::write(at("city.city.json"), cityjson(&houses, "CityJSON").to_string()).unwrap();
    fs::write(at("city.city.jsonl"), sequence(&houses)).unwrap();
    fs::create_dir(at("tiles")).unwrap();
    for (name, houses) in [("tiles/north.city.json", north), ("tiles/south.city.json", south)] {
        fs::write(at(name), cityjson(houses, "CityJSON").to_string()).unwrap();
    }
    copy_folder(&of_repository("assets/sample/sfm"), &at("sfm"));
    copy_folder(&of_repository("assets/sample/labels"), &at("labels"));
    copy_folder(&of_repository("tests/data/positions/exif"), &at("photos"));
    fs::copy(of_repository("tests/data/positions/geo.txt"), at("geo.txt")).unwrap();
    fs::write(at("start.json"), start()).unwrap();
    for (name, first) in [("a", 0), ("b", 8), ("c", 15)] {
        write_part(room.path(), name, &piece(&sample(), first..first + 9, &Similarity::identity()));
    }
    fs::create_dir_all(at("odm/opensfm")).unwrap();
    let (reconstruction, tracks) = opensfm(&sample());
    fs::write(at("odm/opensfm/reconstruction.json"), reconstruction.to_string()).unwrap();
    fs::write(at("odm/opensfm/tracks.csv"), tracks).unwrap();
    room
}

/// The points of the reconstruction where they stand, as a scanner's software writes them.
pub fn write_scan(path: &Path, city_from_sfm: &Similarity) {
    let mut builder = Builder::from((1, 4));
    builder.point_format = Format::new(6).unwrap();
    builder.point_format.is_compressed = true;
    let axis = |offset| Transform { scale: 0.001, offset };
    builder.transforms = Vector { x: axis(TO_GRID[0]), y: axis(TO_GRID[1]), z: axis(TO_GRID[2]) };
    let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
    for (i, point) in sample().points.iter().enumerate() {
        let Point3 { coords } = city_from_sfm.apply(point);
        let (x, y, z) = (coords.x, coords.y, coords.z);
        writer.write_point(Point { x, y, z, gps_time: Some(i as f64), ..Point::default() }).unwrap();
    }
    fs::write(path, writer.into_inner().unwrap().into_inner()).unwrap();
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

fn start() -> String {
    let mut start: Value =
        serde_json::from_slice(&fs::read(of_repository("assets/sample/start.json")).unwrap()).unwrap();
    for (k, shift) in TO_GRID.iter().enumerate() {
        let value = start["translation"][k].as_f64().unwrap() + shift;
        start["translation"][k] = value.into();
    }
    start.to_string()
}

fn houses() -> Houses {
    let text = fs::read_to_string(of_repository("assets/sample/city.obj")).unwrap();
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let mut houses: Houses = Vec::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.split_first() {
            Some((&"v", place)) => {
                let number = |k: usize| place[k].parse::<f64>().unwrap() + TO_GRID[k];
                vertices.push([number(0), number(1), number(2)]);
            }
            Some((&"o", name)) => houses.push((name.join(" "), Vec::new())),
            Some((&"f", corners)) => {
                let place = |corner: &&str| vertices[corner.split('/').next().unwrap().parse::<usize>().unwrap() - 1];
                houses.last_mut().unwrap().1.push(corners.iter().map(place).collect());
            }
            _ => {}
        }
    }
    houses
}

fn obj(houses: &Houses) -> String {
    let (mut text, mut count) = (String::new(), 0);
    for (name, faces) in houses {
        let _ = writeln!(text, "o {name}");
        for face in faces {
            face.iter().for_each(|[x, y, z]| writeln!(text, "v {x:.3} {y:.3} {z:.3}").unwrap());
            let corners: Vec<String> = (1..=face.len()).map(|corner| (count + corner).to_string()).collect();
            let _ = writeln!(text, "f {}", corners.join(" "));
            count += face.len();
        }
    }
    text
}

fn citygml(houses: &[(String, Vec<Vec<[f64; 3]>>)]) -> String {
    let mut text = r#"<?xml version="1.0"?><CityModel xmlns="http://www.opengis.net/citygml/2.0" xmlns:b="http://www.opengis.net/citygml/building/2.0" xmlns:gml="http://www.opengis.net/gml">"#.to_owned();
    for (name, faces) in houses {
        let _ = write!(
            text,
            "\n<cityObjectMember><b:Building gml:id=\"{name}\"><b:lod2MultiSurface><gml:MultiSurface srsName=\"EPSG:28992\">"
        );
        for face in faces {
            text += "<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing><gml:posList srsDimension=\"3\">";
            // A ring of CityGML ends where it began.
            let ring = face.iter().chain(face.first());
            ring.for_each(|[x, y, z]| write!(text, "{x:.3} {y:.3} {z:.3} ").unwrap());
            text += "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>";
        }
        text += "</gml:MultiSurface></b:lod2MultiSurface></b:Building></cityObjectMember>";
    }
    text + "\n</CityModel>\n"
}

fn cityjson(houses: &[(String, Vec<Vec<[f64; 3]>>)], kind: &str) -> Value {
    let mut vertices: Vec<[i64; 3]> = Vec::new();
    let mut objects = BTreeMap::new();
    for (name, faces) in houses {
        let mut boundaries = Vec::new();
        for face in faces {
            let first = vertices.len();
            vertices.extend(face.iter().map(|x| [0, 1, 2].map(|k| ((x[k] - TO_GRID[k]) * 1e3).round() as i64)));
            boundaries.push(vec![(first..vertices.len()).collect::<Vec<_>>()]);
        }
        let geometry = json!([{ "type": "MultiSurface", "lod": "2.2", "boundaries": boundaries }]);
        objects.insert(name, json!({ "type": "Building", "geometry": geometry }));
    }
    let mut city = json!({ "type": kind, "CityObjects": objects, "vertices": vertices });
    if kind == "CityJSON" {
        city["version"] = "2.0".into();
        city["transform"] = json!({ "scale": [0.001, 0.001, 0.001], "translate": TO_GRID });
        city["metadata"] = json!({ "referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/28992" });
    } else {
        city["id"] = houses[0].0.clone().into();
    }
    city
}

fn sequence(houses: &Houses) -> String {
    let header = cityjson(&[], "CityJSON").to_string();
    let features = houses.chunks(1).map(|house| cityjson(house, "CityJSONFeature").to_string());
    std::iter::once(header).chain(features).collect::<Vec<_>>().join("\n")
}

/// `reconstruction.json` and `tracks.csv` of OpenSfM, as an ODM project keeps them.
fn opensfm(sfm: &Reconstruction) -> (Value, String) {
    let camera = &sfm.cameras[0];
    let [focal_px, _, _, radial] = camera.params[..] else { panic!("the sample's camera is SIMPLE_RADIAL") };
    let (width, height) = (camera.width_px as f64, camera.height_px as f64);
    let mut shots = BTreeMap::new();
    let mut tracks = "OPENSFM_TRACKS_VERSION_v2\n".to_owned();
    for image in &sfm.images {
        let rotation: [f64; 3] = image.cam_from_sfm_rotation.scaled_axis().into();
        let translation: [f64; 3] = image.cam_from_sfm_translation.into();
        shots.insert(&image.name, json!({ "rotation": rotation, "translation": translation, "camera": "drone" }));
        for (feature, seen) in image.observations.iter().enumerate() {
            let Some(point) = seen.point else { continue };
            let [x, y] = [(seen.x_px, width), (seen.y_px, height)].map(|(at, size)| (at - size / 2.0) / width);
            let _ = writeln!(tracks, "{}\t{}\t{feature}\t{x}\t{y}\t0.001\t128\t128\t128", image.name, point.0);
        }
    }
    let points: BTreeMap<String, Value> = sfm
        .points
        .iter()
        .enumerate()
        .map(|(i, point)| {
            (i.to_string(), json!({ "coordinates": [point.x, point.y, point.z], "color": [128, 128, 128] }))
        })
        .collect();
    let camera = json!({
        "projection_type": "perspective", "width": camera.width_px, "height": camera.height_px,
        "focal": focal_px / width, "k1": radial, "k2": 0.0,
    });
    (json!([{ "cameras": { "drone": camera }, "shots": shots, "points": points }]), tracks)
}
