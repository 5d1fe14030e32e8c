//! The whole alignment on a small made-up block: houses, ground, a cloud with noise and clutter, a start that is off.

use cityweld::internals::{Limits, patches};
use cityweld::synthetic::{Block, CaptureOptions, CloudOptions, Move, Offset, Ring, Station, Survey, sfm_from_city};
use cityweld::{
    AlignOptions, Alignment, CityModel, Point3, PreparedCity, Reconstruction, Start, StartSigmas, Up, Vector3, Verdict,
    align,
};

fn block(with_ground: bool) -> Block {
    if with_ground { Block::four_houses().with_ground() } else { Block::four_houses() }
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
    AlignOptions::new(start_off(&OFF)).with_seed(seed)
}

fn run(with_ground: bool, options: &AlignOptions) -> Alignment {
    align(&prepared(with_ground), &survey(with_ground).sfm, None, options, &()).unwrap()
}

/// Largest error over the block's corners, horizontally and along up.
fn errors(alignment: &Alignment) -> (f64, f64) {
    let Move { level_m, up_m } = block(true).move_by(&(alignment.best_candidate.unwrap() * sfm_from_city()));
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
    let block = Block::mixed_houses().with_ground();
    let stations: Vec<Station> = [Ring::street(16), Ring::drone(16)].iter().flat_map(|r| r.stations(&block)).collect();
    let survey = block.capture(&stations, &CaptureOptions::default());
    let start = Start::with_default_sigmas(block.off(&OFF) * survey.city_from_sfm);
    let city = PreparedCity::new(block.city().unwrap());
    for superpixels in [None, Some(survey.superpixels(60.0))] {
        let options = AlignOptions::new(start);
        let alignment = align(&city, &survey.sfm, superpixels.as_ref(), &options, &()).unwrap();
        assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
        let off = block.move_by(&(alignment.best_candidate.unwrap() * survey.city_from_sfm.inverse()));
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
    run(true, &AlignOptions::new(start).with_fixed_scale(scale))
}

#[test]
fn holds_a_scale_that_is_given() {
    let alignment = with_scale(true_scale(), start_off(&OFF));
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    assert_eq!(alignment.best_candidate.unwrap().scale.to_bits(), true_scale().to_bits());
    let (level, up) = errors(&alignment);
    assert!(level < 0.03 && up < 0.03, "off by {level} m, {up} m");
    let scale: Vec<_> = alignment.freedoms.iter().filter(|f| f.name == "scale").collect();
    assert_eq!(scale.len(), 1, "{:?}", alignment.freedoms);
    assert!(scale[0].given && scale[0].determined && scale[0].sigma == 0.0, "given, so exact: {:?}", scale[0]);
}

#[test]
fn a_wrong_scale_that_is_given_is_told_beside_that_of_the_data_and_the_best_pose_is_of_theirs() {
    for share in [0.95, 1.05] {
        let wrong = share * true_scale();
        let alignment = with_scale(wrong, start_off(&OFF));
        assert_eq!(alignment.verdict, Verdict::Undetermined, "{share}: {}", alignment.reason);
        // A pose of the wrong scale would be wrong everywhere.
        let off = alignment.best_candidate.unwrap().scale / true_scale() - 1.0;
        assert!(off.abs() < 1e-3, "{share}: {off}, {}", alignment.reason);
        let (level, up) = errors(&alignment);
        assert!(level < 0.03 && up < 0.03, "{share}: off by {level} m, {up} m");
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
    assert_eq!(alignment.best_candidate.unwrap().scale.to_bits(), true_scale().to_bits());
    let (level, up) = errors(&alignment);
    assert!(level < 0.03 && up < 0.03, "off by {level} m, {up} m");
}

/// The start, leaning by 17 degrees and owning to it.
fn leaning(seed: u64) -> AlignOptions {
    let leans = start_off(&Offset { tilt_rad: [0.25, -0.17], ..OFF });
    let sigmas = StartSigmas { tilt_rad: 10.0 * DEGREE, ..StartSigmas::default() };
    let start = Start::new(*leans.city_from_sfm(), sigmas).unwrap();
    AlignOptions::new(start).with_up(Up::None).with_seed(seed)
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
    let scaled = |up| options(0).with_fixed_scale(true_scale()).with_up(up);
    let solver = |options: &AlignOptions| run(true, options).search.solver;
    assert_eq!(solver(&options(0)), "upright similarity (2,1,1,1)");
    assert_eq!(solver(&scaled(Up::Auto)), "upright rigid (2,1,1)");
    assert_eq!(solver(&options(0).with_up(Up::None)), "similarity (3,2,1,1)");
    // Three planes are fewer than four; which of the configurations on three is cheapest is for the data to say.
    let rigid = solver(&scaled(Up::None));
    assert!(rigid.starts_with("rigid (3,") && rigid.matches(',').count() == 2, "{rigid}");
}

#[test]
fn a_single_wall_feeds_no_search_that_turns_freely() {
    let wall = Reconstruction { points: survey(false).sfm.points[..150].to_vec(), ..Reconstruction::default() };
    let free = options(0).with_up(Up::None);
    let alignment = align(&prepared(true), &wall, None, &free, &()).unwrap();
    assert_eq!((alignment.verdict, alignment.search.solver.as_str()), (Verdict::Failed, "none"));
    assert_eq!(alignment.search.samples, 0);
}

#[test]
fn says_failed_where_the_city_is_another() {
    let start = start_off(&OFF);
    let mut elsewhere = *start.city_from_sfm();
    elsewhere.translation += Vector3::new(45.0, 40.0, 0.0);
    let alignment = run(true, &AlignOptions::new(start.about(elsewhere)));
    assert_ne!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
}

#[test]
fn gives_the_same_numbers_for_any_number_of_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(true, &options(3)))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.best_candidate, three.best_candidate);
    assert_eq!(one.covariance, three.covariance);
    assert_eq!(one.reason, three.reason);
}

/// What is said where nothing can be found, and that it was said before any search.
fn refusal(city: &PreparedCity, reconstruction: &Reconstruction, start: Start) -> String {
    let alignment = align(city, reconstruction, None, &AlignOptions::new(start), &()).unwrap();
    assert_eq!((alignment.verdict, alignment.best_candidate), (Verdict::Failed, None), "{}", alignment.reason);
    assert_eq!((alignment.search.samples, alignment.search.solver.as_str()), (0, "none"), "{}", alignment.reason);
    assert!(alignment.freedoms.is_empty() && alignment.alternatives.is_empty() && alignment.evidence.is_empty());
    assert_finite(&alignment);
    alignment.reason
}

#[test]
fn what_stands_in_the_way_of_any_alignment_is_named_without_a_search() {
    let (city, seen) = (prepared(true), survey(true).sfm);
    let reason = refusal(&PreparedCity::new(CityModel::default()), &seen, start_off(&OFF));
    assert!(reason.contains("the city model has no facets"), "{reason}");
    let reason = refusal(&city, &Reconstruction::default(), start_off(&OFF));
    assert!(reason.contains("the reconstruction has no points"), "{reason}");
    let photographs = block(true).capture(&Ring::street(5).stations(&block(true)), &CaptureOptions::default()).sfm;
    let only_images = Reconstruction { points: Vec::new(), track_starts: Vec::new(), ..photographs };
    let reason = refusal(&city, &only_images, start_off(&OFF));
    assert!(reason.contains("no points, only 5 images") && reason.contains("point_triangulator"), "{reason}");
    // Too few points for a plane, and points that are nowhere on one.
    let few = Reconstruction { points: seen.points[..7].to_vec(), ..Reconstruction::default() };
    let reason = refusal(&city, &few, start_off(&OFF));
    assert!(reason.contains("no planar patch among 7 points"), "{reason}");
    let one_place = Reconstruction { points: vec![seen.points[0]; 500], ..Reconstruction::default() };
    let reason = refusal(&city, &one_place, start_off(&OFF));
    assert!(reason.contains("no planar patch among 500 points"), "{reason}");
}

#[test]
fn a_start_that_cannot_reach_the_city_is_refused_with_both_places_and_the_distance() {
    let mut far = *start_off(&OFF).city_from_sfm();
    far.translation += Vector3::new(0.0, 5.78e6, 0.0);
    let reason = refusal(&prepared(true), &survey(true).sfm, Start::with_default_sigmas(far));
    // The cloud's middle is 5,780 km north of a block that lies within a hundred metres of the frame's origin.
    for told in ["5,780 km from the city", "57800", "the city lies from -", "same frame and unit"] {
        assert!(reason.contains(told), "{told:?} is not in: {reason}");
    }
    // The same start with sigmas that reach so far is searched, and finds nothing worse than a verdict.
    let vast = StartSigmas { position_m: 1e7, ..StartSigmas::default() };
    let start = Start::new(far, vast).unwrap();
    let alignment = run(true, &AlignOptions::new(start));
    assert!(alignment.search.samples > 0, "{}", alignment.reason);
    assert_finite(&alignment);
}

/// No number that is none, anywhere in a result.
fn assert_finite(alignment: &Alignment) {
    let mut numbers = vec![alignment.radius, alignment.support.rms_m, alignment.support.median_m];
    numbers.extend(alignment.origin.iter().chain(alignment.center.iter()).chain(alignment.covariance.iter().flatten()));
    for found in alignment.best_candidate.iter().chain(alignment.alternatives.iter().map(|a| &a.city_from_sfm)) {
        numbers.push(found.scale);
        numbers.extend(found.rotation.matrix().iter().chain(found.translation.iter()));
    }
    numbers.extend(alignment.alternatives.iter().map(|a| a.weight));
    numbers.extend(alignment.freedoms.iter().flat_map(|f| [f.sigma, f.direction.x, f.direction.y, f.direction.z]));
    numbers.extend(alignment.evidence.iter().map(|e| e.rms_m));
    assert!(numbers.iter().all(|v| v.is_finite()), "{alignment:?}");
    assert!(!alignment.reason.contains("NaN") && !alignment.reason.contains("inf"), "{}", alignment.reason);
    assert!(alignment.freedoms.iter().all(|f| f.sigma >= 0.0), "{:?}", alignment.freedoms);
}

#[test]
fn a_start_with_sigmas_of_zero_gives_finite_numbers_everywhere() {
    let zero = StartSigmas { position_m: 0.0, height_m: 0.0, heading_rad: 0.0, tilt_rad: 0.0, log_scale: 0.0 };
    let truth = start_off(&Offset::default());
    for (start, fixed_scale, up) in [
        (truth, None, Up::Auto),
        (truth, Some(true_scale()), Up::Auto),
        (truth, None, Up::None),
        (start_off(&OFF), None, Up::Auto),
        (start_off(&OFF), Some(true_scale()), Up::None),
    ] {
        let start = Start::new(*start.city_from_sfm(), zero).unwrap();
        for with_ground in [true, false] {
            let alignment = run(with_ground, &AlignOptions::new(start).with_fixed_scale(fixed_scale).with_up(up));
            assert_finite(&alignment);
            // What is sure may be refused for a millimetre, but nothing far from it is found.
            if let Some(best) = alignment.best_candidate {
                let off = block(true).move_by(&(best * start.city_from_sfm().inverse()));
                assert!(off.level_m < 1.5 && off.up_m < 1.5, "{off:?}: {}", alignment.reason);
            }
        }
    }
}

#[test]
fn sigmas_of_ten_thousand_kilometres_find_the_block() {
    let vast = StartSigmas { position_m: 1e7, height_m: 1e7, ..StartSigmas::default() };
    let start = Start::new(*start_off(&OFF).city_from_sfm(), vast).unwrap();
    let alignment = run(true, &AlignOptions::new(start));
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    let (level, up) = errors(&alignment);
    assert!(level < 0.03 && up < 0.03, "off by {level} m, {up} m");
    assert_finite(&alignment);
}

#[test]
fn points_that_are_given_twice_or_in_another_order_change_nothing() {
    let survey = survey(true).sfm;
    let found = |points: Vec<Point3<f64>>| {
        let cloud = Reconstruction { points, ..Reconstruction::default() };
        align(&prepared(true), &cloud, None, &options(2), &()).unwrap()
    };
    let once = found(survey.points.clone());
    let twice = found([survey.points.clone(), survey.points.clone()].concat());
    let backwards = found(survey.points.iter().rev().copied().collect());
    // Every seventh point first, then those after them, and so on.
    let shuffled = found((0..7).flat_map(|k| survey.points.iter().skip(k).step_by(7)).copied().collect());
    assert_eq!(once.verdict, Verdict::Aligned, "{}", once.reason);
    for other in [&twice, &backwards, &shuffled] {
        assert_eq!(
            (once.best_candidate, once.verdict, &once.reason),
            (other.best_candidate, other.verdict, &other.reason)
        );
        assert_eq!(once.covariance, other.covariance);
    }
    assert!(once.warnings.iter().all(|w| !w.contains("place of another")), "{:?}", once.warnings);
    let copies = format!("{} points stand at the place of another", survey.points.len());
    assert!(twice.warnings.iter().any(|w| w.starts_with(&copies)), "{:?}", twice.warnings);
}

#[test]
fn one_prepared_city_serves_two_alignments_in_either_order_as_fresh_ones_would() {
    let jobs = [(true, options(0)), (false, options(1)), (true, options(2).with_fixed_scale(true_scale()))];
    let on = |city: &PreparedCity, (with_ground, options): &(bool, AlignOptions)| {
        let alignment = align(city, &survey(*with_ground).sfm, None, options, &()).unwrap();
        (alignment.best_candidate, alignment.covariance, alignment.reason, alignment.search.samples)
    };
    let fresh: Vec<_> = jobs.iter().map(|job| on(&prepared(true), job)).collect();
    let shared = prepared(true);
    let in_order: Vec<_> = jobs.iter().map(|job| on(&shared, job)).collect();
    let shared = prepared(true);
    let mut backwards: Vec<_> = jobs.iter().rev().map(|job| on(&shared, job)).collect();
    backwards.reverse();
    assert_eq!(fresh, in_order);
    assert_eq!(fresh, backwards);
}

#[test]
fn the_covariance_is_about_the_centre_of_the_scene_and_holds_the_sigmas_of_the_freedoms() {
    // So little is known beforehand that the data alone make the sigmas.
    let wide = StartSigmas { position_m: 100.0, height_m: 100.0, heading_rad: 3.0, tilt_rad: 1.0, log_scale: 1.0 };
    for fixed_scale in [None, Some(true_scale())] {
        let start = Start::new(*start_off(&OFF).city_from_sfm(), wide).unwrap();
        let alignment = run(true, &AlignOptions::new(start).with_fixed_scale(fixed_scale));
        assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
        let r = alignment.radius;
        let middle = patches(&survey(true).sfm, None, &Limits::default().patches).middle();
        assert!(
            (alignment.best_candidate.unwrap().apply(&middle) - alignment.center).norm() < 1e-6,
            "{}",
            alignment.center
        );
        // Turns and scale as lengths at the radius: then the freedoms are the axes of the covariance.
        let unit = [r, r, r, 1.0, 1.0, 1.0, r];
        let in_metres = nalgebra::SMatrix::<f64, 7, 7>::from_fn(|i, j| alignment.covariance[i][j] * unit[i] * unit[j]);
        let mut of_covariance: Vec<f64> = in_metres.symmetric_eigenvalues().iter().map(|v| v.max(0.0).sqrt()).collect();
        let in_metres = |f: &cityweld::Freedom| match f.unit {
            cityweld::types::FreedomUnit::Metre => f.sigma,
            cityweld::types::FreedomUnit::Degree => f.sigma.to_radians() * r,
            _ => f.sigma * r,
        };
        let mut of_freedoms: Vec<f64> = alignment.freedoms.iter().map(in_metres).collect();
        assert_eq!(of_freedoms.len(), 7, "{:?}", alignment.freedoms);
        of_covariance.sort_by(f64::total_cmp);
        of_freedoms.sort_by(f64::total_cmp);
        for (a, b) in of_covariance.iter().zip(&of_freedoms) {
            // The start's own share of the information is one in a million.
            assert!((a - b).abs() < 1e-3 * b + 1e-9, "{of_covariance:?} {of_freedoms:?}");
        }
        // A block of some tens of metres: centimetres at its radius, and never better than the planes of the model.
        assert!(r > 10.0 && r < 40.0 && of_freedoms[6] < 0.2, "{r} {of_freedoms:?}");
    }
}

#[test]
fn a_start_that_is_exactly_right_and_sure_of_it_is_aligned() {
    let exact = StartSigmas { position_m: 0.0, height_m: 0.0, heading_rad: 0.0, tilt_rad: 0.0, log_scale: 0.0 };
    let start = Start::new(sfm_from_city().inverse(), exact).unwrap();
    let alignment = run(true, &AlignOptions::new(start));
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    let (level, up) = errors(&alignment);
    assert!(level < 0.03 && up < 0.03, "off by {level} m, {up} m");
}

/// A city's model stands off its own coordinate system by decimetres, so a start of survey grade is off by as much.
#[test]
fn a_start_that_is_sure_to_the_centimetre_and_half_a_metre_off_does_not_hide_the_right_pose() {
    let sure = StartSigmas { position_m: 0.02, height_m: 0.02, heading_rad: 1e-3, tilt_rad: 1e-3, log_scale: 1e-3 };
    let off = Offset { shift_m: [0.4, -0.3, 0.2], ..Offset::default() };
    let start = Start::new(block(true).off(&off) * sfm_from_city().inverse(), sure).unwrap();
    let alignment = run(true, &AlignOptions::new(start));
    assert_eq!(alignment.verdict, Verdict::Aligned, "{}", alignment.reason);
    let (level, up) = errors(&alignment);
    assert!(level < 0.05 && up < 0.05, "off by {level} m, {up} m");
}

#[test]
fn a_scale_that_leaves_no_place_is_said_before_a_search() {
    for scale in [1e-100, 1e-15, 1e300] {
        let alignment = with_scale(scale, start_off(&OFF));
        assert_eq!((alignment.verdict, alignment.search.samples), (Verdict::Failed, 0), "{}", alignment.reason);
        assert!(alignment.reason.contains("check the scale"), "{}", alignment.reason);
        assert!(alignment.radius.is_finite() && alignment.center.iter().all(|c| c.is_finite()));
    }
}
