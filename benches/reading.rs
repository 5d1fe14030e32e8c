//! Bytes a second at which files become reconstructions and cities.
//!
//! `cargo bench --bench reading`
//!
//! The files are made up: a COLMAP model of 400 photographs in which 160,000 points have five observations each and two of
//! three keypoints no point, as binary and as text; a city of 20,000 houses as OBJ, CityJSON and CityGML; a scan of a million points as LAZ, beside
//! the `las` crate alone. They lie in the cache of the system. With CITYWELD_BENCH_FILES=FOLDER they are kept there, for other programs to
//! read: `benches/peers_reading.py FOLDER`.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use cityweld::{CityOptions, read_city, read_reconstruction};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use las::point::Format;
use las::{Builder, Color, Reader, Writer};

const IMAGES: usize = 400;
const POINTS: usize = 160_000;
const TRACK: usize = 5;
const KEYPOINTS: usize = 3 * POINTS * TRACK / IMAGES;
const HOUSES: usize = 20_000;
const SCANNED: usize = 1_000_000;

fn bench(criterion: &mut Criterion) {
    let temporary = tempfile::tempdir().expect("a temporary folder");
    let folder = std::env::var_os("CITYWELD_BENCH_FILES").map_or(temporary.path().to_owned(), PathBuf::from);
    let [binary, text] = ["binary", "text"].map(|name| folder.join(name));
    write_binary(&binary);
    write_text(&text);
    let cities =
        [("OBJ", "city.obj", obj()), ("CityJSON", "city.city.json", cityjson()), ("CityGML", "city.gml", citygml())];
    let scan = folder.join("scan.laz");
    write_scan(&scan);

    let mut group = criterion.benchmark_group("read");
    group.throughput(Throughput::Bytes(size_of(&binary)));
    group.bench_function("COLMAP binary", |b| b.iter(|| read_reconstruction(&binary).expect("a sound model")));
    group.throughput(Throughput::Bytes(size_of(&text)));
    group.bench_function("COLMAP text", |b| b.iter(|| read_reconstruction(&text).expect("a sound model")));
    let options = CityOptions::default();
    for (format, name, content) in cities {
        let city = folder.join(name);
        std::fs::write(&city, content).expect("a writable folder");
        group.throughput(Throughput::Bytes(size_of(&city)));
        group.bench_function(format, |b| b.iter(|| read_city(&city, &[], &options).expect("a sound city")));
    }
    group.throughput(Throughput::Bytes(size_of(&scan)));
    group.bench_function("LAZ", |b| b.iter(|| read_reconstruction(&scan).expect("a sound scan")));
    let alone = || Reader::from_path(&scan).and_then(|mut reader| reader.read_all()).expect("a sound scan");
    group.bench_function("LAZ, las crate alone", |b| b.iter(alone));
    group.finish();
}

fn size_of(path: &Path) -> u64 {
    let file = |path: &Path| std::fs::metadata(path).map_or(0, |data| data.len());
    match std::fs::read_dir(path) {
        Ok(entries) => entries.flatten().map(|entry| file(&entry.path())).sum(),
        Err(_) => file(path),
    }
}

/// The keypoint of an image that shows a point: element `k` of the point's track.
fn element(point: usize, k: usize) -> (usize, usize) {
    // Five photographs in a row show the same points; their slots go up by three.
    let block = point * IMAGES / POINTS;
    let image = (block + k) % IMAGES;
    let slot = (point % (POINTS / IMAGES)) + (POINTS / IMAGES) * k;
    (image, 3 * slot)
}

/// For each image the point of each keypoint.
fn seen() -> Vec<Vec<Option<usize>>> {
    let mut seen = vec![vec![None; KEYPOINTS]; IMAGES];
    for point in 0..POINTS {
        for (image, keypoint) in (0..TRACK).map(|k| element(point, k)) {
            seen[image][keypoint] = Some(point);
        }
    }
    seen
}

/// Numbers with all their digits, as reconstructions have them.
fn number(i: usize, scale: f64) -> f64 {
    scale * ((i as f64 * 0.618_033_988_749_894_9).fract() + 1e-3)
}

fn write_binary(folder: &Path) {
    let mut cameras = 1_u64.to_le_bytes().to_vec();
    cameras.extend([1_u32, 1].into_iter().flat_map(u32::to_le_bytes));
    cameras.extend([4000_u64, 3000].into_iter().flat_map(u64::to_le_bytes));
    cameras.extend([3000.0, 3000.0, 2000.0, 1500.0].into_iter().flat_map(f64::to_le_bytes));
    let mut images = (IMAGES as u64).to_le_bytes().to_vec();
    for (i, keypoints) in seen().iter().enumerate() {
        images.extend((i as u32 + 1).to_le_bytes());
        images.extend([1.0, 0.0, 0.0, 0.0, number(i, 9.0), 0.0, 0.0].into_iter().flat_map(f64::to_le_bytes));
        images.extend(1_u32.to_le_bytes());
        images.extend(format!("street/{i:06}.jpg\0").bytes());
        images.extend((KEYPOINTS as u64).to_le_bytes());
        for (k, point) in keypoints.iter().enumerate() {
            images.extend([number(k, 3999.0), number(k + 7, 2999.0)].into_iter().flat_map(f64::to_le_bytes));
            images.extend(point.map_or(u64::MAX, |p| p as u64 + 1).to_le_bytes());
        }
    }
    let mut points = (POINTS as u64).to_le_bytes().to_vec();
    for p in 0..POINTS {
        points.extend((p as u64 + 1).to_le_bytes());
        points.extend([number(p, 9.0), number(p + 3, 9.0), number(p + 5, 9.0)].into_iter().flat_map(f64::to_le_bytes));
        points.extend([128, 128, 128]);
        points.extend(number(p, 1.0).to_le_bytes());
        points.extend((TRACK as u64).to_le_bytes());
        for (image, keypoint) in (0..TRACK).map(|k| element(p, k)) {
            points.extend([image as u32 + 1, keypoint as u32].into_iter().flat_map(u32::to_le_bytes));
        }
    }
    write(folder, [("cameras.bin", cameras), ("images.bin", images), ("points3D.bin", points)]);
}

fn write_text(folder: &Path) {
    let cameras = "1 PINHOLE 4000 3000 3000 3000 2000 1500\n".to_owned();
    let mut images = String::new();
    for (i, keypoints) in seen().iter().enumerate() {
        let _ = writeln!(images, "{} 1 0 0 0 {} 0 0 1 street/{i:06}.jpg", i + 1, number(i, 9.0));
        for (k, point) in keypoints.iter().enumerate() {
            let id = point.map_or(-1, |p| p as i64 + 1);
            let _ = write!(images, "{} {} {id} ", number(k, 3999.0), number(k + 7, 2999.0));
        }
        images.push('\n');
    }
    let mut points = String::new();
    for p in 0..POINTS {
        let [x, y, z, error] = [number(p, 9.0), number(p + 3, 9.0), number(p + 5, 9.0), number(p, 1.0)];
        let _ = write!(points, "{} {x} {y} {z} 128 128 128 {error}", p + 1);
        for (image, keypoint) in (0..TRACK).map(|k| element(p, k)) {
            let _ = write!(points, " {} {keypoint}", image + 1);
        }
        points.push('\n');
    }
    let files = [("cameras.txt", cameras), ("images.txt", images), ("points3D.txt", points)];
    write(folder, files.map(|(name, text)| (name, text.into_bytes())));
}

fn write(folder: &Path, files: [(&str, Vec<u8>); 3]) {
    std::fs::create_dir(folder).expect("a writable temporary folder");
    for (name, bytes) in files {
        std::fs::write(folder.join(name), bytes).expect("a writable temporary folder");
    }
}

/// A scan that goes to and fro over roofs, with all that scanners write.
fn write_scan(path: &Path) {
    let mut builder = Builder::from((1, 2));
    builder.point_format = Format::new(3).expect("a format");
    builder.point_format.is_compressed = true;
    let header = builder.into_header().expect("a sound header");
    let mut writer = Writer::from_path(path, header).expect("a writable folder");
    for i in 0..SCANNED {
        let (along, across) = (i / 1000, i % 1000);
        let (x, y) = (0.2 * along as f64 + number(i, 0.1), 0.2 * across as f64 + number(i + 3, 0.1));
        let z = 6.0 + (y % 10.0 - 5.0).abs() + number(i + 5, 0.05);
        let gray = (number(i, 60_000.0)) as u16;
        let point = las::Point {
            x,
            y,
            z,
            intensity: gray / 8,
            gps_time: Some(1e5 + i as f64 * 2e-6),
            color: Some(Color::new(gray, gray / 2, gray / 3)),
            ..las::Point::default()
        };
        writer.write_point(point).expect("a writable folder");
    }
    writer.close().expect("a writable folder");
}

/// A box with a gable.
const CORNERS: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [8.0, 0.0, 0.0],
    [8.0, 10.0, 0.0],
    [0.0, 10.0, 0.0],
    [0.0, 0.0, 6.0],
    [8.0, 0.0, 6.0],
    [8.0, 10.0, 6.0],
    [0.0, 10.0, 6.0],
    [4.0, 0.0, 9.0],
    [4.0, 10.0, 9.0],
];
const FACES: [&[usize]; 7] =
    [&[3, 2, 1, 0], &[0, 1, 5, 8, 4], &[2, 3, 7, 9, 6], &[1, 2, 6, 5], &[3, 0, 4, 7], &[5, 6, 9, 8], &[7, 4, 8, 9]];

/// Where the corners of a house stand; one object each.
fn house(house: usize) -> [[f64; 3]; 10] {
    let (east, north) = (15.0 * (house % 200) as f64, 20.0 * (house / 200) as f64);
    CORNERS.map(|[x, y, z]| [x + east + number(house, 1.0), y + north, z + number(house, 3.0)])
}

fn cityjson() -> String {
    let mut objects = String::new();
    let mut vertices = String::new();
    for i in 0..HOUSES {
        let separator = if i == 0 { "" } else { "," };
        let rings = FACES.map(|face| format!("[{:?}]", face.iter().map(|c| 10 * i + c).collect::<Vec<_>>()));
        let geometry = format!(r#"{{"type":"Solid","lod":"2.2","boundaries":[[{}]]}}"#, rings.join(","));
        let _ = write!(objects, r#"{separator}"house_{i:06}":{{"type":"Building","geometry":[{geometry}]}}"#);
        for (k, corner) in house(i).iter().enumerate() {
            let comma = if i + k == 0 { "" } else { "," };
            let _ = write!(vertices, "{comma}{:?}", corner.map(|v| (v * 1000.0).round() as i64));
        }
    }
    let head = r#""type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],"translate":[0,0,0]}"#;
    format!(r#"{{{head},"CityObjects":{{{objects}}},"vertices":[{vertices}]}}"#).replace(", ", ",")
}

fn citygml() -> String {
    let mut text = r#"<?xml version="1.0"?><CityModel xmlns="http://www.opengis.net/citygml/2.0" xmlns:b="http://www.opengis.net/citygml/building/2.0" xmlns:gml="http://www.opengis.net/gml">"#.to_owned();
    for i in 0..HOUSES {
        let _ = write!(
            text,
            "\n<cityObjectMember><b:Building gml:id=\"house_{i:06}\"><b:lod2Solid><gml:Solid><gml:exterior><gml:CompositeSurface>"
        );
        let corners = house(i);
        for face in FACES {
            text += "<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing><gml:posList srsDimension=\"3\">";
            for corner in face.iter().chain(&face[..1]) {
                let [x, y, z] = corners[*corner];
                let _ = write!(text, "{x:.3} {y:.3} {z:.3} ");
            }
            text += "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>";
        }
        text += "</gml:CompositeSurface></gml:exterior></gml:Solid></b:lod2Solid></b:Building></cityObjectMember>";
    }
    text + "\n</CityModel>\n"
}

fn obj() -> String {
    let mut text = String::new();
    for i in 0..HOUSES {
        let _ = writeln!(text, "o house_{i:06}");
        for [x, y, z] in house(i) {
            let _ = writeln!(text, "v {x:.3} {y:.3} {z:.3}");
        }
        for face in FACES {
            let _ = write!(text, "f");
            face.iter().for_each(|corner| {
                let _ = write!(text, " {}", CORNERS.len() * i + corner + 1);
            });
            text.push('\n');
        }
    }
    text
}
criterion_group! {
    name = benches;
    config = Criterion::default().warm_up_time(std::time::Duration::from_millis(500))
        .measurement_time(std::time::Duration::from_secs(3)).sample_size(10);
    targets = bench
}
criterion_main!(benches);
