//! Heading, scale and shift of levelled camera positions.
//!
//! Question     which turn about up, scale and shift lay the cameras of a levelled reconstruction on their measured positions?
//! Input        couples of a levelled centre and a position; heights where they are known
//! Output       [`LevelFit`], and which couples were believed
//! Method       1. consensus: of pairs of couples the one under which the median horizontal residual is least (least median of squares,
//!                 Rousseeuw 1984), so that up to half of the positions may be wrong;
//!              2. couples within three and a half sigmas of that median take part in least squares, in complex numbers
//!                 b = z a + t: z = sum conj(a) b / sum |a|^2 about the means; twice;
//!              3. the height is the median of what the believed couples say
//! Fails when   fewer than two couples are apart

use nalgebra::{Complex, Point3, Vector3};

use crate::robust::median;

/// A camera's levelled centre and where it was measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Couple {
    /// Sfm units, z up.
    pub level: Point3<f64>,
    /// Metres.
    pub east_north: [f64; 2],
    pub height_m: Option<f64>,
}

/// city = turn(heading) * scale * level + shift.
#[derive(Clone, Debug)]
pub(super) struct LevelFit {
    pub scale: f64,
    pub heading_rad: f64,
    pub shift: Vector3<f64>,
    /// Indices of the couples that took part.
    pub believed: Vec<usize>,
    /// Of a position about the fit, each horizontal axis, metres.
    pub noise_m: f64,
    /// Root of the sum of squared distances of the believed cameras from their middle, metres, as they are fitted: what noise has blown up
    /// does not count.
    pub spread_m: f64,
    /// The middling horizontal residual of all couples, metres: by this fits are compared.
    pub middling_m: f64,
}

/// Fewer couples cannot tell which of them is wrong: all take part.
const LEAST_FOR_CONSENSUS: usize = 5;
/// Pairs that are tried; of two in three good positions four in nine pairs are good. Chosen: a tenth of a second for thousands of photographs.
const MOST_PAIRS: usize = 2000;
/// A median of |r| over the sigma of one axis: r follows a Rayleigh distribution, whose median is sqrt(2 ln 2) sigmas.
const MEDIAN_PER_SIGMA: f64 = 1.1774;
/// Beyond so many sigmas a position is wrong.
const GATE_SIGMAS: f64 = 3.5;
/// A gate is never narrower, metres: the centimetres of good receivers shall not exclude each other. Chosen.
const LEAST_GATE_M: f64 = 0.5;
const ROUNDS: usize = 3;

type Planar = Complex<f64>;

/// `None` where the couples are all at one place, or have no height.
pub(super) fn level_fit(couples: &[Couple]) -> Option<LevelFit> {
    let a: Vec<Planar> = couples.iter().map(|c| Planar::new(c.level.x, c.level.y)).collect();
    let b: Vec<Planar> = couples.iter().map(|c| Planar::new(c.east_north[0], c.east_north[1])).collect();
    let residuals = |(z, t): (Planar, Planar)| a.iter().zip(&b).map(move |(a, b)| (b - z * a - t).norm());
    let middling = |map| middling_of(residuals(map).collect());
    let mut believed: Vec<usize> = (0..couples.len()).collect();
    let mut map = least_squares(&believed, &a, &b)?;
    if couples.len() >= LEAST_FOR_CONSENSUS {
        let maps = pairs(couples.len()).filter_map(|(i, j)| of_pair([a[i], a[j]], [b[i], b[j]]));
        let (least_m, best) = maps.map(|map| (middling(map), map)).min_by(|x, y| x.0.total_cmp(&y.0))?;
        map = best;
        // Few residuals are small by chance (Rousseeuw and Leroy 1987, 5.1).
        let of_few = 1.0 + 5.0 / (couples.len() - 2) as f64;
        let mut gate_m = (GATE_SIGMAS * of_few * least_m / MEDIAN_PER_SIGMA).max(LEAST_GATE_M);
        for _ in 0..ROUNDS {
            believed = residuals(map).enumerate().filter(|(_, r)| *r <= gate_m).map(|(i, _)| i).collect();
            map = least_squares(&believed, &a, &b)?;
            gate_m = (GATE_SIGMAS * noise(&believed, residuals(map))).max(LEAST_GATE_M);
        }
    }
    let (z, t) = map;
    let scale = z.norm();
    let mut heights: Vec<f64> =
        believed.iter().filter_map(|&i| Some(couples[i].height_m? - scale * couples[i].level.z)).collect();
    let up_m = median(&mut heights)?;
    let middle = believed.iter().map(|&i| a[i]).sum::<Planar>() / believed.len() as f64;
    Some(LevelFit {
        scale,
        heading_rad: z.arg(),
        shift: Vector3::new(t.re, t.im, up_m),
        noise_m: noise(&believed, residuals(map)),
        spread_m: scale * believed.iter().map(|&i| (a[i] - middle).norm_sqr()).sum::<f64>().sqrt(),
        middling_m: middling(map),
        believed,
    })
}

/// The residual that half of those are below which a pair does not fit by itself; infinite of none.
fn middling_of(mut residuals: Vec<f64>) -> f64 {
    residuals.sort_by(f64::total_cmp);
    residuals.get(residuals.len().div_ceil(2)).or(residuals.last()).copied().unwrap_or(f64::INFINITY)
}

/// All pairs, or an even choice of them.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    let all = count * count.saturating_sub(1) / 2;
    let step = all.div_ceil(MOST_PAIRS).max(1);
    (0..count).flat_map(move |i| (i + 1..count).map(move |j| (i, j))).step_by(step)
}

fn of_pair(a: [Planar; 2], b: [Planar; 2]) -> Option<(Planar, Planar)> {
    let z = (b[1] - b[0]) / (a[1] - a[0]);
    (z.is_finite() && z.norm() > 0.0).then(|| (z, b[0] - z * a[0]))
}

fn least_squares(of: &[usize], a: &[Planar], b: &[Planar]) -> Option<(Planar, Planar)> {
    let mean = |values: &[Planar]| of.iter().map(|&i| values[i]).sum::<Planar>() / of.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut cross, mut square) = (Planar::new(0.0, 0.0), 0.0);
    for &i in of {
        cross += (a[i] - mean_a).conj() * (b[i] - mean_b);
        square += (a[i] - mean_a).norm_sqr();
    }
    let z = cross / square;
    (z.is_finite() && z.norm() > 0.0).then(|| (z, mean_b - z * mean_a))
}

/// One sigma of each axis: 2 n residuals, four unknowns.
fn noise(of: &[usize], residuals: impl Iterator<Item = f64>) -> f64 {
    let all: Vec<f64> = residuals.collect();
    let squares: f64 = of.iter().map(|&i| all[i] * all[i]).sum();
    (squares / (2.0 * of.len() as f64 - 4.0).max(1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Couples under a heading of a radian, scale 3 and a shift of (10, 20, 5).
    fn couples(count: usize) -> Vec<Couple> {
        let couple = |i: usize| {
            let t = i as f64;
            let level = Point3::new(4.0 * (t * 0.8).sin() + 0.3 * t, 5.0 * (t * 1.1).cos(), 0.2 * t);
            let turned = Planar::from_polar(3.0, 1.0) * Planar::new(level.x, level.y) + Planar::new(10.0, 20.0);
            Couple { level, east_north: [turned.re, turned.im], height_m: Some(3.0 * level.z + 5.0) }
        };
        (0..count).map(couple).collect()
    }

    #[test]
    fn two_couples_fix_it_and_more_leave_no_residual() {
        for count in [2, 3, 24, 200] {
            let fit = level_fit(&couples(count)).unwrap();
            assert!((fit.scale - 3.0).abs() < 1e-9 && (fit.heading_rad - 1.0).abs() < 1e-9, "{count}: {fit:?}");
            assert!((fit.shift - Vector3::new(10.0, 20.0, 5.0)).norm() < 1e-8 && fit.noise_m < 1e-9);
            assert_eq!(fit.believed.len(), count);
        }
    }

    #[test]
    fn wrong_couples_are_not_believed_as_long_as_they_are_fewer_than_half() {
        let mut wrong = couples(25);
        for (k, couple) in wrong.iter_mut().enumerate().filter(|(k, _)| k % 5 < 2) {
            couple.east_north[0] += 30.0 + 7.0 * k as f64;
        }
        let fit = level_fit(&wrong).unwrap();
        assert!((fit.scale - 3.0).abs() < 1e-6 && fit.believed.len() == 15, "{fit:?}");
    }

    #[test]
    fn one_height_that_is_wrong_moves_nothing_and_some_may_be_missing() {
        let mut some = couples(9);
        (some[2].height_m, some[5].height_m, some[6].height_m) = (Some(1000.0), None, None);
        assert!((level_fit(&some).unwrap().shift.z - 5.0).abs() < 1e-9);
        some.iter_mut().for_each(|couple| couple.height_m = None);
        assert!(level_fit(&some).is_none());
    }

    #[test]
    fn couples_at_one_place_fix_nothing() {
        let one = couples(1)[0];
        assert!(level_fit(&[one; 5]).is_none() && level_fit(&[one]).is_none() && level_fit(&[]).is_none());
    }

    #[test]
    fn the_noise_is_that_of_a_position_on_each_axis() {
        let mut random = crate::robust::Random::stream(4, 0);
        let mut noisy = couples(400);
        for couple in &mut noisy {
            // Uniform within a metre and a half: 0.866 m of each axis.
            couple.east_north = couple.east_north.map(|v| v + 3.0 * (random.unit() - 0.5));
        }
        let fit = level_fit(&noisy).unwrap();
        assert!((fit.noise_m - 0.866).abs() < 0.05, "{}", fit.noise_m);
        assert_eq!(pairs(3).collect::<Vec<_>>(), [(0, 1), (0, 2), (1, 2)]);
        assert!(pairs(1000).count() <= MOST_PAIRS);
    }
}
