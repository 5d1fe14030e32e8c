use std::path::Path;

use super::build::build;
use super::source::Source;
use super::*;
use crate::format::obj::read_obj;
use crate::geometry::{Point3, Vector3};

fn source(role: CityRole, text: &str) -> Source {
    Source::from_obj(Path::new("folder/block.obj"), role, read_obj(text.as_bytes()).unwrap())
}

pub(super) fn model(text: &str) -> CityModel {
    sound(build(vec![source(CityRole::City, text)]).unwrap())
}

/// Holds for every model, whatever it was read from.
fn sound(model: CityModel) -> CityModel {
    let mut next = 0;
    for facet in &model.facets {
        assert!((facet.object.0 as usize) < model.objects.len());
        assert_eq!(facet.triangles.start, next, "triangles lie in the order of facets");
        next = facet.triangles.end;
        assert!((facet.plane.normal.norm() - 1.0).abs() < 1e-12);
        let mut covered = 0.0;
        for [a, b, c] in model.triangles_of(facet) {
            let doubled = (b - a).cross(&(c - a));
            assert!(doubled.dot(&facet.plane.normal) >= -1e-9, "triangles run as their facet does");
            covered += doubled.norm() / 2.0;
        }
        assert!((covered - facet.area).abs() < 1e-4 * facet.area + 1e-9, "{covered} {}", facet.area);
    }
    assert_eq!(next as usize, model.triangles.len());
    assert!(model.triangles.iter().flatten().all(|&at| (at as usize) < model.vertices.len()));
    model
}

fn defects(model: &CityModel) -> Vec<(CityDefect, u64, Option<u32>)> {
    model.warnings.iter().map(|warning| (warning.defect.clone(), warning.count, warning.example.line)).collect()
}

/// A box of 2 x 3 x 4 with its sides outward, at a place of the national grid.
const BOX: &str = "o box\nv 90851 435670 0\nv 90853 435670 0\nv 90853 435673 0\nv 90851 435673 0\n\
    v 90851 435670 4\nv 90853 435670 4\nv 90853 435673 4\nv 90851 435673 4\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn a_box_has_six_outward_facets_and_nothing_to_warn_of() {
    let model = model(BOX);
    assert_eq!(model.warnings, []);
    assert_eq!((model.facets.len(), model.triangles.len(), model.vertices.len()), (6, 12, 8));
    let centre = nalgebra::center(&model.bounds().unwrap().0, &model.bounds().unwrap().1);
    assert!(model.facets.iter().all(|facet| facet.plane.signed_distance(&centre) < -0.9));
    let areas: Vec<f64> = model.facets.iter().map(|facet| facet.area).collect();
    assert_eq!(areas, [6.0, 6.0, 8.0, 12.0, 8.0, 12.0]);
}

#[test]
fn vertices_are_small_and_the_origin_gives_them_back() {
    let model = model(BOX);
    let (low, high) = model.bounds().unwrap();
    assert!(low.coords.amax() < 10.0 && high.coords.amax() < 10.0);
    assert_eq!(model.origin, model.origin.map(f64::round));
    assert_eq!(low + model.origin, Point3::new(90851.0, 435670.0, 0.0));
}

#[test]
fn one_stray_vertex_does_not_move_the_origin() {
    let model = model(&format!("{BOX}v 0 0 0\nf 1 2 9\n"));
    assert!((model.origin - Vector3::new(90852.0, 435671.0, 2.0)).amax() <= 3.0);
}

#[test]
fn files_share_one_origin_and_their_vertices() {
    let ground = "o ground\nv 90851 435670 0\nv 90853 435670 0\nv 90853 435600 0\nf 1 3 2\n";
    let sources = vec![source(CityRole::City, BOX), source(CityRole::Terrain, ground)];
    let model = sound(build(sources).unwrap());
    assert_eq!(model.vertices.len(), 9, "two corners of the ground are the box's");
    assert_eq!(model.objects, ["box", "ground"]);
    let roles: Vec<_> =
        model.sources.iter().map(|part| (part.role, part.facets.clone(), part.objects.clone())).collect();
    assert_eq!(roles, [(CityRole::City, 0..6, 0..1), (CityRole::Terrain, 6..7, 1..2)]);
    assert_eq!(model.warnings, [], "terrain is open by its nature");
}

#[test]
fn y_up_is_turned_to_z_up() {
    let file = read_obj(b"v 0 0 0\nv 1 0 0\nv 1 2 0\nf 1 2 3\n").unwrap();
    let mut source = Source::from_obj(Path::new("block.obj"), CityRole::City, file);
    source.turn(CityUp::Y);
    let model = build(vec![source]).unwrap();
    assert_eq!(model.vertices[2] + model.origin, Point3::new(1.0, 0.0, 2.0));
    assert_eq!(model.facets[0].plane.normal, Vector3::new(0.0, -1.0, 0.0));
}

#[test]
fn objects_are_buildings_and_in_a_lone_object_groups_are() {
    let faces = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    let names = |text: &str| model(&format!("{faces}{text}")).objects;
    assert_eq!(names("o A\ng roof\nf 1 2 3\ng wall\nf 1 2 3\no B\nf 1 2 3\n"), ["A", "B"]);
    assert_eq!(names("o scene\ng A\nf 1 2 3\ng B\nf 1 2 3\ng A\nf 1 2 3\n"), ["A", "B"]);
    assert_eq!(names("g A\nf 1 2 3\n"), ["A"]);
    assert_eq!(names("o A\ng a\nf 1 2 3\n"), ["A"]);
    assert_eq!(names("f 1 2 3\n"), ["block"]);
    assert_eq!(names("f 1 2 3\no A\nf 1 2 3\no A\nf 1 2 3\n"), ["block", "A", "A"]);
    assert_eq!(names("f 1 2 3\ng A\nf 1 2 3\n"), ["block", "A"]);
}

#[test]
fn non_planar_polygons_become_planar_triangles() {
    let model = model("o roof\nv 0 0 0\nv 10 0 0\nv 10 10 1\nv 0 10 0\nf 1 2 3 4\n");
    assert_eq!(model.facets.len(), 2);
    assert!(model.facets.iter().all(|facet| facet.outline.len() == 3));
    let [(CityDefect::NonPlanar { worst_m }, 1, Some(6)), ..] = defects(&model)[..] else {
        panic!("{:?}", model.warnings);
    };
    assert!((worst_m - 0.25).abs() < 0.01, "a corner a metre up lifts the mean plane by a quarter");
}

#[test]
fn rounding_to_the_files_digits_is_no_fold() {
    let model = model("v 0 0 0\nv 10 0 0.004\nv 10 10 0\nv 0 10 0.004\nf 1 2 3 4\n");
    assert_eq!(model.facets.len(), 1, "{:?}", model.warnings);
}

#[test]
fn faces_without_area_are_left_out() {
    let text = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 1 2 1 2\nf 1 2 4\n";
    let model = model(text);
    assert_eq!(model.facets.len(), 1);
    assert_eq!(defects(&model)[0], (CityDefect::ZeroArea, 3, Some(5)));
}

#[test]
fn repeated_corners_and_vertices_are_joined() {
    let model = model("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -0 0 0\nv 1 0 0\nf 1 2 2 3 4 5\nf 4 3 6 1\n");
    assert_eq!(model.facets[0].outline, [0, 1, 2, 3]);
    assert_eq!(defects(&model)[0], (CityDefect::DuplicateVertices, 2, Some(7)));
    assert_eq!(model.vertices.len(), 4);
}

#[test]
fn polygons_that_cross_themselves_get_a_corner_at_the_crossing() {
    let model = model("v 0 0 5\nv 3 0 5\nv 3 4 5\nv 4 4 5\nv 4 3 5\nv 0 3 5\nf 1 2 3 4 5 6\nf 1 2 3 4 5 6\n");
    assert!((model.facets[0].area - 10.0).abs() < 1e-12);
    assert_eq!(model.vertices.len(), 8, "each polygon adds its own crossing");
    assert_eq!(defects(&model)[0], (CityDefect::SelfIntersecting, 2, Some(7)));
    assert_eq!(model.vertices[6] + model.origin, Point3::new(3.0, 3.0, 5.0));
}

/// Every face of the text the other way round.
fn inside_out(text: &str) -> String {
    let turned = |line: &str| match line.strip_prefix("f ") {
        Some(corners) => format!("f {}\n", corners.split(' ').rev().collect::<Vec<_>>().join(" ")),
        None => format!("{line}\n"),
    };
    text.lines().map(turned).collect()
}

/// Normals of all facets, to a tenth.
fn normals(model: &CityModel) -> Vec<[i32; 3]> {
    model.facets.iter().map(|facet| facet.plane.normal.map(|c| (10.0 * c).round() as i32).into()).collect()
}

fn inside_out_objects(model: &CityModel) -> u64 {
    let is_it = |warning: &&CityWarning| matches!(warning.defect, CityDefect::InsideOut { .. });
    model.warnings.iter().filter(is_it).map(|warning| warning.count).sum()
}

#[test]
fn a_facet_wound_against_the_rest_is_turned() {
    let model = model(&BOX.replace("f 5 6 7 8", "f 8 7 6 5"));
    assert_eq!(defects(&model), [(CityDefect::WoundAgainstTheRest { facets: 1 }, 1, Some(11))]);
    assert_eq!(normals(&model), normals(&super::tests::model(BOX)));
}

#[test]
fn a_solid_wound_inwards_is_turned() {
    let model = model(&inside_out(BOX));
    assert_eq!(defects(&model), [(CityDefect::InsideOut { of: 1 }, 1, Some(10))]);
    assert_eq!(normals(&model), normals(&super::tests::model(BOX)));
    assert_eq!(model.facets[0].outline[0], 0, "the first corner stays the first");
}

#[test]
fn a_house_wound_inwards_without_ground_or_with_separate_walls_is_turned() {
    let no_ground = BOX.replace("f 4 3 2 1\n", "");
    // Every wall with corners of its own, a hair off its neighbours', as from a writer that shares none.
    let loose = "o loose\nv 0 0 0\nv 2 0 0\nv 2 0 4\nv 0 0 4\nv 2 0.001 0\nv 2 3 0\nv 2 3 4\nv 2 0.001 4\n\
        v 2 3.001 0\nv 0 3.001 0\nv 0 3.001 4\nv 2 3.001 4\nv 0 3.002 0\nv 0 0.002 0\nv 0 0.002 4\nv 0 3.002 4\n\
        v 0 0 4.001\nv 2 0 4.001\nv 2 3.001 4.001\nv 0 3.001 4.001\n\
        f 1 2 3 4\nf 5 6 7 8\nf 9 10 11 12\nf 13 14 15 16\nf 17 18 19 20\n";
    for text in [&no_ground, loose] {
        let (right, turned) = (model(text), model(&inside_out(text)));
        assert_eq!((inside_out_objects(&right), inside_out_objects(&turned)), (0, 1), "{:?}", right.warnings);
        assert_eq!(normals(&turned), normals(&right));
    }
}

#[test]
fn roofs_alone_look_up() {
    let roof = "o roof\nv 0 0 5\nv 9 0 5\nv 9 4 8\nv 0 4 8\nv 9 8 5\nv 0 8 5\nf 1 2 3 4\nf 4 3 5 6\n";
    assert_eq!(
        (normals(&model(roof)), normals(&model(&inside_out(roof)))),
        (vec![[0, -6, 8], [0, 6, 8]], vec![[0, -6, 8], [0, 6, 8]])
    );
}

#[test]
fn a_wall_that_stands_alone_stays_as_it_is() {
    let wall = "o wall\nv 0 0 0\nv 9 0 0\nv 9 0 3\nv 0 0 3\nf 1 2 3 4\n";
    for text in [wall.to_owned(), inside_out(wall)] {
        assert!(matches!(defects(&model(&text))[..], [(CityDefect::OpenShell { .. }, 1, _)]));
    }
    assert_ne!(normals(&model(wall)), normals(&model(&inside_out(wall))));
    // Two walls at a corner that disagree: nothing tells which is right.
    let corner = format!("{wall}v 9 9 0\nv 9 9 3\nf 2 3 6 5\n");
    assert!(defects(&model(&corner)).iter().any(|found| found.0 == CityDefect::MixedOrientation { edges: 1 }));
}

/// The box again, shrunk about its middle or moved, with corners counted from `first`.
fn further_box(scale: f64, shift: f64, first: usize) -> String {
    let corner = |at: usize| {
        let [x, y, z] = [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [0, 0, 4], [2, 0, 4], [2, 3, 4], [0, 3, 4]][at];
        let about = |value: i32, middle: f64| middle + scale * (f64::from(value) - middle);
        format!("v {} {} {}\n", 90851.0 + about(x, 1.0) + shift, 435670.0 + about(y, 1.5), about(z, 2.0))
    };
    let faces = [[4, 3, 2, 1], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];
    let face = |corners: [usize; 4]| format!("f {}\n", corners.map(|at| (at + first - 1).to_string()).join(" "));
    (0..8).map(corner).chain(faces.into_iter().map(face)).collect()
}

#[test]
fn solids_of_one_object_are_judged_each_and_a_cavity_goes_with_its_solid() {
    let apart = format!("{BOX}{}", inside_out(&further_box(0.9, 10.0, 9)));
    let both = model(&apart);
    assert_eq!(defects(&both)[0].0, CityDefect::WoundAgainstTheRest { facets: 6 });
    assert_eq!(normals(&both)[..6], normals(&both)[6..]);
    let cavity = format!("{BOX}{}", inside_out(&further_box(0.5, 0.0, 9)));
    assert_eq!(model(&cavity).warnings, []);
    let turned = model(&inside_out(&cavity));
    assert_eq!(inside_out_objects(&turned), 1);
    assert_eq!(normals(&turned), normals(&model(&cavity)));
}

#[test]
fn a_band_with_one_side_and_edges_of_many_facets_end_well() {
    let strip = |at: usize| {
        let (turn, half) = (at as f64 * std::f64::consts::TAU / 12.0, at as f64 * std::f64::consts::PI / 12.0);
        let rim = |side: f64| {
            let radius = 5.0 + side * half.cos();
            format!("v {} {} {}\n", radius * turn.cos(), radius * turn.sin(), side * half.sin())
        };
        rim(-1.0) + &rim(1.0)
    };
    let vertices: String = (0..12).map(strip).collect();
    let quads: String =
        (0..11).map(|at| format!("f {} {} {} {}\n", 2 * at + 1, 2 * at + 3, 2 * at + 4, 2 * at + 2)).collect();
    model(&format!("o band\n{vertices}{quads}f 23 2 1 24\n"));
    let fan: String = (0..300).map(|at| format!("v {at} 7 1\nf 1 2 -1\n")).collect();
    model(&format!("o fan\nv 0 0 0\nv 0 0 9\n{fan}"));
}

#[test]
fn terrain_wound_downwards_is_turned_as_a_whole() {
    // Mostly level, with one step that leans over: it is turned with the rest.
    let ground = "o field\nv 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nf 1 2 3 4\no quay\nv 9 0 0\nv 9 9 0\nv 8.9 9 -2\nv 8.9 0 -2\nf 5 8 7 6\n";
    let read = |text: &str| sound(build(vec![source(CityRole::City, BOX), source(CityRole::Terrain, text)]).unwrap());
    let (right, turned) = (read(ground), read(&inside_out(ground)));
    assert_eq!(normals(&turned), normals(&right));
    assert!(defects(&turned).contains(&(CityDefect::TerrainLooksDown, 1, Some(6))), "{:?}", turned.warnings);
    assert!(defects(&right).iter().all(|found| found.0 != CityDefect::TerrainLooksDown));
}

#[test]
fn a_city_inside_out_as_a_whole_may_be_a_mirror_image_and_the_warning_says_so() {
    let exchanged: String = BOX
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            ["v", x, y, z] => format!("v {y} {x} {z}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    let sentence = model(&exchanged).warnings[0].to_string();
    assert!(
        sentence.starts_with("1 object is wound inside out (of 1), turned; if the city is a mirror image"),
        "{sentence}"
    );
    let one_of_two = format!("{BOX}o other\n{}", inside_out(&further_box(1.0, 10.0, 9)));
    let sentence = model(&one_of_two).warnings[0].to_string();
    assert!(sentence.starts_with("1 object is wound inside out (of 2), turned; first: object other"), "{sentence}");
}

#[test]
fn many_walls_behind_each_other_are_judged_in_time() {
    let walls: String = (0..20_000)
        .map(|at| {
            let y = f64::from(at) * 0.01;
            format!("v 0 {y} 0\nv 9 {y} 0\nv 9 {y} 9\nv 0 {y} 9\nf -4 -3 -2 -1\n")
        })
        .collect();
    assert_eq!(model(&format!("o walls\n{walls}")).facets.len(), 20_000);
}

#[test]
fn names_from_files_are_shown_escaped() {
    let warned = model("o \x1b[31mred\u{9b}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").warnings[0].to_string();
    assert!(warned.contains("object \\u{1b}[31mred\\u{9b}, "), "{warned}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("city.obj");
    std::fs::write(&path, "o \x1b[2J\x07\nv 0 0 0\nf 1 2 \x1bx\n").unwrap();
    let refused = read_city(&path, &[], &CityOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("object \\u{1b}[2J\\u{7}, ") && !refused.contains('\x1b'), "{refused}");
}

#[test]
fn a_box_without_ground_is_an_open_shell() {
    let model = model(&BOX.replace("f 4 3 2 1\n", ""));
    assert_eq!(defects(&model), [(CityDefect::OpenShell { open_edges: 4, edges: 12 }, 1, Some(11))]);
}

#[test]
fn walls_that_stand_twice_are_told_by_their_sides() {
    let model = model(&format!("{BOX}f 6 7 8 5\no party wall\nf 8 5 1 4\n"));
    assert_eq!(model.facets.len(), 8, "none is left out");
    let found = defects(&model);
    assert!(found.contains(&(CityDefect::Doubled, 1, Some(16))), "{found:?}");
    assert!(found.contains(&(CityDefect::DoubledReversed, 1, Some(18))), "{found:?}");
}

#[test]
fn a_city_without_faces_is_refused_with_what_it_has() {
    let refused = |text: &str| build(vec![source(CityRole::City, text)]).unwrap_err().to_string();
    assert!(refused("v 0 0 0\nv 1 0 0\n").contains("2 vertices and no polygons"));
    assert!(refused("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").contains("one polygon, which has no area"));
}

#[test]
fn every_warning_is_one_sentence_with_a_place() {
    let text = format!("{BOX}f 1 2\nodd line\nf 1 1 2\no wall\nf 5 8 4 1\n");
    let sentences: Vec<String> = model(&text).warnings.iter().map(CityWarning::to_string).collect();
    assert_eq!(sentences[0], "1 line begins with an unknown word, passed over; first: block.obj:17");
    assert_eq!(sentences[1], "1 face has less than 3 corners, left out; first: block.obj:16");
    assert_eq!(sentences[2], "1 face has no area, left out; first: object box, block.obj:18");
}

#[test]
fn the_precision_is_what_the_writer_rounded_to() {
    let precision = |text: &str| model(text).sources[0].precision_m;
    assert_eq!(precision(BOX), 0.01, "whole metres are the shape, not rounding");
    assert_eq!(precision("v 0 0 0\nv 1.25 0 0\nv 1 1.5 0\nf 1 2 3\n"), 0.01);
    assert_eq!(precision("v 5500000.123 0 0\nv 5500001.456 0 0\nv 5500000 1.5 0\nf 1 2 3\n"), 0.001);
    assert_eq!(precision("v 0.123456789 0 0\nv 1 0.1 0\nv 0 1 0\nf 1 2 3\n"), 1e-6);
}

#[test]
fn a_subset_is_counted_anew() {
    let text = format!("{BOX}o wall\nv 90860 435670 0\nv 90861 435670 0\nv 90861 435670 1\nf 9 10 11\n");
    let model = model(&text);
    let kept = sound(model.subset(|facet| facet.0 == 1 || facet.0 == 6));
    assert_eq!((kept.facets.len(), kept.triangles.len(), kept.vertices.len()), (2, 3, 7));
    assert_eq!(kept.objects, ["box", "wall"]);
    assert_eq!(kept.origin, model.origin);
    assert_eq!(kept.sources[0].facets, 0..2);
    assert_eq!(kept.facets[1].plane, model.facets[6].plane);
    assert_eq!(model.subset(|facet| facet.0 == 6).objects, ["wall"]);
    assert!(model.subset(|_| false).bounds().is_none());
}

#[test]
fn what_is_written_as_obj_reads_back() {
    let model =
        model(&format!("{BOX}o wall\nv 90860.125 435670 0\nv 90861 435670 0\nv 90861 435670 1.001\nf 9 10 11\n"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("block.obj");
    model.write_obj(&path).unwrap();
    let again = read_city(&path, &[], &CityOptions::default()).unwrap();
    assert_eq!((&again.objects, &again.triangles), (&model.objects, &model.triangles));
    assert_eq!((&again.vertices, again.origin), (&model.vertices, model.origin));
}

#[test]
fn a_subset_of_a_model_made_by_hand_needs_no_files() {
    let made = CityModel { sources: Vec::new(), ..model(BOX) };
    assert_eq!(made.subset(|facet| facet.0 < 2).facets.len(), 2);
}

#[test]
fn other_units_and_frames_are_noticed() {
    let degrees = "v 4.3 52.07 10\nv 4.301 52.07 10\nv 4.301 52.071 10\nf 1 2 3\n";
    let sentence = model(degrees).warnings.last().unwrap().to_string();
    assert!(sentence.contains("units must be metres"), "{sentence}");
    let elsewhere = "v 51 70 0\nv 53 70 0\nv 53 73 0\nf 1 2 3\n";
    let model = build(vec![source(CityRole::City, BOX), source(CityRole::Terrain, elsewhere)]).unwrap();
    let sentence = model.warnings[0].to_string();
    assert!(sentence.starts_with("1 file lies far from the city (up to 444960 m;"), "{sentence}");
}

#[test]
fn many_copies_of_one_wall_are_counted_in_time() {
    let text = format!("{BOX}{}", "f 1 2 6 5\n".repeat(50_000));
    assert!(defects(&model(&text)).iter().any(|(defect, count, _)| *defect == CityDefect::Doubled && *count == 50_000));
}
