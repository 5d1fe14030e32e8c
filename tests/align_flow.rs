//! The whole alignment on a small made-up block: houses, ground, a cloud with noise and clutter, a start that is off.

use cityweld::geometry::{Start, StartSigmas, Vector3};
use cityweld::planes::PreparedCity;
use cityweld::reconstruction::Reconstruction;
use cityweld::synthetic::{Block, CaptureOptions, CloudOptions, Move, Offset, Ring, Station, Survey, sfm_from_city};
use cityweld::verdict::{Alignment, Verdict};
use cityweld::{AlignOptions, Up, align};

fn block(with_ground: bool) -> Block {
    Block::four_houses().with_ground(with_ground)
}

fn prepared(with_ground: bool) -> PreparedCity {
    PreparedCity::new(block(with_ground).city().unwrap())
}

/// Points on walls, and on the ground round the houses if asked for, 2 cm of noise, one in ten anywhere.
fn survey(with_ground: bool) -> Survey {
    let points_on_ground = if with_ground { 500 } else { 0 };
    block(with_ground).cloud(&CloudOptions { points_on_ground, seed: 5, ..CloudOptions::default() })
}

/// Metres for each unit of the reconstruction.
fn true_scale() -> f64 {
    sfm_from_city().scale.recip()
}

/// The truth, 7 m and 8 degrees off and 12 % too large.
const OFF: Offset = Offset { shift_m: [5.0, -5.0, 1.5], heading_rad: 8.0 * DEGREE, tilt_rad: [0.0; 2], scale: 1.12 };
const DEGREE: f64 = std::f64::consts::PI / 180.0;

fn start_off(offset: &Offset) -> Start {
    Start::with_default_sigmas(block(true).off(offset) * sfm_from_city().inverse())
}

fn options(seed: u64) -> AlignOptions {
    AlignOptions { seed, ..AlignOptions::new(start_off(&OFF)) }
}

fn run(with_ground: bool, options: &AlignOptions) -> Alignment {
    align(&prepared(with_ground), &survey(with_ground).sfm, None, options, &|_, _, _| ())
}

/// Largest error over the block's corners, horizontally and along up.
fn errors(alignment: &Alignment) -> (f64, f64) {
    let Move { level_m, up_m } = block(true).move_by(&(alignment.best.unwrap() * sfm_from_city()));
    (level_m, up_m)
}

#[test]
fn finds_the_block_from_a_start_that_is_off() {
    let alignment = run(true, &options(0));
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    let (level, up) = errors(&alignment);
    assert!(level < 0.03 && up < 0.03, "off by {level} m, {up} m");
}

#[test]
fn finds_the_block_from_photographs_with_their_cameras_and_superpixels() {
    let block = Block::mixed_houses().with_ground(true);
    let stations: Vec<Station> = [Ring::street(16), Ring::drone(16)].iter().flat_map(|r| r.stations(&block)).collect();
    let survey = block.capture(&stations, &CaptureOptions::default());
    let start = Start::with_default_sigmas(block.off(&OFF) * survey.city_from_sfm);
    let city = PreparedCity::new(block.city().unwrap());
    for superpixels in [None, Some(survey.superpixels(60.0))] {
        let options = AlignOptions { start, ..options(0) };
        let alignment = align(&city, &survey.sfm, superpixels.as_ref(), &options, &|_, _, _| ());
        assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
        let off = block.move_by(&(alignment.best.unwrap() * survey.city_from_sfm.inverse()));
        assert!(off.level_m < 0.03 && off.up_m < 0.03, "{off:?}");
    }
}

#[test]
fn walls_alone_leave_the_height_open() {
    let alignment = run(false, &options(0));
    assert_eq!(alignment.verdict, Verdict::Undetermined, "{}", alignment.reason);
    assert!(alignment.reason.contains("along up"), "{}", alignment.reason);
    let open: Vec<&str> = alignment.freedoms.iter().filter(|f| !f.determined).map(|f| f.name.as_str()).collect();
    assert_eq!(open, ["along up"]);
    let (level, _) = errors(&alignment);
    assert!(level < 0.03, "off by {level} m");
}

fn with_scale(scale: f64, start: Start) -> Alignment {
    run(true, &AlignOptions { start, fixed_scale: Some(scale), ..options(0) })
}

#[test]
fn holds_a_scale_that_is_given() {
    let alignment = with_scale(true_scale(), start_off(&OFF));
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    assert_eq!(alignment.best.unwrap().scale.to_bits(), true_scale().to_bits());
    let (level, up) = errors(&alignment);
    assert!(level < 0.03 && up < 0.03, "off by {level} m, {up} m");
    let scale: Vec<_> = alignment.freedoms.iter().filter(|f| f.name == "scale").collect();
    assert_eq!(scale.len(), 1, "{:?}", alignment.freedoms);
    assert!(scale[0].given && scale[0].determined && scale[0].sigma == 0.0, "given, so exact: {:?}", scale[0]);
}

#[test]
fn a_wrong_scale_that_is_given_comes_back_as_it_is_and_is_told() {
    for share in [0.95, 1.05] {
        let wrong = share * true_scale();
        let alignment = with_scale(wrong, start_off(&OFF));
        assert_ne!(alignment.verdict, Verdict::Aligned, "{share}: {}", alignment.reason);
        if let Some(best) = alignment.best {
            assert_eq!(best.scale.to_bits(), wrong.to_bits(), "{share}: {}", alignment.reason);
        }
        // To a thousandth: the data's own scale is an estimate.
        let numbers: Vec<f64> = alignment.reason.split([' ', ',', ';']).filter_map(|word| word.parse().ok()).collect();
        for scale in [true_scale(), wrong] {
            let is_told = numbers.iter().any(|number| (number / scale - 1.0).abs() < 1e-3);
            assert!(is_told, "{share}: {scale} is not in: {}", alignment.reason);
        }
    }
}

#[test]
fn a_given_scale_replaces_the_start_s_about_the_start_s_centre() {
    let doubled = start_off(&Offset { scale: 2.0, ..OFF });
    let alignment = with_scale(true_scale(), doubled);
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    assert_eq!(alignment.best.unwrap().scale.to_bits(), true_scale().to_bits());
    let (level, up) = errors(&alignment);
    assert!(level < 0.03 && up < 0.03, "off by {level} m, {up} m");
}

/// The start, leaning by 17 degrees and owning to it.
fn leaning(seed: u64) -> AlignOptions {
    let leans = start_off(&Offset { tilt_rad: [0.25, -0.17], ..OFF });
    let sigmas = StartSigmas { tilt_rad: 10.0 * DEGREE, ..StartSigmas::default() };
    let start = Start::new(*leans.city_from_sfm(), sigmas).unwrap();
    AlignOptions { start, up: Up::None, ..options(seed) }
}

#[test]
fn turns_freely_where_up_is_not_used() {
    let alignment = run(true, &leaning(0));
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    let (level, up) = errors(&alignment);
    assert!(level < 0.03 && up < 0.03, "off by {level} m, {up} m");
}

#[test]
fn the_result_names_the_configuration_that_searched() {
    let scaled = |up| AlignOptions { fixed_scale: Some(true_scale()), up, ..options(0) };
    let solver = |options: &AlignOptions| run(true, options).search.solver;
    assert_eq!(solver(&options(0)), "upright similarity (2,1,1,1)");
    assert_eq!(solver(&scaled(Up::Auto)), "upright rigid (2,1,1)");
    assert_eq!(solver(&AlignOptions { up: Up::None, ..options(0) }), "similarity (3,2,1,1)");
    // Three planes are fewer than four; which of the configurations on three is cheapest is for the data to say.
    let rigid = solver(&scaled(Up::None));
    assert!(rigid.starts_with("rigid (3,") && rigid.matches(',').count() == 2, "{rigid}");
}

#[test]
fn a_single_wall_feeds_no_search_that_turns_freely() {
    let wall = Reconstruction { points: survey(false).sfm.points[..150].to_vec(), ..Reconstruction::default() };
    let free = AlignOptions { up: Up::None, ..options(0) };
    let alignment = align(&prepared(true), &wall, None, &free, &|_, _, _| ());
    assert_eq!((alignment.verdict, alignment.search.solver.as_str()), (Verdict::Failed, "none"));
    assert_eq!(alignment.search.samples, 0);
}

#[test]
fn says_failed_where_the_city_is_another() {
    let mut elsewhere = options(0);
    let mut off = *elsewhere.start.city_from_sfm();
    off.translation += Vector3::new(45.0, 40.0, 0.0);
    elsewhere.start = elsewhere.start.about(off);
    let alignment = run(true, &elsewhere);
    assert_ne!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
}

#[test]
fn gives_the_same_numbers_for_any_number_of_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(true, &options(3)))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.best, three.best);
    assert_eq!(one.covariance, three.covariance);
    assert_eq!(one.reason, three.reason);
}
