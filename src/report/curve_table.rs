//! Reads a CSV file of a run.

use super::figure::to_digits;
use crate::curves::Status;
use serde::{Deserialize, Serialize};

/// Columns of numbers from a CSV file, and the column `status` if the file has one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveTable {
    /// Names of the numeric columns.
    pub header: Vec<String>,
    /// Values of each column. `None` for an empty cell.
    pub columns: Vec<Vec<Option<f64>>>,
    /// Status of each row. Empty without the column `status`.
    pub status: Vec<String>,
}

impl CurveTable {
    /// Reads a CSV file that a run has written. The error names the line and the column of a cell that is not a finite number.
    pub fn read(text: &[u8]) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(text);
        let names: Vec<String> = reader
            .headers()
            .map_err(|e| e.to_string())?
            .iter()
            .map(str::to_owned)
            .collect();
        let has_status = names.last().is_some_and(|name| name == "status");
        let numbers = names.len() - has_status as usize;
        let mut table = CurveTable {
            header: names[..numbers].to_vec(),
            columns: vec![Vec::new(); numbers],
            status: Vec::new(),
        };
        for (row, record) in reader.records().enumerate() {
            let record = record.map_err(|e| e.to_string())?;
            for (column, cell) in record.iter().take(numbers).enumerate() {
                table.columns[column].push(match cell {
                    "" => None,
                    cell => Some(number(cell).ok_or_else(|| {
                        format!(
                            "line {}, {}: expected a number, found {cell:?}",
                            row + 2,
                            names[column]
                        )
                    })?),
                });
            }
            if has_status {
                table.status.push(record[numbers].to_owned());
            }
        }
        Ok(table)
    }

    /// Rounds the numbers to six digits, which is more than a chart shows.
    pub fn with_six_digits(mut self) -> Self {
        for value in self.columns.iter_mut().flatten().flatten() {
            *value = to_digits(*value, 6);
        }
        self
    }

    /// Number of rows of the table.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Number of rows whose station is not solved, or lacks a defined value. 0 without the column `status`.
    pub fn incomplete_rows(&self) -> usize {
        let whole = Status::WHOLE.map(|status| status.word());
        let incomplete = |word: &&String| !whole.contains(&word.as_str());
        self.status.iter().filter(incomplete).count()
    }

    /// True if every station is solved with all its defined values, and every column has a value at some station.
    pub fn is_complete(&self) -> bool {
        let has_value = |column: &Vec<Option<f64>>| column.iter().any(Option::is_some);
        self.incomplete_rows() == 0 && self.columns.iter().all(has_value)
    }

    /// Column with this name.
    pub fn column(&self, name: &str) -> Option<&[Option<f64>]> {
        let place = self.header.iter().position(|n| n == name)?;
        Some(&self.columns[place])
    }

    /// Adds a column with the same value in all rows, unless the table has the column.
    pub fn set_constant(&mut self, name: &str, value: f64) {
        if self.column(name).is_none() {
            self.columns.push(vec![Some(value); self.rows()]);
            self.header.push(name.to_owned());
        }
    }

    /// Selects at most `most` rows, evenly spaced. From two rows on, they include the first and the last.
    pub fn thinned(&self, most: usize) -> Self {
        let rows = self.rows();
        if rows <= most {
            return self.clone();
        }
        let kept: Vec<usize> = (0..most)
            .map(|i| i * (rows - 1) / (most - 1).max(1))
            .collect();
        CurveTable {
            header: self.header.clone(),
            columns: self
                .columns
                .iter()
                .map(|c| kept.iter().map(|row| c[*row]).collect())
                .collect(),
            status: if self.status.is_empty() {
                Vec::new()
            } else {
                kept.iter().map(|row| self.status[*row].clone()).collect()
            },
        }
    }
}

fn number(cell: &str) -> Option<f64> {
    cell.parse().ok().filter(|v: &f64| v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_cells_stay_empty() {
        let table =
            CurveTable::read(b"travel_mm,camber_deg,status\n-1.0,0.5,ok\n1.0,,unreachable\n");
        let table = table.unwrap();
        assert_eq!(table.column("camber_deg"), Some(&[Some(0.5), None][..]));
        assert_eq!(table.status, ["ok", "unreachable"]);
        assert!(CurveTable::read(b"a\nNaN\n").is_err());
        assert!(CurveTable::read(b"a,b\n1\n").is_err());
    }

    #[test]
    fn thinning_keeps_the_ends() {
        let text: String = (0..100).map(|i| format!("{i},ok\n")).collect();
        let table = CurveTable::read(format!("travel_mm,status\n{text}").as_bytes()).unwrap();
        assert_eq!(table.thinned(1).columns[0], [Some(0.0)]);
        let few = table.thinned(10);
        assert_eq!((few.rows(), few.status.len()), (10, 10));
        assert_eq!(
            (few.columns[0][0], few.columns[0][9]),
            (Some(0.0), Some(99.0))
        );
    }
}
