//! Finds the unit of an angle: from the angle's name, from a remark beside it, or from the file.

use super::names::cut;
use super::unit::FileUnit;

/// Unit of angles that a file states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AngleUnit {
    Degree,
    Radian,
    Milliradian,
    /// A unit that is rejected, such as minutes.
    Other,
}

impl AngleUnit {
    /// Unit of angles that a word names, in upper or lower case. `None` if it names none.
    pub(super) fn named(word: &str) -> Option<Self> {
        match word.to_lowercase().as_str() {
            "deg" | "degs" | "degree" | "degrees" => Some(AngleUnit::Degree),
            "rad" | "rads" | "radian" | "radians" => Some(AngleUnit::Radian),
            "mrad" | "milliradian" | "milliradians" => Some(AngleUnit::Milliradian),
            "min" | "minute" | "minutes" | "arcmin" | "arcminute" | "arcminutes" | "sec"
            | "second" | "seconds" | "arcsec" | "arcsecond" | "arcseconds" | "gon" | "grad"
            | "grads" | "gradian" | "gradians" | "percent" => Some(AngleUnit::Other),
            _ => None,
        }
    }

    /// Symbol of the unit, for messages.
    pub(super) fn symbol(self) -> &'static str {
        match self {
            AngleUnit::Degree => "deg",
            AngleUnit::Radian => "rad",
            AngleUnit::Milliradian => "mrad",
            AngleUnit::Other => "in another unit",
        }
    }

    /// Converts an angle from this unit to degrees. `None` for a unit that is rejected.
    pub(super) fn degrees(self, value: f64) -> Option<f64> {
        match self {
            AngleUnit::Degree => Some(value),
            AngleUnit::Radian => Some(value.to_degrees()),
            AngleUnit::Milliradian => Some((value / 1000.0).to_degrees()),
            AngleUnit::Other => None,
        }
    }
}

/// Returns the unit of an angle that its name or its remark states. [`AngleUnit::Other`] if they state a unit of length, or two
/// different units.
pub(super) fn of_angle(name: &str, remark: &str) -> Option<AngleUnit> {
    let is_length = |word: &str| word != "in" && FileUnit::named(word).is_some();
    let unit_of = |word: &String| {
        let length = is_length(word).then_some(AngleUnit::Other);
        length.or(AngleUnit::named(word))
    };
    let is_marked = name.contains("[in]") || [name, remark].into_iter().any(has_mark);
    let marked = is_marked.then_some(AngleUnit::Other);
    let words = cut(name).into_iter().chain(cut(remark));
    one_of(
        marked
            .into_iter()
            .chain(words.filter_map(|word| unit_of(&word))),
    )
}

/// Unit of all angles, if a line without values states it: "angles in radians", `Units: mm, rad`. [`AngleUnit::Other`] if the line
/// states two different units.
pub(super) fn of_line(texts: &[&str]) -> Option<AngleUnit> {
    let words: Vec<String> = texts.iter().flat_map(|text| cut(text)).collect();
    let has = |wanted: &str| {
        let mut known = wanted.split(' ');
        known.any(|wanted| words.iter().any(|word| word == wanted))
    };
    let (says_angles, says_units) = (has("angle angles angular"), has("unit units"));
    let of_word = |word: &String| match AngleUnit::named(word)? {
        AngleUnit::Radian if word.starts_with("radian") => Some(AngleUnit::Radian),
        AngleUnit::Other if !says_angles => None,
        unit => (says_angles || says_units).then_some(unit),
    };
    one_of(words.iter().filter_map(of_word))
}

/// Returns the unit if all these units are equal, and [`AngleUnit::Other`] if they differ. `None` without a unit.
fn one_of(mut units: impl Iterator<Item = AngleUnit>) -> Option<AngleUnit> {
    let first = units.next()?;
    let is_same = units.all(|other| other == first);
    Some(if is_same { first } else { AngleUnit::Other })
}

/// True if a text has the sign of minutes, seconds or percent. A sign directly after a letter or a digit does not count (driver's,
/// 10"), and quotes around the text do not count.
fn has_mark(text: &str) -> bool {
    let text = text.trim();
    let quotes = |c: char| "'\"".contains(c);
    let quoted = text
        .strip_prefix(quotes)
        .and_then(|inner| inner.strip_suffix(quotes));
    let chars: Vec<char> = quoted.unwrap_or(text).chars().collect();
    let is_mark = |k: usize| {
        let before = k.checked_sub(1).map(|k| chars[k]);
        let is_after_word = before.is_some_and(char::is_alphanumeric);
        "'\u{2032}\u{2019}\"\u{2033}\u{201d}%".contains(chars[k]) && !is_after_word
    };
    (0..chars.len()).any(is_mark)
}

/// True if a text is only a unit of lengths or angles, also in brackets: `mm`, `[rad]`, `'`.
pub(super) fn is_unit(text: &str) -> bool {
    let word = text.trim().trim_matches(['[', ']', '(', ')']).trim();
    let is_mark = word.chars().count() == 1 && has_mark(word);
    word == "\u{b0}"
        || is_mark
        || FileUnit::named(word).is_some()
        || AngleUnit::named(word).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_minutes_are_not_apostrophes() {
        for (text, is_marked) in [
            ("toe (')", true),
            ("toe [\u{2032}]", true),
            ("toe [%]", true),
            ("\"", true),
            ("driver's toe", false),
            ("'toe'", false),
            ("for 10\" rims", false),
            ("toe [\u{b0}]", false),
        ] {
            assert_eq!(has_mark(text), is_marked, "{text}");
        }
    }

    #[test]
    fn lines_state_the_unit_of_angles() {
        for (line, unit) in [
            ("# angles in radians", Some(AngleUnit::Radian)),
            ("angle unit: deg", Some(AngleUnit::Degree)),
            ("Units: mm, rad", Some(AngleUnit::Radian)),
            (
                "all dimensions in mm, angles in minutes",
                Some(AngleUnit::Other),
            ),
            ("angles in deg, toe angle in rad", Some(AngleUnit::Other)),
            ("takes 5 min", None),
            ("all dimensions in mm", None),
        ] {
            assert_eq!(of_line(&[line]), unit, "{line}");
        }
    }
}
