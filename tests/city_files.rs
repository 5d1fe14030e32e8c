//! City files as a whole: the real models, and damaged ones.

mod needs;

use std::path::{Path, PathBuf};

use cityweld::synthetic::Block;
use cityweld::types::{CityDefect, CityError};
use cityweld::{CityModel, CityOptions, CityUp, Point3, Vector3, read_city};
use needs::shared;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/city").join(name)
}

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/sample/city.obj")
}

fn try_read(path: &Path) -> Result<CityModel, CityError> {
    read_city(path, &[], &CityOptions::default())
}

fn read(path: &Path) -> CityModel {
    try_read(path).unwrap_or_else(|error| panic!("{error}"))
}

/// In file coordinates.
fn vertices(model: &CityModel) -> Vec<Point3<f64>> {
    model.vertices.iter().map(|vertex| vertex + model.origin).collect()
}

fn count(model: &CityModel, is_it: impl Fn(&CityDefect) -> bool) -> u64 {
    model.warnings.iter().filter(|warning| is_it(&warning.defect)).map(|warning| warning.count).sum()
}

/// What must hold for any model, wherever it came from.
fn check(model: &CityModel) {
    assert!(!model.facets.is_empty());
    assert!(model.vertices.iter().all(|vertex| vertex.iter().all(|value| value.is_finite())));
    for facet in &model.facets {
        assert!(facet.outline.len() >= 3 && facet.area > 0.0 && !model.object_name(facet.object).is_empty());
        assert!((facet.plane.normal.norm() - 1.0).abs() < 1e-9);
        assert!(facet.outline.iter().all(|&corner| (corner as usize) < model.vertices.len()));
        assert!(facet.triangles.start < facet.triangles.end);
        for [a, b, c] in model.triangles_of(facet) {
            assert!((b - a).cross(&(c - a)).dot(&facet.plane.normal) > -1e-6);
        }
    }
}

#[test]
fn shared_models_load_with_their_counts() {
    let Some(shared) = shared("data/city") else { return };
    // Buildings and polygons as they stand in the files; triangles by the table of the data's README.
    let table = [
        ("model_denhaag/city.obj", 1990, 16209, 35592),
        ("model_denhaag/terrain.obj", 1, 5595, 5595),
        ("model_rotterdam/city.obj", 853, 14743, 37398),
        ("model_rotterdam/city_raw.obj", 134, 1686, 4153),
        ("model_delft/city.obj", 160, 5556, 5556),
        ("model_delft/terrain.obj", 6, 30481, 30481),
        ("model_ingolstadt/city.obj", 23, 43070, 71782),
        ("model_ingolstadt_big/city.glb", 54, 143337, 143337),
        ("model_symmetric/city.obj", 1, 9, 16),
    ];
    for (name, objects, polygons, triangles) in table {
        assert_counts(&shared.join(name), objects, polygons, triangles);
    }
}

#[test]
fn the_sample_loads_with_its_counts() {
    assert_counts(&sample(), 527, 7921, 19881);
}

/// A model holds the buildings, polygons and triangles of its file.
fn assert_counts(path: &Path, objects: usize, polygons: usize, triangles: usize) {
    let name = path.display();
    let model = read(path);
    check(&model);
    let left_out = count(&model, |defect| matches!(defect, CityDefect::ZeroArea | CityDefect::Tangled)) as usize;
    assert_eq!(model.objects.len(), objects, "{name}");
    // A polygon that is not planar stands as its triangles; of a polygon left out no triangle stands.
    let non_planar = count(&model, |defect| matches!(defect, CityDefect::NonPlanar { .. })) as usize;
    assert!(model.facets.len() >= polygons - left_out && model.facets.len() <= polygons + 12 * non_planar, "{name}");
    assert!(model.triangles.len() + 5 * left_out >= triangles && model.triangles.len() <= triangles, "{name}");
    assert!(left_out <= 1, "{name}: {:?}", model.warnings);
    let (low, high) = model.bounds().unwrap();
    assert!(low.coords.amax().max(high.coords.amax()) < 2000.0, "{name}: vertices are small");
}

#[test]
fn raw_coordinates_give_the_geometry_of_the_local_ones() {
    let Some(shared) = shared("data/city/model_rotterdam") else { return };
    let compared = assert_same_but_moved(&read(&shared.join("city_raw.obj")), &read(&shared.join("city.obj")));
    assert_eq!(compared, 1686);
}

#[test]
fn the_sample_in_national_coordinates_has_its_geometry() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("national.obj");
    let moved = std::fs::read_to_string(sample()).unwrap().lines().map(in_national_grid).collect::<String>();
    std::fs::write(&path, moved).unwrap();
    let local = read(&sample());
    assert_eq!(assert_same_but_moved(&read(&path), &local), local.facets.len());
}

/// From the local coordinates of the Rotterdam models to those of the national grid, metres.
const NATIONAL: [f64; 3] = [90400.0, 435400.0, 0.0];

/// A line of an OBJ file with millimetres, its vertex moved.
fn in_national_grid(line: &str) -> String {
    let Some(vertex) = line.strip_prefix("v ") else { return format!("{line}\n") };
    let moved =
        vertex.split_whitespace().zip(NATIONAL).map(|(v, by)| format!(" {:.3}", v.parse::<f64>().unwrap() + by));
    format!("v{}\n", moved.collect::<String>())
}

/// Every facet of the one is a facet of the other, moved; says how many.
fn assert_same_but_moved(national: &CityModel, local: &CityModel) -> usize {
    let offset = Vector3::from(NATIONAL);
    let (national_vertices, local_vertices) = (vertices(national), vertices(local));
    for facet in &national.facets {
        let name = national.object_name(facet.object);
        let outline =
            |of: &[u32], vertices: &[Point3<f64>]| of.iter().map(|&at| vertices[at as usize]).collect::<Vec<_>>();
        let expected = outline(&facet.outline, &national_vertices);
        let differs = |other: &[Point3<f64>]| {
            expected.iter().zip(other).map(|(a, b)| (a - (b + offset)).amax()).fold(0.0, f64::max)
        };
        let candidates = local
            .facets
            .iter()
            .filter(|other| other.outline.len() == facet.outline.len() && local.object_name(other.object) == name);
        let nearest =
            candidates.map(|other| differs(&outline(&other.outline, &local_vertices))).fold(f64::MAX, f64::min);
        assert!(nearest <= 1e-3, "{name}: a polygon is {nearest} m off");
    }
    national.facets.len()
}

#[test]
fn terrain_shares_the_citys_origin() {
    let Some(shared) = shared("data/city/model_denhaag") else { return };
    assert_terrain_joins(&shared.join("city.obj"), &shared.join("terrain.obj"), 5595);
}

#[test]
fn made_up_terrain_shares_the_samples_origin() {
    let folder = tempfile::tempdir().unwrap();
    let terrain = folder.path().join("terrain.obj");
    let mut text = String::new();
    let (low, high) = read(&sample()).bounds().unwrap();
    let corner = low + read(&sample()).origin;
    // Strips along x that undulate.
    for i in 0..20 {
        for (x, y) in [(0.0, i), (high.x - low.x, i), (high.x - low.x, i + 1), (0.0, i + 1)] {
            text += &format!("v {} {} {}\n", corner.x + x, corner.y + 20.0 * f64::from(y), 0.5 * f64::from(y % 3));
        }
        text += "f -4 -3 -2 -1\n";
    }
    std::fs::write(&terrain, text).unwrap();
    assert_terrain_joins(&sample(), &terrain, 20);
}

fn assert_terrain_joins(city: &Path, terrain: &Path, facets: usize) {
    let alone = read(city);
    let both = read_city(city, &[terrain.to_owned()], &CityOptions::default()).unwrap();
    check(&both);
    assert_eq!((both.origin, both.sources.len()), (alone.origin, 2));
    assert_eq!(both.facets.len(), alone.facets.len() + facets);
}

/// The sample with every line of one kind rewritten, read.
fn rewritten(kind: &str, rewrite: impl Fn(&[&str]) -> String) -> CityModel {
    let text = std::fs::read_to_string(sample()).unwrap();
    let line = |line: &str| match line.split_once(' ') {
        Some((word, rest)) if word == kind => {
            format!("{kind} {}\n", rewrite(&rest.split_whitespace().collect::<Vec<_>>()))
        }
        _ => format!("{line}\n"),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("city.obj");
    std::fs::write(&path, text.lines().map(line).collect::<String>()).unwrap();
    read(&path)
}

fn reversed(corners: &[&str]) -> String {
    corners.iter().rev().copied().collect::<Vec<_>>().join(" ")
}

#[test]
fn a_city_wound_inwards_is_turned_and_told_to_be_perhaps_a_mirror_image() {
    let (right, turned) = (read(&sample()), rewritten("f", reversed));
    let area = |m: &CityModel| m.facets.iter().map(|f| f.area).sum::<f64>();
    let same = right.facets.iter().zip(&turned.facets).filter(|(a, b)| a.plane.normal.dot(&b.plane.normal) > 0.0);
    let same_m2: f64 = same.map(|(facet, _)| facet.area).sum();
    assert!(same_m2 > 0.99 * area(&right), "{same_m2} of {}", area(&right));
    for city in [turned, rewritten("v", |v| [v[1], v[0], v[2]].join(" "))] {
        let told =
            city.warnings.iter().map(ToString::to_string).any(|w| w.contains("inside out") && w.contains("mirror"));
        assert!(told, "{:?}", city.warnings);
    }
    assert!(right.warnings.iter().all(|warning| !warning.to_string().contains("mirror")));
}

#[test]
fn one_house_is_the_same_in_every_format() {
    let obj = read(&data("good.obj"));
    assert_eq!(obj.warnings, []);
    for name in ["good.gltf", "good.glb"] {
        let model = read(&data(name));
        check(&model);
        assert_eq!(model.warnings, []);
        assert_eq!((&model.objects, model.origin), (&obj.objects, obj.origin));
        assert_eq!((model.facets.len(), model.triangles.len(), model.vertices.len()), (12, 12, 8));
        let area = |model: &CityModel| model.facets.iter().map(|facet| facet.area).sum::<f64>();
        assert!((area(&model) - area(&obj)).abs() < 1e-9);
        let facing_up = |model: &CityModel| -> f64 {
            model.facets.iter().filter(|facet| facet.plane.normal.z > 0.5).map(|facet| facet.area).sum()
        };
        assert_eq!(facing_up(&model), 6.0);
        assert_eq!(model.bounds(), obj.bounds());
    }
}

#[test]
fn what_obj_writers_do_otherwise_changes_nothing() {
    let good = read(&data("good.obj"));
    for name in ["bom_crlf.obj", "continued.obj", "latin1.obj"] {
        let model = read(&data(name));
        assert_eq!((vertices(&model), &model.triangles), (vertices(&good), &good.triangles), "{name}");
    }
    assert_eq!(read(&data("latin1.obj")).objects, ["Straße 7"]);
    let up = CityOptions::default().with_up(CityUp::Y);
    let turned = read_city(&data("good.obj"), &[], &up).unwrap();
    assert_eq!(vertices(&turned)[0], Point3::new(90851.0, 0.0, 435673.0));
}

#[test]
fn tolerated_defects_are_counted_with_their_first_place() {
    type IsIt = fn(&CityDefect) -> bool;
    let table: [(&str, u64, IsIt, &str); 9] = [
        ("non_planar.obj", 1, |defect| matches!(defect, CityDefect::NonPlanar { .. }), "non_planar.obj:11"),
        ("duplicate_vertices.obj", 1, |defect| *defect == CityDefect::DuplicateVertices, "duplicate_vertices.obj:16"),
        ("zero_area.obj", 2, |defect| *defect == CityDefect::ZeroArea, "object house, zero_area.obj:16"),
        ("mixed_orientation.obj", 1, |defect| *defect == CityDefect::WoundAgainstTheRest { facets: 1 }, ":11"),
        ("open_shell.obj", 1, |defect| matches!(defect, CityDefect::OpenShell { open_edges: 4, .. }), ":11"),
        (
            "doubled_wall.obj",
            1,
            |defect| *defect == CityDefect::DoubledReversed,
            "object neighbour, doubled_wall.obj:18",
        ),
        ("self_intersecting.obj", 1, |defect| *defect == CityDefect::SelfIntersecting, "self_intersecting.obj:21"),
        ("two_corners.obj", 2, |defect| *defect == CityDefect::TooFewCorners, "two_corners.obj:16"),
        ("unknown_lines.obj", 1, |defect| *defect == CityDefect::UnknownLines, "unknown_lines.obj:16"),
    ];
    for (name, expected, is_it, place) in table {
        let model = read(&data(name));
        check(&model);
        let warning = model.warnings.iter().find(|warning| is_it(&warning.defect));
        let warning = warning.unwrap_or_else(|| panic!("{name}: {:?}", model.warnings));
        assert_eq!(warning.count, expected, "{name}");
        assert!(warning.to_string().ends_with(place), "{warning}");
    }
}

#[test]
fn a_vertex_that_is_nowhere_takes_only_its_own_faces_away() {
    for name in ["nan.obj", "far.obj"] {
        let model = read(&data(name));
        check(&model);
        assert_eq!(model.facets.len(), 3, "{name}");
        let told: Vec<String> = model.warnings.iter().map(|warning| warning.to_string()).collect();
        assert!(told[0].starts_with("1 vertex is not finite or too far from zero, left out; first: "), "{told:?}");
        assert!(told[0].ends_with(":8") && told[1].starts_with("3 faces use such vertices, left out; "), "{told:?}");
    }
}

#[test]
fn damaged_files_are_refused_with_a_place() {
    let table = [
        ("empty.obj", "the file is empty", "empty.obj"),
        ("no_faces.obj", "the city has no faces: 8 vertices and no polygons", "no_faces.obj"),
        ("only_slivers.obj", "has no area", "only_slivers.obj"),
        ("comma.obj", "`435673,5` is not a number", "comma.obj:8)"),
        ("short_vertex.obj", "a vertex has 2 coordinates", "short_vertex.obj:8)"),
        ("index_out_of_range.obj", "face index 9 points outside the file, which has 8 vertices", "object house, "),
        ("index_out_of_range.obj", "", "index_out_of_range.obj:12)"),
        ("index_billions.obj", "face index 4000000000", "index_billions.obj:12)"),
        ("zero_index.obj", "face index 0 means nothing", "zero_index.obj:12)"),
        ("negative_index.obj", "counts back past the first vertex", "negative_index.obj:12)"),
        ("no_index.obj", "face corner `six` is not an index", "no_index.obj:12)"),
        ("points.ply", "this is a PLY cloud without faces", "points.ply"),
        ("city.city.json", "the city has no faces", "city.city.json"),
        ("solid.stl", "the city has no faces", "solid.stl"),
        ("city.gml", "a CityModel outside the namespaces of CityGML", "city.gml"),
        ("utf16.obj", "this is UTF-16 text", "utf16.obj"),
        ("noise.bin", "unknown format", "noise.bin"),
        ("not there.obj", "cannot read the file", "not there.obj"),
        ("truncated.glb", "the file is cut off: the header says", "byte 8, "),
        ("four_billion_file.glb", "says 4294967295 bytes", "byte 8, "),
        ("four_billion_json.glb", "says 4294967295 bytes", "byte 12, "),
        ("four_billion_binary.glb", "says 4294967295 bytes", "byte 616, "),
        ("four_billion_vertices.glb", "the accessor reaches to byte 48000000000", "object house, accessors[0], "),
        ("four_billion_zeros.glb", "too many for 892 bytes", "nodes[1]"),
        ("version_1.glb", "glTF version 1, expected 2", "byte 4, "),
        ("version_1.gltf", "glTF version 1.0, expected 2", "asset.version, "),
        ("nan.glb", "vertex 0 is not finite", "object house, meshes[0].primitives[0], "),
        ("no_buffer.glb", "the buffer says 4000 bytes", "buffers[0], "),
        ("index_out_of_range.gltf", "index 8 points outside the primitive's 8 vertices", "object house, "),
        ("beyond_buffer.gltf", "the bufferView reaches to byte 172, but there are 168", "bufferViews[1], "),
        ("float_indices.gltf", "accessor is Scalar F32, expected unsigned whole numbers", "accessors[1], "),
        ("narrow_stride.gltf", "byteStride 4 is smaller than an element", "bufferViews[0], "),
        ("own_child.gltf", "is its own ancestor", "nodes[0], "),
        ("missing_mesh.gltf", "mesh 3 does not exist, there are 1", "nodes[1], "),
        ("missing_accessor.gltf", "accessor 9 does not exist", "meshes[0].primitives[0], "),
        ("no_position.gltf", "POSITION", "meshes[0].primitives[0]"),
        ("no_faces.gltf", "the city has no faces", "no_faces.gltf"),
        ("draco.gltf", "KHR_draco_mesh_compression", "extensionsRequired, "),
        ("buffer_above.gltf", "only files in the same folder", "buffers[0], "),
        ("buffer_missing.gltf", "buffer `nowhere.bin` cannot be read", "buffers[0], "),
        ("bad_base64.gltf", "base64", "buffers[0], "),
        ("broken.gltf", "the JSON is broken", "JSON line 8 column 14, "),
    ];
    for (name, what, place) in table {
        let message = try_read(&data(name)).expect_err(name).to_string();
        assert!(message.contains(what) && message.contains(place) && message.contains(name), "{name}: {message}");
    }
}

/// Gives the bytes to the reader under this name, and holds what comes out to the promises.
fn survives(folder: &Path, name: &str, bytes: &[u8]) {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    match try_read(&path) {
        Ok(model) => check(&model),
        Err(error) => assert!(error.to_string().contains(name), "{error}"),
    }
}

#[test]
fn truncated_files_give_an_error_or_a_model() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["good.obj", "good.gltf", "good.glb"] {
        let bytes = std::fs::read(data(name)).unwrap();
        for length in 0..bytes.len() {
            survives(folder.path(), name, &bytes[..length]);
        }
    }
}

#[test]
fn flipped_bytes_give_an_error_or_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for name in ["good.obj", "duplicate_vertices.obj", "self_intersecting.obj", "good.gltf", "good.glb"] {
        let bytes = std::fs::read(data(name)).unwrap();
        for _ in 0..600 {
            let mut flipped = bytes.clone();
            for _ in 0..1 + random.next_u64() % 4 {
                let at = random.next_u64() as usize % flipped.len();
                flipped[at] = random.next_u64() as u8;
            }
            survives(folder.path(), name, &flipped);
        }
    }
}

#[test]
fn swapped_digits_give_an_error_or_a_model() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for name in ["good.obj", "good.gltf", "good.glb"] {
        let bytes = std::fs::read(data(name)).unwrap();
        let digits: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
        for _ in 0..600 {
            let mut changed = bytes.clone();
            for _ in 0..1 + random.next_u64() % 3 {
                changed[digits[random.next_u64() as usize % digits.len()]] = b'0' + (random.next_u64() % 10) as u8;
            }
            survives(folder.path(), name, &changed);
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_model() {
    let Some(path) = shared("data/city/model_ingolstadt/city.obj") else { return };
    assert_same_for_any_number_of_threads(|| read(&path));
}

#[test]
fn any_number_of_threads_gives_the_same_town() {
    // Some thousand facets: work for several threads.
    let town = Block::town(15, 10, 0);
    assert_same_for_any_number_of_threads(|| town.city().unwrap());
    assert_same_for_any_number_of_threads(|| read(&sample()));
}

fn assert_same_for_any_number_of_threads(model: impl Fn() -> CityModel + Sync) {
    let with_threads = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        format!("{:?}", pool.install(&model))
    };
    assert!(with_threads(1) == with_threads(3));
}
