//! City files as offices publish them: what is in them, and what becomes of it. Small ones lie here, the rest in
//! `../shared/data/formats`.

mod needs;

use std::path::{Path, PathBuf};

use cityweld::types::{CityContents, CityError, KindCounts, Lod};
use cityweld::{CityModel, CityOptions, read_city, read_city_contents};
use needs::shared;

fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats/city").join(name)
}

fn read(path: &Path) -> CityModel {
    read_city(path, &[], &CityOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn contents(model: &CityModel) -> &CityContents {
    &model.sources[0].contents
}

/// Lowest and highest corner in file coordinates.
fn extent(model: &CityModel) -> [[f64; 3]; 2] {
    let (low, high) = model.bounds().unwrap();
    [(low + model.origin).into(), (high + model.origin).into()]
}

fn kinds(ground: usize, roof: usize, wall: usize) -> KindCounts {
    KindCounts { ground, roof, wall, ..KindCounts::default() }
}

/// Format, objects, parts, polygons by level, polygons with holes.
type Expected<'a> = (&'a str, usize, usize, &'a [(Option<Lod>, KindCounts)], usize);

fn check(model: &CityModel, (format, objects, parts, polygons, holes): Expected<'_>) {
    let found = contents(model);
    assert_eq!((found.format.as_str(), found.objects, found.parts, found.holes), (format, objects, parts, holes));
    assert_eq!(found.polygons.iter().map(|(lod, counts)| (*lod, *counts)).collect::<Vec<_>>(), polygons);
}

fn close(found: [[f64; 3]; 2], expected: [[f64; 3]; 2]) {
    let off = found.as_flattened().iter().zip(expected.as_flattened()).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-3, "{found:?}, expected {expected:?}");
}

const LOD_2: Option<Lod> = Some(Lod(2, 0));
const LOD_2_2: Option<Lod> = Some(Lod(2, 2));

#[test]
fn parts_belong_to_their_buildings_and_version_1_0_is_read() {
    let model = read(&own("DH_01_subs_v1.0.city.json"));
    check(&model, ("CityJSON 1.0", 4, 8, &[(LOD_2, kinds(9, 13, 48))], 0));
    assert_eq!((model.objects.len(), model.facets.len()), (4, 70));
    assert!(model.objects.contains(&"GUID_13974D93-CB4F-4B5A-AB1E-577DD9928CF2".to_owned()));
}

#[test]
fn a_sequence_is_read_with_the_vertices_of_each_feature() {
    let model = read(&own("3dbag_b2.city.jsonl"));
    check(&model, ("CityJSON 2.0 Seq", 2, 2, &[(LOD_2_2, kinds(2, 10, 65))], 0));
    close(extent(&model), [[84994.438, 446535.536, -0.276], [85022.194, 446562.148, 13.108]]);
    assert_eq!(model.facets.len(), 77);
    assert_eq!(model.sources[0].precision_m, 1e-3);
}

#[test]
fn one_of_four_levels_is_taken_and_never_a_footprint() {
    let model = read(&own("small.city.jsonl"));
    let footprints = KindCounts { unsaid: 3, ..KindCounts::default() };
    let levels = [
        (Some(Lod(0, 0)), footprints),
        (Some(Lod(1, 2)), kinds(3, 3, 16)),
        (Some(Lod(1, 3)), kinds(3, 4, 21)),
        (LOD_2_2, kinds(3, 6, 24)),
    ];
    check(&model, ("CityJSON 2.0 Seq", 3, 3, &levels, 0));
    assert_eq!((model.objects.len(), model.facets.len()), (3, 33));
}

#[test]
fn a_file_of_points_alone_is_no_city() {
    let error = read_city(&own("geometry_instance.city.json"), &[], &CityOptions::default()).unwrap_err();
    assert!(matches!(error, CityError::NoFaces { .. }), "{error}");
    assert!(error.to_string().contains("2 points and lines, passed over; first: object fixture"), "{error}");
    let contents = read_city_contents(&[own("geometry_instance.city.json")], &CityOptions::default()).unwrap();
    assert_eq!(
        (contents[0].1.format.as_str(), contents[0].1.objects, contents[0].1.polygons.len()),
        ("CityJSON 2.0", 1, 0)
    );
}

#[test]
fn shared_files_hold_what_their_readme_says() {
    let Some(shared) = shared("data/formats/city") else { return };
    let unsaid = |unsaid| KindCounts { unsaid, ..KindCounts::default() };
    let files: [(&str, Expected<'_>, usize); 4] = [
        ("DH_01_subs.city.json", ("CityJSON 1.1", 4, 8, &[(LOD_2, kinds(9, 13, 48))], 0), 70),
        // Twelve of its polygons have no area.
        ("rotterdam_subset.city.json", ("CityJSON 2.0", 16, 0, &[(LOD_2, kinds(16, 41, 191))], 0), 248 - 12),
        ("zurich_12.city.json", ("CityJSON 1.1", 12, 60, &[(LOD_2, kinds(12, 322, 507))], 2), 841),
        (
            "multi_lod.city.json",
            (
                "CityJSON 2.0",
                10,
                0,
                &[(Some(Lod(1, 2)), unsaid(180)), (Some(Lod(1, 3)), unsaid(224)), (LOD_2_2, kinds(60, 84, 204))],
                0,
            ),
            348,
        ),
    ];
    for (name, expected, facets) in files {
        let model = read(&shared.join(name));
        check(&model, expected);
        assert_eq!(model.facets.len(), facets, "{name}");
    }
    let zurich = read(&shared.join("zurich_12.city.json"));
    close(extent(&zurich), [[2678219.194, 1243583.906, 402.37], [2686115.578, 1252050.985, 533.89]]);
}

#[test]
fn shared_templates_are_put_at_their_places() {
    let Some(shared) = shared("data/formats/city") else { return };
    let model = read(&shared.join("geom_temp.city.jsonl"));
    let found = contents(&model);
    assert_eq!((found.objects, found.parts), (18, 0));
}
