//! The main job on one page: patches, up, scene, search, refinement, evidence, verdict.

mod evidence;
mod obstacle;
mod report;

use crate::correspondence::{Candidate, Hypotheses, Refiner, Scene, candidates, joined, search};
use crate::geometry::{Similarity, Start, Vector3};
use crate::imagery::LiftedSuperpixels;
use crate::limits::Limits;
use crate::planes::{PatchOptions, Patches, PreparedCity, UpChoice, Upright, choose_up, patches};
use crate::reconstruction::Reconstruction;
use crate::verdict::{Alignment, judge};

/// Which way is up in the reconstruction.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Up {
    /// Estimated from walls, floors and cameras.
    #[default]
    Auto,
    /// Not used: the search turns freely, as far as three sigmas of the start's tilt.
    None,
    /// Given, in the sfm frame (any length but zero).
    Given(Vector3<f64>),
}

/// What the user may set.
#[derive(Clone, Copy, Debug)]
pub struct AlignOptions {
    /// To absolute city coordinates.
    pub start: Start,
    /// Metres per sfm unit, held fixed, in place of the start's; free where `None`.
    pub fixed_scale: Option<f64>,
    pub up: Up,
    /// Same seed, same answer, whatever the number of threads.
    pub seed: u64,
    pub limits: Limits,
}

impl AlignOptions {
    /// Everything but the start as most users want it.
    pub fn new(start: Start) -> AlignOptions {
        AlignOptions { start, fixed_scale: None, up: Up::Auto, seed: 0, limits: Limits::default() }
    }
}

/// A stage of the alignment, told to whoever watches: its name and how much of it is done.
pub type Progress<'a> = &'a (dyn Fn(&'static str, usize, usize) + Sync);

/// Finds where the reconstruction stands in the city and judges it. `superpixels` are the evidence of labels or
/// photographs; without them planar clusters are taken out of the cloud itself.
pub fn align(
    city: &PreparedCity,
    reconstruction: &Reconstruction,
    superpixels: Option<&LiftedSuperpixels>,
    options: &AlignOptions,
    progress: Progress<'_>,
) -> Alignment {
    progress("patches", 0, 1);
    let patches = patches(reconstruction, superpixels, &PatchOptions::default());
    let start = options.start.about(options.start.city_from_sfm().relative_to(&city.model.origin));
    if let Some(obstacle) = obstacle::find(city, reconstruction, &patches, &start, &options.limits) {
        return report::refused(&obstacle, city, &patches, options);
    }
    progress("city", 0, 1);
    let uprights = uprights(&patches, &start, options.up);
    let views = uprights.iter().map(|upright| {
        let scene = Scene::new(city, &patches, &start, options.fixed_scale, upright, &options.limits);
        let hypotheses = search(&scene, options.seed, &|done, of| progress("search", done, of));
        let candidates = candidates(&Refiner::new(&scene), &hypotheses);
        View { scene, hypotheses, candidates }
    });
    let view = View::best_of(views.collect());
    let refiner = Refiner::new(&view.scene);
    let holding = evidence::gather(&refiner, &view.candidates);
    let ruling = judge(&holding.evidence, &options.limits.verdict);
    report::tell(ruling, holding, &view.hypotheses, &patches, city, options)
}

/// One way of taking up, searched.
struct View<'a> {
    scene: Scene<'a>,
    hypotheses: Hypotheses,
    candidates: Vec<Candidate>,
}

impl<'a> View<'a> {
    /// The view with the best candidate, joined by the candidates of the others.
    fn best_of(mut views: Vec<View<'a>>) -> View<'a> {
        let balance = |view: &View| view.candidates.first().map_or(f64::NEG_INFINITY, Candidate::balance);
        let at = (0..views.len()).max_by(|&a, &b| balance(&views[a]).total_cmp(&balance(&views[b])).then(b.cmp(&a)));
        let mut best = views.swap_remove(at.unwrap_or(0));
        let sfm_from_level = best.scene.votes.level_from_sfm.inverse();
        let others: Vec<(Similarity, Candidate)> = views
            .into_iter()
            .flat_map(|view| {
                let other_from_level = view.scene.votes.level_from_sfm * sfm_from_level;
                view.candidates.into_iter().map(move |c| (other_from_level, c))
            })
            .collect();
        if !others.is_empty() {
            best.candidates = joined(&Refiner::new(&best.scene), best.candidates, &others);
        }
        best
    }
}

/// The ways of taking up that are searched.
fn uprights(patches: &Patches, start: &Start, up: Up) -> Vec<Upright> {
    let up_of_start = start.city_from_sfm().rotation.inverse() * Vector3::z();
    let guess = Upright { up: up_of_start, sigma_rad: start.sigmas().tilt_rad, known: false };
    match up {
        Up::Auto => match choose_up(patches, &guess) {
            UpChoice::Known(all) => all,
            UpChoice::Free(up) => vec![up],
        },
        Up::None => vec![guess],
        Up::Given(up) => {
            vec![Upright { up: up.try_normalize(0.0).unwrap_or(guess.up), sigma_rad: 0.0, known: true }]
        }
    }
}
