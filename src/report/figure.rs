//! Formats numbers for people: with enough digits, and without rounding errors.
//!
//! A value that should be zero is computed as about 1e-16 of its inputs, such as 7e-34 degrees or 2e-15 mm. Such a number has no
//! meaning, so it is shown as 0. The size of the inputs follows from the unit: coordinates of a wheel suspension are about a
//! metre, angles about a radian. Files keep every number as it is ([`shortest`]).

use super::shortest;

/// Number of digits shown for the largest of several numbers.
const DIGITS: i32 = 6;

/// Largest number of significant digits in a number that a person writes.
const WRITTEN_DIGITS: usize = 9;

/// Differences up to this fraction of the inputs of a number are rounding errors. Rates are accurate to 1e-11.
const ROUNDING: f64 = 1e-11;

/// Value without a negative zero. `None` if it is not finite.
pub(super) fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value + 0.0)
}

/// Formats with six significant digits, and at most nine decimals. Below 1e-5 and from 1e7, the number has an exponent.
pub fn brief(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = magnitude(value);
    if !(-5..7).contains(&magnitude) {
        let text = format!("{value:.5e}");
        // An infinite number has no exponent.
        let Some((digits, power)) = text.split_once('e') else {
            return text;
        };
        return format!("{}e{power}", without_zeros(digits));
    }
    let decimals = (DIGITS - 1 - magnitude).clamp(0, 9) as usize;
    without_zeros(&format!("{value:.decimals$}")).to_owned()
}

/// Compares the end of a range (`value`) with the requested end (`wanted`): `ends at 7.5, not 8`. If both have the same six digits,
/// the text states the difference: `ends 2e-6 below 8`. A difference of at most 1e-9 is a rounding error: `reaches 8`.
pub fn ends_at(value: f64, wanted: f64) -> String {
    let (reached, target) = (brief(value), brief(wanted));
    if reached != target {
        return format!("ends at {reached}, not {target}");
    }
    let apart = (value - wanted).abs();
    if apart <= 1e-9 {
        return format!("reaches {target}");
    }
    let above = if value > wanted { "above" } else { "below" };
    format!("ends {} {above} {target}", brief(apart))
}

/// Formats with six significant digits. A rounding error in this unit (named as in columns: `deg_per_mm`) becomes 0.
pub fn figure(value: f64, unit: &str) -> String {
    if value.abs() < resolution(unit) {
        "0".to_owned()
    } else {
        brief(value)
    }
}

/// Formats values side by side, with the number of decimals that suits the largest value. A value that would have fewer than two
/// digits gets its own decimals. The text of an unknown value is empty.
pub fn figures<const N: usize>(values: [Option<f64>; N], unit: &str) -> [String; N] {
    let largest = values
        .iter()
        .flatten()
        .fold(0.0, |m: f64, v| m.max(v.abs()));
    let power = magnitude(largest);
    if largest < resolution(unit) || !(-5..7).contains(&power) {
        return values.map(|v| v.map_or_else(String::new, |v| figure(v, unit)));
    }
    let decimals = (DIGITS - 1 - power).clamp(0, 9) as usize;
    let (rounding, two_digits) = (resolution(unit), 10f64.powi(1 - decimals as i32));
    let is_small = |v: f64| v.abs() >= rounding && v.abs() < two_digits;
    let shown = values.map(|v| {
        v.filter(|v| !is_small(*v))
            .map(|v| with_decimals(v, decimals))
    });
    let zeros = |text: &String| text.len() - without_zeros(text).len();
    let spare = shown.iter().flatten().map(zeros).min().unwrap_or(0);
    let mut texts =
        shown.map(|text| text.map_or_else(String::new, |t| t[..t.len() - spare].to_owned()));
    for (text, value) in texts.iter_mut().zip(values) {
        if let Some(value) = value.filter(|v| is_small(*v)) {
            *text = brief(value);
        }
    }
    texts
}

/// Text of a power of ten: `10⁻³`.
pub(super) fn power_of_ten(power: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        digit => {
            let place = digit.to_digit(10).unwrap_or(0) as usize;
            ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][place]
        }
    };
    let digits = power.to_string();
    "10".chars().chain(digits.chars().map(raised)).collect()
}

/// Replaces the hyphens that are signs of numbers by minus signs, for pages. Hyphens within words, names and ranges stay.
pub fn with_minus_signs(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    let mut before: [Option<char>; 2] = [None, None];
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let begins = match before[1] {
            None => true,
            // A hyphen after "e" is the sign of an exponent, as in 1e-9.
            Some('e') => before[0].is_some_and(|digit| digit.is_ascii_digit()),
            Some(other) => other.is_whitespace() || "([{,:;=\u{00b1}".contains(other),
        };
        let is_number = rest.peek().is_some_and(char::is_ascii_digit);
        shown.push(if c == '-' && begins && is_number {
            '\u{2212}'
        } else {
            c
        });
        before = [before[1], Some(c)];
    }
    shown
}

/// Formats a number with this many decimals, without a negative zero.
pub fn with_decimals(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if !has_digits(zero) => zero.to_owned(),
        _ => text,
    }
}

/// True if a printed number is not 0.
pub fn has_digits(text: &str) -> bool {
    text.contains(|c: char| ('1'..='9').contains(&c))
}

/// Writes a plus sign before a positive value whose text is not 0.
pub fn with_plus(value: f64, text: String) -> String {
    if value > 0.0 && has_digits(&text) {
        format!("+{text}")
    } else {
        text
    }
}

/// Rounds to this number of significant digits.
pub fn to_digits(value: f64, digits: usize) -> f64 {
    let decimals = digits.saturating_sub(1);
    format!("{value:.decimals$e}").parse().unwrap_or(value)
}

/// Formats a number as the user wrote it, but without a trailing ".0". A number with more digits than people write, such as one
/// from a conversion of units, gets six significant digits.
pub fn as_written(value: f64) -> String {
    let text = shortest(value);
    let text = text.strip_suffix(".0").unwrap_or(&text);
    let digits = text.split('e').next().unwrap_or(text);
    let digits = digits.chars().filter(char::is_ascii_digit);
    let digits = digits.skip_while(|digit| *digit == '0').count();
    if digits > WRITTEN_DIGITS {
        return brief(value);
    }
    text.to_owned()
}

/// Size of a rounding error in a unit. The unit is named as in columns: `deg`, `deg_per_mm2`, `N_mm`.
pub fn resolution(unit: &str) -> f64 {
    let (above, below) = match unit.strip_prefix("per_") {
        Some(below) => ("", below),
        None => unit.split_once("_per_").unwrap_or((unit, "")),
    };
    let product = |units: &str| units.split('_').map(size).product::<f64>();
    ROUNDING * product(above) / product(below)
}

/// Typical size of the inputs of a quantity in this unit.
fn size(unit: &str) -> f64 {
    let with = |digit: char, power: i32| unit.strip_suffix(digit).map(|unit| (unit, power));
    let (unit, power) = with('2', 2).or(with('3', 3)).unwrap_or((unit, 1));
    let size: f64 = match unit {
        "mm" => 1e3,
        "in" => 40.0,
        "deg" => 57.0,
        "percent" => 1e2,
        "N" => 1e3,
        "lbf" => 200.0,
        _ => 1.0,
    };
    size.powi(power)
}

/// Power of ten of the number's first digit: 2 for 350.
fn magnitude(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// Removes trailing zeros of a decimal number.
pub(super) fn without_zeros(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brief_numbers_keep_six_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.515661, "-0.515661"),
            (12.5, "12.5"),
            (123456.7, "123457"),
            (1e-9, "1e-9"),
            (-1.23456789e-9, "-1.23457e-9"),
            (300.0, "300"),
            (9.9999999, "10"),
            (1.23456789e-5, "0.000012346"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(brief(value), text);
        }
    }

    /// Numbers that a person wrote stay as they are. Numbers from a conversion of units have six digits.
    #[test]
    fn written_numbers_have_few_digits() {
        for (value, text) in [
            (60.0, "60"),
            (-0.000123, "-0.000123"),
            (123456.789, "123456.789"),
            (123456789.0, "123456789"),
            (1234567890.0, "1.23457e9"),
            (0.1 + 0.2, "0.3"),
            (60.0 / 25.4, "2.3622"),
            (-15.0 / 25.4, "-0.590551"),
        ] {
            assert_eq!(as_written(value), text);
        }
    }

    #[test]
    fn an_end_never_equals_the_value_that_it_misses() {
        assert_eq!(ends_at(7.5, 8.0), "ends at 7.5, not 8");
        assert_eq!(ends_at(8.0 - 2e-6, 8.0), "ends 2e-6 below 8");
        assert_eq!(ends_at(-7.9999997, -8.0), "ends 3e-7 above -8");
        assert_eq!(ends_at(8.0 + 1e-12, 8.0), "reaches 8");
        assert_eq!(ends_at(0.0, 1e-7), "ends at 0, not 1e-7");
    }

    #[test]
    fn signs_of_numbers_become_minus_signs_and_hyphens_stay() {
        let same = [
            "camber",
            "four-link",
            "2026-05-01",
            "--round 0.5",
            "a - b",
            "front-2",
            "-",
        ];
        for text in same {
            assert_eq!(with_minus_signs(text), text);
        }
        for (text, shown) in [
            ("-0.5", "\u{2212}0.5"),
            ("1e-9", "1e\u{2212}9"),
            ("-1.2e-7", "\u{2212}1.2e\u{2212}7"),
            ("from -80 to 80", "from \u{2212}80 to 80"),
            ("[-1.5, -2]", "[\u{2212}1.5, \u{2212}2]"),
            ("toe-in -0.1 deg", "toe-in \u{2212}0.1 deg"),
        ] {
            assert_eq!(with_minus_signs(text), shown);
        }
    }

    #[test]
    fn rounding_is_no_figure() {
        assert_eq!(figure(-7.26471e-34, "deg"), "0");
        assert_eq!(figure(1.98588e-15, "mm"), "0");
        assert_eq!(figure(3e-15, "per_mm"), "0");
        // Values that really differ from zero are shown.
        assert_eq!(figure(1e-6, "deg"), "1e-6");
        assert_eq!(figure(2.5e-9, "deg_per_mm2"), "2.5e-9");
        assert_eq!(figure(2e-15, "deg_per_mm"), "0");
    }

    #[test]
    fn figures_side_by_side_have_the_decimals_of_the_largest() {
        let shown = figures([Some(-0.515661), Some(-12.3456789), Some(1e-12)], "deg");
        assert_eq!(shown, ["-0.5157", "-12.3457", "0.0000"]);
        assert_eq!(
            figures([Some(575.0), None, Some(564.1)], "mm"),
            ["575.0", "", "564.1"]
        );
        assert_eq!(figures([Some(-1e-17), Some(2e-34)], "deg"), ["0", "0"]);
        let far = figures([Some(-0.0102346), Some(-935_228.4)], "deg_per_mm");
        assert_eq!(far, ["-0.0102346", "-935228"]);
        assert_eq!(
            figures([Some(2e-7), Some(1e-7)], "per_mm"),
            ["2e-7", "1e-7"]
        );
    }
}
