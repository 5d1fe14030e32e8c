//! From evidence to a verdict.
//!
//! | verdict | when |
//! |---|---|
//! | failed | the best pose explains less than a least share of the vote, lines of sight that it blocks taken off |
//! | ambiguous | a truly different pose explains nearly as much (see below) |
//! | undetermined | a freedom is not determined (see [`super::freedoms`]) |
//! | aligned | otherwise |
//!
//! A rival explains nearly as much where its balance comes near the best one's, or somewhat less near while so few patches tell the
//! two apart that chance may have decided. Differences along freedoms that nothing holds do not count.

use super::freedoms::{GivenScale, HeldDirection, Hold};
use super::{Alternative, Verdict, freedoms, words};
use crate::geometry::Similarity;
use crate::limits::VerdictLimits;

/// A pose among others, with what speaks for it.
#[derive(Clone, Debug)]
pub struct Rival {
    /// To absolute city coordinates.
    pub city_from_sfm: Similarity,
    /// Share of the vote that lies on the city, 0 to 1.
    pub share: f64,
    /// Share of the vote whose lines of sight the city would block.
    pub blocked: f64,
    /// `share` less `blocked` less the cost of leaving the start.
    pub balance: f64,
    /// By how many standard errors of the vote the best pose leads this one.
    pub lead_sigmas: f64,
}

/// The verdict and what it rests on.
#[derive(Clone, Debug)]
pub struct Ruling {
    pub verdict: Verdict,
    pub reason: String,
    pub alternatives: Vec<Alternative>,
}

/// Everything that a verdict reads.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Sorted, best first.
    pub rivals: Vec<Rival>,
    /// What holds the best of them.
    pub hold: Hold,
    pub has_cameras: bool,
}

/// Rivals whose balance is below this share are not worth telling.
const WORTH_TELLING: f64 = 0.25;

/// Judges the best of the rivals by the hold that the data have on it.
pub fn judge(evidence: &Evidence, limits: &VerdictLimits) -> Ruling {
    let Evidence { rivals, hold, has_cameras } = evidence;
    let least = limits.least_balance_of(*has_cameras);
    let Some(best) = rivals.first() else {
        return Ruling {
            verdict: Verdict::Failed,
            reason: "no pose within three sigmas of the start lays the points on facets of the city; check the start, its scale and \
                     that the city covers this place"
                .to_owned(),
            alternatives: Vec::new(),
        };
    };
    let directions = hold.directions(limits);
    let others: Vec<&Rival> = rivals[1..].iter().filter(|r| differs(best, r, hold, &directions, limits)).collect();
    let alternatives = alternatives(best, &others, hold);
    let serious = others.iter().filter(|r| is_serious(r, best, limits)).count();
    let contradicted = hold.given_scale.filter(|scale| scale.is_contradicted(hold.chart.radius, limits));
    let (verdict, reason) = if let Some(scale) = contradicted.filter(|scale| scale.balance >= least) {
        (Verdict::Undetermined, contradicted_reason(&scale))
    } else if best.balance < least {
        (Verdict::Failed, failed_reason(best, least))
    } else if serious > 0 {
        (Verdict::Ambiguous, ambiguous_reason(best, serious, &alternatives))
    } else if let Some(reason) = undetermined_reason(hold, limits) {
        (Verdict::Undetermined, reason)
    } else {
        (Verdict::Aligned, aligned_reason(best, others.first().copied(), hold, limits))
    };
    Ruling { verdict, reason, alternatives }
}

fn is_serious(rival: &Rival, best: &Rival, limits: &VerdictLimits) -> bool {
    let share = rival.balance / best.balance;
    share >= limits.rival_share || share >= limits.comparable_share && rival.lead_sigmas < limits.least_lead_sigmas
}

/// True where two poses differ along what the data hold.
fn differs(a: &Rival, b: &Rival, hold: &Hold, directions: &[HeldDirection], limits: &VerdictLimits) -> bool {
    let mut motion = hold.chart.between(&a.city_from_sfm, &b.city_from_sfm);
    for d in directions.iter().filter(|d| !d.determined) {
        motion -= d.unit * d.unit.dot(&motion);
    }
    motion.norm() > limits.same_m
}

fn alternatives(best: &Rival, others: &[&Rival], hold: &Hold) -> Vec<Alternative> {
    let told: Vec<&&Rival> =
        others.iter().filter(|r| r.balance > WORTH_TELLING * best.balance && r.balance > 0.0).collect();
    let total: f64 = best.balance.max(0.0) + told.iter().map(|r| r.balance).sum::<f64>();
    told.iter()
        .map(|r| Alternative {
            city_from_sfm: r.city_from_sfm,
            weight: r.balance / total,
            differs: words::difference(&best.city_from_sfm, &r.city_from_sfm, &hold.chart.center),
        })
        .collect()
}

fn percent(share: f64) -> f64 {
    100.0 * share
}

fn failed_reason(best: &Rival, least: f64) -> String {
    format!(
        "the best pose lays {:.0} % of the vote on the city and blocks {:.0} % of the lines of sight, a balance of {:.0} % where {:.0} % is \
         the least to rely on; check the start, its scale and that the city covers this place",
        percent(best.share),
        percent(best.blocked),
        percent(best.balance),
        percent(least)
    )
}

fn ambiguous_reason(best: &Rival, serious: usize, alternatives: &[Alternative]) -> String {
    let how = alternatives.first().map_or(String::new(), |a| format!(" (the heaviest: {})", a.differs));
    format!(
        "{serious} other pose{} explain{} the data too well to be ruled out beside the best, which lays {:.0} % of the vote on the city{how}; a start with \
         smaller sigmas would exclude what is wrong",
        if serious == 1 { "" } else { "s" },
        if serious == 1 { "s" } else { "" },
        percent(best.share)
    )
}

fn contradicted_reason(scale: &GivenScale) -> String {
    let percent_off = percent(scale.log_off().exp_m1());
    format!(
        "the data say {} metres per reconstruction unit, given was {} ({percent_off:+.1} %, one sigma is {:.2} %); leave the scale free \
         or check what it was taken from",
        significant(scale.of_data),
        scale.given,
        percent(scale.log_sigma)
    )
}

/// A number with four digits that mean something.
fn significant(value: f64) -> String {
    let digits = 3.0 - value.abs().log10().floor();
    format!("{value:.*}", digits.clamp(0.0, 12.0) as usize)
}

fn undetermined_reason(hold: &Hold, limits: &VerdictLimits) -> Option<String> {
    let open: Vec<String> = freedoms(hold, limits)
        .into_iter()
        .filter(|f| !f.determined && !f.given)
        .map(|f| {
            let (sigma, unit) = if f.unit == "1" { (percent(f.sigma), "%") } else { (f.sigma, f.unit) };
            format!("{} (sigma {sigma:.2} {unit}; {})", f.name, words::remedy(&f.name))
        })
        .collect();
    (!open.is_empty()).then(|| format!("the data do not fix the pose {}", open.join(", nor ")))
}

fn aligned_reason(best: &Rival, second: Option<&Rival>, hold: &Hold, limits: &VerdictLimits) -> String {
    let loosest = freedoms(hold, limits).into_iter().find(|f| !f.given);
    let loosest = loosest.map_or(String::new(), |f| {
        let (sigma, unit) = if f.unit == "1" { (percent(f.sigma), "%") } else { (f.sigma, f.unit) };
        format!("; the loosest freedom, {}, is held to {sigma:.2} {unit}", f.name)
    });
    let runner_up = second.map_or("no other pose explains anything".to_owned(), |r| {
        format!("the next best pose reaches {:.0} % of that", percent((r.balance / best.balance).max(0.0)))
    });
    format!(
        "{:.0} % of the vote lies on {} planes of the city and {runner_up}{loosest}",
        percent(best.share),
        hold.by_plane.len()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point3, Vector3};
    use crate::limits::Limits;
    use crate::robust::{Chart, Matrix7, Motion};

    fn rival(shift: [f64; 3], share: f64, blocked: f64) -> Rival {
        let city_from_sfm = Similarity { translation: Vector3::from(shift), ..Similarity::identity() };
        Rival { city_from_sfm, share, blocked, balance: share - blocked, lead_sigmas: 5.0 }
    }

    /// Two planes that hold everything to 0.05 m, but for the freedom `open`.
    fn hold(open: Option<usize>) -> Hold {
        let mut information = Matrix7::identity() * 200.0;
        if let Some(k) = open {
            information[(k, k)] = 0.0;
        }
        Hold {
            chart: Chart::of_similarity(Point3::origin(), 20.0),
            by_plane: vec![information, information],
            prior: Matrix7::identity() * 0.01,
            given_scale: None,
        }
    }

    fn ruling(rivals: &[Rival], hold: &Hold, has_cameras: bool) -> Ruling {
        let evidence = Evidence { rivals: rivals.to_vec(), hold: hold.clone(), has_cameras };
        judge(&evidence, &Limits::default().verdict)
    }

    /// The data say 2 % more than what was given, or as much.
    fn with_given_scale(log_off: f64, log_sigma: f64) -> Hold {
        let given_scale = GivenScale { given: 6.85, of_data: 6.85 * log_off.exp(), log_sigma, balance: 0.8 };
        let mut hold = hold(None);
        hold.chart.motion = Motion::Rigid;
        Hold { given_scale: Some(given_scale), ..hold }
    }

    #[test]
    fn a_given_scale_that_the_data_contradict_is_undetermined_and_both_are_told() {
        let wrong = ruling(&[rival([0.0; 3], 0.3, 0.0)], &with_given_scale(-0.049, 0.002), true);
        assert_eq!(wrong.verdict, Verdict::Undetermined);
        assert!(
            wrong.reason.contains("the data say 6.522") && wrong.reason.contains("given was 6.85"),
            "{}",
            wrong.reason
        );
    }

    #[test]
    fn a_given_scale_within_the_sigmas_of_the_data_or_of_the_model_is_aligned() {
        for (off, sigma) in [(0.02, 0.01), (0.005, 0.0001), (0.05, f64::INFINITY)] {
            let right = ruling(&[rival([0.0; 3], 0.8, 0.0)], &with_given_scale(off, sigma), true);
            assert_eq!(right.verdict, Verdict::Aligned, "{}", right.reason);
        }
    }

    #[test]
    fn a_given_scale_is_a_freedom_told_as_given_and_no_other_freedom_is_scale() {
        let found = freedoms(&with_given_scale(0.0, 0.01), &Limits::default().verdict);
        let scales: Vec<bool> = found.iter().filter(|f| f.name == "scale").map(|f| f.given).collect();
        assert_eq!((found.len(), scales), (7, vec![true]));
    }

    #[test]
    fn is_aligned_when_all_is_held_and_nothing_rivals() {
        let ruling = ruling(&[rival([0.0; 3], 0.8, 0.02), rival([5.0, 0.0, 0.0], 0.3, 0.2)], &hold(None), true);
        assert_eq!(ruling.verdict, Verdict::Aligned, "{}", ruling.reason);
    }

    #[test]
    fn is_undetermined_along_up_when_only_walls_hold() {
        let ruling = ruling(&[rival([0.0; 3], 0.8, 0.0)], &hold(Some(5)), true);
        assert_eq!(ruling.verdict, Verdict::Undetermined);
        assert!(ruling.reason.contains("along up") && ruling.reason.contains("--terrain"), "{}", ruling.reason);
    }

    #[test]
    fn a_shift_along_what_is_open_is_no_rival_and_any_other_is() {
        let same = ruling(&[rival([0.0; 3], 0.8, 0.0), rival([0.0, 0.0, 4.0], 0.79, 0.0)], &hold(Some(5)), true);
        assert_eq!(same.verdict, Verdict::Undetermined);
        let other = ruling(&[rival([0.0; 3], 0.8, 0.0), rival([4.0, 0.0, 0.0], 0.79, 0.0)], &hold(None), true);
        assert_eq!(other.verdict, Verdict::Ambiguous);
        assert_eq!(other.alternatives.len(), 1);
        assert!(other.alternatives[0].differs.contains("shifted by (4.00, 0.00, 0.00) m"));
    }

    #[test]
    fn a_lead_that_chance_explains_is_ambiguous() {
        let verdict = |share: f64, lead_sigmas: f64| {
            let behind = Rival { lead_sigmas, ..rival([5.0, 0.0, 0.0], share, 0.0) };
            ruling(&[rival([0.0; 3], 0.8, 0.0), behind], &hold(None), true).verdict
        };
        assert_eq!(verdict(0.6, 1.0), Verdict::Ambiguous);
        assert_eq!(verdict(0.6, 3.0), Verdict::Aligned);
        assert_eq!(verdict(0.4, 1.0), Verdict::Aligned);
    }

    #[test]
    fn blocked_lines_of_sight_fail_a_pose_that_fits_walls() {
        assert_eq!(ruling(&[rival([0.0; 3], 0.42, 0.4)], &hold(None), true).verdict, Verdict::Failed);
        assert_eq!(ruling(&[], &hold(None), true).verdict, Verdict::Failed);
    }

    #[test]
    fn without_cameras_half_of_the_vote_must_lie_on_the_city() {
        assert_eq!(ruling(&[rival([0.0; 3], 0.4, 0.0)], &hold(None), true).verdict, Verdict::Aligned);
        assert_eq!(ruling(&[rival([0.0; 3], 0.4, 0.0)], &hold(None), false).verdict, Verdict::Failed);
    }
}
