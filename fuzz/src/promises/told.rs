//! What people are shown: one clear message, and nothing that steers a terminal.

/// Letters of a message beside its path. Chosen: what fills half a screen is not read.
const LONGEST: usize = 2000;

pub fn check(message: &str) -> Result<(), String> {
    let start: String = message.chars().take(200).map(|c| if is_steering(c) { '?' } else { c }).collect();
    if message.trim().is_empty() {
        return Err("a message says nothing".to_owned());
    }
    if message.chars().any(is_steering) {
        return Err(format!("a message steers the terminal: {start}"));
    }
    match message.chars().count() {
        count if count > LONGEST => Err(format!("a message of {count} letters: {start}")),
        _ => Ok(()),
    }
}

/// Control characters, and those that turn the direction of writing.
fn is_steering(letter: char) -> bool {
    (letter.is_control() && letter != '\n') || matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
