//! From evidence to a verdict.
//!
//! The first that holds:
//!
//! | verdict | when |
//! |---|---|
//! | failed | there is no pose (or nothing to search: `align/obstacle.rs`) |
//! | undetermined | a given scale is contradicted by a pose of free scale whose evidence is enough |
//! | ambiguous | in a whole city, the evidence outweighs chance at one of its places, but not by the false alarms that are allowed |
//! | failed | the evidence for the best pose is less than what is needed |
//! | ambiguous | a rival beyond the start's reach has more bits, or one within it is less than log2(1 / false alarms) behind |
//! | undetermined | a freedom is not determined (see [`super::freedoms`]) |
//! | aligned | otherwise |
//!
//! Method       Bayes: a pose with b bits of evidence is 2^b times as likely as before the data were seen. Among so many distinct poses chance gives
//!              one such a lead; the false alarms that are allowed are shared out among them as the start finds them likely, so that
//!              a pose of share w needs log2(1/w) bits more. Each rival is as likely as its own bits, and the start's, say. Two
//!              comparisons decide, both in bits: the evidence against what is needed, and the lead over every rival against log2 of one
//!              over the false alarms. [`Certainty::probability`] is reported only
//! Source       a-contrario test: Desolneux, Moisan and Morel 2000; weighted union bound: Genovese, Roeder and Wasserman 2006;
//!              docs/mathematics.md 16.4
//!
//! Differences along freedoms that nothing holds do not count. Beyond three sigmas the start rules a pose out unless that explains
//! more: a start may be wrong, but where two poses explain the same (the halves of a symmetric block), only the start can tell.

use super::freedoms::{DirectionEstimate, GivenScale, PoseInformation};
use super::{Alternative, Certainty, Verdict, freedoms, words};
use crate::geometry::Similarity;
use crate::limits::VerdictLimits;

/// A pose among others, with what speaks for it.
#[derive(Clone, Debug)]
pub struct Rival {
    /// To absolute city coordinates.
    pub city_from_sfm: Similarity,
    /// How much likelier is what the cloud meets under this pose than by chance, bits.
    pub bits: f64,
    /// What the start says of it against the expected pose, bits: none or less.
    pub prior_bits: f64,
    /// Whether it lies beyond the start's reach.
    pub beyond_start: bool,
    /// Whether it was fitted by chance, and is none of those among which the search chose.
    pub by_chance: bool,
}

impl Rival {
    /// With what the start says, bits.
    pub fn posterior_bits(&self) -> f64 {
        self.bits + self.prior_bits
    }
}

/// The verdict and what it rests on.
#[derive(Clone, Debug)]
pub struct Decision {
    pub verdict: Verdict,
    pub reason: String,
    pub alternatives: Vec<Alternative>,
    pub certainty: Certainty,
    /// Whether the data, sure of the pose, deny the scale that was given.
    pub scale_is_denied: bool,
}

impl Decision {
    /// Each of several places of a city has more evidence where chance is asked about another: none is beyond doubt.
    pub fn between_places(self) -> Decision {
        match self.verdict {
            Verdict::Aligned | Verdict::Undetermined => Decision {
                verdict: Verdict::Ambiguous,
                reason: format!(
                    "several places of the city explain the cloud, each best by what chance does near another; --near or a start would settle it ({})",
                    self.reason
                ),
                ..self
            },
            Verdict::Ambiguous | Verdict::Failed => self,
        }
    }
}

/// What a search did not look at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// Share of the city that was searched before the time was over.
    pub share_searched: f64,
    /// Poses that may be as good as the best and were not compared.
    pub unexamined: usize,
}

impl Decision {
    /// The same where a part of the search was not made: whatever was found, a pose as good may be there.
    pub fn with_left_out(self, left_out: &LeftOut) -> Decision {
        let LeftOut { share_searched, unexamined } = *left_out;
        let told = if share_searched < 1.0 {
            format!(
                "{:.1} % of the city were searched in the time given, and a place as good may be in the rest; more time (--budget), --near or a \
                 start would settle it",
                100.0 * share_searched
            )
        } else if unexamined > 0 {
            format!(
                "{unexamined} more places of the city may be as good and were not compared; --near or a start would settle it"
            )
        } else {
            return self;
        };
        let verdict = match self.verdict {
            Verdict::Aligned | Verdict::Undetermined | Verdict::Ambiguous => Verdict::Ambiguous,
            Verdict::Failed => Verdict::Failed,
        };
        Decision { verdict, reason: format!("{told} ({})", self.reason), ..self }
    }
}

/// What the poses that are compared were chosen from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SearchSpace {
    /// The neighbourhood of a start; its sigmas say how likely each place was beforehand.
    #[default]
    AboutStart,
    /// A city, or a part of it, where so many poses were as likely beforehand: their number as a logarithm to base 2.
    City { bits: f64 },
}

/// Everything that a verdict reads.
#[derive(Clone, Debug)]
pub struct Evidence {
    pub space: SearchSpace,
    /// The best within the start's reach first.
    pub rivals: Vec<Rival>,
    /// What holds the best of them.
    pub hold: PoseInformation,
    /// Planes in space that could speak, and those that speak for the best pose.
    pub witnesses: usize,
    pub speaking: usize,
    /// How many poses were fitted to other places, and the most bits that one of them has.
    pub by_chance: usize,
    pub most_by_chance: f64,
}

/// Rivals that are so much less likely than the best are not worth telling, bits.
const WORTH_TELLING_BITS: f64 = 20.0;

/// Judges the best of the rivals by the hold that the data have on it.
pub fn judge(evidence: &Evidence, limits: &VerdictLimits) -> Decision {
    let Evidence { rivals, hold, .. } = evidence;
    let Some(best) = rivals.first() else {
        return Decision {
            verdict: Verdict::Failed,
            reason: no_pose_reason(evidence.space),
            alternatives: Vec::new(),
            certainty: Certainty { false_alarm: limits.false_alarm, ..Certainty::default() },
            scale_is_denied: false,
        };
    };
    let directions = hold.directions();
    let others: Vec<&Rival> = rivals[1..].iter().filter(|r| differs(best, r, hold, &directions, limits)).collect();
    let alternatives = alternatives(best, &others, hold);
    let certainty = certainty(evidence, &others, limits);
    let serious: Vec<&Rival> = others.iter().copied().filter(|r| is_serious(r, best, limits)).collect();
    let is_denied = |scale: &GivenScale| {
        scale.is_contradicted(hold.parameters.radius, limits) && scale.bits >= certainty.needed_bits
    };
    let denied = hold.given_scale.filter(is_denied);
    let (verdict, reason) = if let Some(scale) = denied {
        (Verdict::Undetermined, contradicted_reason(&scale))
    } else if certainty.bits < certainty.needed_bits {
        match evidence.space {
            SearchSpace::City { .. } if certainty.bits > certainty.needed_bits - limits.margin_bits() => {
                (Verdict::Ambiguous, elsewhere_reason(&certainty))
            }
            _ => (Verdict::Failed, failed_reason(&certainty, evidence)),
        }
    } else if let Some(beyond) = serious.iter().find(|r| r.beyond_start) {
        (Verdict::Ambiguous, beyond_reason(best, beyond, hold))
    } else if !serious.is_empty() {
        (Verdict::Ambiguous, ambiguous_reason(best, &serious, evidence))
    } else if let Some(reason) = undetermined_reason(hold, limits) {
        (Verdict::Undetermined, reason)
    } else {
        (Verdict::Aligned, aligned_reason(best, &others, &certainty, hold, limits))
    };
    Decision { verdict, reason, alternatives, certainty, scale_is_denied: denied.is_some() }
}

/// Whether the evidence leaves room for a rival: within the start's reach where the lead over it is less than chance may give, beyond it
/// where it explains more.
fn is_serious(rival: &Rival, best: &Rival, limits: &VerdictLimits) -> bool {
    if rival.beyond_start {
        rival.bits > best.bits
    } else {
        best.posterior_bits() - rival.posterior_bits() < limits.margin_bits()
    }
}

/// True where two poses differ along what the data hold.
fn differs(
    a: &Rival,
    b: &Rival,
    hold: &PoseInformation,
    directions: &[DirectionEstimate],
    limits: &VerdictLimits,
) -> bool {
    let mut motion = hold.parameters.between(&a.city_from_sfm, &b.city_from_sfm);
    for d in directions.iter().filter(|d| !d.determined) {
        motion -= d.unit * d.unit.dot(&motion);
    }
    motion.norm() > limits.same_m
}

fn certainty(evidence: &Evidence, others: &[&Rival], limits: &VerdictLimits) -> Certainty {
    let best = &evidence.rivals[0];
    let within: Vec<&&Rival> = others.iter().filter(|r| !r.beyond_start).collect();
    // The share that the start gives to the best among all that the search chose from.
    let tried = within.iter().filter(|r| !r.by_chance).map(|r| (r.prior_bits - best.prior_bits).exp2());
    let others_searched = match evidence.space {
        SearchSpace::AboutStart => 0.0,
        SearchSpace::City { bits } => bits.exp2() - 1.0,
    };
    let search_bits = (1.0 + others_searched.max(tried.sum::<f64>())).log2();
    let excess_bits = excess_of_chance(evidence, others, search_bits + limits.margin_bits());
    // Odds against the pose: chance among all that were tried, and each rival.
    let chance = (search_bits + excess_bits - best.bits).exp2();
    let of_rivals: f64 = within.iter().map(|r| (r.posterior_bits() - best.posterior_bits()).exp2()).sum();
    Certainty {
        bits: best.bits,
        search_bits,
        needed_bits: search_bits + excess_bits + limits.margin_bits(),
        probability: 1.0 / (1.0 + chance + of_rivals),
        false_alarm: limits.false_alarm,
        witnesses: evidence.witnesses,
        speaking: evidence.speaking,
        by_chance: evidence.by_chance,
        most_bits_by_chance: evidence.most_by_chance,
    }
}

/// By how much chance does better here than bits allow: among n poses by chance the best has log2 n bits and b more with a probability of 2^-b
/// at most (Markov's inequality, since bits are the logarithm of a likelihood ratio). A pose that has enough by itself is no chance but a rival.
fn excess_of_chance(evidence: &Evidence, others: &[&Rival], enough_bits: f64) -> f64 {
    let is_rival = others.iter().any(|rival| rival.by_chance && rival.bits >= enough_bits);
    let expected = (evidence.by_chance.max(1) as f64).log2();
    if is_rival { 0.0 } else { (evidence.most_by_chance - expected).max(0.0) }
}

fn alternatives(best: &Rival, others: &[&Rival], hold: &PoseInformation) -> Vec<Alternative> {
    let lag = |r: &Rival| best.posterior_bits() - r.posterior_bits();
    let mut told: Vec<&Rival> = others.iter().copied().filter(|r| lag(r) < WORTH_TELLING_BITS).collect();
    told.sort_by(|a, b| b.posterior_bits().total_cmp(&a.posterior_bits()));
    let total: f64 = 1.0 + told.iter().map(|r| (-lag(r)).exp2()).sum::<f64>();
    told.iter()
        .map(|r| Alternative {
            city_from_sfm: r.city_from_sfm,
            weight: (-lag(r)).exp2() / total,
            differs: words::difference(&best.city_from_sfm, &r.city_from_sfm, &hold.parameters.center),
        })
        .collect()
}

fn percent(share: f64) -> f64 {
    100.0 * share
}

fn no_pose_reason(space: SearchSpace) -> String {
    let sought = match space {
        SearchSpace::AboutStart => "within three sigmas of the start",
        SearchSpace::City { .. } => "at the places where walls lie on the city's",
    };
    format!("no pose {sought} lays the points on facets of the city; {}", what_to_check(space))
}

fn what_to_check(space: SearchSpace) -> &'static str {
    match space {
        SearchSpace::AboutStart => "check the start, its scale and that the city covers this place",
        SearchSpace::City { .. } => "check that the city covers this place, or say where it is (--near, a start)",
    }
}

fn failed_reason(certainty: &Certainty, evidence: &Evidence) -> String {
    let Certainty { bits, needed_bits, speaking, witnesses, .. } = certainty;
    let best_by_chance = match evidence.by_chance {
        0 => String::new(),
        poses => format!(
            ", where {poses} poses that were fitted to other places reach {:.1} at most",
            evidence.most_by_chance
        ),
    };
    format!(
        "nothing fits better than chance may: {speaking} of the {witnesses} planes that the cloud saw lie on the city in the best pose, which is evidence of \
         {bits:.1} bits, and {needed_bits:.1} are needed{best_by_chance}; {}",
        what_to_check(evidence.space)
    )
}

/// The pose is likelier right than not, but some other place of the city may yet explain as much.
fn elsewhere_reason(certainty: &Certainty) -> String {
    let Certainty { bits, needed_bits, search_bits, speaking, witnesses, .. } = certainty;
    format!(
        "the best pose is not beyond doubt: {speaking} of the {witnesses} planes that the cloud saw lie on the city, which is evidence of {bits:.1} bits where \
         {needed_bits:.1} are needed, since 2^{search_bits:.0} poses were looked at; --near or a start would settle it, or more photographs"
    )
}

fn ambiguous_reason(best: &Rival, serious: &[&Rival], evidence: &Evidence) -> String {
    let hold = &evidence.hold;
    let remedy = match evidence.space {
        SearchSpace::AboutStart => "a start with smaller sigmas",
        SearchSpace::City { .. } => "a start, or --near,",
    };
    let heaviest = serious.iter().max_by(|a, b| a.posterior_bits().total_cmp(&b.posterior_bits()));
    let how = heaviest.map_or(String::new(), |r| {
        let differs = words::difference(&best.city_from_sfm, &r.city_from_sfm, &hold.parameters.center);
        format!(
            " (the likeliest: {differs}; the evidence for the best leads it by {:.1} bits)",
            best.posterior_bits() - r.posterior_bits()
        )
    });
    format!(
        "{} other pose{} cannot be ruled out beside the best{how}; {remedy} would exclude what is wrong",
        serious.len(),
        if serious.len() == 1 { "" } else { "s" },
    )
}

fn beyond_reason(best: &Rival, beyond: &Rival, hold: &PoseInformation) -> String {
    format!(
        "beyond three sigmas of the start a pose explains more: {}, evidence of {:.1} bits against {:.1}; check the start, or give it larger sigmas",
        words::difference(&best.city_from_sfm, &beyond.city_from_sfm, &hold.parameters.center),
        beyond.bits,
        best.bits
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

fn undetermined_reason(hold: &PoseInformation, limits: &VerdictLimits) -> Option<String> {
    let open: Vec<String> = freedoms(hold, limits)
        .into_iter()
        .filter(|f| !f.determined && !f.given)
        .map(|f| format!("{} (sigma {}; {})", f.name, words::sigma(&f), words::remedy(&f)))
        .collect();
    (!open.is_empty()).then(|| format!("the data do not fix the pose {}", open.join(", nor ")))
}

fn aligned_reason(
    best: &Rival,
    others: &[&Rival],
    certainty: &Certainty,
    hold: &PoseInformation,
    limits: &VerdictLimits,
) -> String {
    let loosest = freedoms(hold, limits).into_iter().find(|f| !f.given);
    let loosest = loosest
        .map_or(String::new(), |f| format!("; the loosest freedom, {}, is held to {}", f.name, words::sigma(&f)));
    let second = others.iter().max_by(|a, b| a.bits.total_cmp(&b.bits));
    let runner_up = second.map_or("no other pose explains anything".to_owned(), |r| {
        let twin = r.beyond_start && best.bits - r.bits < limits.margin_bits();
        let note = if twin { " beyond the start's reach, so that the answer rests on the start" } else { "" };
        format!("the next best pose has {:.0}{note}", r.bits)
    });
    let Certainty { bits, needed_bits, speaking, witnesses, .. } = certainty;
    format!(
        "{speaking} of the {witnesses} planes that the cloud saw lie on the city, which is evidence of {bits:.0} bits where {needed_bits:.0} are needed; \
         {runner_up}{loosest}"
    )
}

#[cfg(test)]
mod tests;
