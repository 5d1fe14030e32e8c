//! Limits of refining and ranking poses.

/// How a pose is made sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinementLimits {
    /// A point whose foot lies farther outside its facet than this share of the gate is not on it. Chosen.
    pub outside_share: f64,
    /// Directions held worse than this are not moved by least squares. Chosen: a step of a metre is beyond every gate.
    pub most_sigma_m: f64,
    /// Loose points, of unknown direction, are taken for a facet's own only this close to it, sigmas of a point. Derived: 99 % of
    /// Gaussian noise.
    pub unsegmented_gate_sigmas: f64,
    /// Such points count for this much of a patch's point. Chosen: many of them lie there by chance.
    pub unsegmented_weight: f64,
    /// Width of Tukey's biweight, sigmas. Derived: 95 % efficient on Gaussian noise.
    pub tukey_sigmas: f64,
    /// The narrowest gate that residuals may set, as a share of the widest. Chosen.
    pub least_gate_share: f64,
    /// Two poses that move no corner of the scene by more than this are one, units. Chosen.
    pub same_pose_units: f64,
    /// Rounds of improvement, each with more sample points, narrower gates and fewer poses. Chosen.
    pub stages: [StageLimits; 3],
    /// Sample points whose lines of sight are traced, and that rank at most. Derived: more points change the third digit.
    pub traced_points: usize,
    pub most_scoring_points: usize,
}

impl Default for RefinementLimits {
    fn default() -> Self {
        RefinementLimits {
            outside_share: 0.5,
            most_sigma_m: 1.0,
            unsegmented_gate_sigmas: 2.5,
            unsegmented_weight: 0.25,
            tukey_sigmas: 4.685,
            least_gate_share: 0.2,
            same_pose_units: 2.5,
            stages: [
                StageLimits {
                    sample_points: 400,
                    gates_units: &[5.0, 5.0, 4.0, 3.3, 2.7],
                    ranking_gate_units: 2.3,
                    occlusion: false,
                    basins: false,
                    keep: 16,
                },
                StageLimits {
                    sample_points: 1500,
                    gates_units: &[2.7, 2.3, 2.0, 1.7, 1.7],
                    ranking_gate_units: 1.3,
                    occlusion: true,
                    basins: false,
                    keep: 6,
                },
                StageLimits {
                    sample_points: usize::MAX,
                    gates_units: &[1.7, 1.3, 1.0, 1.0],
                    ranking_gate_units: 1.0,
                    occlusion: true,
                    basins: true,
                    keep: 6,
                },
            ],
            traced_points: 500,
            most_scoring_points: 3000,
        }
    }
}

/// A round of improvement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageLimits {
    /// Sample points that refine and rank; all of the patches' where the cloud has fewer.
    pub sample_points: usize,
    /// Gates of refinement, one step each, and of ranking, units.
    pub gates_units: &'static [f64],
    pub ranking_gate_units: f64,
    /// Whether lines of sight count.
    pub occlusion: bool,
    /// Whether better poses in the basins beside join first.
    pub basins: bool,
    /// Poses that go on.
    pub keep: usize,
}

/// How poses are moved along what the data hold loosely or not at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSearchLimits {
    /// Directions held worse than this are searched by the score. Chosen: a window's reveal.
    pub loose_m: f64,
    /// Step of that search in gates. Derived: the score changes by little over half a gate.
    pub step_of_gate: f64,
    /// Its greatest number of steps to either side. Chosen: a bound for starts that know nothing.
    pub most_steps: i32,
    /// Moves into neighbouring basins, units. Chosen: parallel planes of one facade stand some decimetres apart.
    pub basin_moves_units: [f64; 4],
    /// Gates of refinement after such a move, units. Derived: as wide as a move, then as the score's.
    pub basin_gates_units: [f64; 4],
    /// Sample points that say which of two basins explains more. Chosen.
    pub basin_points: usize,
    /// Rounds of such moves. Chosen.
    pub most_rounds: usize,
    /// A search by the score ends within this many units of the right place. Chosen.
    pub settling_units: f64,
    /// A plane whose distance changes by less than this share of a motion is not left by it. Chosen.
    pub unmoved_share: f64,
}

impl Default for LineSearchLimits {
    fn default() -> Self {
        LineSearchLimits {
            loose_m: 0.25,
            step_of_gate: 0.5,
            most_steps: 120,
            basin_moves_units: [-2.0, -1.0, 1.0, 2.0],
            basin_gates_units: [1.7, 1.3, 1.0, 1.0],
            basin_points: 1500,
            most_rounds: 3,
            settling_units: 4.0,
            unmoved_share: 0.3,
        }
    }
}

/// When the city hides a point from its camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OcclusionLimits {
    /// The point's own surroundings do not hide it. Chosen: eaves, reveals and the model's error reach this far.
    pub surroundings_m: f64,
    /// The camera's own place may be off the model's free space by this much. Chosen.
    pub camera_slack_m: f64,
}

impl Default for OcclusionLimits {
    fn default() -> Self {
        OcclusionLimits { surroundings_m: 0.7, camera_slack_m: 0.7 }
    }
}
