//! Smallest and largest values of columns over a motion.

use super::table::{Cell, Column, Table};
use serde::{Deserialize, Serialize};

/// Range of a column over the motion, in the unit of the column.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Range {
    output: String,
    /// Unit of the column. Empty for a dimensionless number.
    #[serde(default)]
    unit: String,
    /// Value in the design position, if it is known.
    at_design: Option<f64>,
    /// Smallest value. `None` if no station has a value.
    min: Option<f64>,
    /// Largest value. `None` if no station has a value.
    max: Option<f64>,
}

impl Range {
    /// Range of the values of the column with this name and unit.
    pub(super) fn of(
        [output, unit]: [&str; 2],
        at_design: Option<f64>,
        values: impl Iterator<Item = f64> + Clone,
    ) -> Self {
        Range {
            output: output.to_owned(),
            unit: unit.to_owned(),
            at_design,
            min: values.clone().min_by(f64::total_cmp),
            max: values.max_by(f64::total_cmp),
        }
    }

    /// Table of the ranges. CSV and JSON also have a column with the unit.
    pub(super) fn table(ranges: &[Range]) -> Table {
        let unit = Column::for_programs("unit");
        let columns = ["output", "at design", "min", "max"].map(Column::from);
        let mut table = Table::with_columns(columns.into_iter().chain([unit]));
        for range in ranges {
            let values = [range.at_design, range.min, range.max];
            let mut row = vec![Cell::from(range.output.as_str())];
            row.extend(Cell::figures(values, &range.unit));
            row.push(range.unit.as_str().into());
            table.push_row(row);
        }
        table
    }
}

/// Smallest and largest of these values. `None` without values.
pub(super) fn ends(values: impl Iterator<Item = f64> + Clone) -> Option<[f64; 2]> {
    let low = values.clone().reduce(f64::min)?;
    Some([low, values.reduce(f64::max)?])
}
