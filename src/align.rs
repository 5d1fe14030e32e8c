//! The main job on one page: patches and planes, search, refinement, verdict.

use crate::city::CityModel;
use crate::correspondence::{
    ErrorModel, FacetField, Pairing, PoseSearch, Refined, Scorer, Sightlines, Votes, largest_shift, refine, slide,
};
use crate::geometry::{Point3, Similarity, Start, Vector3};
use crate::imagery::LiftedSuperpixels;
use crate::planes::{
    CityPlanes, PatchOptions, Patches, PlaneId, Upright, city_planes, estimate_up, exposed_triangles, patches,
};
use crate::reconstruction::Reconstruction;
use crate::robust::{RansacOptions, ransac};
use crate::verdict::Alignment;

/// Which way is up in the reconstruction.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Up {
    /// Estimated from walls, floors and cameras.
    #[default]
    Auto,
    /// Not used: the start's tilt is all that is known.
    None,
    /// Given, in the sfm frame (any length but zero).
    Given(Vector3<f64>),
}

/// What the user may set.
#[derive(Clone, Copy, Debug)]
pub struct AlignOptions {
    pub start: Start,
    /// Metres per sfm unit, held fixed; free where `None`.
    pub fixed_scale: Option<f64>,
    pub up: Up,
    /// Same seed, same answer, whatever the number of threads.
    pub seed: u64,
}

/// A stage of the alignment, told to whoever watches: its name and how much of it is done.
pub type Progress<'a> = &'a (dyn Fn(&'static str, usize, usize) + Sync);

/// A pose that survived to the end.
#[derive(Clone, Debug)]
pub struct Finalist {
    pub refined: Refined,
    pub score: f64,
    pub hits: usize,
}

/// Everything that the stages before the search prepare.
pub struct Scene<'a> {
    pub patches: Patches,
    pub votes: Votes,
    pub planes: CityPlanes,
    pub field: FacetField,
    pub seen: Vec<bool>,
    pub sightlines: Sightlines,
    pub start: Start,
    pub city: &'a CityModel,
}

impl<'a> Scene<'a> {
    pub fn prepare(
        city: &'a CityModel,
        reconstruction: &Reconstruction,
        superpixels: Option<&LiftedSuperpixels>,
        options: &AlignOptions,
    ) -> Scene<'a> {
        let start = Start { city_from_sfm: options.start.city_from_sfm.relative_to(&city.origin), ..options.start };
        let patches = patches(reconstruction, superpixels, &PatchOptions::default());
        let guess =
            Upright { up: start.city_from_sfm.rotation.inverse() * Vector3::z(), sigma_rad: start.tilt_sigma_rad };
        let upright = match options.up {
            Up::Auto => estimate_up(&patches.patches, &guess),
            Up::None => guess,
            Up::Given(up) => Upright { up: up.normalize(), sigma_rad: 0.0 },
        };
        let votes = Votes::new(&patches, &start, &upright);
        let (low, high) = reach_box(&votes, &start);
        let planes = city_planes(city);
        let near = |t: u32| {
            let c = city.triangles[t as usize].map(|v| city.vertices[v as usize]);
            let (l, h) = (c[0].inf(&c[1]).inf(&c[2]), c[0].sup(&c[1]).sup(&c[2]));
            (0..2).all(|k| l[k] <= high[k] && h[k] >= low[k])
        };
        let (exposed, rays) = exposed_triangles(city, near);
        let field = FacetField::new(city, &low, &high, COARSE_GATE_M * 1.6, |t| exposed[t as usize]);
        let mut seen = vec![false; planes.planes.len()];
        for t in &field.triangles {
            seen[planes.of_facet(t.facet).0 as usize] = true;
        }
        Scene { patches, votes, planes, field, seen, sightlines: Sightlines { rays }, start, city }
    }
}

const COARSE_GATE_M: f64 = 1.5;

fn reach_box(votes: &Votes, start: &Start) -> (Point3<f64>, Point3<f64>) {
    let grow = (3.0 * start.log_scale_sigma).exp();
    let side = 1.2 * votes.radius_m * grow + 3.0 * start.position_sigma_m + 2.0;
    let mut heights: Vec<f64> = votes.probes.iter().map(|p| p.position.z).collect();
    heights.sort_by(f64::total_cmp);
    let at = |share: f64| heights.get((heights.len() as f64 * share) as usize).copied().unwrap_or(0.0);
    let (bottom, top) = (at(0.002).min(0.0) * grow, at(0.998).max(0.0) * grow);
    let rise = 3.0 * start.height_sigma_m + 2.0;
    let c = votes.center_in_city;
    (Point3::new(c.x - side, c.y - side, c.z + bottom - rise), Point3::new(c.x + side, c.y + side, c.z + top + rise))
}

pub fn search(scene: &Scene, seed: u64, progress: Progress<'_>) -> Vec<Finalist> {
    let scorer = Scorer { votes: &scene.votes, field: &scene.field, start: scene.start };
    let seen = |p: PlaneId| scene.seen[p.0 as usize];
    let pairing = Pairing::new(&scene.votes, &scene.planes, &scene.start, None, seen);
    let z = Vector3::z();
    let Some(up) = crate::solvers::Up::new(&z, &z) else { return Vec::new() };
    let problem = PoseSearch { pairing, scorer: &scorer, up, panel: scene.votes.panel(200), gate_m: COARSE_GATE_M };
    let options = RansacOptions { seed, keep: 60, fewest_samples: 8192, most_samples: 65_536, enough_hits: 10 };
    let (ranked, samples) = ransac(&problem, &options, |n| progress("search", n, 65_536));
    eprintln!(
        "samples {samples} kept {} best {:?}",
        ranked.len(),
        ranked.iter().take(5).map(|r| (r.score, r.hits)).collect::<Vec<_>>()
    );
    let errors = ErrorModel { point_sigma_m: scene.votes.noise_m.max(0.01), plane_sigma_m: 0.05 };
    let votes = &scene.votes;
    let stages = [
        Stage { panel: votes.panel(400), gates_m: &[1.5, 1.5, 1.2, 1.0, 0.8], score_gate_m: 0.7, keep: 16 },
        Stage { panel: votes.panel(1500), gates_m: &[0.8, 0.7, 0.6, 0.5, 0.5], score_gate_m: 0.4, keep: 6 },
        Stage {
            panel: (0..votes.probes.len() as u32).collect(),
            gates_m: &[0.5, 0.4, 0.35, 0.3, 0.3, 0.3],
            score_gate_m: 0.3,
            keep: 6,
        },
    ];
    let mut pool: Vec<Finalist> = ranked
        .iter()
        .map(|r| {
            let refined = refine(&scorer, &scene.planes, &[], &r.pose, &[], &errors);
            Finalist { refined, score: r.score, hits: r.hits }
        })
        .collect();
    for stage in &stages {
        for f in &mut pool {
            let run = |pose: &Similarity| refine(&scorer, &scene.planes, &stage.panel, pose, stage.gates_m, &errors);
            let first = run(&f.refined.city_from_level);
            let spectrum = first.equations.spectrum();
            let slid =
                slide(&scorer, &stage.panel, &first.chart, &spectrum, &first.city_from_level, stage.score_gate_m);
            f.refined = if slid == first.city_from_level { first } else { run(&slid) };
            let p = &f.refined.city_from_level;
            f.score = if stage.panel.len() >= votes.firm {
                scorer.share(p, stage.score_gate_m)
            } else {
                scorer.panel_share(&stage.panel, p, stage.score_gate_m)
            } - scorer.prior_cost(p);
        }
        pool = distinct(pool, votes.radius_m, stage.keep);
    }
    pool
}

struct Stage {
    panel: Vec<u32>,
    gates_m: &'static [f64],
    score_gate_m: f64,
    keep: usize,
}

fn distinct(mut pool: Vec<Finalist>, radius_m: f64, keep: usize) -> Vec<Finalist> {
    pool.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut kept: Vec<Finalist> = Vec::new();
    for f in pool {
        let same = |k: &Finalist| largest_shift(&k.refined.city_from_level, &f.refined.city_from_level, radius_m) < 0.8;
        match kept.iter_mut().find(|k| same(k)) {
            Some(k) => k.hits += f.hits,
            None => kept.push(f),
        }
    }
    kept.truncate(keep);
    kept
}

/// Finds where the reconstruction stands in the city and judges it. `superpixels` are the evidence of labels or
/// photographs; without them planar clusters are taken out of the cloud itself.
pub fn align(
    city: &CityModel,
    reconstruction: &Reconstruction,
    superpixels: Option<&LiftedSuperpixels>,
    options: &AlignOptions,
    progress: Progress<'_>,
) -> Alignment {
    let scene = Scene::prepare(city, reconstruction, superpixels, options);
    let finalists = search(&scene, options.seed, progress);
    let _ = (finalists, Similarity::identity());
    unimplemented!()
}
