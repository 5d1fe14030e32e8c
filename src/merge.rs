//! The joining of reconstructions on one page: superpixels of the photographs they share, places in a city, one model.
//!
//! Question     how do several reconstructions of one place, as they were read, become one, in a city where there is one?
//! Input        the parts, each with what is known of its place where there is a city; label images or photographs, where there are any
//! Output       [`Merge`]
//! Method       photographs that several parts have are cut into superpixels that all of them see alike; each part is
//!              aligned to the city by
//!              itself, which gives it an anchor; [`join`] does the rest
//! Assumptions  as of [`crate::align()`] and [`join`]
//! Fails when   a file of a photograph cannot be read; what cannot be joined is a verdict

use std::collections::{BTreeSet, HashMap};

use crate::align::{AlignOptions, Place, align};
use crate::geometry::Similarity;
use crate::imagery::{
    ImageryError, ImageryWarning, LiftedSuperpixels, SuperpixelOptions, SuperpixelSource, lift_superpixels,
    lift_superpixels_of,
};
use crate::limits::Limits;
use crate::merging::{Anchor, JoinOptions, Merge, MergeError, Part, join, unify_names};
use crate::observer::Observer;
use crate::planes::PreparedCity;
use crate::reconstruction::{Image, Reconstruction};
use crate::verdict::Verdict;

/// One of the reconstructions to be joined, as it was read.
#[derive(Clone, Debug)]
pub struct MergePart {
    /// Unique among the parts.
    pub name: String,
    pub sfm: Reconstruction,
    /// What is known of where it stands in the city; not asked where there is none.
    pub place: Place,
}

/// What the user may set.
#[derive(Clone, Debug, Default)]
pub struct MergeOptions {
    /// Where superpixels come from; without them points alone join the parts.
    pub superpixels: Option<SuperpixelSource>,
    pub join: JoinOptions,
}

/// Joins reconstructions, in the city where one is given.
pub fn merge(
    given: Vec<MergePart>,
    city: Option<&PreparedCity>,
    options: &MergeOptions,
    observer: &dyn Observer,
) -> Result<Merge, MergeError> {
    let (mut parts, places): (Vec<Part>, Vec<Place>) = given
        .into_iter()
        .map(|MergePart { name, sfm, place }| (Part { name, sfm, superpixels: None, anchor: None }, place))
        .unzip();
    let by_name = unify_names(&mut parts)?;
    let nothing_there = match &options.superpixels {
        Some(source) => lift_shared(&mut parts, source, options, observer)?,
        None => None,
    };
    let mut not_found = Vec::new();
    if let Some(city) = city {
        for (part, place) in parts.iter_mut().zip(places) {
            match anchor(part, place, city, options, observer)? {
                Ok(anchor) => part.anchor = Some(anchor),
                Err(reason) => not_found.push(format!("{}: {reason}", part.name)),
            }
        }
    }
    let mut merged = join(&parts, &options.join, observer)?;
    merged.warnings.extend(by_name.into_iter().chain(nothing_there).chain(not_found));
    Ok(merged)
}

/// Cuts the photographs that several parts have into superpixels; the others join nothing. A warning where none of them is there.
fn lift_shared(
    parts: &mut [Part],
    source: &SuperpixelSource,
    options: &MergeOptions,
    observer: &dyn Observer,
) -> Result<Option<String>, ImageryError> {
    let mut parts_with: HashMap<String, usize> = HashMap::new();
    for part in parts.iter() {
        let names: BTreeSet<&String> = part.sfm.images.iter().map(|image| &image.name).collect();
        names.into_iter().for_each(|name| *parts_with.entry(name.clone()).or_default() += 1);
    }
    let is_shared = |image: &Image| parts_with.get(&image.name).is_some_and(|count| *count > 1);
    // Both parts must see the same superpixels, whatever keypoints each of them has.
    let cut = SuperpixelOptions { count: options.join.limits.planes.superpixels, by_keypoints: false };
    for part in parts.iter_mut() {
        part.superpixels = what_is_there(lift_superpixels_of(&part.sfm, &is_shared, source, &cut, observer))?;
    }
    // Where no photograph is shared, labels and photographs are for the city.
    let any_is_shared = parts_with.values().any(|count| *count > 1);
    Ok((any_is_shared && parts.iter().all(|part| part.superpixels.is_none())).then(|| {
        let folder = source.folder().display();
        format!("no file there is that of a photograph that two parts share, so no plane joins them: {folder}")
    }))
}

/// Where the city puts a part by itself; or why a part of which nothing was known is not found there: a place that was searched in a whole
/// city and is not sure to be the only one holds nothing.
fn anchor(
    part: &Part,
    place: Place,
    city: &PreparedCity,
    options: &MergeOptions,
    observer: &dyn Observer,
) -> Result<Result<Anchor, String>, MergeError> {
    let lift = |source| what_is_there(lift_superpixels(&part.sfm, source, &SuperpixelOptions::default(), observer));
    let superpixels = options.superpixels.as_ref().map(lift).transpose()?.flatten();
    let limits = Limits { verdict: options.join.limits.verdict, ..Limits::default() };
    let align_options = AlignOptions::at(place).with_seed(options.join.seed).with_limits(limits);
    let found = align(city, &part.sfm, superpixels.as_ref(), &align_options, observer)?;
    let fallback = match place {
        Place::Start(start) => *start.city_from_sfm(),
        Place::Anywhere(_) => Similarity::identity(),
    };
    let anchor = Anchor::of(&found, &part.sfm, fallback);
    observer.detail(&format!("{}: {}", part.name, anchor.reason));
    let is_guess = matches!(place, Place::Anywhere(_)) && matches!(found.verdict, Verdict::Failed | Verdict::Ambiguous);
    Ok(if is_guess { Err(anchor.reason) } else { Ok(anchor) })
}

/// A part of whose photographs none is there has nothing to add. That only the shared ones are there is the normal case, and
/// no matter for a warning.
fn what_is_there(lifted: Result<LiftedSuperpixels, ImageryError>) -> Result<Option<LiftedSuperpixels>, ImageryError> {
    match lifted {
        Err(ImageryError::NothingFound { .. } | ImageryError::NoImages { .. }) => Ok(None),
        Err(error) => Err(error),
        Ok(mut lifted) => {
            lifted.warnings.retain(|w| !matches!(w, ImageryWarning::Missing { .. }));
            Ok(Some(lifted))
        }
    }
}

#[cfg(test)]
mod tests;
