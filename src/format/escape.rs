//! Text that came out of a file, fit to be shown.

use std::fmt;

/// Shows text from a file with everything that would steer a terminal or forge a line written out, as in `\u{1b}`:
/// control characters, separators of lines and paragraphs, and marks that turn the direction of writing.
pub fn escaped(text: &str) -> impl fmt::Display + '_ {
    Escaped(text)
}

/// JSON text with what would steer a terminal written as JSON's own escapes, as in `\u202e`: it says the same.
///
/// JSON leaves such characters plain in its strings, all but the first 32; elsewhere it has none but line ends.
#[cfg(feature = "cli")]
pub fn escaped_json(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        if steers(c) && c != '\n' {
            escaped.push_str(&format!("\\u{:04x}", u32::from(c)));
        } else {
            escaped.push(c);
        }
    }
    escaped
}

struct Escaped<'a>(&'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rest = self.0;
        while let Some(at) = rest.find(steers) {
            let (plain, from_it_on) = rest.split_at(at);
            let mut characters = from_it_on.chars();
            let steering = characters.next().map_or(0, u32::from);
            write!(f, "{plain}\\u{{{steering:x}}}")?;
            rest = characters.as_str();
        }
        f.write_str(rest)
    }
}

fn steers(c: char) -> bool {
    // The marks of direction: Unicode Standard Annex 9, section 2.
    c.is_control()
        || matches!(c, '\u{2028}' | '\u{2029}')
        || matches!(c, '\u{061C}' | '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_written_out() {
        let shown = |text: &str| escaped(text).to_string();
        assert_eq!(shown("\x1b[2J\x1b]0;owned\x07"), "\\u{1b}[2J\\u{1b}]0;owned\\u{7}");
        assert_eq!(shown("a\nwarning: b\r\t\0"), "a\\u{a}warning: b\\u{d}\\u{9}\\u{0}");
        assert_eq!(shown("\u{9b}31m \u{7f}"), "\\u{9b}31m \\u{7f}");
        assert_eq!(shown("a\u{2028}b\u{2029}"), "a\\u{2028}b\\u{2029}");
        assert_eq!(shown("\u{202e}gpj.\u{2066}\u{200f}"), "\\u{202e}gpj.\\u{2066}\\u{200f}");
    }

    #[cfg(feature = "cli")]
    #[test]
    fn json_says_the_same_without_steering_a_terminal() {
        let name = "a\u{202e}gpj.\u{9b}31m\x1b[2J\n\u{7f} Straße";
        let json = serde_json::to_string_pretty(&[name]).unwrap();
        let shown = escaped_json(&json);
        assert_eq!(shown, "[\n  \"a\\u202egpj.\\u009b31m\\u001b[2J\\n\\u007f Straße\"\n]");
        assert_eq!(serde_json::from_str::<[String; 1]>(&shown).unwrap(), [name]);
    }

    #[test]
    fn names_in_any_script_stay_as_they_are() {
        for name in ["", "Straße 7", "東京駅", "برج", "a\\b \"c\" 'd'", "🏠"] {
            assert_eq!(escaped(name).to_string(), name);
        }
    }
}
