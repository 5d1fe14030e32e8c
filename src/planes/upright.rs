//! Which way is up in the reconstruction, from walls that stand and floors that lie.
//!
//! Question     the direction of up in the sfm frame, better than the start knows it
//! Input        patches, a first guess of up and how far it may be off
//! Output       [`Upright`]: the direction and its standard deviation
//! Method       each patch votes for directions across its normal (a wall) or along it (a floor), with a bounded kernel so that
//!              sloping roofs do not count; the best of a grid of directions round the guess is polished by reweighted
//!              least squares
//! Assumptions  most patches are upright or level
//! Fails when   neither walls nor floors are seen: then the guess comes back with its own sigma

use super::patches::Patch;
use crate::geometry::{Matrix3, Vector3};

/// Up in the sfm frame.
#[derive(Clone, Copy, Debug)]
pub struct Upright {
    pub up: Vector3<f64>,
    /// About each horizontal axis.
    pub sigma_rad: f64,
    /// Whether a search may take it for granted.
    pub known: bool,
}

/// A wall this far from upright (or a floor from level) still votes, with a weight that has fallen to a half.
const KERNEL_RAD: f64 = 0.035;
/// Directions of the first search are this far apart; two thirds of the kernel, so that none falls between.
const STEP_RAD: f64 = 0.02;
/// Walls are built to this, and a polished estimate is never believed to be better.
const BEST_SIGMA_RAD: f64 = 0.005;
/// Up worse than this is not known: three sigmas of it are what the normals of a right pair of patch and plane may differ by.
const KNOWN_SIGMA_RAD: f64 = 0.04;

/// Polishes `guess`, looking as far as three of its sigmas.
pub fn estimate_up(patches: &[Patch], guess: &Upright) -> Upright {
    let votes: Vec<(Vector3<f64>, f64)> =
        patches.iter().map(|p| (p.fit.plane.normal, (p.members.len() as f64).sqrt())).collect();
    let (e1, e2) = across(&guess.up);
    let steps = (3.0 * guess.sigma_rad / STEP_RAD).ceil() as i32;
    let mut best = (score(&votes, &guess.up), guess.up);
    for i in -steps..=steps {
        for j in -steps..=steps {
            let up = (guess.up + STEP_RAD * (f64::from(i) * e1 + f64::from(j) * e2)).normalize();
            let score = score(&votes, &up);
            if score > best.0 {
                best = (score, up);
            }
        }
    }
    let mut up = best.1;
    let mut sigma = guess.sigma_rad;
    for _ in 0..10 {
        let Some((next, s)) = polish(&votes, &up, guess.sigma_rad) else { break };
        (up, sigma) = (next, s);
    }
    let sigma_rad = sigma.clamp(BEST_SIGMA_RAD.min(guess.sigma_rad), guess.sigma_rad);
    Upright { up, sigma_rad, known: sigma_rad <= KNOWN_SIGMA_RAD }
}

/// How far a patch is from being a wall or a floor under `up`, whichever is nearer: the sine of the angle, and its
/// gradient with respect to `up`.
fn misfit(normal: &Vector3<f64>, up: &Vector3<f64>) -> (Vector3<f64>, bool) {
    let along = normal.dot(up);
    if along.abs() < std::f64::consts::FRAC_1_SQRT_2 { (normal * along, true) } else { (up - normal * along, false) }
}

fn score(votes: &[(Vector3<f64>, f64)], up: &Vector3<f64>) -> f64 {
    let kernel = |e_sq: f64| 1.0 / (1.0 + e_sq / (KERNEL_RAD * KERNEL_RAD));
    votes.iter().map(|(n, w)| w * kernel(misfit(n, up).0.norm_squared()).powi(2)).sum()
}

/// One step of reweighted least squares on the two angles of `up`, and its standard deviation.
fn polish(votes: &[(Vector3<f64>, f64)], up: &Vector3<f64>, prior_sigma: f64) -> Option<(Vector3<f64>, f64)> {
    let mut normal_matrix = Matrix3::zeros();
    let (mut weights, mut squares) = (0.0, 0.0);
    for (n, w) in votes {
        let (e, wall) = misfit(n, up);
        let robust = w / (1.0 + e.norm_squared() / (KERNEL_RAD * KERNEL_RAD)).powi(2);
        // A wall asks for n . up = 0, a floor for n x up = 0: the quadratic forms of up that they make small.
        let form = n * n.transpose();
        normal_matrix += robust * if wall { form } else { Matrix3::identity() - form };
        weights += robust;
        squares += robust * e.norm_squared();
    }
    if weights == 0.0 {
        return None;
    }
    let (e1, e2) = across(up);
    let at = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(&(normal_matrix * b));
    // Where only one direction of walls is seen, up may lean along them: the prior holds it there.
    let variance = (squares / weights).max(BEST_SIGMA_RAD * BEST_SIGMA_RAD);
    let damping = variance / (prior_sigma * prior_sigma);
    let (h11, h12, h22) = (at(&e1, &e1) + damping, at(&e1, &e2), at(&e2, &e2) + damping);
    let (g1, g2) = (at(&e1, up), at(&e2, up));
    let det = h11 * h22 - h12 * h12;
    if det <= 0.0 {
        return None;
    }
    let next = up - e1 * ((h22 * g1 - h12 * g2) / det) - e2 * ((h11 * g2 - h12 * g1) / det);
    let worst = (h11 + h22) / 2.0 - (((h11 - h22) / 2.0).powi(2) + h12 * h12).sqrt();
    Some((next.try_normalize(0.0)?, (variance / worst.max(f64::MIN_POSITIVE)).sqrt()))
}

/// Two unit vectors across `up` and each other.
fn across(up: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let least = up.iamin();
    let mut axis = Vector3::zeros();
    axis[least] = 1.0;
    let e1 = up.cross(&axis).normalize();
    (e1, up.cross(&e1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, Rotation3};
    use crate::planes::fit::fit_plane;

    fn facing(normal: Vector3<f64>) -> Patch {
        let (a, b) = across(&normal);
        let corners = [a, b, -a, -b, 0.5 * a, 0.5 * b, -0.5 * a, -0.5 * b];
        let fit = fit_plane(corners.iter().map(|c| Point3::from(*c))).unwrap();
        Patch { members: (0..8).collect(), fit, sided: true }
    }

    #[test]
    fn finds_up_among_walls_floors_and_roofs() {
        let turn = Rotation3::from_euler_angles(0.05, -0.04, 0.3);
        let normals =
            [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.2, 0.0), (0.0, 0.0, 1.0), (0.7, 0.0, 0.7), (0.0, -0.6, 0.8)];
        let patches: Vec<Patch> =
            normals.iter().map(|&(x, y, z)| facing(turn * Vector3::new(x, y, z).normalize())).collect();
        let found = estimate_up(&patches, &Upright { up: Vector3::z(), sigma_rad: 0.035, known: false });
        assert!(found.up.angle(&(turn * Vector3::z())) < 2e-3, "{}", found.up.angle(&(turn * Vector3::z())));
        assert!(found.sigma_rad < 0.035 && found.known);
    }

    #[test]
    fn keeps_the_guess_where_nothing_votes() {
        let guess = Upright { up: Vector3::new(0.0, 0.6, 0.8), sigma_rad: 0.3, known: false };
        let found = estimate_up(&[], &guess);
        assert_eq!(found.sigma_rad, guess.sigma_rad);
        assert!(!found.known);
        assert!(found.up.angle(&guess.up) < 0.2);
    }
}
