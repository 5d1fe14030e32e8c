//! The main job on one page: patches and planes, search, refinement, verdict.

use crate::city::CityModel;
use crate::correspondence::{Contender, Contest, ProbeOnPlane, Scene, Scorer, contest, refiner};
use crate::geometry::{Similarity, Start, Vector3};
use crate::imagery::LiftedSuperpixels;
use crate::planes::{PatchOptions, Patches, Upright, estimate_up, patches};
use crate::reconstruction::Reconstruction;
use crate::robust::{Chart, Matrix7};
use crate::verdict::{Alignment, Hold, PlaneEvidence, Rival, SearchSummary, Support, freedoms, judge};

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
    pub start: Start,
    /// Metres per sfm unit, held fixed; free where `None`.
    pub fixed_scale: Option<f64>,
    pub up: Up,
    /// Same seed, same answer, whatever the number of threads.
    pub seed: u64,
}

/// A stage of the alignment, told to whoever watches: its name and how much of it is done.
pub type Progress<'a> = &'a (dyn Fn(&'static str, usize, usize) + Sync);

/// Finds where the reconstruction stands in the city and judges it. `superpixels` are the evidence of labels or
/// photographs; without them planar clusters are taken out of the cloud itself.
pub fn align(
    city: &CityModel,
    reconstruction: &Reconstruction,
    superpixels: Option<&LiftedSuperpixels>,
    options: &AlignOptions,
    progress: Progress<'_>,
) -> Alignment {
    progress("patches", 0, 1);
    let patches = patches(reconstruction, superpixels, &PatchOptions::default());
    let start = local_start(options, city);
    let upright = upright(&patches, &start, options.up);
    progress("city", 0, 1);
    let scene = Scene::new(city, &patches, &start, &upright);
    let scale = options.fixed_scale.map(|s| s / start.city_from_sfm.scale);
    let contest = contest(&scene, scale, options.seed, &|done, of| progress("search", done, of));
    Outcome { city, patches: &patches, scene: &scene, contest: &contest, scale_is_fixed: scale.is_some() }.told(options)
}

/// The start about the city's local origin.
fn local_start(options: &AlignOptions, city: &CityModel) -> Start {
    Start { city_from_sfm: options.start.city_from_sfm.relative_to(&city.origin), ..options.start }
}

fn upright(patches: &Patches, start: &Start, up: Up) -> Upright {
    let up_of_start = start.city_from_sfm.rotation.inverse() * Vector3::z();
    let guess = Upright { up: up_of_start, sigma_rad: start.tilt_sigma_rad, known: false };
    match up {
        Up::Auto => estimate_up(&patches.patches, &guess),
        Up::None => guess,
        Up::Given(up) => Upright { up: up.try_normalize(0.0).unwrap_or(guess.up), sigma_rad: 0.0, known: true },
    }
}

/// What the stages found, to be turned into an [`Alignment`].
struct Outcome<'a> {
    city: &'a CityModel,
    patches: &'a Patches,
    scene: &'a Scene,
    contest: &'a Contest,
    scale_is_fixed: bool,
}

impl Outcome<'_> {
    fn told(&self, options: &AlignOptions) -> Alignment {
        let contenders = &self.contest.contenders;
        let rivals: Vec<Rival> = contenders.iter().map(|c| self.rival(c)).collect();
        let rows = contenders.first().map_or(Vec::new(), |best| self.rows(best));
        let hold = self.hold(contenders.first(), &rows, options);
        let ruling = judge(&rivals, &hold, !self.patches.cameras.is_empty());
        Alignment {
            verdict: ruling.verdict,
            reason: ruling.reason,
            best: rivals.first().map(|r| r.city_from_sfm),
            alternatives: ruling.alternatives,
            origin: self.city.origin,
            center: hold.chart.center,
            freedoms: if rivals.is_empty() { Vec::new() } else { freedoms(&hold) },
            covariance: hold.covariance(),
            support: self.support(&rows),
            evidence: self.evidence(&rows),
            search: SearchSummary {
                solver: self.contest.solver.clone(),
                samples: self.contest.samples as u64,
                seed: options.seed,
            },
            warnings: self.warnings(),
        }
    }

    fn rival(&self, contender: &Contender) -> Rival {
        let local = contender.refined.city_from_level * self.scene.votes.level_from_sfm;
        let city_from_sfm = Similarity { translation: local.translation + self.city.origin, ..local };
        Rival {
            city_from_sfm,
            share: contender.share,
            blocked: contender.blocked,
            balance: contender.balance(),
            lead_sigmas: contender.lead_sigmas,
        }
    }

    /// Which points lie on which planes in the best pose.
    fn rows(&self, best: &Contender) -> Vec<ProbeOnPlane> {
        let scorer = Scorer { votes: &self.scene.votes, field: &self.scene.field, start: self.scene.start };
        let all: Vec<u32> = (0..self.scene.votes.probes.len() as u32).collect();
        let refiner = refiner(self.scene, &scorer, self.scale_is_fixed);
        refiner.probes_on_planes(&all, &best.refined.city_from_level, self.scene.unit_m)
    }

    fn hold(&self, best: Option<&Contender>, rows: &[ProbeOnPlane], options: &AlignOptions) -> Hold {
        let chart = best.map_or(
            Chart { center: self.scene.votes.center_in_city, radius: self.scene.votes.radius_m.max(1e-3) },
            |best| best.refined.chart,
        );
        let scorer = Scorer { votes: &self.scene.votes, field: &self.scene.field, start: self.scene.start };
        let refiner = refiner(self.scene, &scorer, self.scale_is_fixed);
        let of_plane = |rows: &[ProbeOnPlane]| refiner.equations_of_plane(&chart, rows).full();
        let planes = rows.chunk_by(|a, b| a.plane == b.plane).filter(|p| p.len() >= FEWEST_ON_PLANE);
        let by_plane = planes.map(of_plane).collect();
        let start = start_information(&options.start, chart.radius);
        let chart = Chart { center: chart.center + self.city.origin, ..chart };
        Hold { chart, by_plane, start, scale_is_fixed: self.scale_is_fixed }
    }

    fn support(&self, rows: &[ProbeOnPlane]) -> Support {
        let mut across: Vec<f64> = rows.iter().map(|r| r.hit.across_m.abs()).collect();
        across.sort_by(f64::total_cmp);
        Support {
            points: self.scene.votes.firm,
            trusted_points: rows.len(),
            planes: rows.chunk_by(|a, b| a.plane == b.plane).count(),
            rms_m: rms(&across),
            median_m: across.get(across.len() / 2).copied().unwrap_or(0.0),
        }
    }

    /// The planes by falling number of points.
    fn evidence(&self, rows: &[ProbeOnPlane]) -> Vec<PlaneEvidence> {
        let of_plane = |rows: &[ProbeOnPlane]| {
            let plane = &self.scene.planes.planes[rows[0].plane.0 as usize];
            let across: Vec<f64> = rows.iter().map(|r| r.hit.across_m).collect();
            PlaneEvidence {
                plane: rows[0].plane.0,
                object: self.city.object_name(plane.object).to_owned(),
                points: rows.len(),
                rms_m: rms(&across),
            }
        };
        let mut evidence: Vec<PlaneEvidence> = rows.chunk_by(|a, b| a.plane == b.plane).map(of_plane).collect();
        evidence.sort_by(|a, b| b.points.cmp(&a.points).then(a.plane.cmp(&b.plane)));
        evidence
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let Patches { too_few_points, not_planar, support, patches, .. } = self.patches;
        if *too_few_points + *not_planar > 0 {
            warnings.push(format!(
                "superpixels without a plane: {too_few_points} with too few points, {not_planar} not planar"
            ));
        }
        if patches.is_empty() {
            warnings.push(format!("no planar group among {} points", support.len()));
        }
        warnings
    }
}

/// The start's sigmas as information in the chart's unknowns, 1 / m^2.
fn start_information(start: &Start, radius: f64) -> Matrix7 {
    let sigmas = [
        radius * start.tilt_sigma_rad,
        radius * start.tilt_sigma_rad,
        radius * start.heading_sigma_rad,
        start.position_sigma_m,
        start.position_sigma_m,
        start.height_sigma_m,
        radius * start.log_scale_sigma,
    ];
    let information = sigmas.map(|s| s.max(SMALLEST_SIGMA_M).powi(-2));
    Matrix7::from_diagonal(&information.into())
}

/// A single point lies on a plane by chance.
const FEWEST_ON_PLANE: usize = 2;

/// A start that claims to be exact is still only as good as this, metres.
const SMALLEST_SIGMA_M: f64 = 1e-6;

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
