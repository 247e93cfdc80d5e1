//! Units in lines above and below a header, and in the row of units below it.

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

/// Unit in a line below a header: `Units: inches`, "All dimensions in mm".
pub(super) fn unit_below(texts: &[&str]) -> Option<FileUnit> {
    const FIRST: [&str; 6] = [
        "all",
        "unit",
        "units",
        "dimensions",
        "lengths",
        "coordinates",
    ];
    let first = cut(texts.first()?).into_iter().next()?;
    // A line such as "Units: N/mm" is about rates.
    let is_rate = texts.iter().any(|text| text.contains('/'));
    let found = unit_above(texts).filter(|_| !is_rate);
    found.filter(|_| FIRST.contains(&first.as_str()))
}

/// Unknown unit of length in the lines above a header, such as `units, parsec`.
pub(super) fn unknown_above<'t>(texts: &[&'t str]) -> Option<&'t str> {
    let word = value_of_unit(texts)?;
    let is_word = word.chars().all(char::is_alphabetic);
    (is_word && unit_above(texts).is_none()).then_some(word)
}

/// Value of a line with the key "unit" or, in OptimumKinematics, "Length": `unit, mm`, `Units: cm`,
/// `User Options, Length, centimeter, cm`.
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

/// Text without brackets and spaces around it.
pub(super) fn without_brackets(text: &str) -> &str {
    text.trim().trim_matches(['[', ']', '(', ')']).trim()
}

/// Texts in the columns of coordinates, for a row of units below the header. `None` if one of the first three texts is missing or
/// is not a unit.
pub(super) fn unit_row<'t>(numbers: &[[Option<&'t Cell>; 3]]) -> Option<Vec<&'t str>> {
    let is_unit = |cell: &Option<&'t Cell>| {
        let word = cell.and_then(text).map(without_brackets);
        word.is_some_and(|word| FileUnit::named(word).is_some())
    };
    let is_row = numbers.first()?.iter().all(is_unit);
    is_row.then(|| {
        numbers
            .iter()
            .flatten()
            .flatten()
            .copied()
            .filter_map(text)
            .collect()
    })
}
