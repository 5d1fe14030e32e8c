//! Limits of the verdict.

/// What a verdict asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerdictLimits {
    /// The chance of a wrong pose that is called right which may be taken. Chosen: one in a thousand; `--false-alarm`.
    pub false_alarm: f64,
    /// Poses that differ by less than this along what is held are one pose, at the scene's radius. Chosen.
    pub same_m: f64,
    /// A freedom that the data hold worse than this is not determined, at the scene's radius. Chosen: a window's width is what a
    /// user would see.
    pub default_accuracy_m: f64,
    /// The accuracy asked for as a share of the radius, where that is more. Chosen: reconstructions bend by as much.
    pub default_accuracy_share: f64,
    /// Gates that lead from a given scale to the data's own, units. Derived: from the search's to the score's, step by step.
    pub scale_gates_units: &'static [f64],
    /// The data contradict a given scale where theirs is so many sigmas away ... Derived: 99.7 % of Gaussian errors.
    pub scale_sigmas: f64,
    /// It must also be off at least so far at the scene's radius. Derived: three sigmas of a plane of the model, which alone explain as much.
    pub scale_m: f64,
}

impl Default for VerdictLimits {
    fn default() -> Self {
        VerdictLimits {
            false_alarm: 0.001,
            same_m: 0.8,
            default_accuracy_m: 0.35,
            default_accuracy_share: 0.01,
            scale_gates_units: &[5.0, 5.0, 4.0, 3.3, 2.7, 2.3, 2.0, 1.7, 1.3, 1.0],
            scale_sigmas: 3.0,
            scale_m: 0.15,
        }
    }
}

impl VerdictLimits {
    /// How much likelier than all that speaks against it a pose must be, in bits.
    pub fn margin_bits(&self) -> f64 {
        -self.false_alarm.log2()
    }

    /// What a freedom must be held to where nothing else is asked for, metres at this radius.
    pub fn accuracy_m(&self, radius_m: f64) -> f64 {
        self.default_accuracy_m.max(self.default_accuracy_share * radius_m)
    }
}
