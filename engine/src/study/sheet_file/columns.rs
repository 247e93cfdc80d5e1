//! Columns of a measured sheet.

use super::super::curve_file::{only_column, refuse_other_units};
use super::super::names::nearest;
use crate::model::LengthUnit;

/// Required columns of a sheet.
pub(super) const NEEDED: [&str; 3] = ["load", "quantity", "value"];

/// Columns of positions, without their unit.
const POSITIONS: [&str; 5] = ["travel", "travel_left", "travel_right", "rack", "trail"];

/// Optional columns: the remaining columns of `kc.csv`, and `tolerance`.
const OTHERS: [&str; 16] = [
    "at",
    "mode",
    "hold",
    "anti_roll_bar",
    "steering",
    "wheel",
    "secant",
    "tolerance",
    "window",
    "unit",
    "other_name",
    "other_value",
    "other_unit",
    "share",
    "reason",
    "status",
];

/// Refuses unknown columns, columns with the same name, and positions in another unit.
pub(super) fn check(header: &csv::StringRecord, unit: LengthUnit) -> Result<(), String> {
    for name in header.iter().filter(|name| !name.is_empty()) {
        only_column(header, name)?;
    }
    refuse_other_units(header, &POSITIONS, unit)?;
    let positions = POSITIONS.map(|name| format!("{name}_{}", unit.symbol()));
    let others = NEEDED.into_iter().chain(OTHERS);
    let known: Vec<&str> = positions.iter().map(String::as_str).chain(others).collect();
    let mut named = header.iter().filter(|name| !name.is_empty());
    match named.find(|name| !known.contains(name)) {
        None => Ok(()),
        Some(name) => Err(match nearest(name, known.iter().copied()) {
            Some(near) => format!("unknown column {name:?}; did you mean {near:?}?"),
            None => format!("unknown column {name:?}; known here: {}", known.join(", ")),
        }),
    }
}
