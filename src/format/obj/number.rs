//! Decimal text to f64, exactly rounded.

use super::ObjProblem;

/// Metres. The Earth fits in a hundred times over; beyond it, squares of coordinates would lose what areas need.
const COORDINATE_LIMIT: f64 = 1e9;

/// Whole numbers up to this are exact in f64.
const EXACT_WHOLE: u64 = 1 << 53;

/// Powers of ten that are exact in f64, as far as they are needed.
const EXACT_POWERS: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// A coordinate: any decimal number; NaN where it is out of reach.
pub(super) fn coordinate(word: &[u8]) -> Result<f64, ObjProblem> {
    let value = plain_decimal(word).or_else(|| std::str::from_utf8(word).ok()?.parse().ok());
    match value {
        Some(value) if value.abs() <= COORDINATE_LIMIT => Ok(value),
        Some(_) => Ok(f64::NAN),
        None => Err(ObjProblem::NotANumber { token: String::from_utf8_lossy(word).into_owned() }),
    }
}

/// Digits with at most one point and no exponent, few enough that numerator and power of ten are exact; then their
/// quotient is the nearest f64. It serves nearly every number of a city, in a fraction of the general parser's time.
fn plain_decimal(word: &[u8]) -> Option<f64> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, word),
    };
    // Eighteen digits cannot overflow.
    if digits.len() > 19 {
        return None;
    }
    let mut whole: u64 = 0;
    let mut point = None;
    for (at, &byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => whole = 10 * whole + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(at),
            _ => return None,
        }
    }
    let decimals = point.map_or(0, |at| digits.len() - 1 - at);
    let some_digit = digits.len() > usize::from(point.is_some());
    if !some_digit || whole > EXACT_WHOLE || (point.is_none() && digits.len() == 19) {
        return None;
    }
    let value = whole as f64 / EXACT_POWERS.get(decimals)?;
    Some(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_decimals_equal_the_general_parser_to_the_last_bit() {
        let texts =
            ["0", "-0", "5500000.123", "90851.4533", "-.5", "7.", "0.1", "123456789.123456", "9007199254740993"];
        let made = (0..2000).map(|at| format!("{}.{:04}", at * 2753 % 90001, at * 7919 % 10007));
        for text in texts.into_iter().map(str::to_owned).chain(made) {
            let expected: f64 = text.parse().unwrap();
            if let Some(value) = plain_decimal(text.as_bytes()) {
                assert_eq!(value.to_bits(), expected.to_bits(), "{text}");
            }
        }
        assert_eq!(coordinate(b"1.5e3"), Ok(1500.0));
        assert_eq!(coordinate(b"+2"), Ok(2.0));
    }

    #[test]
    fn what_is_no_place_is_nan_and_what_is_no_number_is_refused() {
        for word in ["nan", "inf", "-infinity", "1e300", "1000000001", "99999999999999999999999"] {
            assert!(coordinate(word.as_bytes()).unwrap().is_nan(), "{word}");
        }
        for word in ["", "-", ".", "1,5", "1.2.3", "x", "0x10", "1d5", "\u{661}"] {
            assert!(matches!(coordinate(word.as_bytes()), Err(ObjProblem::NotANumber { .. })), "{word}");
        }
    }
}
