//! Limits of holding poses against chance.

/// Poses fitted by chance, against which an answer's evidence is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NullPoseLimits {
    /// Null poses that are asked for. Chosen: a chance of 2 % is then known to half of itself.
    pub count: usize,
    /// Each round has a batch of samples for every null pose that is asked for; there are no more rounds than so many. Measured on
    /// a scan of roofs of which few samples give a pose: with four rounds 26 to 41 null poses were found, the rates by chance were hardly known, and the
    /// right pose had 9 to 13 bits; with sixteen 126 to 137, and 18 to 21 bits, in a tenth of a second more.
    pub most_rounds: u64,
    /// Samples in a batch, of which the best is taken. Measured on 114 wrong answers of generated captures: against single samples they exceed
    /// 2, 4, 6 and 8 bits in 23, 7, 4 and 2 %, as often as the four poses that an answer is chosen from on average allow at most; against the best
    /// of ten right poses lose a third of their bits.
    pub samples: usize,
    /// Sample points that choose the best of a batch. Derived: as the search's.
    pub ranking_points: usize,
    /// Sample points that refine it. Derived: as the search's first round.
    pub refining_points: usize,
    /// Gates of refinement, units. Derived: from the search's to the score's.
    pub gates_units: &'static [f64],
    /// Null poses are sought at least so far from the start, metres. Chosen: a row of houses along a street.
    pub least_reach_m: f64,
    /// Poses that differ by less than these (metres, radians, log scale) are led to one place by refinement. Measured on the scenes of
    /// known truth: 2 m, 6 degrees, 8 %.
    pub basin_m: f64,
    pub basin_rad: f64,
    pub basin_log_scale: f64,
    /// The best null poses of other places, which are refined to the end and compared with the answer as rivals. Chosen: as many as the
    /// search's candidates.
    pub rivals: usize,
}

impl Default for NullPoseLimits {
    fn default() -> Self {
        NullPoseLimits {
            count: 256,
            most_rounds: 16,
            samples: 1,
            ranking_points: 200,
            refining_points: 400,
            gates_units: &[5.0, 4.0, 3.3, 2.7, 2.0, 1.3, 1.0],
            least_reach_m: 100.0,
            basin_m: 2.0,
            basin_rad: 0.105,
            basin_log_scale: 0.08,
            rivals: 6,
        }
    }
}

/// What speaks for a pose, in bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvidenceLimits {
    /// Coplanar patches of the cloud are one observation: normals within this angle. Measured on 369 poses: where each patch of a front
    /// counts, wrong poses reach 86 bits, where the front counts once, 15.
    pub same_plane_deg: f64,
    /// Their centres must lie within this of the larger one's plane, metres. Measured on the same poses.
    pub same_plane_m: f64,
    /// Sample points of a patch that are looked up. Derived: a share of a patch is then known to a seventh.
    pub sample_points: usize,
    /// Sample points of a patch whose lines of sight are traced. Chosen: two in three decide.
    pub traced_points: usize,
    /// A sample point lies on a facet within this distance, metres. Measured on the same poses: 0.2 to 0.5 m do alike.
    pub tolerance_m: f64,
    /// The distance is at least so many sigmas of the cloud's noise. Derived: 99.7 % of Gaussian noise.
    pub tolerance_sigmas: f64,
    /// Points of the cloud that are asked whether the city hides them. Derived: a share is then known to 3 %.
    pub occlusion_points: usize,
    /// They are spread evenly over squares of this width, metres. Chosen: a house's width, since one house hides what lies in one.
    pub hidden_square_m: f64,
    /// Null poses that met everything alike stand in for what few null poses cannot tell. Chosen: one.
    pub unseen_null_poses: f64,
}

impl Default for EvidenceLimits {
    fn default() -> Self {
        EvidenceLimits {
            same_plane_deg: 8.0,
            same_plane_m: 0.5,
            sample_points: 12,
            traced_points: 3,
            tolerance_m: 0.3,
            tolerance_sigmas: 3.0,
            occlusion_points: 256,
            hidden_square_m: 12.0,
            unseen_null_poses: 1.0,
        }
    }
}
