use super::*;

/// Wants the end from the start.
struct Impatient;

impl Observer for Impatient {
    fn is_cancelled(&self) -> bool {
        true
    }
}

#[test]
fn who_watches_nothing_never_ends_the_work_and_who_wants_the_end_gets_it() {
    assert_eq!(check_cancelled(&()), Ok(()));
    assert_eq!(check_cancelled(&Impatient), Err(Cancelled));
    assert_eq!(Cancelled.to_string(), "ended before it was done");
}

#[test]
fn every_stage_has_words_of_its_own() {
    let stages = [
        Stage::Superpixels,
        Stage::Patches,
        Stage::City,
        Stage::Places,
        Stage::Search,
        Stage::Evidence,
        Stage::ComparingParts,
        Stage::JoiningParts,
    ];
    let words: std::collections::BTreeSet<String> = stages.iter().map(ToString::to_string).collect();
    assert_eq!(words.len(), stages.len());
}
