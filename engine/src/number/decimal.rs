//! Decimal numbers without the rounding errors of a conversion of units.

/// Converts a value to another unit, as a decimal number with at most 15 significant digits: 9.5 in are 241.3 mm, not
/// 241.29999999999998 mm. `there` converts to the other unit, and `back` is the inverse. `None` if the conversion has no such
/// result: it would differ from the computed result by more than rounding errors, or its conversion back would give another value.
pub(crate) fn short_decimal(
    value: f64,
    there: impl Fn(f64) -> f64,
    back: impl Fn(f64) -> f64,
) -> Option<f64> {
    let short = near_decimal(there(value))?;
    let again = back(short);
    (near_decimal(again).unwrap_or(again) == value).then_some(short)
}

/// Nearest decimal number with 15 significant digits. `None` if it differs from the value by more than 2 units in the last place.
fn near_decimal(value: f64) -> Option<f64> {
    let decimal: f64 = format!("{value:.14e}").parse().ok()?;
    (value.to_bits().abs_diff(decimal.to_bits()) <= 2).then_some(decimal)
}
