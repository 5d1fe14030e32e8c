//! Limits of the search by minimal samples.

/// How hypotheses are drawn, ranked and kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchLimits {
    /// Samples drawn at least and at most. Measured on
    /// the scenes of known truth: with these all of 160 starts were found (2026-11-22).
    pub fewest_samples: usize,
    pub most_samples: usize,
    /// The search ends once the leader has been found so often. Chosen.
    pub enough_hits: usize,
    /// The best of each block of 64 samples, which are refined before they are ranked. Measured on two laser scans of which the model knows a
    /// tenth, five starts each: right poses, one sample in ten thousand, are among the best two or three of their blocks.
    pub best_of_block: usize,
    /// Sample points that refine and rank them. Derived: one inlier in 200 more or less is noise beside that of a minimal sample.
    pub local_optimization_points: usize,
    /// Gates of that refinement, one step each, and of the ranking after it, units. Derived: from a hypothesis's to what a refined pose is off
    /// by. Measured on the same scans: of the poses kept the right one is the first in five of six runs; a ranking gate of 2.3 left it
    /// behind a hundred in one.
    pub local_optimization_gates_units: &'static [f64],
    pub ranking_gate_units: f64,
    /// Hypotheses that are refined further. Chosen.
    pub keep: usize,
    /// Sample points that rank a hypothesis within its block. Measured on the same scans: with 64 the right pose of one run in four is lost, with
    /// 100 of none.
    pub ranking_points: usize,
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
    /// A row's own uncertainty: error of the model and of the patch's centre. Chosen.
    pub row_sigma_m: f64,
    /// What an uncertain rotation adds to it, per metre of distance from the middle of the cloud. Derived: a normal that is a
    /// degree off.
    pub row_sigma_per_m: f64,
    /// A patch whose row is known to within this says nothing new. Chosen: three or four row sigmas.
    pub informative_sigma_m: f64,
    /// Patches drawn for a place in a sample until one can lie anywhere. Measured on laser scans of which the model knows a tenth: with one the
    /// right pose of the Delft blocks is missed in every other run.
    pub most_draws: usize,
    /// They are drawn where fewer than this share of the samples find planes for all their patches with one. Measured on 13 scenes: where models
    /// lack most of what was seen 0 to 7 % do, else 12 to 63 %.
    pub feasible_share: f64,
    /// Patches that lie on the city: the others are trees, cars, and houses that the model lacks. Chosen: half.
    pub on_city: f64,
    /// Time to draw one pair and to score one pose (on 200 sample points, when these ranked), microseconds. Measured by `cargo bench --bench search` on one
    /// core of a shared EPYC, 2026-11-30; their ratio matters.
    pub pair_us: f64,
    pub score_us: f64,
}

impl Default for SearchLimits {
    fn default() -> Self {
        SearchLimits {
            fewest_samples: 8192,
            most_samples: 65_536,
            enough_hits: 10,
            best_of_block: 3,
            local_optimization_points: 200,
            local_optimization_gates_units: &[5.0, 2.3],
            ranking_gate_units: 1.3,
            keep: 60,
            ranking_points: 100,
            gate_units: 5.0,
            same_place_m: 1.5,
            smallest_target_m2: 1.0,
            same_angle_rad: 0.12,
            same_cos: 0.17,
            row_sigma_m: 0.3,
            row_sigma_per_m: 0.015,
            informative_sigma_m: 1.0,
            most_draws: 6,
            feasible_share: 0.1,
            on_city: 0.5,
            pair_us: 0.6,
            score_us: 16.0,
        }
    }
}
