//! Every number that decides how a reconstruction is aligned and judged, in one value.
//!
//! Each says where it comes from: *derived* (from what), *measured on* (what), or *chosen* (why). Guards of arithmetic (smallest
//! lengths, block sizes of parallel work) stand beside the code that they guard. Lengths are metres; a *unit* is the width of a
//! scene's narrowest gate, [`Limits::model_unit_m`] and so many sigmas of the cloud's noise.

/// The numbers that decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// How far what is known beforehand is believed, in sigmas. Derived: nine in a thousand of Gaussian errors of one freedom lie
    /// beyond three sigmas; what users are told.
    pub reach_sigmas: f64,
    /// Cost of one squared sigma away from what is known beforehand, in shares of the vote. Chosen: three sigmas in one freedom (9)
    /// cost as much as a small house, 3 %.
    pub prior_cost: f64,
    /// Levelling by walls and floors is not believed to be better than this, radians. Chosen: a degree.
    pub least_tilt_rad: f64,

    /// Gates are multiples of this ... Chosen: what eaves, reveals and a model's error put between a point and its facet.
    pub model_unit_m: f64,
    /// ... and so many sigmas of the cloud's noise. Derived: 95 % of Gaussian noise.
    pub noise_sigmas: f64,
    /// Error of one plane of the model as a whole. Measured on the surveyed LoD2 models at hand: some centimetres.
    pub plane_sigma_m: f64,
    /// No point of a photograph is better than this. Chosen.
    pub least_point_sigma_m: f64,

    /// Normals of a patch and its facet agree within this angle. Chosen: patch normals are good to some degrees, walls of a block
    /// turn by more.
    pub same_normal_deg: f64,
    /// A facet that is seen at a more grazing angle shows no points. Chosen.
    pub grazing_deg: f64,
    /// Sine of the angle within which a wall is upright and a floor level. Chosen: steeper roofs and ramps are neither.
    pub upright_sin: f64,
    /// A frame that leans by less than this tells a floor, up to 37 degrees from its z, from the ceiling that it would be upside
    /// down, radians. Derived: a right angle less 37 degrees, and some slack.
    pub tells_floors_rad: f64,

    pub search: SearchLimits,
    pub refinement: RefinementLimits,
    pub walk: WalkLimits,
    pub sight: SightLimits,
    pub verdict: VerdictLimits,
}

/// How hypotheses are drawn, ranked and kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchLimits {
    /// Samples drawn at least and at most. Measured on
    /// the scenes of known truth: with these all of 160 starts were found (2026-11-22).
    pub fewest_samples: usize,
    pub most_samples: usize,
    /// The search ends once the leader has been found so often. Chosen.
    pub enough_hits: usize,
    /// Hypotheses that are refined. Chosen.
    pub keep: usize,
    /// Probes that rank a hypothesis. Derived: one vote in 200 more or less is noise beside that of a minimal sample.
    pub ranking_probes: usize,
    /// Gate of that ranking, units. Derived: a minimal sample extrapolates the noise of a few patches over the whole scene.
    pub gate_units: f64,
    /// Poses that move no corner of the scene by more than this are one place of the search. Chosen: well within the basin
    /// of refinement.
    pub same_place_m: f64,
    /// Planes smaller than this are not offered as pairs (they still count in every score), square metres. Chosen: a patch of that
    /// size has no firm normal.
    pub smallest_target_m2: f64,
    /// Tilts of a patch and its plane differ by no more than this, radians, and azimuths, once the heading is fixed by another pair of
    /// the same uncertainty. Chosen: patch normals are good to some degrees.
    pub same_angle_rad: f64,
    /// Two patches and their two planes stand at the same angle, by as much as this: cosines. Derived: they differ by at most the
    /// angles, of which there are two.
    pub same_cos: f64,
    /// A row's own uncertainty: error of the model and of the patch's centre. Chosen ...
    pub row_sigma_m: f64,
    /// ... and what an uncertain rotation adds, per metre of distance from the middle of the cloud. Derived: a normal that is a
    /// degree off.
    pub row_sigma_per_m: f64,
    /// A patch whose row is known to within this says nothing new. Chosen: three or four row sigmas.
    pub learned_m: f64,
    /// Patches that lie on the city: the others are trees, cars, and houses that the model lacks. Chosen: half.
    pub on_city: f64,
}

/// How a pose is made sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinementLimits {
    /// A point whose foot lies farther outside its facet than this share of the gate is not on it. Chosen.
    pub outside_share: f64,
    /// Directions held worse than this are not moved by least squares. Chosen: a step of a metre is beyond every gate.
    pub held_m: f64,
    /// Loose points, of unknown direction, are taken for a facet's own only this close to it, sigmas of a point. Derived: 99 % of
    /// Gaussian noise.
    pub loose_gate_sigmas: f64,
    /// ... and count for this much of a patch's point. Chosen: many of them lie there by chance.
    pub loose_weight: f64,
    /// Width of Tukey's biweight, sigmas. Derived: 95 % efficient on Gaussian noise.
    pub tukey_sigmas: f64,
    /// The narrowest gate that residuals may set, as a share of the widest. Chosen.
    pub least_gate_share: f64,
    /// Two poses that move no corner of the scene by more than this are one, units. Chosen.
    pub same_pose_units: f64,
}

/// How poses are moved along what the data hold loosely or not at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkLimits {
    /// Directions held worse than this are walked by the score. Chosen: a window's reveal.
    pub loose_m: f64,
    /// Step of that walk in gates. Derived: votes change by little over half a gate.
    pub step_of_gate: f64,
    /// Its greatest number of steps to either side. Chosen: a bound for starts that know nothing.
    pub most_steps: i32,
    /// Moves into neighbouring basins, units. Chosen: parallel planes of one facade stand some decimetres apart.
    pub basin_moves_units: [f64; 4],
    /// Rounds of such moves. Chosen.
    pub most_rounds: usize,
    /// A walk by the score ends within this many units of the right place. Chosen.
    pub settling_units: f64,
    /// A plane whose distance changes by less than this share of a motion is not left by it. Chosen.
    pub unmoved_share: f64,
}

/// When the city hides a point from its camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SightLimits {
    /// The point's own surroundings do not hide it. Chosen: eaves, reveals and the model's error reach this far.
    pub surroundings_m: f64,
    /// The camera's own place may be off the model's free space by this much. Chosen.
    pub camera_slack_m: f64,
}

/// What a verdict asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerdictLimits {
    /// Least balance of a pose that may be relied on. Measured on the scenes: wrong poses of real blocks reached 0.30 where cameras
    /// speak against them, right ones of a scene of which the model knows less than half 0.39; the middle.
    pub least_balance: f64,
    /// The same without cameras. Chosen: nothing speaks against a pose but what it leaves unexplained, so half of the vote must lie
    /// on the city.
    pub least_balance_without_cameras: f64,
    /// A rival that reaches this share of the best balance is taken seriously. Chosen.
    pub rival_share: f64,
    /// A rival that reaches this share is taken seriously too where chance explains its lag. Chosen: with no such bar a building that
    /// stands alone, whose few walls cannot lead by much, was never sure against a rival of 61 %.
    pub comparable_share: f64,
    /// Chance explains a lag of fewer standard errors. Derived: a one-sided test at about 4 %. Leads do not part right poses from wrong
    /// ones (measured: wrong 0.7 to 1.3, right 1.3 to 3.7), so this costs some right poses their word for the sake of the wrong ones.
    pub least_lead_sigmas: f64,
    /// Poses that differ by less than this along what is held are one pose, at the scene's radius. Chosen.
    pub same_m: f64,
    /// A freedom that the data hold worse than this is not determined, at the scene's radius. Chosen: a window's width is what a
    /// user would see.
    pub determined_m: f64,
    /// Fewest points that hold a plane. Derived: a single point lies on a plane by chance.
    pub fewest_on_plane: usize,
    /// The data contradict a given scale where theirs is so many sigmas away ... Derived: 99.7 % of Gaussian errors.
    pub scale_sigmas: f64,
    /// ... and at the scene's radius at least so far. Derived: three sigmas of a plane of the model, which alone explain as much.
    pub scale_m: f64,
}

impl VerdictLimits {
    /// Least balance of a pose that may be relied on.
    pub fn least_balance_of(&self, has_cameras: bool) -> f64 {
        if has_cameras { self.least_balance } else { self.least_balance_without_cameras }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            reach_sigmas: 3.0,
            prior_cost: 0.003,
            least_tilt_rad: 0.02,
            model_unit_m: 0.25,
            noise_sigmas: 2.0,
            plane_sigma_m: 0.05,
            least_point_sigma_m: 0.01,
            same_normal_deg: 25.0,
            grazing_deg: 83.0,
            upright_sin: 0.2,
            tells_floors_rad: 0.8,
            search: SearchLimits {
                fewest_samples: 8192,
                most_samples: 65_536,
                enough_hits: 10,
                keep: 60,
                ranking_probes: 200,
                gate_units: 5.0,
                same_place_m: 1.5,
                smallest_target_m2: 1.0,
                same_angle_rad: 0.12,
                same_cos: 0.17,
                row_sigma_m: 0.3,
                row_sigma_per_m: 0.015,
                learned_m: 1.0,
                on_city: 0.5,
            },
            refinement: RefinementLimits {
                outside_share: 0.5,
                held_m: 1.0,
                loose_gate_sigmas: 2.5,
                loose_weight: 0.25,
                tukey_sigmas: 4.685,
                least_gate_share: 0.2,
                same_pose_units: 2.5,
            },
            walk: WalkLimits {
                loose_m: 0.25,
                step_of_gate: 0.5,
                most_steps: 120,
                basin_moves_units: [-2.0, -1.0, 1.0, 2.0],
                most_rounds: 3,
                settling_units: 4.0,
                unmoved_share: 0.3,
            },
            sight: SightLimits { surroundings_m: 0.7, camera_slack_m: 0.7 },
            verdict: VerdictLimits {
                least_balance: 0.34,
                least_balance_without_cameras: 0.50,
                rival_share: 0.85,
                comparable_share: 0.67,
                least_lead_sigmas: 1.8,
                same_m: 0.8,
                determined_m: 0.35,
                fewest_on_plane: 2,
                scale_sigmas: 3.0,
                scale_m: 0.15,
            },
        }
    }
}
