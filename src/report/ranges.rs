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
    /// Value of the column in the design position, if it is known.
    at_design: Option<f64>,
    /// Smallest value of the column. `None` if no station has a value.
    min: Option<f64>,
    /// Largest value of the column. `None` if no station has a value.
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

    /// Value in the design position, if this is the range of the column with this name.
    pub(super) fn at_design_of(&self, column: &str) -> Option<f64> {
        self.at_design.filter(|_| self.output == column)
    }

    /// Table of the ranges of columns. CSV and JSON also have a column with the unit.
    pub(super) fn table(ranges: &[Range]) -> Table {
        let mut table = Table::with_columns(Range::columns());
        for range in ranges {
            table.push_row(range.cells());
        }
        table
    }

    /// Machine-readable table of the ranges of columns over several motions. Each motion has a name.
    pub(super) fn table_of_motions(motions: &[(&str, Vec<Range>)]) -> Table {
        let mut table =
            Table::with_columns([Column::from("motion")].into_iter().chain(Range::columns()));
        for (motion, ranges) in motions {
            for range in ranges {
                let name = [Cell::from(*motion)].into_iter();
                table.push_row(name.chain(range.cells()));
            }
        }
        table
    }

    fn columns() -> impl Iterator<Item = Column> {
        let unit = Column::for_programs("unit");
        let columns = ["output", "at design", "min", "max"].map(Column::from);
        columns.into_iter().chain([unit])
    }

    fn cells(&self) -> impl Iterator<Item = Cell> {
        let values = [self.at_design, self.min, self.max];
        let name = [Cell::from(self.output.as_str())].into_iter();
        let unit = Cell::from(self.unit.as_str());
        name.chain(Cell::figures(values, &self.unit)).chain([unit])
    }
}

/// Smallest and largest of these values. `None` without values.
pub(super) fn ends(values: impl Iterator<Item = f64> + Clone) -> Option<[f64; 2]> {
    let low = values.clone().reduce(f64::min)?;
    Some([low, values.reduce(f64::max)?])
}
