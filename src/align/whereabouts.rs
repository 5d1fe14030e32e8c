//! Where the search begins: at a start, or at the places that the walls of the reconstruction find in the city.

use std::f64::consts::PI;
use std::time::Instant;

use super::obstacle::{self, Obstacle};
use super::options::{AlignOptions, Place, Up};
use crate::city::CityModel;
use crate::correspondence::{Hypotheses, Scene};
use crate::geometry::{Similarity, Start, StartSigmas, Vector3};
use crate::limits::Limits;
use crate::observer::{Cancelled, Observer};
use crate::place_search::{PlaceCandidate, PlacePrior, PlaceSearch, PlaceTask, search_places};
use crate::planes::{Patches, PreparedCity, UpChoice, Upright, choose_up, up_without_start};
use crate::reconstruction::Reconstruction;
use crate::robust::Ranked;
use crate::verdict::{LeftOut, SearchSpace};

/// What is known of the place before poses are compared.
pub(super) struct Whereabouts {
    /// The likeliest place, in the city's local frame, and how well it is known where it is the right one.
    pub start: Start,
    /// The same pose, with sigmas that reach over every place that is compared.
    pub reach: Start,
    /// The ways of taking up that are searched.
    pub uprights: Vec<Upright>,
    /// What walls found in the city, where no start was given.
    places: Option<PlaceSearch>,
}

impl Whereabouts {
    /// Where a reconstruction is sought, or what stands in the way.
    pub fn find(
        city: &PreparedCity,
        reconstruction: &Reconstruction,
        patches: &Patches,
        options: &AlignOptions,
        observer: &dyn Observer,
    ) -> Result<Result<Whereabouts, Obstacle>, Cancelled> {
        if let Some(obstacle) = obstacle::of_inputs(&city.model, reconstruction, patches) {
            return Ok(Err(obstacle));
        }
        match &options.place {
            Place::Start(start) => Ok(Whereabouts::about(start, city, patches, options)),
            Place::Anywhere(prior) => Whereabouts::anywhere(prior, city, patches, options, observer),
        }
    }

    fn about(
        start: &Start,
        city: &PreparedCity,
        patches: &Patches,
        options: &AlignOptions,
    ) -> Result<Whereabouts, Obstacle> {
        let local = start.about(start.city_from_sfm().relative_to(&city.model.origin));
        let start = of_given_scale(&local, options.fixed_scale, patches);
        match obstacle::of_start(&city.model, patches, &start, &options.limits) {
            Some(obstacle) => Err(obstacle),
            None => {
                let uprights = uprights(patches, &start, options.up, &options.limits);
                Ok(Whereabouts { reach: start, start, uprights, places: None })
            }
        }
    }

    fn anywhere(
        prior: &PlacePrior,
        city: &PreparedCity,
        patches: &Patches,
        options: &AlignOptions,
        observer: &dyn Observer,
    ) -> Result<Result<Whereabouts, Obstacle>, Cancelled> {
        let origin = &city.model.origin;
        let places = sought(prior, origin, patches, options, observer, |task| search_places(city, task))?;
        Ok(Whereabouts::of_places(places, patches, options))
    }

    /// At places that a search of the city found.
    pub fn of_places(
        mut places: PlaceSearch,
        patches: &Patches,
        options: &AlignOptions,
    ) -> Result<Whereabouts, Obstacle> {
        if let Some(obstacle) = places.obstacle {
            return Err(Obstacle::NoPlace(obstacle));
        }
        let share = places.share_searched;
        places.candidates.iter_mut().for_each(|c| c.start = of_given_scale(&c.start, options.fixed_scale, patches));
        let nothing = if share < 1.0 { Obstacle::NothingFitsInPart { share } } else { Obstacle::NothingFits };
        Whereabouts::about_first(places, patches, &options.limits).ok_or(nothing)
    }

    /// What the search has left out.
    pub fn left_out(&self) -> LeftOut {
        let all = LeftOut { share_searched: 1.0, unexamined: 0 };
        self.places
            .as_ref()
            .map_or(all, |places| LeftOut { share_searched: places.share_searched, unexamined: places.unexamined })
    }

    /// Places found, about the first of them: `None` where there is none.
    fn about_first(places: PlaceSearch, patches: &Patches, limits: &Limits) -> Option<Whereabouts> {
        let start = places.candidates.first()?.start;
        let reach = start.with_sigmas(over_all(&places, patches, limits.reach_sigmas));
        let mut uprights: Vec<Upright> = Vec::new();
        for candidate in &places.candidates {
            if uprights.iter().all(|upright| upright.up != candidate.upright.up) {
                uprights.push(candidate.upright);
            }
        }
        Some(Whereabouts { start, reach, uprights, places: Some(places) })
    }

    /// The same places about the one that a pose (to the city's local frame) stands at, where that is not the one already: what chance does depends on the
    /// place and the scale, and is to be asked where the answer is.
    pub fn moved_to(&self, pose: &Similarity, patches: &Patches, limits: &Limits) -> Option<Whereabouts> {
        let mut places = self.places.clone()?;
        // By all patches, since a place is a heading and a scale as well.
        let off_m = |candidate: &PlaceCandidate| {
            let other = candidate.start.city_from_sfm();
            let centers = patches.patches.iter().map(|patch| &patch.fit.center);
            centers.map(|center| (other.apply(center) - pose.apply(center)).norm()).sum::<f64>()
        };
        let all = &places.candidates;
        let nearest = (0..all.len()).min_by(|&a, &b| off_m(&all[a]).total_cmp(&off_m(&all[b])))?;
        if nearest == 0 {
            return None;
        }
        places.candidates.swap(0, nearest);
        Whereabouts::about_first(places, patches, limits)
    }

    /// The poses that walls found under one up, to be made sharp; `None` where a start is to be searched.
    pub fn hypotheses(&self, scene: &Scene, upright: &Upright) -> Option<Hypotheses> {
        let places = self.places.as_ref()?;
        let sfm_from_level = scene.level_cloud.level_from_sfm.inverse();
        let of_this_up = places.candidates.iter().filter(|candidate| candidate.upright.up == upright.up);
        let ranked = of_this_up.map(|candidate| Ranked {
            pose: *candidate.start.city_from_sfm() * sfm_from_level,
            score: candidate.z,
            hits: 1,
        });
        Some(Hypotheses {
            ranked: ranked.collect(),
            solver: "walls in plan".to_owned(),
            samples: places.poses_scanned as usize,
        })
    }

    pub fn space(&self) -> SearchSpace {
        match &self.places {
            None => SearchSpace::AboutStart,
            Some(places) => SearchSpace::City { bits: places.space_bits() },
        }
    }

    pub fn is_start(&self) -> bool {
        self.places.is_none()
    }
}

/// Has a search made for what a prior, to a city about an origin, allows; the time that it may take begins here.
pub(super) fn sought<T>(
    prior: &PlacePrior,
    origin: &Vector3<f64>,
    patches: &Patches,
    options: &AlignOptions,
    observer: &dyn Observer,
    search: impl FnOnce(&PlaceTask) -> T,
) -> T {
    let begun = Instant::now();
    let limits = &options.limits;
    let uprights = match options.up {
        Up::Given(up) => {
            up.try_normalize(0.0).map(|up| Upright { up, sigma_rad: 0.0, known: true }).into_iter().collect()
        }
        Up::Auto | Up::None => up_without_start(patches, limits),
    };
    let mut prior = prior.relative_to(origin);
    prior.scale = options.fixed_scale.map(|scale| [scale, scale]).or(prior.scale);
    let is_over = || options.budget.is_some_and(|budget| begun.elapsed() >= budget);
    search(&PlaceTask { patches, uprights: &uprights, prior: &prior, limits, is_over: &is_over, observer })
}

/// A start at the coordinates that a reconstruction has, where it seems to stand in the city's own system already: its file names a system, or its
/// coordinates are far from zero, and they lie in the city.
pub(super) fn in_place(
    city: &CityModel,
    reconstruction: &Reconstruction,
    patches: &Patches,
    options: &AlignOptions,
) -> Option<Start> {
    let Place::Anywhere(prior) = &options.place else { return None };
    let (low, high) = city.bounds()?;
    let middle = patches.middle();
    let local = middle - city.origin;
    let is_in_city = (0..2).all(|k| (low[k]..=high[k]).contains(&local[k]));
    let is_allowed = prior.near.is_none_or(|near| near.holds([middle.x, middle.y]));
    let is_georeferenced = reconstruction.crs.is_some() || middle.coords.xy().norm() > FAR_FROM_ZERO;
    let fits = is_in_city && is_allowed && is_georeferenced && options.fixed_scale.is_none();
    fits.then(|| Start::with_default_sigmas(Similarity::identity()))
}

/// No frame of a camera begins so far off, units. Chosen: reconstructions without a reference have extents of some ten units.
const FAR_FROM_ZERO: f64 = 1000.0;

/// The start with a scale that is given in place of its own, about the cloud's middle.
fn of_given_scale(start: &Start, fixed_scale: Option<f64>, patches: &Patches) -> Start {
    let city_from_sfm = start.city_from_sfm();
    let middle = patches.middle();
    start.about(match fixed_scale {
        None => *city_from_sfm,
        Some(scale) => Similarity::about(&middle, &city_from_sfm.apply(&middle), scale, city_from_sfm.rotation),
    })
}

/// Sigmas about the best place, so many of which reach all the others.
fn over_all(places: &PlaceSearch, patches: &Patches, reach_sigmas: f64) -> StartSigmas {
    let middle = patches.middle();
    let of = |start: &Start| (start.city_from_sfm().apply(&middle), start.city_from_sfm().scale);
    let Some(best) = places.candidates.first() else { return StartSigmas::default() };
    let (place, scale) = of(&best.start);
    let own = *best.start.sigmas();
    places.candidates.iter().fold(StartSigmas { heading_rad: PI, ..own }, |sigmas, candidate| {
        let (at, other_scale) = of(&candidate.start);
        let off = at - place;
        let other = candidate.start.sigmas();
        StartSigmas {
            position_m: sigmas.position_m.max(off.xy().norm() / reach_sigmas + own.position_m),
            height_m: sigmas.height_m.max(off.z.abs() / reach_sigmas + other.height_m),
            tilt_rad: sigmas.tilt_rad.max(other.tilt_rad),
            log_scale: sigmas.log_scale.max((other_scale / scale).ln().abs() / reach_sigmas + own.log_scale),
            ..sigmas
        }
    })
}

/// The ways of taking up that are searched about a start.
fn uprights(patches: &Patches, start: &Start, up: Up, limits: &Limits) -> Vec<Upright> {
    let guess = up_of(start);
    match up {
        Up::Auto => match choose_up(patches, &guess, limits) {
            UpChoice::Known(all) => all,
            UpChoice::Free(up) => vec![up],
        },
        Up::None => vec![guess],
        Up::Given(up) => {
            vec![Upright { up: up.try_normalize(0.0).unwrap_or(guess.up), sigma_rad: 0.0, known: true }]
        }
    }
}

/// What a start says of up.
pub(super) fn up_of(start: &Start) -> Upright {
    let up = start.city_from_sfm().rotation.inverse() * Vector3::z();
    Upright { up, sigma_rad: start.sigmas().tilt_rad, known: false }
}
