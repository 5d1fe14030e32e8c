//! Cures: one capture again, with one fault after the other taken away. What makes its answer wrong?

use cityweld::synthetic::{Case, Fault, Levels};

use crate::runs::{Questions, Run, asked, mixed_number};

/// At the right place; the first line is the capture as it is.
pub fn print(seed: u64, index: u64) {
    let number = mixed_number(index);
    let Some(case) = Case::drawn(seed, number) else { return println!("no such capture can be made") };
    println!("{}: {}", case.setting.name(), case.levels);
    for cure in Levels::CURES {
        for run in cured(seed, number, &case, cure) {
            let a = run.assessment;
            println!("{:16} {:?}, error {:.2} m, stated {:.2} m", cure.0, a.outcome(), a.error_m, a.stated_m);
        }
    }
}

fn cured(seed: u64, number: u64, case: &Case, (name, change): &Fault) -> Vec<Run> {
    let mut levels = case.levels;
    change(&mut levels);
    let cured = Case::with(seed, number, case.setting, &levels);
    cured.map_or(Vec::new(), |case| asked(&case, number, Some(*name), Questions::ALL.of_first()))
}
