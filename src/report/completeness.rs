//! Completeness of the requested results: stations by status, and cells that are empty by definition.
//!
//! A cell may be empty at a solved station if the quantity is not defined there: a swing arm where the wheel does not
//! turn. This is no failure. It is counted with its reason. A column without any value counts as a request that was
//! not met.

use super::table::{Cell, Table};
use crate::axle::AxleCurves;
use crate::characteristics::Characteristic;
use crate::curves::{Curves, Station, Status};
use serde::{Deserialize, Serialize};

/// Stations by status, and empty cells by reason.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Completeness {
    /// Statuses, in the order of their first occurrence.
    #[serde(default)]
    statuses: Vec<StatusCount>,
    /// Empty columns. Neighbouring columns with as many empty stations for one reason form one entry.
    #[serde(default)]
    empty: Vec<EmptyCells>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct StatusCount {
    status: String,
    stations: usize,
}

/// Cells that are empty at stations that were solved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct EmptyCells {
    columns: Vec<String>,
    stations: usize,
    /// Whether no station has a value.
    throughout: bool,
    reason: String,
}

impl Completeness {
    /// Number of stations of each status.
    pub fn table(&self) -> Table {
        let mut table = Table::new(["status", "stations"]);
        for count in &self.statuses {
            table.push([Cell::from(count.status.as_str()), count.stations.into()]);
        }
        table
    }

    /// Counts stations and empty cells of the curves of one wheel.
    pub fn of(curves: &Curves) -> Self {
        let is_solved = |s: &&Station| matches!(s.status, Status::Ok | Status::IllConditioned);
        let solved = || curves.stations.iter().filter(is_solved);
        let mut empty: Vec<EmptyCells> = Vec::new();
        for (k, column) in curves.columns.iter().enumerate() {
            let stations = solved().filter(|s| s.values[k].is_none()).count();
            if stations == 0 {
                continue;
            }
            let reason = Characteristic::named(&column.output).map_or(
                "it is not a finite number there",
                Characteristic::undefined_where,
            );
            let alike = |e: &&mut EmptyCells| e.stations == stations && e.reason == reason;
            match empty.last_mut().filter(alike) {
                Some(cells) => cells.columns.push(column.name.clone()),
                None => empty.push(EmptyCells {
                    columns: vec![column.name.clone()],
                    stations,
                    throughout: stations == solved().count(),
                    reason: reason.to_owned(),
                }),
            }
        }
        let words = curves.stations.iter().map(|s| s.status.word());
        Completeness::with(words, empty)
    }

    /// Counts stations and empty cells of the curves of an axle, column by column.
    pub fn of_axle(curves: &AxleCurves) -> Self {
        let solved = curves.stations.iter().filter(|s| s.placed.is_ok()).count();
        let mut empty: Vec<EmptyCells> = Vec::new();
        for (column, void, stations) in curves.empty_cells() {
            let columns = vec![curves.columns[column].name.clone()];
            match empty.last_mut().filter(|cells| cells.columns == columns) {
                Some(cells) => {
                    cells.stations += stations;
                    cells.throughout = cells.stations == solved;
                    cells.reason = format!("{}; or {}", cells.reason, void.reason());
                }
                None => empty.push(EmptyCells {
                    columns,
                    stations,
                    throughout: stations == solved,
                    reason: void.reason().to_owned(),
                }),
            }
        }
        Completeness::with(curves.stations.iter().map(|s| s.status), empty)
    }

    /// Completeness of stations with these statuses.
    fn with(words: impl Iterator<Item = &'static str>, empty: Vec<EmptyCells>) -> Self {
        let mut statuses: Vec<StatusCount> = Vec::new();
        for status in words {
            match statuses.iter_mut().find(|count| count.status == status) {
                Some(count) => count.stations += 1,
                None => statuses.push(StatusCount {
                    status: status.to_owned(),
                    stations: 1,
                }),
            }
        }
        Completeness { statuses, empty }
    }

    /// Sentence with the number of solved stations and the statuses of the others; `None` if nothing was counted.
    pub fn headline(&self) -> Option<String> {
        let all: usize = self.statuses.iter().map(|count| count.stations).sum();
        let is_solved = |count: &&StatusCount| {
            let solved = [Status::Ok, Status::IllConditioned].map(|status| status.word());
            solved.contains(&count.status.as_str())
        };
        let solved = self.statuses.iter().filter(is_solved);
        let solved: usize = solved.map(|count| count.stations).sum();
        let others = self.statuses.iter().filter(|count| !is_solved(count));
        let others = others.map(|count| format!(", {} {}", count.stations, count.status));
        let others: String = others.collect();
        (all > 0).then(|| format!("{solved} of {all} stations solved{others}"))
    }

    /// Remarks on empty cells, a line each.
    pub fn remarks(&self) -> impl Iterator<Item = String> {
        self.empty.iter().map(|cells| {
            let columns = cells.columns.join(", ");
            let have = if cells.columns.len() == 1 {
                "has"
            } else {
                "have"
            };
            let reason = &cells.reason;
            match (cells.throughout, cells.stations) {
                (true, _) => format!("warning: {columns} {have} no value at any station: {reason}"),
                (false, 1) => format!("{columns} {have} no value at 1 station: {reason}"),
                (false, n) => format!("{columns} {have} no value at {n} stations: {reason}"),
            }
        })
    }
}
