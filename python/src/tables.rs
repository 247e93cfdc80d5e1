//! Reads the tables of results.

use crate::errors::failure;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

/// Cells of a column: numbers (NaN for an empty cell) or words.
enum Cells {
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

impl Cells {
    fn push(&mut self, cell: &str) {
        let number = match cell {
            "" => Some(f64::NAN),
            cell => cell
                .parse()
                .ok()
                .filter(|_| !cell.starts_with(char::is_alphabetic)),
        };
        match (&mut *self, number) {
            (Cells::Words(words), _) => words.push(cell.to_owned()),
            (Cells::Numbers(numbers), Some(number)) => numbers.push(number),
            (Cells::Numbers(numbers), None) => {
                // The column contains a word, so the cells that were read as numbers become words, too. NaN stands for an
                // empty cell.
                let word = |n: &f64| {
                    if n.is_nan() {
                        String::new()
                    } else {
                        n.to_string()
                    }
                };
                let mut words: Vec<String> = numbers.iter().map(word).collect();
                words.push(cell.to_owned());
                *self = Cells::Words(words);
            }
        }
    }
}

fn read(from: impl Read, columns: &mut Vec<(String, Cells)>) -> Result<(), csv::Error> {
    let mut reader = csv::Reader::from_reader(from);
    let header: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    if columns.is_empty() {
        let none = |name| (name, Cells::Numbers(Vec::new()));
        columns.extend(header.iter().cloned().map(none));
    }
    if !columns.iter().map(|c| &c.0).eq(&header) {
        let kind = std::io::ErrorKind::InvalidData;
        let message = "its columns differ from those of the other parts";
        return Err(std::io::Error::new(kind, message).into());
    }
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record)? {
        for ((_, cells), cell) in columns.iter_mut().zip(&record) {
            cells.push(cell);
        }
    }
    Ok(())
}

/// Columns of several CSV files that have the same header; their rows follow each other. A column of numbers and empty cells
/// becomes an array, any other column a list of words.
#[pyfunction]
pub(crate) fn read_tables(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Bound<'_, PyDict>> {
    let mut columns = Vec::new();
    py.detach(|| {
        let mut all = paths.iter();
        all.try_for_each(|path| {
            let described = |e: csv::Error| failure(format!("{}: {e}", path.display()));
            let file = File::open(path).map_err(csv::Error::from);
            file.and_then(|file| read(file, &mut columns))
                .map_err(described)
        })
    })?;
    columns_of(py, columns)
}

/// Splits the name of a column into the part before its unit, and the unit.
#[pyfunction]
pub(crate) fn split_unit(name: &str) -> (&str, &str) {
    hardpoint::report::split_unit(name)
}

/// Columns of a CSV file in memory, in the form that [`read_tables`] returns.
#[pyfunction]
pub(crate) fn parse_table<'py>(py: Python<'py>, csv: &[u8]) -> PyResult<Bound<'py, PyDict>> {
    let mut columns = Vec::new();
    py.detach(|| read(csv, &mut columns))
        .map_err(|e| failure(e.to_string()))?;
    columns_of(py, columns)
}

fn columns_of(py: Python<'_>, columns: Vec<(String, Cells)>) -> PyResult<Bound<'_, PyDict>> {
    let table = PyDict::new(py);
    for (name, cells) in columns {
        match cells {
            Cells::Numbers(numbers) => table.set_item(name, numbers.into_pyarray(py))?,
            Cells::Words(words) => table.set_item(name, words)?,
        }
    }
    Ok(table)
}
