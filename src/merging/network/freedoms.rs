//! The seven freedoms of a part in the merged frame, in words.

use nalgebra::SymmetricEigen;

use super::adjustment::Held;
use crate::geometry::Vector3;
use crate::limits::VerdictLimits;
use crate::merging::limits::MergeLimits;
use crate::robust::Matrix7;
use crate::verdict::{Freedom, FreedomKind, FreedomUnit, PoseInformation};

/// In the city's frame: metres and directions by their names.
pub(super) fn in_the_city(held: &Held, limits: &VerdictLimits) -> Vec<Freedom> {
    let hold = PoseInformation {
        parameters: held.parameters,
        information: held.information,
        // Edges have been confirmed by those who made them.
        without: Vec::new(),
        prior: Matrix7::zeros(),
        given_scale: None,
        accuracy_m: limits.accuracy_m(held.parameters.radius),
        confirmed_times: 1.0,
    };
    crate::verdict::freedoms(&hold, limits)
}

/// In the frame of a part, which knows neither metres nor up; the loosest first. Sigmas hold what parts bend by, which no edges tell;
/// whether a freedom is determined is for the edges to say.
pub(super) fn in_a_parts_frame(held: &Held, limits: &MergeLimits) -> Vec<Freedom> {
    let radius = held.parameters.radius;
    let eigen = SymmetricEigen::new(held.information);
    let mut order: Vec<usize> = (0..7).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    // What nothing holds is known as well as the size of the scene.
    let own = |k: usize| if eigen.eigenvalues[k] > 0.0 { eigen.eigenvalues[k].sqrt().recip() } else { radius };
    let sigma = |k: usize| own(k).hypot(limits.network.edge_floor * radius);
    let in_words = |k: usize| {
        let unit = eigen.eigenvectors.column(k);
        let part = |first: usize| Vector3::new(unit[first], unit[first + 1], unit[first + 2]);
        let (turn, shift, scale) = (part(0), part(3), unit[6].abs());
        let largest = turn.norm().max(shift.norm()).max(scale);
        let (kind, name, direction, sigma_in_unit, unit) = if scale == largest {
            (FreedomKind::Scale, "scale", Vector3::zeros(), sigma(k) / radius, FreedomUnit::LogScale)
        } else if shift.norm() == largest {
            (FreedomKind::Shift, "shift", positive(&shift), sigma(k), FreedomUnit::FrameUnit)
        } else {
            (FreedomKind::Turn, "turn", positive(&turn), (sigma(k) / radius).to_degrees(), FreedomUnit::Degree)
        };
        let determined = own(k) <= limits.decision.determined * radius;
        Freedom { kind, name: name.to_owned(), direction, sigma: sigma_in_unit, unit, determined, given: false }
    };
    order.into_iter().map(in_words).collect()
}

/// The unit vector along `v` whose largest component is positive.
fn positive(v: &Vector3<f64>) -> Vector3<f64> {
    let unit = v.normalize();
    if unit[unit.iamax()] < 0.0 { -unit } else { unit }
}

#[cfg(test)]
mod tests;
