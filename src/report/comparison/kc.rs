//! Results of several `kc` runs side by side.

use super::unknown_axes;
use crate::model::FrameConvention;
use crate::report::column::{ColumnAxes, split_unit};
use crate::report::files::csv_of_rows;
use crate::report::kc::four_figures;
use crate::report::table::{Cell, Column, Table};
use crate::report::{optional, shortest};
use std::collections::HashMap;

/// A `kc` run in a comparison.
pub struct ComparedKc {
    /// Label, unique for each run.
    pub label: String,
    /// Content of its `kc.csv`.
    pub csv: Vec<u8>,
    /// Axes of the results in `csv`. `None` if they are not known, because the run has no stored study.
    pub axes: Option<FrameConvention>,
}

/// Results of several `kc` runs side by side, in the axes of the first run.
pub struct KcComparison {
    labels: Vec<String>,
    /// Names of the columns that identify station, test and quantity.
    keys: Vec<String>,
    figures: Vec<Figure>,
}

/// A result of a test, with its value and its secant in each run. The secant is the mean slope between the loads -`window` and
/// +`window` of the test. `None` if a run does not have the result.
struct Figure {
    keys: Vec<String>,
    unit: String,
    values: Vec<[Option<f64>; 2]>,
}

/// Rows of one `kc.csv`: keys, unit, value and secant.
struct Sheet {
    keys: Vec<String>,
    rows: Vec<(Vec<String>, String, [Option<f64>; 2])>,
}

impl KcComparison {
    /// Compares runs. Results keep the order of the first run in which they occur.
    ///
    /// # Errors
    /// Returns the reason in words, with the label of the run. Possible reasons: a text is not a `kc.csv`, runs have different
    /// columns, or unknown axes determine the sign of a value.
    pub fn of(runs: &[ComparedKc]) -> Result<Self, String> {
        let mut comparison = KcComparison {
            labels: runs.iter().map(|run| run.label.clone()).collect(),
            keys: Vec::new(),
            figures: Vec::new(),
        };
        let mut places: HashMap<Vec<String>, usize> = HashMap::new();
        for (run, ComparedKc { label, csv, axes }) in runs.iter().enumerate() {
            let mut sheet = Sheet::read(csv).map_err(|why| format!("{label}, kc.csv: {why}"))?;
            if let Some(own) = axes {
                sheet.turn([*own, runs[0].axes.unwrap_or(*own)]);
            } else if let Some(name) = sheet.component() {
                return Err(unknown_axes(label, name));
            }
            if run == 0 {
                comparison.keys = sheet.keys;
            } else if sheet.keys != comparison.keys {
                return Err(format!(
                    "{label} and {} have different columns: one is of a wheel and one of an axle, \
                     or their units of length differ",
                    comparison.labels[0]
                ));
            }
            for (keys, unit, values) in sheet.rows {
                let place = *places.entry(keys.clone()).or_insert_with(|| {
                    comparison.figures.push(Figure {
                        keys,
                        unit,
                        values: vec![[None; 2]; runs.len()],
                    });
                    comparison.figures.len() - 1
                });
                comparison.figures[place].values[run] = values;
            }
        }
        Ok(comparison)
    }

    /// `comparison.csv`: one row for each result, with value and secant of each run and their differences from the first.
    pub fn csv(&self) -> Vec<u8> {
        let mut header = self.keys.clone();
        header.push("unit".to_owned());
        for label in &self.labels {
            header.extend([label.clone(), format!("{label}_secant")]);
        }
        for label in &self.labels[1..] {
            header.extend(["difference", "secant_difference"].map(|of| format!("{label}_{of}")));
        }
        let rows = self.figures.iter().map(|figure| {
            let mut cells = figure.keys.clone();
            cells.push(figure.unit.clone());
            cells.extend(figure.values.iter().flatten().copied().map(optional));
            for own in &figure.values[1..] {
                let pairs = own.iter().zip(&figure.values[0]);
                cells.extend(pairs.map(|(own, first)| optional(difference(*own, *first))));
            }
            cells
        });
        csv_of_rows(std::iter::once(header).chain(rows))
    }

    /// Table of the results whose values differ between the runs after rounding to four digits. Secants are not compared.
    pub fn table(&self) -> Table {
        let shown: Vec<&Figure> = self.figures.iter().filter(|f| f.differs()).collect();
        // A column with the same cell in all rows contains no information. The last column names the quantity.
        let tells = |k: usize| {
            k + 1 == self.keys.len() || shown.iter().any(|f| f.keys[k] != shown[0].keys[k])
        };
        let telling: Vec<usize> = (0..self.keys.len()).filter(|k| tells(*k)).collect();
        let keys = telling.iter().map(|k| self.keys[*k].as_str());
        let mut columns: Vec<Column> = keys.map(Column::from).collect();
        columns.extend(self.labels.iter().map(|label| Column::from(label.clone())));
        for label in &self.labels[1..] {
            let title = match self.labels.len() {
                2 => "difference".to_owned(),
                _ => format!("{label} difference"),
            };
            columns.push(Column::from(title));
        }
        columns.push("unit".into());
        let mut table = Table::with_columns(columns).keyed(telling.len());
        for figure in shown {
            let keys = telling.iter().map(|k| Cell::from(figure.keys[*k].as_str()));
            let mut cells: Vec<Cell> = keys.collect();
            let number = |value: Option<f64>| Cell::by(value, four_figures);
            let first = figure.values[0][0];
            cells.extend(figure.values.iter().map(|[value, _]| number(*value)));
            let others = figure.values[1..].iter();
            cells.extend(others.map(|[value, _]| number(difference(*value, first))));
            cells.push(figure.unit.as_str().into());
            table.push_row(cells);
        }
        table
    }

    /// Number of results with the same four-digit value in all runs. Secants are not compared.
    pub fn equal(&self) -> usize {
        self.figures.iter().filter(|f| !f.differs()).count()
    }
}

impl Figure {
    fn differs(&self) -> bool {
        let text = |[value, _]: &[Option<f64>; 2]| value.map(four_figures);
        self.values
            .iter()
            .any(|own| text(own) != text(&self.values[0]))
    }
}

fn difference(own: Option<f64>, first: Option<f64>) -> Option<f64> {
    own.zip(first).map(|(own, first)| own - first)
}

impl Sheet {
    fn read(text: &[u8]) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(text);
        let header = reader.headers().map_err(|e| e.to_string())?.clone();
        let place = |name: &str| {
            let found = header.iter().position(|column| column == name);
            found.ok_or_else(|| format!("there is no column {name}"))
        };
        let [quantity, value, secant, unit] = ["quantity", "value", "secant", "unit"].map(place);
        let (quantity, value, secant, unit) = (quantity?, value?, secant?, unit?);
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|e| e.to_string())?;
            let number = |k: usize| match &record[k] {
                "" => Ok(None),
                cell => match cell.parse::<f64>() {
                    Ok(number) if number.is_finite() => Ok(Some(number)),
                    _ => Err(format!("expected a number, found {cell:?}")),
                },
            };
            // A station without equilibrium has rows without results.
            if record[quantity].is_empty() {
                continue;
            }
            let keys = record.iter().take(value).map(str::to_owned).collect();
            rows.push((
                keys,
                record[unit].to_owned(),
                [number(value)?, number(secant)?],
            ));
        }
        let keys = header.iter().take(value).map(str::to_owned).collect();
        Ok(Sheet { keys, rows })
    }

    /// Converts the stations and results of a run from the first axes to the second axes.
    fn turn(&mut self, axes: [FrameConvention; 2]) {
        let signs: Vec<f64> = self.keys.iter().map(|key| sign(key, axes)).collect();
        for (keys, _, values) in &mut self.rows {
            let own = sign(quantity(keys), axes);
            for value in values.iter_mut().flatten() {
                *value = own * *value + 0.0;
            }
            for (cell, sign) in keys.iter_mut().zip(&signs).filter(|(_, s)| **s != 1.0) {
                if let Ok(number) = cell.parse::<f64>() {
                    *cell = shortest(sign * number + 0.0);
                }
            }
        }
    }

    /// Name of the first result or station column that has a value other than 0, and whose sign depends on the axes.
    fn component(&self) -> Option<&str> {
        let matters = |name: &str| ColumnAxes::of(split_unit(name).0).matter();
        let is_number = |cell: &str| cell.parse::<f64>().is_ok_and(|number| number != 0.0);
        let station = self.keys.iter().enumerate().find(|(k, key)| {
            matters(key) && self.rows.iter().any(|(keys, ..)| is_number(&keys[*k]))
        });
        let results = self.rows.iter().filter(|(_, _, values)| {
            let mut known = values.iter().flatten();
            known.any(|value| *value != 0.0)
        });
        let mut results = results.map(|(keys, ..)| quantity(keys));
        let station = station.map(|(_, key)| key.as_str());
        station.or_else(|| results.find(|name| matters(name)))
    }
}

/// Name of the quantity in a row of `kc.csv`. It is the last of the row's keys.
fn quantity(keys: &[String]) -> &str {
    keys.last().map_or("", String::as_str)
}

fn sign(name: &str, axes: [FrameConvention; 2]) -> f64 {
    ColumnAxes::of(split_unit(name).0).sign(axes)
}
