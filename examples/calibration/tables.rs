//! The tables that a calibration prints, in Markdown.

use cityweld::Verdict;
use cityweld::synthetic::{Errand, Levels, Outcome, Setting};

use crate::rates::{Rate, quantile};
use crate::runs::Run;

/// Runs, by a name.
type Group<'a> = (String, Vec<&'a Run>);

pub fn print(runs: &[Run]) {
    let all: Vec<&Run> = runs.iter().filter(|run| run.fault.is_none()).collect();
    let right: Vec<&Run> = all.iter().copied().filter(|run| is_at_right_place(run)).collect();
    println!("### What is said, by what was asked\n");
    verdicts(&by_errand(&all));
    println!("\n### At the right place, by setting\n");
    verdicts(&by(&right, |run| run.setting.name().to_owned()));
    println!("\n### At the right place, by fault\n");
    let by_level: Vec<Group> = LEVELS.iter().flat_map(|(name, level)| by_values(&right, name, *level)).collect();
    verdicts(&by_level);
    println!("\n### Error beside what was stated (right place, error below 2 m along what is held)\n");
    sigmas(
        &[vec![("all".to_owned(), right.clone())], by(&right, |run| run.setting.name().to_owned()), by_level].concat(),
    );
    println!("\n### One fault at a time, right place\n");
    let alone: Vec<&Run> = runs.iter().filter(|run| run.fault.is_some()).collect();
    let of_fault = |name: &'static str| {
        (name.to_owned(), alone.iter().copied().filter(|run| run.fault == Some(name)).collect::<Vec<_>>())
    };
    let faults: Vec<Group> = Levels::FAULTS.iter().map(|(name, _)| of_fault(name)).collect();
    verdicts(&faults);
    println!();
    sigmas(&faults);
    let wrong = |run: &&Run| matches!(run.assessment.outcome(), Outcome::AlignedWrong | Outcome::AlignedGross);
    println!("\n### Wrong `aligned`, by name\n");
    runs.iter().filter(wrong).for_each(|run| println!("* {}", run.line()));
}

fn is_at_right_place(run: &Run) -> bool {
    run.errand == Errand::RightPlace && Setting::TOLD_APART.contains(&run.setting)
}

fn by_errand<'a>(runs: &[&'a Run]) -> Vec<Group<'a>> {
    let name =
        |run: &Run| if Setting::TOLD_APART.contains(&run.setting) { run.errand.name() } else { run.setting.name() };
    let mut groups = by(runs, |run| name(run).to_owned());
    groups.push(("all".to_owned(), runs.to_vec()));
    groups
}

/// Groups in the order in which they first appear.
fn by<'a>(runs: &[&'a Run], name: impl Fn(&Run) -> String) -> Vec<Group<'a>> {
    let mut groups: Vec<Group> = Vec::new();
    for run in runs {
        let name = name(run);
        match groups.iter_mut().find(|group| group.0 == name) {
            Some(group) => group.1.push(run),
            None => groups.push((name, vec![run])),
        }
    }
    groups
}

/// A fault's level in numbers.
type Level = fn(&Levels) -> f64;

const LEVELS: &[(&str, Level)] = &[
    ("houses off, m", |l| l.building_m),
    ("planes off, m", |l| l.plane_m),
    ("under eaves, m", |l| l.eaves_m),
    ("flat lids", |l| f64::from(u8::from(l.lids))),
    ("changed", |l| l.changed),
    ("relief", |l| l.relief),
    ("clutter", |l| l.clutter),
    ("outliers", |l| l.outliers),
    ("noise, px", |l| l.noise_px),
    ("bent", |l| l.bend),
    ("ground modelled", |l| f64::from(u8::from(l.ground))),
    ("cameras", |l| f64::from(u8::from(l.cameras))),
];

fn by_values<'a>(runs: &[&'a Run], name: &str, level: Level) -> Vec<Group<'a>> {
    let mut groups = by(runs, |run| format!("{name} {}", level(&run.levels)));
    groups.sort_by(|a, b| level(&a.1[0].levels).total_cmp(&level(&b.1[0].levels)));
    groups
}

const OUTCOMES: [(&str, &[Outcome]); 8] = [
    ("`aligned` right", &[Outcome::AlignedRight]),
    ("wrong", &[Outcome::AlignedWrong]),
    ("gross", &[Outcome::AlignedGross]),
    ("`undetermined` right", &[Outcome::UndeterminedRight]),
    ("wrong", &[Outcome::UndeterminedWrong]),
    ("`ambiguous` right", &[Outcome::AmbiguousRight]),
    ("`failed` right", &[Outcome::FailedRight]),
    ("neither", &[Outcome::AmbiguousWrong, Outcome::FailedWrong]),
];

fn verdicts(groups: &[Group]) {
    let names: Vec<&str> = OUTCOMES.iter().map(|(name, _)| *name).collect();
    println!(
        "| | runs | {} | wrong `aligned`, of all | ... of the `aligned` | right withheld | `undetermined`, wrong |",
        names.join(" | ")
    );
    println!("|---|{}", "---|".repeat(OUTCOMES.len() + 5));
    for (name, runs) in groups.iter().filter(|(_, runs)| !runs.is_empty()) {
        let of = |outcomes: &[Outcome]| Rate::new(runs, |run| outcomes.contains(&run.assessment.outcome()));
        let counts: Vec<String> = OUTCOMES.iter().map(|(_, outcomes)| of(outcomes).hits.to_string()).collect();
        let wrong = of(&[Outcome::AlignedWrong, Outcome::AlignedGross]);
        let of_verdict = |verdict| Rate::new(runs, |run| run.assessment.verdict == verdict).hits;
        let withheld = of(&[Outcome::AmbiguousRight, Outcome::FailedRight]);
        let right = of(&[Outcome::AlignedRight, Outcome::UndeterminedRight]).hits + withheld.hits;
        println!(
            "| {name} | {} | {} | {wrong} | {} | {} | {} |",
            runs.len(),
            counts.join(" | "),
            Rate { of: of_verdict(Verdict::Aligned), ..wrong },
            Rate { of: right, ..withheld },
            Rate { of: of_verdict(Verdict::Undetermined), ..of(&[Outcome::UndeterminedWrong]) },
        );
    }
}

fn sigmas(groups: &[Group]) {
    println!(
        "| | runs | inside its 95 % band | above | factor that the sigmas lack | error / stated: 10 % | 50 % | 90 % |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, runs) in groups {
        let told: Vec<&&Run> = runs.iter().filter(|run| run.assessment.tells_sigmas()).collect();
        if told.is_empty() {
            continue;
        }
        let inside = Rate::new(&told, |run| run.assessment.band().is_eq());
        let above = Rate::new(&told, |run| run.assessment.band().is_gt());
        let normalised: Vec<f64> = told.iter().map(|run| run.assessment.normalised()).collect();
        let ratio = |run: &&&Run| run.assessment.held_error_m / run.assessment.held_stated_m;
        let ratios: Vec<f64> = told.iter().map(ratio).collect();
        println!(
            "| {name} | {} | {inside} | {above} | {:.1} | {:.2} | {:.2} | {:.2} |",
            told.len(),
            quantile(&normalised, 0.5).sqrt(),
            quantile(&ratios, 0.1),
            quantile(&ratios, 0.5),
            quantile(&ratios, 0.9),
        );
    }
}
