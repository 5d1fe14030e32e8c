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

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, element: Element) -> Result<Vec<f64>, String> {
        let mut numbers = vec![9.0];
        numbers_of(text, element, &mut numbers).map(|()| numbers)
    }

    #[test]
    fn numbers_stand_between_spaces_of_any_kind() {
        assert_eq!(read(" 1\t-2.5e3\r\n+.5 ", Element::Positions).unwrap(), [1.0, -2500.0, 0.5]);
        assert_eq!(read("", Element::Positions).unwrap(), [0.0; 0]);
        assert_eq!(read("1,2,3 4,5,6", Element::Coordinates).unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn what_is_no_finite_number_is_shown_shortened() {
        for word in ["NaN", "inf", "-Infinity", "1e400", "0x10", "1,5", "12m"] {
            assert!(read(word, Element::Positions).unwrap_err().contains(&format!("`{word}`")), "{word}");
        }
        let long = "x".repeat(1000);
        assert!(read(&long, Element::Positions).unwrap_err().len() < 120);
    }
}
