//! Numbers out of texts.

use super::element::Element;

/// The numbers of a text between spaces; of `coordinates` also between commas. Each must be finite.
pub(super) fn numbers_of(text: &str, element: Element, numbers: &mut Vec<f64>) -> Result<(), String> {
    numbers.clear();
    if element == Element::Coordinates {
        return text.split([',', ' ', '\n', '\r', '\t']).filter(|word| !word.is_empty()).try_for_each(|word| {
            numbers.push(number(word)?);
            Ok(())
        });
    }
    for word in text.split_ascii_whitespace() {
        numbers.push(number(word)?);
    }
    Ok(())
}

fn number(word: &str) -> Result<f64, String> {
    match fast_float2::parse::<f64, _>(word) {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{}` is no coordinate; expected a finite number", shortened(word))),
    }
}

fn shortened(word: &str) -> String {
    const SHOWN: usize = 40;
    if word.chars().count() <= SHOWN {
        word.to_owned()
    } else {
        word.chars().take(SHOWN).chain("...".chars()).collect()
    }
}
