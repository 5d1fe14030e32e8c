//! Alignment without a start: a made-up town, whole or in part, and what is said where no place can be told.

use cityweld::synthetic::{Block, CloudOptions, House, Move, Survey, sfm_from_city};
use cityweld::{
    AlignOptions, Alignment, Disc, Place, PlacePrior, Point3, PreparedCity, Similarity, Up, Vector3, Verdict, align,
};

fn town() -> Block {
    Block::town(4, 3, 11).with_ground()
}

/// Points on all of a town, 2 cm of noise, one in ten anywhere.
fn survey() -> Survey {
    let seen = CloudOptions { points_on_ground: 900, points_per_roof: 60, seed: 5, ..CloudOptions::default() };
    town().cloud(&seen)
}

fn prepared(block: &Block) -> PreparedCity {
    PreparedCity::new(block.city().unwrap())
}

fn found(block: &Block, options: &AlignOptions) -> Alignment {
    align(&prepared(block), &survey().sfm, None, options, &()).unwrap()
}

/// Largest error over the town's corners, horizontally and along up.
fn errors(alignment: &Alignment) -> (f64, f64) {
    let Move { level_m, up_m } = town().move_by(&(alignment.best_candidate.unwrap() * sfm_from_city()));
    (level_m, up_m)
}

fn assert_right(alignment: &Alignment) {
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    let (level, up) = errors(alignment);
    assert!(level < 0.1 && up < 0.1, "off by {level} m, {up} m");
}

#[test]
fn a_town_is_found_with_nothing_known_of_scale_heading_and_position() {
    let alignment = found(&town(), &AlignOptions::anywhere(PlacePrior::default()));
    assert_right(&alignment);
    assert_eq!(alignment.search.solver, "walls in plan");
    assert!(alignment.certainty.search_bits > 10.0, "{:?}", alignment.certainty);
}

/// Houses of other sizes at other places: towns of one generator share the corners of their plots.
fn another_town() -> Block {
    let off = |k: usize, step: f64| 9.0 * (k as f64 * step).sin();
    let houses = Block::town(4, 3, 12).houses;
    let moved = houses.into_iter().enumerate().map(|(k, house)| house.at([off(k, 2.3), off(k, 5.7), 0.0]));
    Block::new(moved.collect()).with_ground()
}

#[test]
fn another_town_is_never_aligned_with() {
    let alignment = found(&another_town(), &AlignOptions::anywhere(PlacePrior::default()));
    assert_eq!(alignment.verdict, Verdict::Failed, "{}", alignment.reason);
}

/// Nothing but a start could tell them apart: their scale is unknown.
#[test]
fn a_larger_twin_of_the_town_elsewhere_in_the_city_is_told_as_well() {
    let mut twin = Block::town(4, 3, 11);
    let corners = twin.houses.iter_mut().flat_map(|house| &mut house.faces).flat_map(|face| &mut face.corners);
    corners.for_each(|corner| *corner = Point3::from(corner.coords * 1.25 + Vector3::new(400.0, 150.0, 0.0)));
    let both = Block::new(Block::town(4, 3, 11).houses.into_iter().chain(twin.houses).collect()).with_ground();
    let alignment = found(&both, &AlignOptions::anywhere(PlacePrior::default()));
    assert_eq!(alignment.verdict, Verdict::Ambiguous, "{}", alignment.reason);
    let best = alignment.best_candidate.unwrap().scale;
    let is_twin = |scale: f64| (scale / best - 1.25).abs() < 0.01 || (best / scale - 1.25).abs() < 0.01;
    assert!(alignment.alternatives.iter().any(|other| is_twin(other.city_from_sfm.scale)), "{alignment:?}");
}

#[test]
fn what_is_known_of_the_place_narrows_the_search_and_a_wrong_place_finds_nothing() {
    let middle = town().middle();
    let near = |center: [f64; 2]| PlacePrior { near: Some(Disc { center, radius_m: 15.0 }), ..PlacePrior::default() };
    let right = found(&town(), &AlignOptions::anywhere(near([middle.x + 5.0, middle.y])));
    assert_right(&right);
    let everywhere = found(&town(), &AlignOptions::anywhere(PlacePrior::default()));
    assert!(right.search.samples < everywhere.search.samples);
    let wrong = found(&town(), &AlignOptions::anywhere(near([middle.x + 5000.0, middle.y])));
    assert_eq!(wrong.verdict, Verdict::Failed);
}

#[test]
fn a_given_scale_is_held_to_the_bit() {
    let scale = sfm_from_city().scale.recip();
    let alignment = found(&town(), &AlignOptions::anywhere(PlacePrior::default()).with_fixed_scale(scale));
    assert_right(&alignment);
    assert_eq!(alignment.best_candidate.unwrap().scale.to_bits(), scale.to_bits());
}

#[test]
fn a_cloud_in_the_city_s_own_coordinates_is_found_where_it_is() {
    let far = town().at([85_000.0, 447_000.0, 0.0]);
    let mut sfm = survey().sfm;
    let shift = Vector3::new(85_000.0, 447_000.0, 0.0);
    let city_from_sfm = sfm_from_city().inverse();
    sfm.points.iter_mut().for_each(|p| *p = city_from_sfm.apply(p) + shift);
    sfm.normals.iter_mut().for_each(|n| *n = city_from_sfm.rotation * *n);
    let alignment = align(&prepared(&far), &sfm, None, &AlignOptions::anywhere(PlacePrior::default()), &()).unwrap();
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    let found: Similarity = alignment.best_candidate.unwrap();
    assert!((found.scale - 1.0).abs() < 2e-3, "{}", found.scale);
    assert_ne!(alignment.search.solver, "walls in plan");
}

#[test]
fn walls_of_one_direction_are_said_before_anything_is_searched() {
    let street = Block::row(&House::flat([9.0, 12.0, 8.0]), 6, 9.0).with_ground();
    let mut seen = street.cloud(&CloudOptions { points_on_ground: 400, outlier_share: 0.0, ..CloudOptions::default() });
    let faces: Vec<_> = street.faces().cloned().collect();
    // The fronts on one side of the street, and the ground before them.
    let is_seen = |face: &Option<usize>| face.is_none_or(|f| faces.get(f).is_none_or(|face| is_front(&face.corners)));
    let mut keep = seen.face_of_point.iter().map(is_seen).collect::<Vec<_>>().into_iter();
    seen.sfm.points.retain(|_| keep.next() == Some(true));
    let up = Up::Given(sfm_from_city().rotation * Vector3::z());
    let options = AlignOptions::anywhere(PlacePrior::default()).with_up(up);
    let alignment = align(&prepared(&street), &seen.sfm, None, &options, &()).unwrap();
    assert_eq!((alignment.verdict, alignment.search.samples), (Verdict::Failed, 0), "{}", alignment.reason);
    assert!(alignment.reason.contains("one direction"), "{}", alignment.reason);
}

/// Upright, facing y.
fn is_front(corners: &[Point3<f64>]) -> bool {
    let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).normalize();
    normal.y.abs() > 0.9
}

#[test]
fn the_same_numbers_come_of_any_number_of_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| found(&town(), &AlignOptions::anywhere(PlacePrior::default())))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(format!("{:?}", one.best_candidate), format!("{:?}", three.best_candidate));
    assert_eq!(one.reason, three.reason);
}

#[test]
fn options_without_a_start_are_those_of_a_start_but_for_the_place() {
    let options = AlignOptions::anywhere(PlacePrior::default());
    assert_eq!(options.place, Place::Anywhere(PlacePrior::default()));
    assert_eq!((options.fixed_scale, options.seed), (None, 0));
}
