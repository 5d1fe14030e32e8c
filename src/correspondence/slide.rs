//! Along what the data do not hold, a pose is slid by the score, never moved by least squares.
//!
//! Question     where along a loose direction does the pose explain most?
//! Method       poses at even steps along the direction, as far as three sigmas of the start reach; the best score (which includes the
//!              cost of leaving the start) wins. Edges and corners of facets, which say nothing to a least-squares step, speak here.
//! Why          a wall's top and foot tell the height softly; a prior inside Gauss-Newton would drag the pose off its facets

use super::scoring::Scorer;
use crate::geometry::Similarity;
use crate::robust::{Chart, Spectrum, Vector7};

/// Directions held worse than this are slid along, metres.
const LOOSE_M: f64 = 0.25;
/// Steps of the slide in units of the gate: votes change by little over half a gate.
const STEP_OF_GATE: f64 = 0.5;
/// The farthest slide, in steps; a bound for starts that know nothing.
const MOST_STEPS: i32 = 120;

/// The pose after a slide along each loose direction in turn, the loosest first; scores with `panel` within `gate_m`.
pub fn slide(
    scorer: &Scorer,
    panel: &[u32],
    chart: &Chart,
    spectrum: &Spectrum,
    pose: &Similarity,
    gate_m: f64,
) -> Similarity {
    let mut order: Vec<usize> = (0..7).filter(|&k| spectrum.sigmas_m[k] > LOOSE_M).collect();
    order.sort_by(|&a, &b| spectrum.sigmas_m[b].total_cmp(&spectrum.sigmas_m[a]));
    let mut best = *pose;
    for k in order {
        let direction: Vector7 = spectrum.directions.column(k).into_owned();
        // A loose direction that is held a little ends where three of its own sigmas end.
        let reach = 3.0 * spectrum.sigmas_m[k] / (STEP_OF_GATE * gate_m);
        let steps = (reach.min(f64::from(MOST_STEPS))).ceil() as i32;
        best = slide_along(scorer, panel, chart, &direction, &best, gate_m, steps);
    }
    best
}

fn slide_along(
    scorer: &Scorer,
    panel: &[u32],
    chart: &Chart,
    direction: &Vector7,
    pose: &Similarity,
    gate_m: f64,
    steps: i32,
) -> Similarity {
    let score = |pose: &Similarity| scorer.panel_share(panel, pose, gate_m) - scorer.prior_cost(pose);
    let mut best = (score(pose), *pose);
    for side in [1.0, -1.0] {
        for step in 1..=steps {
            let moved = chart.moved(pose, &(direction * (side * f64::from(step) * STEP_OF_GATE * gate_m)));
            if !scorer.within_reach(&moved) {
                break;
            }
            let found = score(&moved);
            if found > best.0 {
                best = (found, moved);
            }
        }
    }
    best.1
}
