//! References to files beside, as URIs.

/// A URI with its `%20` turned back; nothing where that is no UTF-8.
pub(super) fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let hex = |digit: u8| char::from(digit).to_digit(16);
        match (first, tail) {
            (b'%', [high, low, after @ ..]) if hex(*high).is_some() && hex(*low).is_some() => {
                bytes.push((16 * hex(*high)? + hex(*low)?) as u8);
                rest = after;
            }
            _ => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).ok()
}

/// Enough of a URI to know it by.
pub(super) fn shortened(uri: &str) -> String {
    const SHOWN: usize = 60;
    if uri.chars().count() <= SHOWN { uri.to_owned() } else { uri.chars().take(SHOWN).chain("...".chars()).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hundredths_are_turned_back_and_odd_ones_left() {
        assert_eq!(percent_decoded("a%20b%2Fc%2").as_deref(), Some("a b/c%2"));
        assert_eq!(percent_decoded("100%zz").as_deref(), Some("100%zz"));
        assert_eq!(percent_decoded("%C3%BC").as_deref(), Some("\u{fc}"));
        assert_eq!(percent_decoded("%ff"), None);
    }

    #[test]
    fn long_names_are_shortened_between_letters() {
        assert_eq!(shortened("short"), "short");
        assert_eq!(shortened(&"\u{fc}".repeat(100)).chars().count(), 63);
    }
}
