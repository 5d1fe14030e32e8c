//! A box of plan.

/// A box of plan, metres of the city.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanBox {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl PlanBox {
    /// As far as `reach_m` from a place along both axes.
    pub fn about(place: [f64; 2], reach_m: f64) -> PlanBox {
        PlanBox { low: place.map(|value| value - reach_m), high: place.map(|value| value + reach_m) }
    }

    pub fn relative_to(&self, origin: [f64; 3]) -> PlanBox {
        let moved = |corner: [f64; 2]| [corner[0] - origin[0], corner[1] - origin[1]];
        PlanBox { low: moved(self.low), high: moved(self.high) }
    }

    /// How far two boxes are apart along the axis on which they are farther; 0 where they touch.
    pub fn gap_m(&self, other: &PlanBox) -> f64 {
        let gap = |k: usize| (self.low[k] - other.high[k]).max(other.low[k] - self.high[k]).max(0.0);
        gap(0).max(gap(1))
    }
}
