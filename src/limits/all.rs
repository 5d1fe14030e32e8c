//! All limits in one value.

use super::{
    EvidenceLimits, FacetVisibilityLimits, LineSearchLimits, NullPoseLimits, OcclusionLimits, PatchLimits,
    PlaceSearchLimits, RefinementLimits, SearchLimits, UncertaintyLimits, UpLimits, VerdictLimits,
};

/// The numbers that decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// How far what is known beforehand is believed, in sigmas. Derived: nine in a thousand of Gaussian errors of one freedom lie
    /// beyond three sigmas; what users are told.
    pub reach_sigmas: f64,
    /// Cost of one squared sigma away from what is known beforehand, in the unit of the score. Chosen: three sigmas in one freedom (9)
    /// cost as much as a small house, 3 %.
    pub prior_cost: f64,
    /// Levelling by walls and floors is not believed to be better than this, radians. Chosen: a degree.
    pub least_tilt_rad: f64,

    /// Gates are multiples of this ... Chosen: what eaves, reveals and a model's error put between a point and its facet.
    pub model_unit_m: f64,
    /// So many sigmas of the cloud's noise are added to it. Derived: 95 % of Gaussian noise.
    pub noise_sigmas: f64,
    /// Error tau of one plane of the model, in search and refinement alone (docs/mathematics.md 15).
    /// The covariance has errors of its own: [`UncertaintyLimits`]. Measured on the surveyed LoD2 models at hand: some centimetres.
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

    pub facet_visibility: FacetVisibilityLimits,
    pub patches: PatchLimits,
    pub up: UpLimits,
    pub place_search: PlaceSearchLimits,
    pub search: SearchLimits,
    pub refinement: RefinementLimits,
    pub line_search: LineSearchLimits,
    pub occlusion: OcclusionLimits,
    pub null_poses: NullPoseLimits,
    pub evidence: EvidenceLimits,
    pub uncertainty: UncertaintyLimits,
    pub verdict: VerdictLimits,
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
            facet_visibility: FacetVisibilityLimits::default(),
            patches: PatchLimits::default(),
            up: UpLimits::default(),
            place_search: PlaceSearchLimits::default(),
            search: SearchLimits::default(),
            refinement: RefinementLimits::default(),
            line_search: LineSearchLimits::default(),
            occlusion: OcclusionLimits::default(),
            null_poses: NullPoseLimits::default(),
            evidence: EvidenceLimits::default(),
            uncertainty: UncertaintyLimits::default(),
            verdict: VerdictLimits::default(),
        }
    }
}

#[cfg(test)]
mod tests;
