//! Words that readers stumble over, in place of numbers and names.

use crate::chance::Chance;

/// Numbers at the edges of types, and beyond them. All are text, since most are no number of any type.
const NUMBERS: [&str; 44] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "-2",
    "127",
    "128",
    "255",
    "256",
    "32767",
    "65535",
    "65536",
    "1000000",
    "2147483647",
    "2147483648",
    "-2147483648",
    "-2147483649",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "340282366920938463463374607431768211456",
    "0.5",
    "-0.5",
    "1e-320",
    "1e-9",
    "1e9",
    "1e19",
    "-1e19",
    "1e38",
    "1e39",
    "1e154",
    "1.7976931348623157e308",
    "-1.7976931348623157e308",
    "1e309",
    "-1e999",
    "0x10",
    "1.",
];

/// What stands where a number or a name should.
const ODD: [&str; 24] = [
    "NaN",
    "nan",
    "-nan",
    "inf",
    "-Infinity",
    "null",
    "true",
    "",
    " ",
    ".",
    "-",
    "+",
    "e",
    "1e",
    "--1",
    "1,5",
    "\u{0}",
    "\u{1b}[2J",
    "\u{202e}",
    "\u{fffd}",
    "..",
    "../../../../etc/passwd",
    "/dev/zero",
    "%00",
];

/// A number at an edge.
pub fn number(chance: &mut Chance) -> String {
    chance.pick(&NUMBERS).map_or(String::new(), |word| (*word).to_owned())
}

/// A number at an edge, or a word that is none, or a very long one.
pub fn odd(chance: &mut Chance) -> String {
    match chance.below(12) {
        0..=6 => number(chance),
        7..=10 => chance.pick(&ODD).map_or(String::new(), |word| (*word).to_owned()),
        _ => chance.pick(&["9", "a", "-", "0.", "\u{e9}"]).map_or(String::new(), |unit| unit.repeat(chance.few() * 8)),
    }
}

/// The word changed a little: its sign, a digit, a step up or down, its scale.
pub fn near(word: &str, chance: &mut Chance) -> String {
    let whole: Option<i128> = word.parse().ok();
    match (chance.below(5), whole) {
        (0, Some(value)) => (value + 1).to_string(),
        (1, Some(value)) => (value - 1).to_string(),
        (2, _) => format!("-{word}"),
        (3, _) => format!("{word}e{}", chance.pick(&["3", "-3", "300", "-300"]).unwrap_or(&"0")),
        _ => {
            let mut letters: Vec<char> = word.chars().collect();
            let at = chance.below(letters.len());
            if let Some(letter) = letters.get_mut(at) {
                *letter = *chance.pick(&['0', '9', '.', '-', 'e', ' ', 'x', '"']).unwrap_or(&'0');
            }
            letters.into_iter().collect()
        }
    }
}

/// Either of both.
pub fn spoiled(word: &str, chance: &mut Chance) -> String {
    if chance.one_in(2) { odd(chance) } else { near(word, chance) }
}
