//! Aligns one reconstruction to a city that is an index, of which only what matters is read.
//!
//! Question     where in a city larger than memory does a reconstruction stand of which nothing is known?
//! Method       the walls in plan are in the index; the search for the place goes by them, and reads the blocks at its best poses for their lines of
//!              sight. Then the blocks about all places that may be right are one city, and the rest is the usual way

use super::options::{AlignOptions, Place};
use super::task::{align_about, align_patches, in_place_first};
use super::whereabouts::{self, Whereabouts, sought};
use super::{obstacle, report};
use crate::city::{CityError, CityIndex, CityModel, PlanBox};
use crate::format::city_index::WallRecord;
use crate::geometry::Similarity;
use crate::imagery::LiftedSuperpixels;
use crate::observer::{Cancelled, Observer, Stage, check_cancelled};
use crate::place_search::{CityWall, Disc, PlacePrior, PlaceSearch, search_places_by_walls};
use crate::planes::{Patches, PreparedCity, patches};
use crate::reconstruction::Reconstruction;
use crate::verdict::Alignment;

/// Why an alignment to an index has no answer.
#[derive(Debug, thiserror::Error)]
pub enum AlignIndexError {
    #[error(transparent)]
    City(#[from] CityError),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// An alignment, and what was read of the city for it.
pub struct IndexedAlignment {
    pub alignment: Alignment,
    pub city: PreparedCity,
}

/// As [`align`](super::align), to a city of which only the blocks about places that may be right are read. With a start all of it is: whoever has one reads what
/// it reaches ([`read_city_within`](crate::read_city_within)).
pub fn align_in_index(
    index: &CityIndex,
    reconstruction: &Reconstruction,
    superpixels: Option<&LiftedSuperpixels>,
    options: &AlignOptions,
    observer: &dyn Observer,
) -> Result<IndexedAlignment, AlignIndexError> {
    let Place::Anywhere(prior) = &options.place else {
        let city = PreparedCity::new(index.read_all()?);
        let alignment = super::align(&city, reconstruction, superpixels, options, observer)?;
        return Ok(IndexedAlignment { alignment, city });
    };
    observer.progress(Stage::Patches, 0, 0);
    let patches = patches(reconstruction, superpixels, &options.limits.patches);
    let frame = index.read_frame()?;
    let in_place = whereabouts::in_place(&frame, reconstruction, &patches, options);
    let align_by = |options: &AlignOptions| {
        if matches!(options.place, Place::Anywhere(_)) {
            return Search { index, frame: frame.clone(), patches: &patches, options, observer }
                .alignment(prior, reconstruction);
        }
        let near = about(&patches, options.limits.null_poses.least_reach_m);
        let city = PreparedCity::new(index.read_within(&near)?);
        let alignment = align_patches(&city, reconstruction, &patches, options, observer)?;
        Ok(IndexedAlignment { alignment, city })
    };
    in_place_first(in_place, options, align_by, |found| found.alignment.verdict)
}

/// What stands about a cloud whose coordinates are the city's.
fn about(patches: &Patches, reach_m: f64) -> PlanBox {
    let bound = |k: usize, pick: fn(f64, f64) -> f64, start: f64| patches.points.iter().map(|p| p[k]).fold(start, pick);
    PlanBox {
        low: [0, 1].map(|k| bound(k, f64::min, f64::INFINITY) - reach_m),
        high: [0, 1].map(|k| bound(k, f64::max, f64::NEG_INFINITY) + reach_m),
    }
}

/// A search of an index.
struct Search<'a> {
    index: &'a CityIndex,
    /// The city without anything in it.
    frame: CityModel,
    patches: &'a Patches,
    options: &'a AlignOptions,
    observer: &'a dyn Observer,
}

impl Search<'_> {
    fn alignment(
        self,
        prior: &PlacePrior,
        reconstruction: &Reconstruction,
    ) -> Result<IndexedAlignment, AlignIndexError> {
        let Search { patches, options, observer, .. } = &self;
        let whereabouts = match obstacle::of_inputs(&self.frame, reconstruction, patches) {
            Some(obstacle) => Err(obstacle),
            None => {
                let places = self.places(prior)?;
                let discs = self.compared_at(&places);
                Whereabouts::of_places(places, patches, options).map(|whereabouts| (whereabouts, discs))
            }
        };
        match whereabouts {
            Ok((whereabouts, discs)) => {
                check_cancelled(*observer)?;
                let city = self.city_at(&discs)?;
                let alignment = align_about(&city, patches, whereabouts, options, *observer)?;
                Ok(IndexedAlignment { alignment, city })
            }
            Err(obstacle) => Ok(IndexedAlignment {
                alignment: report::refused(&obstacle, &self.frame, patches, options),
                city: PreparedCity::new(self.frame),
            }),
        }
    }

    fn places(&self, prior: &PlacePrior) -> Result<PlaceSearch, AlignIndexError> {
        let origin = &self.frame.origin;
        let walls = self.walls(prior)?;
        sought(prior, origin, self.patches, self.options, self.observer, |task| {
            search_places_by_walls(task, walls, &mut |discs: &[Disc], look: &mut dyn FnMut(&PreparedCity)| {
                look(&self.city_at(discs)?);
                Ok(())
            })
        })
    }

    /// The walls in plan, about the city's origin.
    fn walls(&self, prior: &PlacePrior) -> Result<Vec<CityWall>, CityError> {
        self.observer.progress(Stage::City, 0, 0);
        let everywhere = PlanBox { low: [f64::NEG_INFINITY; 2], high: [f64::INFINITY; 2] };
        let reach_m = self.options.limits.place_search.most_radius_m;
        let within = prior.near.map_or(everywhere, |near| PlanBox::about(near.center, near.radius_m + reach_m));
        let wall = |record: &WallRecord| CityWall {
            from: record.from.map(Into::into),
            to: record.to.map(Into::into),
            normal: record.normal.map(Into::into),
            foot_m: record.foot_m.into(),
            top_m: record.top_m.into(),
        };
        Ok(self.index.walls_within(&within)?.iter().map(wall).collect())
    }

    /// What stands within discs about the city's origin.
    fn city_at(&self, discs: &[Disc]) -> Result<PreparedCity, CityError> {
        let origin = self.frame.origin;
        let boxes = discs.iter().map(|disc| {
            let [x, y] = disc.center;
            PlanBox::about([x + origin.x, y + origin.y], disc.radius_m)
        });
        Ok(PreparedCity::new(self.index.read_about(&boxes.collect::<Vec<_>>())?))
    }

    /// What matters where places are compared: all that the cloud covers there, and as far beyond it as poses by chance are sought.
    fn compared_at(&self, places: &PlaceSearch) -> Vec<Disc> {
        let middle = self.patches.middle();
        // Strays belong to no patch, and would have a kilometre read about each place.
        let members = self.patches.patches.iter().flat_map(|patch| &patch.members);
        let seen = members.map(|&member| &self.patches.points[member as usize]);
        let far = seen.chain(&self.patches.cameras).map(|point| (point - middle).norm());
        let radius = far.fold(0.0, f64::max);
        let of_place = |pose: &Similarity| {
            let center = pose.apply(&middle);
            let beyond_m = self.options.limits.null_poses.least_reach_m;
            let radius_m = (pose.scale * radius).min(self.options.limits.place_search.most_radius_m);
            Disc { center: [center.x, center.y], radius_m: radius_m + beyond_m }
        };
        places.candidates.iter().map(|candidate| of_place(candidate.start.city_from_sfm())).collect()
    }
}
