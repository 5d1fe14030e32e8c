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

use super::freedoms::{Direction, Hold};
use super::{Alternative, Verdict, freedoms, words};
use crate::geometry::Similarity;
use crate::robust::Vector7;

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

/// Wrong poses of real blocks reached a balance of 0.30 where cameras speak against them, right ones of a scene of which
/// the model knows less than half 0.39: the middle.
const LEAST_BALANCE: f64 = 0.34;
/// Without cameras nothing speaks against a pose but what it leaves unexplained: half of the vote must lie on the city.
const LEAST_BALANCE_WITHOUT_CAMERAS: f64 = 0.50;
/// A rival that reaches this share of the best balance is taken seriously.
const RIVAL_SHARE: f64 = 0.85;
/// A rival that reaches this share is taken seriously too where chance explains its lag. Chosen, not derived: with no such bar a
/// building that stands alone, whose few walls cannot lead by much, was never sure against a rival of 61 %.
const COMPARABLE_SHARE: f64 = 0.67;
/// Chance explains a lag of fewer standard errors: a one-sided test at about 4 %. Leads do not part right poses from wrong ones: two
/// wrong poses led their comparable rivals by 0.7 to 1.3, right ones in places not looked at before (nine comparisons) by 1.3 to 3.7.
/// So the bar costs some right poses their word, for the sake of the wrong ones.
const LEAST_LEAD_SIGMAS: f64 = 1.8;
/// Poses that differ by less than this along what is held are one pose, metres at the scene's radius.
const SAME_M: f64 = 0.8;
/// Rivals whose balance is below this share are not worth telling.
const WORTH_TELLING: f64 = 0.25;

/// Judges the best of `rivals` (sorted, best first) by the hold that the data have on it.
pub fn judge(rivals: &[Rival], hold: &Hold, has_cameras: bool) -> Ruling {
    let least = if has_cameras { LEAST_BALANCE } else { LEAST_BALANCE_WITHOUT_CAMERAS };
    let Some(best) = rivals.first() else {
        return Ruling {
            verdict: Verdict::Failed,
            reason: "no pose within three sigmas of the start lays the points on facets of the city; check the start, its scale and \
                     that the city covers this place"
                .to_owned(),
            alternatives: Vec::new(),
        };
    };
    let directions = hold.directions();
    let others: Vec<&Rival> = rivals[1..].iter().filter(|r| differs(best, r, hold, &directions)).collect();
    let alternatives = alternatives(best, &others, hold);
    let serious = others.iter().filter(|r| is_serious(r, best)).count();
    let (verdict, reason) = if best.balance < least {
        (Verdict::Failed, failed_reason(best, least))
    } else if serious > 0 {
        (Verdict::Ambiguous, ambiguous_reason(best, serious, &alternatives))
    } else if let Some(reason) = undetermined_reason(hold) {
        (Verdict::Undetermined, reason)
    } else {
        (Verdict::Aligned, aligned_reason(best, others.first().copied(), hold))
    };
    Ruling { verdict, reason, alternatives }
}

fn is_serious(rival: &Rival, best: &Rival) -> bool {
    let share = rival.balance / best.balance;
    share >= RIVAL_SHARE || share >= COMPARABLE_SHARE && rival.lead_sigmas < LEAST_LEAD_SIGMAS
}

/// True where two poses differ along what the data hold.
fn differs(a: &Rival, b: &Rival, hold: &Hold, directions: &[Direction]) -> bool {
    let b_from_a = b.city_from_sfm * a.city_from_sfm.inverse();
    let r = hold.chart.radius;
    let turn = b_from_a.rotation.scaled_axis() * r;
    let shift = b_from_a.apply(&hold.chart.center) - hold.chart.center;
    let scale = b_from_a.scale.ln() * r;
    let mut motion = Vector7::from_column_slice(&[turn.x, turn.y, turn.z, shift.x, shift.y, shift.z, scale]);
    for d in directions.iter().filter(|d| !d.determined) {
        motion -= d.unit * d.unit.dot(&motion);
    }
    motion.norm() > SAME_M
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

fn undetermined_reason(hold: &Hold) -> Option<String> {
    let open: Vec<String> = freedoms(hold)
        .into_iter()
        .filter(|f| !f.determined)
        .map(|f| {
            let (sigma, unit) = if f.unit == "1" { (percent(f.sigma), "%") } else { (f.sigma, f.unit) };
            format!("{} (sigma {sigma:.2} {unit}; {})", f.name, words::remedy(&f.name))
        })
        .collect();
    (!open.is_empty()).then(|| format!("the data do not fix the pose {}", open.join(", nor ")))
}

fn aligned_reason(best: &Rival, second: Option<&Rival>, hold: &Hold) -> String {
    let loosest = freedoms(hold).into_iter().next();
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
    use crate::robust::{Chart, Matrix7};

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
            chart: Chart { center: Point3::origin(), radius: 20.0 },
            by_plane: vec![information, information],
            start: Matrix7::identity() * 0.01,
            scale_is_fixed: false,
        }
    }

    #[test]
    fn is_aligned_when_all_is_held_and_nothing_rivals() {
        let ruling = judge(&[rival([0.0; 3], 0.8, 0.02), rival([5.0, 0.0, 0.0], 0.3, 0.2)], &hold(None), true);
        assert_eq!(ruling.verdict, Verdict::Aligned, "{}", ruling.reason);
    }

    #[test]
    fn is_undetermined_along_up_when_only_walls_hold() {
        let ruling = judge(&[rival([0.0; 3], 0.8, 0.0)], &hold(Some(5)), true);
        assert_eq!(ruling.verdict, Verdict::Undetermined);
        assert!(ruling.reason.contains("along up") && ruling.reason.contains("--terrain"), "{}", ruling.reason);
    }

    #[test]
    fn a_shift_along_what_is_open_is_no_rival_and_any_other_is() {
        let same = judge(&[rival([0.0; 3], 0.8, 0.0), rival([0.0, 0.0, 4.0], 0.79, 0.0)], &hold(Some(5)), true);
        assert_eq!(same.verdict, Verdict::Undetermined);
        let other = judge(&[rival([0.0; 3], 0.8, 0.0), rival([4.0, 0.0, 0.0], 0.79, 0.0)], &hold(None), true);
        assert_eq!(other.verdict, Verdict::Ambiguous);
        assert_eq!(other.alternatives.len(), 1);
        assert!(other.alternatives[0].differs.contains("shifted by (4.00, 0.00, 0.00) m"));
    }

    #[test]
    fn a_lead_that_chance_explains_is_ambiguous() {
        let verdict = |share: f64, lead_sigmas: f64| {
            let behind = Rival { lead_sigmas, ..rival([5.0, 0.0, 0.0], share, 0.0) };
            judge(&[rival([0.0; 3], 0.8, 0.0), behind], &hold(None), true).verdict
        };
        assert_eq!(verdict(0.6, 1.0), Verdict::Ambiguous);
        assert_eq!(verdict(0.6, 3.0), Verdict::Aligned);
        assert_eq!(verdict(0.4, 1.0), Verdict::Aligned);
    }

    #[test]
    fn blocked_lines_of_sight_fail_a_pose_that_fits_walls() {
        let ruling = judge(&[rival([0.0; 3], 0.42, 0.4)], &hold(None), true);
        assert_eq!(ruling.verdict, Verdict::Failed);
        assert_eq!(judge(&[], &hold(None), true).verdict, Verdict::Failed);
    }

    #[test]
    fn without_cameras_half_of_the_vote_must_lie_on_the_city() {
        assert_eq!(judge(&[rival([0.0; 3], 0.4, 0.0)], &hold(None), true).verdict, Verdict::Aligned);
        assert_eq!(judge(&[rival([0.0; 3], 0.4, 0.0)], &hold(None), false).verdict, Verdict::Failed);
    }
}
