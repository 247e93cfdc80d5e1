//! Figures of rig tests as tables of the terminal.

use super::super::table::{Cell, Table};
use super::KcResults;
use crate::ask::Unit;
use crate::compliance::KcFigure;
use crate::model::LengthUnit;

/// The unit for a reader.
fn unit_shown(unit: Unit, length: LengthUnit) -> String {
    let u = length.symbol();
    match unit {
        Unit::AnglePerForce => "deg/kN".to_owned(),
        Unit::LengthPerForce => format!("{u}/kN"),
        Unit::AnglePerTorque => "deg/(100 N m)".to_owned(),
        Unit::Stiffness => "N/mm".to_owned(),
        Unit::AnglePerLength => format!("deg/{u}"),
        Unit::Ratio => "-".to_owned(),
        unit => unit.suffix(length),
    }
}

impl KcResults<'_> {
    /// The figures of all stations, for programs.
    pub fn table(&self) -> Table {
        let u = self.length().symbol();
        let mut columns = vec!["test".to_owned()];
        columns.extend([format!("travel {u}"), format!("rack {u}")]);
        columns.extend(["quantity", "value", "secant", "unit"].map(str::to_owned));
        let mut table = Table::with_columns(columns).keyed(4);
        for station in &self.stations {
            for outcome in station.outcomes.iter().flatten() {
                let name = self.test_name(&outcome.test);
                for figure in &outcome.figures {
                    let mut row = vec![Cell::from(name.as_str())];
                    row.extend([Cell::from(station.travel), Cell::from(station.rack)]);
                    row.extend(self.figure_cells(figure));
                    table.push_row(row);
                }
            }
        }
        table
    }

    /// The place of each station that has figures, and its table for a reader: tests with their figures below them.
    pub fn tables_for_readers(&self) -> Vec<(String, Table)> {
        let mut tables = Vec::new();
        for station in &self.stations {
            let Ok(outcomes) = &station.outcomes else {
                continue;
            };
            let mut table = Table::new(["quantity", "value", "secant", "unit"]);
            for outcome in outcomes {
                let name = self.test_name(&outcome.test);
                table.push([Cell::from(name), "".into(), "".into(), "".into()]);
                for figure in &outcome.figures {
                    table.push_row(self.figure_cells(figure));
                }
            }
            tables.push((self.place(station), table));
        }
        tables
    }

    /// Value and unit of a figure at the first station that has it.
    pub(in crate::report) fn first_figure(&self, quantity: &str) -> Option<[String; 2]> {
        let outcomes = self
            .stations
            .iter()
            .flat_map(|s| s.outcomes.iter().flatten());
        let mut figures = outcomes.flat_map(|outcome| &outcome.figures);
        let figure = figures.find(|figure| figure.quantity == quantity)?;
        let value = self.printed(figure, figure.value)?;
        Some([four_figures(value), unit_shown(figure.unit, self.length())])
    }

    /// Name, value, secant and unit of a figure.
    fn figure_cells(&self, figure: &KcFigure) -> [Cell; 4] {
        let number = |value: Option<f64>| Cell::by(value, four_figures);
        [
            Cell::from(figure.quantity),
            number(self.printed(figure, figure.value)),
            number(self.printed(figure, figure.secant)),
            Cell::from(unit_shown(figure.unit, self.length())),
        ]
    }
}

/// A number with the four figures that a rig sheet has.
fn four_figures(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse().unwrap_or(value);
    super::super::brief(rounded)
}
