//! Decimal numbers without the rounding errors of a conversion of units.

/// Largest number of significant digits that all decimal numbers keep in double precision.
const KEPT_DIGITS: usize = 15;

/// Largest number of digits that an exact conversion adds to a number. The factor 25.4 has three digits.
const ADDED_DIGITS: usize = 3;

/// Converts a decimal number to another unit, if the result is also a decimal number: 9.5 in are 241.3 mm, not
/// 241.29999999999998 mm. `there` converts to the other unit, and `back` is the inverse. `None` in these cases:
///
/// - The result differs from the nearest decimal number with 15 digits by more than rounding errors.
/// - One of the two numbers has many more digits than the other. Then the result is near a decimal number only by chance.
/// - The conversion back would give another value.
pub(crate) fn short_decimal(
    value: f64,
    there: impl Fn(f64) -> f64,
    back: impl Fn(f64) -> f64,
) -> Option<f64> {
    let given = digits(value);
    let short = near_decimal(there(value)).filter(|_| given <= KEPT_DIGITS)?;
    let again = back(short);
    let is_same = near_decimal(again).unwrap_or(again) == value;
    (is_same && digits(short) <= given + ADDED_DIGITS).then_some(short)
}

/// Nearest decimal number with 15 significant digits. `None` if it differs from the value by more than 2 units in the last place.
fn near_decimal(value: f64) -> Option<f64> {
    let decimal: f64 = format!("{value:.*e}", KEPT_DIGITS - 1).parse().ok()?;
    (value.to_bits().abs_diff(decimal.to_bits()) <= 2).then_some(decimal)
}

/// Number of significant digits of the shortest decimal number that is stored as this value.
fn digits(value: f64) -> usize {
    let text = format!("{value:e}");
    let mantissa = text.chars().take_while(|c| *c != 'e');
    mantissa.filter(char::is_ascii_digit).count()
}
