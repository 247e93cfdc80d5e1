//! Remarks about an angle, in its name or beside it: the positive direction ("top in positive"), and the number of wheels
//! ("total").

use super::names::cut;

/// Direction in which the top of the wheel leans (camber) or the front of the wheel points (toe).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Inward,
    Outward,
}

impl Direction {
    fn opposite(self) -> Self {
        match self {
            Direction::Inward => Direction::Outward,
            Direction::Outward => Direction::Inward,
        }
    }
}

/// Sign of an angle, as a text (the angle's name or a remark beside it) states it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    /// The text states nothing.
    Unstated,
    /// The text states the positive direction: "top in positive", "negative = toe out".
    Positive(Direction),
    /// The text states a direction without a sign: "toe out".
    Alone(Direction),
    /// The text states that the angle is negative, and no direction: "negative camber".
    Negative,
    /// The text can be read in two ways: "toe in or toe out".
    Unclear,
}

impl Sign {
    /// Direction that the text states for a positive angle. `None` if it states no direction or is unclear.
    pub(super) fn direction(self) -> Option<Direction> {
        match self {
            Sign::Positive(direction) | Sign::Alone(direction) => Some(direction),
            Sign::Unstated | Sign::Negative | Sign::Unclear => None,
        }
    }
}

/// Wheels to which an angle belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wheels {
    /// The text states nothing, or one wheel.
    One,
    /// The angle is the sum of both wheels.
    Sum,
    /// The text names both wheels, but not whether the angle is their sum.
    Unclear,
}

/// Words that state a positive sign. [`NEGATIVE`] has the words for a negative sign.
const POSITIVE: &[&str] = &["positive", "pos", "plus"];
const NEGATIVE: &[&str] = &["negative", "neg", "minus"];
/// Words that make a following "in" a direction, as in "toe in". In "in degrees" and "in design position", "in" is not a
/// direction.
const BEFORE_IN: &[&str] = &[
    "toe", "top", "front", "nose", "lean", "leans", "leaning", "tilt", "tilts", "tilted", "is",
];
/// Words that mark an angle as the sum of both wheels.
const SUM: &[&str] = &["total", "overall", "sum", "together", "combined"];
/// Words that mark an angle as the angle of each wheel.
const EACH: &[&str] = &["each", "per", "same", "equal"];
/// Further words in remarks about the sign of an angle or about the number of wheels. [`without_remarks`] removes them.
const BESIDE: &[&str] = &["both", "wheels", "side", "sides", "top"];

/// True for a word that means positive, false for negative, `None` for any other word.
fn sign_of_word(word: &str) -> Option<bool> {
    if POSITIVE.contains(&word) {
        Some(true)
    } else {
        NEGATIVE.contains(&word).then_some(false)
    }
}

/// Direction that the word at position `at` of a remark names. "in" is a direction only beside certain words, and not before a
/// unit.
fn direction(words: &[String], at: usize) -> Option<Direction> {
    let is_sign = |word: &String| sign_of_word(word).is_some();
    match words[at].as_str() {
        "out" | "outward" | "outwards" | "outboard" => Some(Direction::Outward),
        "inward" | "inwards" | "inboard" => Some(Direction::Inward),
        "in" => {
            let (before, after) = (at.checked_sub(1).map(|k| &words[k]), words.get(at + 1));
            let is_after = before.is_some_and(|w| is_sign(w) || BEFORE_IN.contains(&w.as_str()));
            let is_unit = after.is_some_and(|w| super::angle_unit::is_unit(w));
            let is_direction = is_after || after.is_some_and(is_sign) || words.len() == 1;
            (is_direction && !is_unit).then_some(Direction::Inward)
        }
        _ => None,
    }
}

/// Writes the signs + and - of a text as words. A minus before a letter or a digit is a hyphen, except in "-ve". A minus between
/// spaces is a dash, unless "=" or ":" follows.
fn with_signs_as_words(text: &str) -> String {
    let text = text.replace("+/-", " ").replace('\u{b1}', " ");
    let chars: Vec<char> = text.chars().collect();
    let is_minus = |k: usize| {
        let before = k.checked_sub(1).map(|k| chars[k]);
        let after = chars.get(k + 1).copied();
        let both = |is: fn(char) -> bool| before.is_some_and(is) && after.is_some_and(is);
        let next = chars[k + 1..].iter().find(|c| !c.is_whitespace());
        let is_dash = both(char::is_whitespace) && !next.is_some_and(|c| "=:".contains(*c));
        let is_hyphen =
            after.is_some_and(char::is_alphanumeric) && !chars[k + 1..].starts_with(&['v', 'e']);
        "-\u{2212}".contains(chars[k]) && !both(char::is_alphanumeric) && !is_hyphen && !is_dash
    };
    let mut words = String::new();
    for (k, c) in chars.iter().enumerate() {
        match c {
            '+' => words += " positive ",
            _ if is_minus(k) => words += " negative ",
            c => words.push(*c),
        }
    }
    words
}

/// Returns the statement of a text about the sign of an angle. The bottom of a wheel leans the other way, so a text with "bottom"
/// is unclear.
pub(super) fn sign(text: &str) -> Sign {
    let words = cut(&with_signs_as_words(text));
    let directions: Vec<Direction> = (0..words.len())
        .filter_map(|k| direction(&words, k))
        .collect();
    let signs: Vec<bool> = words.iter().filter_map(|word| sign_of_word(word)).collect();
    let Some(first) = directions.first().copied() else {
        let is_negative = cut(text)
            .iter()
            .any(|word| NEGATIVE.contains(&word.as_str()));
        return if is_negative {
            Sign::Negative
        } else {
            Sign::Unstated
        };
    };
    let is_one_direction = directions.iter().all(|other| *other == first);
    let positive = |(direction, sign): (Direction, bool)| {
        if sign {
            direction
        } else {
            direction.opposite()
        }
    };
    if words.iter().any(|word| word == "bottom") {
        return Sign::Unclear;
    }
    let Some(sign) = signs.first().copied() else {
        return if is_one_direction {
            Sign::Alone(first)
        } else {
            Sign::Unclear
        };
    };
    if is_one_direction && signs.iter().all(|other| *other == sign) {
        return Sign::Positive(positive((first, sign)));
    }
    // "top out positive, top in negative" has a sign for each direction.
    let mut pairs = directions
        .iter()
        .copied()
        .zip(signs.iter().copied())
        .map(positive);
    let stated = pairs.next().unwrap_or(first);
    if directions.len() == signs.len() && pairs.all(|other| other == stated) {
        Sign::Positive(stated)
    } else {
        Sign::Unclear
    }
}

/// Returns the wheels to which an angle with this name and remark belongs.
pub(super) fn wheels(name: &str, remark: &str) -> Wheels {
    let words: Vec<String> = cut(name).into_iter().chain(cut(remark)).collect();
    let has = |known: &[&str]| words.iter().any(|word| known.contains(&word.as_str()));
    let of_axle = words.windows(2).any(|pair| pair == ["per", "axle"]);
    match (has(SUM) || of_axle, has(EACH) && !of_axle, has(&["both"])) {
        (true, false, _) => Wheels::Sum,
        (true, true, _) | (false, false, true) => Wheels::Unclear,
        (false, ..) => Wheels::One,
    }
}

/// Removes remarks from the words of an angle's name: "static toe deg toe out positive" becomes "static toe deg". Other words
/// stay, because they change the meaning ("toe at full bump").
pub(super) fn without_remarks(name: &mut Vec<String>) {
    let is_angle = |word: &String| word == "toe" || word == "camber";
    let Some(angle) = name.iter().position(is_angle) else {
        return;
    };
    let all = name.clone();
    let is_remark = |at: usize| {
        let word = all[at].as_str();
        let known = [BESIDE, EACH, POSITIVE, NEGATIVE];
        let is_known = known.iter().any(|words| words.contains(&word)) || *word == all[angle];
        let is_per_axle = word == "axle" && all[..at].last().is_some_and(|word| word == "per");
        // In "toe in rad", "in" is no unit of length.
        let is_of_angle = is_known || word == "in" || direction(&all, at).is_some();
        SUM.contains(&word) || at > angle && (is_of_angle || is_per_axle)
    };
    let mut at = 0;
    name.retain(|_| {
        at += 1;
        !is_remark(at - 1)
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_state_the_positive_direction() {
        use Direction::{Inward, Outward};
        for (text, expected) in [
            ("positive = top in", Sign::Positive(Inward)),
            ("top in positive", Sign::Positive(Inward)),
            ("top inboard positive", Sign::Positive(Inward)),
            ("+ve: leaning in", Sign::Positive(Inward)),
            ("top in +", Sign::Positive(Inward)),
            ("- = top in", Sign::Positive(Outward)),
            ("top in (-)", Sign::Positive(Outward)),
            ("negative top out", Sign::Positive(Inward)),
            ("top out positive, top in negative", Sign::Positive(Outward)),
            (
                "positive = top out; negative = top in",
                Sign::Positive(Outward),
            ),
            ("+ top out, top in -", Sign::Positive(Outward)),
            ("toe -in", Sign::Alone(Inward)),
            ("-ve: top in", Sign::Positive(Outward)),
            ("toe-out per side", Sign::Alone(Outward)),
            ("toe out - measured on the rig", Sign::Alone(Outward)),
            ("in", Sign::Alone(Inward)),
            ("in degrees", Sign::Unstated),
            ("positive in degrees", Sign::Unstated),
            ("in design position", Sign::Unstated),
            ("-", Sign::Unstated),
            ("+/- 0.1", Sign::Unstated),
            ("positive", Sign::Unstated),
            ("negative camber", Sign::Negative),
            ("top in positive, top out positive", Sign::Unclear),
            ("bottom in positive", Sign::Unclear),
            ("toe in or toe out", Sign::Unclear),
        ] {
            assert_eq!(sign(text), expected, "{text}");
        }
    }

    #[test]
    fn remarks_state_the_number_of_wheels() {
        for (text, expected) in [
            ("total", Wheels::Sum),
            ("total toe, both wheels", Wheels::Sum),
            ("deg, both wheels together", Wheels::Sum),
            ("deg per axle", Wheels::Sum),
            ("per side", Wheels::One),
            ("both wheels each", Wheels::One),
            ("left wheel", Wheels::One),
            ("both wheels", Wheels::Unclear),
            ("total, per wheel", Wheels::Unclear),
        ] {
            assert_eq!(wheels("Static toe", text), expected, "{text}");
        }
    }
}
