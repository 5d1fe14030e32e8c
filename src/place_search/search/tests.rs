use super::*;
use crate::geometry::{Point3, Similarity, Vector3};
use crate::place_search::HeadingPrior;
use crate::place_search::{Disc, PlaceCandidate};
use crate::planes::{patches, up_without_start};
use crate::synthetic::{Block, CaptureOptions, CloudOptions, House, Ring, Survey};

/// A town of 4 x 3 blocks, one of which was walked round.
fn town_and_survey() -> (Block, Survey) {
    let town = Block::town(4, 3, 5);
    let seen = Block::new(town.houses[30..36].to_vec());
    let survey = seen.capture(&Ring::street(24).stations(&seen), &CaptureOptions::default());
    (town, survey)
}

struct Asked {
    city: PreparedCity,
    patches: Patches,
    truth: Similarity,
    limits: Limits,
}

impl Asked {
    fn new(block: &Block, survey: &Survey) -> Asked {
        let (city, limits) = (PreparedCity::new(block.city().unwrap()), Limits::default());
        let truth = survey.city_from_sfm.relative_to(&city.model.origin);
        Asked { patches: patches(&survey.sfm, None, &limits.patches), city, truth, limits }
    }

    fn found(&self, prior: &PlacePrior) -> PlaceSearch {
        let ups = up_without_start(&self.patches, &self.limits);
        self.searched(&self.patches, &ups, prior, &|| false)
    }

    fn searched(
        &self,
        patches: &Patches,
        uprights: &[Upright],
        prior: &PlacePrior,
        is_over: &dyn Fn() -> bool,
    ) -> PlaceSearch {
        let task = PlaceTask { patches, uprights, prior, limits: &self.limits, is_over, observer: &() };
        search_places(&self.city, &task).unwrap()
    }

    /// Metres in plan and in height.
    fn off(&self, place: &PlaceCandidate) -> [f64; 2] {
        let middle = self.patches.middle();
        let off = place.start.city_from_sfm().apply(&middle) - self.truth.apply(&middle);
        [off.xy().norm(), off.z.abs()]
    }

    fn middle(&self) -> Point3<f64> {
        self.truth.apply(&self.patches.middle())
    }
}

#[test]
fn a_block_of_a_town_is_found_with_nothing_known() {
    let (town, survey) = town_and_survey();
    let asked = Asked::new(&town, &survey);
    let found = asked.found(&PlacePrior::default());
    let best = &found.candidates[0];
    let [plan_m, height_m] = asked.off(best);
    let sigmas = best.start.sigmas();
    assert!(plan_m < sigmas.position_m && height_m < 2.0 * sigmas.height_m, "{plan_m} {height_m}");
    assert!((best.start.city_from_sfm().scale / asked.truth.scale).ln().abs() < sigmas.log_scale);
    assert!(found.space_bits() > 15.0 && found.obstacle.is_none());
}

#[test]
fn the_same_places_are_found_on_any_number_of_threads() {
    let (town, survey) = town_and_survey();
    let told = |threads: usize| {
        let asked = Asked::new(&town, &survey);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| asked.found(&PlacePrior::default()));
        (found.poses_scanned, found.candidates.iter().map(|c| (*c.start.city_from_sfm(), c.z)).collect::<Vec<_>>())
    };
    assert_eq!(told(1), told(3));
}

#[test]
fn what_is_known_shrinks_the_scan_and_leaves_the_place() {
    let (town, survey) = town_and_survey();
    let asked = Asked::new(&town, &survey);
    let all = asked.found(&PlacePrior::default()).poses_scanned;
    let (middle, scale) = (asked.middle(), asked.truth.scale);
    let near = Some(Disc { center: [middle.x + 10.0, middle.y - 10.0], radius_m: 30.0 });
    let heading = Some(HeadingPrior { city_from_sfm: asked.truth.rotation, within_rad: 0.2 });
    let priors = [
        PlacePrior { near, ..PlacePrior::default() },
        PlacePrior { scale: Some([0.95 * scale, 1.05 * scale]), ..PlacePrior::default() },
        PlacePrior { heading, ..PlacePrior::default() },
    ];
    for prior in priors {
        let found = asked.found(&prior);
        assert!(found.poses_scanned < all / 4, "{} of {all} with {prior:?}", found.poses_scanned);
        assert!(asked.off(&found.candidates[0])[0] < 1.5, "{prior:?}");
    }
}

#[test]
fn walls_of_one_direction_are_refused_before_the_search() {
    let row = Block::row(&House::flat([6.0, 9.0, 7.0]), 6, 6.0);
    let asked = Asked::new(&row, &row.cloud(&CloudOptions::default()));
    // Gables taken away.
    let mut patches = asked.patches.clone();
    let along = asked.truth.rotation.inverse() * Vector3::x();
    patches.patches.retain(|patch| patch.fit.plane.normal.dot(&along).abs() < 0.5);
    let up = Upright { up: asked.truth.rotation.inverse() * Vector3::z(), sigma_rad: 0.01, known: true };
    let search = |patches: &Patches| asked.searched(patches, &[up], &PlacePrior::default(), &|| false);
    let found = search(&patches);
    assert!(found.poses_scanned == 0 && found.candidates.is_empty());
    assert!(matches!(found.obstacle, Some(PlaceObstacle::OneDirection | PlaceObstacle::TooFewWalls { .. })));
    assert_eq!(search(&Patches::default()).obstacle, Some(PlaceObstacle::NoWalls));
}

#[test]
fn a_city_without_walls_near_the_place_is_told() {
    let (town, survey) = town_and_survey();
    let asked = Asked::new(&town, &survey);
    let near = Some(Disc { center: [9e4, 9e4], radius_m: 10.0 });
    let found = asked.found(&PlacePrior { near, ..PlacePrior::default() });
    assert_eq!(found.obstacle, Some(PlaceObstacle::NoCityWalls));
}

#[test]
fn a_city_in_districts_and_told_by_its_walls_alone_has_the_same_places() {
    let (town, survey) = town_and_survey();
    let mut asked = Asked::new(&town, &survey);
    let told =
        |found: &PlaceSearch| found.candidates.iter().map(|c| (*c.start.city_from_sfm(), c.z)).collect::<Vec<_>>();
    let whole = asked.found(&PlacePrior::default());
    let ups = up_without_start(&asked.patches, &asked.limits);
    let task = PlaceTask {
        patches: &asked.patches,
        uprights: &ups,
        prior: &PlacePrior::default(),
        limits: &asked.limits,
        is_over: &|| false,
        observer: &(),
    };
    let mut shown = 0;
    let mut city_at = |discs: &[Disc], look: &mut dyn FnMut(&PreparedCity)| {
        shown += discs.len();
        look(&asked.city);
        Ok::<(), Cancelled>(())
    };
    let mut walls = city_walls(&asked.city, None, &asked.limits);
    walls.reverse();
    let by_walls = search_places_by_walls(&task, walls, &mut city_at).unwrap();
    assert_eq!(told(&by_walls), told(&whole));
    assert!(shown > 0 && shown < asked.limits.place_search.keep);
    asked.limits.place_search.district_m = 30.0;
    let parted = asked.found(&PlacePrior::default());
    assert_eq!(parted.poses_scanned, whole.poses_scanned);
    let [a, b] = [&parted, &whole].map(|found| found.candidates[0]);
    let off =
        a.start.city_from_sfm().apply(&asked.patches.middle()) - b.start.city_from_sfm().apply(&asked.patches.middle());
    assert!(off.norm() < 0.1, "{off}");
}

#[test]
fn a_search_that_is_stopped_says_what_share_was_searched_and_what_all_of_it_would_have_been() {
    let (town, survey) = town_and_survey();
    let mut asked = Asked::new(&town, &survey);
    asked.limits.place_search.district_m = 30.0;
    let ups = up_without_start(&asked.patches, &asked.limits);
    let rounds = std::cell::Cell::new(0);
    let stopped_after = |most: usize| {
        rounds.set(0);
        let is_over = || {
            rounds.set(rounds.get() + 1);
            rounds.get() > most
        };
        asked.searched(&asked.patches, &ups, &PlacePrior::default(), &is_over)
    };
    let (none, some, all) = (stopped_after(0), stopped_after(6), stopped_after(usize::MAX));
    assert_eq!((none.share_searched, none.candidates.len()), (0.0, 0));
    assert!(some.share_searched > 0.05 && some.share_searched < 0.9, "{}", some.share_searched);
    assert_eq!(all.share_searched, 1.0);
    let ratio = some.poses_scanned as f64 / all.poses_scanned as f64;
    assert!(ratio > 0.5 && ratio < 2.0, "{ratio}");
    assert_eq!(stopped_after(6).poses_scanned, some.poses_scanned);
}
