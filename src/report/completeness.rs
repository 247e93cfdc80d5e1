//! Completeness of the requested results: stations by status, and cells that are empty by definition.
//!
//! A cell may be empty at a solved station because the quantity is not defined there. An example is the swing arm of a wheel that
//! does not turn. Such a cell is not a failure; it is counted with its reason. But a column without any value counts as a request
//! that could not be met.

use super::table::{Cell, Table};
use crate::curves::{Curves, Status};
use serde::{Deserialize, Serialize};

/// Numbers of stations by status (such as solved or failed), and of empty cells by reason.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Completeness {
    /// Statuses with their numbers of stations, in the order of their first occurrence.
    #[serde(default)]
    statuses: Vec<StatusCount>,
    /// Columns with empty cells. Neighbouring columns are listed together if they have equal numbers of empty stations and the same
    /// reason, and if all or none of them lack values at every station.
    #[serde(default)]
    empty: Vec<EmptyCells>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct StatusCount {
    status: String,
    stations: usize,
}

/// Empty cells of some columns at stations with a pose. Cells that are empty because of a rocker's toggle or a missing support do
/// not count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct EmptyCells {
    columns: Vec<String>,
    stations: usize,
    /// True if the columns have no value at any station.
    throughout: bool,
    reason: String,
}

/// Columns with empty cells, each with all of its reasons.
fn empty_columns(curves: &Curves) -> Vec<EmptyCells> {
    let mut found: Vec<EmptyCells> = Vec::new();
    let cells = curves.empty_cells();
    for of_column in cells.chunk_by(|a, b| a.0 == b.0) {
        let column = of_column[0].0;
        let reasons: Vec<&str> = of_column
            .iter()
            .map(|(_, reason, _)| reason.reason())
            .collect();
        found.push(EmptyCells {
            columns: vec![curves.columns[column].name.clone()],
            stations: of_column.iter().map(|(.., stations)| stations).sum(),
            throughout: !curves.has_value(column),
            reason: reasons.join("; or "),
        });
    }
    found
}

impl Completeness {
    /// Table with the number of stations for each status.
    pub fn table(&self) -> Table {
        let mut table = Table::new(["status", "stations"]);
        for count in &self.statuses {
            table.push([Cell::from(count.status.as_str()), count.stations.into()]);
        }
        table
    }

    /// Counts the stations and empty cells of curves.
    pub fn of(curves: &Curves) -> Self {
        let mut statuses: Vec<StatusCount> = Vec::new();
        for status in curves.stations.iter().map(|s| s.status.word()) {
            match statuses.iter_mut().find(|count| count.status == status) {
                Some(count) => count.stations += 1,
                None => statuses.push(StatusCount {
                    status: status.to_owned(),
                    stations: 1,
                }),
            }
        }
        let mut empty: Vec<EmptyCells> = Vec::new();
        for column in empty_columns(curves) {
            let alike = |e: &&mut EmptyCells| {
                let [own, other] = [&**e, &column].map(|c| (c.stations, c.throughout, &c.reason));
                own == other
            };
            match empty.last_mut().filter(alike) {
                Some(cells) => cells.columns.extend(column.columns),
                None => empty.push(column),
            }
        }
        Completeness { statuses, empty }
    }

    /// Words for the number of solved stations and the statuses of the other stations. Only stations with all defined values
    /// count as solved. `None` if there are no stations.
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

    /// Remarks on empty cells, one per line. A column without any value causes no warning if another motion of the study has
    /// values of it. `elsewhere` returns true for such a column.
    pub fn remarks(&self, elsewhere: impl Fn(&str) -> bool) -> Vec<String> {
        let remarks = self.empty.iter().flat_map(|cells| {
            let columns = cells.columns.iter().map(String::as_str);
            let (there, nowhere): (Vec<_>, Vec<_>) = columns.partition(|column| elsewhere(column));
            let (stations, reason) = (cells.stations, &cells.reason);
            let remark = |columns: Vec<&str>, is_elsewhere: bool| {
                let have = if columns.len() == 1 { "has" } else { "have" };
                let names = columns.join(", ");
                let text = match (cells.throughout, is_elsewhere, stations) {
                    (true, true, _) => format!("{names} {have} no value in this motion: {reason}"),
                    (true, false, _) => {
                        format!("warning: {names} {have} no value at any station: {reason}")
                    }
                    (false, _, 1) => format!("{names} {have} no value at 1 station: {reason}"),
                    (false, _, n) => format!("{names} {have} no value at {n} stations: {reason}"),
                };
                (!columns.is_empty()).then_some(text)
            };
            if cells.throughout {
                [remark(nowhere, false), remark(there, true)]
            } else {
                let all = cells.columns.iter().map(String::as_str);
                [remark(all.collect(), false), None]
            }
        });
        remarks.flatten().collect()
    }
}
