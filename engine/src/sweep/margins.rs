//! Columns with the margins of constraints.

use super::{Kind, OutputColumn};
use crate::ask::with_unit;
use crate::optimise::VIOLATED;
use crate::study::{Constraint, Limited};

/// Columns with the margins of these constraints (distances to the nearer limit). `prefix` begins the names: the name of
/// an axle of a car, or nothing.
pub(super) fn margin_columns(constraints: &[Constraint], prefix: &str) -> Vec<OutputColumn> {
    let column = |constraint: &Constraint| {
        let is_limit = !constraint.parts.iter().any(fixes_value);
        let units = constraint.parts.first().map(|part| &part.unit[..]);
        let unit = units.filter(|unit| *unit != "1").unwrap_or_default();
        let visible = constraint.visible();
        let name = [prefix, &constraint.name].join(" ");
        margin_column(name.trim(), unit, is_limit.then_some(visible))
    };
    constraints.iter().map(column).collect()
}

/// Column with the margin of a constraint with this name and unit. `visible` is a change of the margin that a user
/// notices (for example 1 mm or 1 degree), in `unit`. It is `None` if the constraint fixes a value.
pub(super) fn margin_column(name: &str, unit: &str, visible: Option<f64>) -> OutputColumn {
    let column = column_name(&format!("margin {name}"));
    let unit = &column_name(unit);
    // The limits at the end of a name may already have the unit. Then the unit is not appended again.
    let column = if column.ends_with(&format!("_{unit}")) {
        column
    } else {
        with_unit(column, unit)
    };
    OutputColumn {
        least: visible.map(|visible| -VIOLATED * visible),
        ..OutputColumn::new(column, name, Kind::Margin, unit)
    }
}

/// Appends a number to the names of columns that would have the same name as an earlier column.
pub(super) fn distinguish(columns: &mut [OutputColumn]) {
    for place in 1..columns.len() {
        let (earlier, rest) = columns.split_at_mut(place);
        let (first, mut number) = (rest[0].column.clone(), 1);
        while earlier.iter().any(|known| known.column == rest[0].column) {
            number += 1;
            rest[0].column = format!("{first}_{number}");
        }
    }
}

/// Returns true if a part of a constraint fixes a value: its lower limit equals its upper limit.
fn fixes_value(part: &Limited) -> bool {
    part.lower.is_some() && part.lower == part.upper
}

/// Name of a column, from words. Letters, digits, minus signs and decimal points remain; the rest becomes underscores. A number
/// of more than eight characters is rounded to six digits, and to at most five decimals.
fn column_name(words: &str) -> String {
    let is_kept = |c: char| c.is_alphanumeric() || "-.".contains(c);
    let words = words.replace('%', " percent").replace('/', " per ");
    let words = words.split(|c| !is_kept(c)).filter(|word| !word.is_empty());
    let short = |word: &str| match word.parse::<f64>() {
        Ok(value) if word.len() > 8 => {
            let digits = value.abs().max(1e-9).log10().floor().clamp(0.0, 6.0);
            format!("{value:.*}", (5.0 - digits).max(0.0) as usize)
        }
        _ => word.to_owned(),
    };
    words.map(short).collect::<Vec<_>>().join("_")
}
