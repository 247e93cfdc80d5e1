//! Columns of compared designs in the same unit of length.

use super::super::curve_table::CurveTable;
use super::Compared;
use crate::model::LengthUnit;

/// Curves of a design with their lengths in another unit.
pub(super) fn in_unit(design: &Compared, unit: LengthUnit) -> CurveTable {
    let mut table = design.curves.clone();
    if design.unit == unit {
        return table;
    }
    let ratio = unit.per_metre() / design.unit.per_metre();
    for (name, column) in table.header.iter_mut().zip(&mut table.columns) {
        let (renamed, power) = converted(name, design.unit, unit);
        *name = renamed;
        let factor = ratio.powi(power);
        for value in column.iter_mut().flatten() {
            *value *= factor;
        }
    }
    table
}

/// Name of a column with another unit of length, and the power of the length in its unit.
fn converted(name: &str, from: LengthUnit, to: LengthUnit) -> (String, i32) {
    let mut power = 0;
    let mut sign = 1;
    let words = name.split('_').map(|word| {
        if word == "per" {
            sign = -1;
        }
        let count = match word.strip_prefix(from.symbol()) {
            Some("") => 1,
            Some("2") => 2,
            _ => return word.to_owned(),
        };
        power += sign * count;
        format!("{}{}", to.symbol(), &word[from.symbol().len()..])
    });
    let renamed = words.collect::<Vec<_>>().join("_");
    (renamed, power)
}

/// Splits a column's name into the part before its unit, and the unit.
pub(super) fn split(name: &str) -> (&str, &str) {
    const UNITS: [&str; 11] = [
        "deg", "mm", "m", "in", "percent", "N", "lbf", "ft", "per", "rad", "kg",
    ];
    let mut start = name.len();
    for (at, _) in name.rmatch_indices('_') {
        let word = name[at + 1..].split('_').next().unwrap_or("");
        if !UNITS.contains(&word.trim_end_matches('2')) {
            break;
        }
        start = at;
    }
    match name.get(start + 1..) {
        Some(unit) => (&name[..start], unit),
        None => (name, ""),
    }
}
