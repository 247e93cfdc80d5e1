//! Units in the lines above a header and in the row below it.

use super::super::cell::Cell;
use super::super::header::text;
use super::super::names::cut;
use super::super::unit::FileUnit;

/// Unit in the lines above a header: `unit, mm` or "all dimensions in inches".
pub(super) fn unit_above(texts: &[&str]) -> Option<FileUnit> {
    if let Some(unit) = value_of_unit(texts).and_then(FileUnit::named) {
        return Some(unit);
    }
    let mut words = texts.iter().flat_map(|text| cut(text));
    // In running text, "in" and "m" have other meanings.
    words.find_map(|word| FileUnit::named(&word).filter(|_| word != "in" && word != "m"))
}

/// Unknown unit of length in the lines above a header, such as `units, parsec`.
pub(super) fn unknown_above<'t>(texts: &[&'t str]) -> Option<&'t str> {
    let word = value_of_unit(texts)?;
    let is_word = word.chars().all(char::is_alphabetic);
    (is_word && unit_above(texts).is_none()).then_some(word)
}

/// Value of a line with the key "unit": `unit, mm`, `Units: cm`, `User Options, Length, centimeter, cm`.
fn value_of_unit<'t>(texts: &[&'t str]) -> Option<&'t str> {
    let (key, value) = match texts {
        [only] => only.split_once([':', '='])?,
        ["User Options", key, value, ..] | [key, value, ..] => (*key, *value),
        [] => return None,
    };
    let words = cut(key);
    let is_key = words.iter().any(|word| word == "unit" || word == "units")
        || (texts.first() == Some(&"User Options") && words == ["length"]);
    let is_length = words.iter().all(|word| {
        "unit units length lengths of coordinates coordinate"
            .split(' ')
            .any(|known| known == word)
    });
    (is_key && is_length).then_some(without_brackets(value))
}

pub(super) fn without_brackets(text: &str) -> &str {
    text.trim().trim_matches(['[', ']', '(', ')']).trim()
}

/// Unit in all three columns of coordinates, in a row of units below the header.
pub(super) fn unit_row<'t>(numbers: &[[Option<&'t Cell>; 3]]) -> Option<&'t str> {
    let texts = numbers.first()?.map(|cell| cell.and_then(text));
    let [Some(x), Some(y), Some(z)] = texts else {
        return None;
    };
    (x == y && y == z && FileUnit::named(without_brackets(x)).is_some()).then_some(x)
}
