//! Limits of which facets somebody could have seen.

/// Which facets somebody could have seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetVisibilityLimits {
    /// Lines of sight start this far off the facet. Chosen: beyond the mortar between the walls of two houses.
    pub start_m: f64,
    /// What is nearer than this in front of a facet hides it. Chosen: nobody stands there.
    pub narrowest_gap_m: f64,
    /// The front of a neighbour's wall this near before the back of one's own is met with it: the two share a party wall, often to the
    /// last digit. Chosen: models are written to centimetres or finer.
    pub joint_m: f64,
    /// Lines of sight that meet nothing within this distance end in the open. Chosen: wider than a courtyard.
    pub open_m: f64,
    /// Larger triangles are looked at from three places, square metres. Chosen.
    pub large_triangle_m2: f64,
}

impl Default for FacetVisibilityLimits {
    fn default() -> Self {
        FacetVisibilityLimits {
            start_m: 0.06,
            narrowest_gap_m: 0.5,
            joint_m: 0.01,
            open_m: 40.0,
            large_triangle_m2: 4.0,
        }
    }
}
