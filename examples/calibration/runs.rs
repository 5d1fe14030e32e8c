//! Runs: the program asked about one case after the other, and what its answers were worth.

use cityweld::synthetic::{Assessment, Case, Errand, Fault, Levels, Setting};
use cityweld::{AlignOptions, CityModel, PlacePrior, PreparedCity, align};

/// Every fourth capture shows one fault alone.
const ALONE: u64 = 4;

/// What is asked of a capture.
#[derive(Clone, Copy, Debug)]
pub struct Questions {
    /// The right place first.
    pub errands: &'static [Errand],
    /// Whether the errand's start is told, or nothing of the place.
    pub with_start: bool,
}

impl Questions {
    pub const ALL: Questions = Questions { errands: &Errand::ALL, with_start: true };

    /// At the right place alone.
    pub fn of_first(self) -> Questions {
        Questions { errands: &self.errands[..1], ..self }
    }
}

/// One answer.
#[derive(Clone, Debug)]
pub struct Run {
    pub index: u64,
    pub setting: Setting,
    pub levels: Levels,
    /// The one fault of the capture, or the one that was taken away; `None` where all are mixed.
    pub fault: Option<&'static str>,
    pub errand: Errand,
    pub assessment: Assessment,
    /// Evidence of the best pose, what is needed, and the most that chance has, bits.
    pub bits: [f64; 3],
    /// Planes that speak for it, of those that the cloud saw.
    pub planes: [usize; 2],
}

impl Run {
    /// One line by which it is found again.
    pub fn line(&self) -> String {
        let (a, [bits, needed, by_chance], [speaking, seen]) = (&self.assessment, self.bits, self.planes);
        format!(
            "case {} {}, {}{}: {:?}, {bits:.1} bits of {needed:.1}, by chance {by_chance:.1}, {speaking} planes of {seen}; error {:.2} m, stated {:.2} m; held {}: error {:.2} m, stated {:.2} m, chi-square {:.1}; {}",
            self.index,
            self.setting.name(),
            self.errand.name(),
            self.fault.map_or(String::new(), |fault| format!(", {fault}")),
            a.outcome(),
            a.error_m,
            a.stated_m,
            a.held,
            a.held_error_m,
            a.held_stated_m,
            a.chi_square,
            self.levels,
        )
    }
}

/// All runs of capture `index`: of mixed faults with all questions, or of one fault with the first.
pub fn runs_of(seed: u64, index: u64, questions: Questions) -> Vec<Run> {
    if index % ALONE == ALONE - 1 {
        let faults = Levels::FAULTS.len() as u64;
        let number = index / ALONE;
        let fault = &Levels::FAULTS[(number % faults) as usize];
        return alone(seed, index, number / faults, fault, questions.of_first());
    }
    let Some(case) = Case::drawn(seed, mixed_number(index)) else { return Vec::new() };
    // Elsewhere no pose is right, or the start's place says nothing.
    let told_apart = Setting::TOLD_APART.contains(&case.setting);
    asked(&case, index, None, if told_apart { questions } else { questions.of_first() })
}

/// The number among the captures of mixed faults, without gaps.
pub fn mixed_number(index: u64) -> u64 {
    index - index / ALONE
}

/// The same capture for every fault: what differs is the fault.
fn alone(seed: u64, index: u64, capture: u64, (name, change): &Fault, questions: Questions) -> Vec<Run> {
    let setting = Setting::TOLD_APART[(capture % Setting::TOLD_APART.len() as u64) as usize];
    let mut levels = Levels::good();
    change(&mut levels);
    let case = Case::with(seed ^ 0xfa17, capture, setting, &levels);
    case.map_or(Vec::new(), |case| asked(&case, index, Some(*name), questions))
}

/// The case, asked these questions.
pub fn asked(case: &Case, index: u64, fault: Option<&'static str>, questions: Questions) -> Vec<Run> {
    let prepared = |city: CityModel| PreparedCity::new(city);
    let Some(city) = case.city().ok().map(prepared) else { return Vec::new() };
    let points = case.points();
    let run = |errand: &Errand| {
        let request = case.request(*errand);
        let options = match questions.with_start {
            true => AlignOptions::new(request.start),
            false => AlignOptions::anywhere(PlacePrior::default()),
        };
        let options = options.with_fixed_scale(request.fixed_scale);
        let sfm = &case.capture.survey.sfm;
        let (alignment, truth) = if *errand == Errand::ForeignTown {
            (align(&prepared(case.foreign_city().ok()?), sfm, None, &options, &()).unwrap(), None)
        } else {
            (align(&city, sfm, None, &options, &()).unwrap(), Some(&case.capture.survey.city_from_sfm))
        };
        let assessment = Assessment::new(&alignment, truth, &points);
        let told = &alignment.certainty;
        let (bits, planes) = ([told.bits, told.needed_bits, told.most_bits_by_chance], [told.speaking, told.witnesses]);
        Some(Run {
            index,
            setting: case.setting,
            levels: case.levels,
            fault,
            errand: *errand,
            assessment,
            bits,
            planes,
        })
    };
    questions.errands.iter().filter_map(run).collect()
}
