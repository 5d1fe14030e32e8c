//! Bytes a second at which files become reconstructions and cities.
//!
//! `cargo bench --bench reading`
//!
//! The files are made up: a COLMAP model of 400 photographs in which 160,000 points have five observations each and two of
//! three keypoints no point, as binary and as text; a city of 20,000 houses as OBJ. They lie in the cache of the system.

use std::fmt::Write;
use std::path::Path;

use cityweld::{CityOptions, read_city, read_reconstruction};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const IMAGES: usize = 400;
const POINTS: usize = 160_000;
const TRACK: usize = 5;
const KEYPOINTS: usize = 3 * POINTS * TRACK / IMAGES;
const HOUSES: usize = 20_000;

fn bench(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [binary, text] = ["binary", "text"].map(|name| folder.path().join(name));
    write_binary(&binary);
    write_text(&text);
    let city = folder.path().join("city.obj");
    std::fs::write(&city, houses()).expect("a writable temporary folder");

    let mut group = criterion.benchmark_group("read");
    group.throughput(Throughput::Bytes(size_of(&binary)));
    group.bench_function("COLMAP binary", |b| b.iter(|| read_reconstruction(&binary).expect("a sound model")));
    group.throughput(Throughput::Bytes(size_of(&text)));
    group.bench_function("COLMAP text", |b| b.iter(|| read_reconstruction(&text).expect("a sound model")));
    group.throughput(Throughput::Bytes(size_of(&city)));
    let options = CityOptions::default();
    group.bench_function("OBJ", |b| b.iter(|| read_city(&city, &[], &options).expect("a sound city")));
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

/// Boxes with a gable each, one object a house.
fn houses() -> String {
    let corners = [
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
    let faces: [&[usize]; 7] =
        [&[3, 2, 1, 0], &[0, 1, 5, 8, 4], &[2, 3, 7, 9, 6], &[1, 2, 6, 5], &[3, 0, 4, 7], &[5, 6, 9, 8], &[7, 4, 8, 9]];
    let mut text = String::new();
    for house in 0..HOUSES {
        let (east, north) = (15.0 * (house % 200) as f64, 20.0 * (house / 200) as f64);
        let _ = writeln!(text, "o house_{house:06}");
        for [x, y, z] in corners {
            let _ =
                writeln!(text, "v {:.3} {:.3} {:.3}", x + east + number(house, 1.0), y + north, z + number(house, 3.0));
        }
        for face in faces {
            let _ = write!(text, "f");
            face.iter().for_each(|corner| {
                let _ = write!(text, " {}", corners.len() * house + corner + 1);
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
