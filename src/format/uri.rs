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
