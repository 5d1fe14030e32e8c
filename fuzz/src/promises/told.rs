//! What people are shown: a message, and nothing in it that steers a terminal. How long it is does not matter: the program cuts its lines.

pub fn check(message: &str) -> Result<(), String> {
    let start: String = message.chars().take(200).map(|c| if is_steering(c) { '?' } else { c }).collect();
    if message.trim().is_empty() {
        return Err("a message says nothing".to_owned());
    }
    if message.chars().any(is_steering) {
        return Err(format!("a message steers the terminal: {start}"));
    }
    Ok(())
}

/// Control characters, and those that turn the direction of writing.
fn is_steering(letter: char) -> bool {
    (letter.is_control() && letter != '\n') || matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}
