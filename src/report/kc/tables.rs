//! Results of `kc` tests as tables for the terminal.

use super::super::figure::{brief, to_digits};
use super::super::table::{Cell, Table};
use super::{KcResults, subject};
use crate::ask::Unit;
use crate::compliance::{KcFigure, KcStation};
use crate::model::LengthUnit;

/// Readable form of a result's unit.
fn unit_shown(unit: Unit, length: LengthUnit) -> String {
    let u = length.symbol();
    match unit {
        Unit::AnglePerForce => "deg/kN".to_owned(),
        Unit::LengthPerForce => format!("{u}/kN"),
        Unit::AnglePerTorque => "deg/(100 N m)".to_owned(),
        Unit::Stiffness => "N/mm".to_owned(),
        Unit::AnglePerLength => format!("deg/{u}"),
        Unit::AnglePerAngle => "deg/deg".to_owned(),
        Unit::TorquePerAngle => "N m/deg".to_owned(),
        Unit::Length => u.to_owned(),
        Unit::Ratio => "-".to_owned(),
        unit => unit.suffix(length),
    }
}

impl KcResults<'_> {
    /// Machine-readable table of the test results at all stations.
    pub fn table(&self) -> Table {
        let u = self.length().symbol();
        let mut columns = vec!["test".to_owned()];
        if self.is_axle {
            columns.extend(["travel left", "travel right"].map(|c| format!("{c} {u}")))
        } else {
            columns.push(format!("travel {u}"))
        }
        columns.push(format!("rack {u}"));
        columns.extend(self.is_axle.then(|| "wheel".to_owned()));
        columns.extend(["quantity", "value", "secant", "unit"].map(str::to_owned));
        let keys = columns.len() - 3;
        let mut table = Table::with_columns(columns).keyed(keys);
        for station in &self.stations {
            for outcome in station.outcomes.iter().flatten() {
                let name = self.test_name(&outcome.test);
                for figure in &outcome.figures {
                    let mut row = vec![Cell::from(name.as_str())];
                    row.push(Cell::from(station.travel));
                    row.extend(station.right_travel.map(Cell::from));
                    row.push(Cell::from(station.rack));
                    row.extend(self.is_axle.then(|| Cell::from(subject(figure.of))));
                    row.extend(self.figure_cells(figure));
                    table.push_row(row);
                }
            }
        }
        table
    }

    /// Tables for the text output and the page. Each station with an equilibrium has a table of its results, test by test, and the
    /// position of the station in words.
    pub fn tables_for_readers(&self) -> Vec<(String, Table)> {
        let mut tables = Vec::new();
        for station in &self.stations {
            let Ok(outcomes) = &station.outcomes else {
                continue;
            };
            let mut columns = vec!["quantity", "value", "secant", "unit"];
            if self.is_axle {
                columns.insert(0, "wheel");
            }
            let mut table = Table::with_columns(columns);
            for outcome in outcomes {
                table.push_heading(self.test_name(&outcome.test));
                for figure in &outcome.figures {
                    let mut row = Vec::new();
                    row.extend(self.is_axle.then(|| Cell::from(subject(figure.of))));
                    row.extend(self.figure_cells(figure));
                    table.push_row(row);
                }
            }
            tables.push((self.station_name(station), table));
        }
        tables
    }

    /// Stations sorted by their distance from the design position, nearest first. The distance is the sum of the magnitudes of
    /// travels and rack displacement.
    pub(in crate::report) fn nearest_stations(&self) -> Vec<&KcStation> {
        let far = |station: &KcStation| {
            let right = station.right_travel.unwrap_or(0.0);
            station.travel.abs() + right.abs() + station.rack.abs()
        };
        let stations = self.stations.iter();
        let mut stations: Vec<(f64, &KcStation)> = stations.map(|s| (far(s), s)).collect();
        stations.sort_by(|a, b| a.0.total_cmp(&b.0));
        stations.into_iter().map(|(_, station)| station).collect()
    }

    /// Value and unit of a result at the station nearest to the design position that has the result. `None` if no station has it,
    /// or if it has no value there.
    pub(in crate::report) fn first_figure(&self, quantity: &str) -> Option<[String; 2]> {
        let stations = self.nearest_stations();
        let outcomes = stations
            .into_iter()
            .flat_map(|s| s.outcomes.iter().flatten());
        let mut figures = outcomes.flat_map(|outcome| &outcome.figures);
        let figure = figures.find(|figure| figure.quantity == quantity)?;
        let value = self.printed(figure, figure.value)?;
        Some([four_figures(value), unit_shown(figure.unit, self.length())])
    }

    /// Table cells of a result: name, value, secant (mean slope from -`window` to +`window`) and unit.
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

/// Formats a number with four significant digits, as on the result sheets of a K&C rig.
pub(in crate::report) fn four_figures(value: f64) -> String {
    brief(to_digits(value, 4))
}
