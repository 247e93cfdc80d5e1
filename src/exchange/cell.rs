//! Cells of a table in any file format.

use std::collections::BTreeMap;

/// Content of a cell.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    /// A number that the file stores as a number.
    Number(f64),
    /// A text. In a text file it may also represent a number.
    Text(String),
    /// A cell without a usable value. It contains a description of the cell, such as "the error #REF!".
    Unusable(String),
}

/// Naming scheme for the cells of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Places {
    /// Line and column, counted from 1.
    Lines,
    /// Cell names of spreadsheets: B3.
    Spreadsheet,
}

/// A table: cells by row and column. Both indices count from 0.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sheet {
    /// Name of the table. Empty if the file has only one table.
    pub name: String,
    /// Cells that are not empty, by their row and column.
    pub cells: BTreeMap<(u32, u32), Cell>,
    /// Naming scheme for the cells in messages.
    pub places: Places,
}

impl Sheet {
    /// Largest number of cells in a table that is read. Hardpoints fill a few hundred cells.
    pub(super) const MOST_CELLS: usize = 200_000;

    /// Longest text of a cell that is read, in bytes. Names and numbers are much shorter.
    const LONGEST_TEXT: usize = 2000;

    /// Makes a table without cells.
    pub(super) fn new(name: impl Into<String>, places: Places) -> Self {
        Sheet {
            name: name.into(),
            cells: BTreeMap::new(),
            places,
        }
    }

    /// Adds a cell. A text that is too long becomes [`Cell::Unusable`].
    ///
    /// # Errors
    /// The table has too many cells.
    pub(super) fn put(&mut self, row: u32, column: u32, cell: Cell) -> Result<(), String> {
        if self.cells.len() >= Sheet::MOST_CELLS {
            return Err(format!(
                "more than {} cells are filled: this is not a table of hardpoints",
                Sheet::MOST_CELLS
            ));
        }
        let cell = match cell {
            Cell::Text(text) if text.len() > Sheet::LONGEST_TEXT => {
                Cell::Unusable(format!("a text of {} bytes", text.len()))
            }
            cell => cell,
        };
        self.cells.insert((row, column), cell);
        Ok(())
    }

    /// Cells of a row, with their column numbers.
    pub(super) fn row(&self, row: u32) -> impl Iterator<Item = (u32, &Cell)> {
        let cells = self.cells.range((row, 0)..=(row, u32::MAX));
        cells.map(|((_, column), cell)| (*column, cell))
    }

    /// Numbers of the rows that are not empty, in order.
    pub(super) fn rows(&self) -> Vec<u32> {
        let mut rows: Vec<u32> = self.cells.keys().map(|(row, _)| *row).collect();
        rows.dedup();
        rows
    }

    /// Cell at a row and a column.
    pub(super) fn cell(&self, row: u32, column: u32) -> Option<&Cell> {
        self.cells.get(&(row, column))
    }

    /// Name of a cell in the naming scheme: "line 3, column 2" or "B3".
    pub(super) fn place(&self, row: u32, column: u32) -> String {
        match self.places {
            Places::Lines => format!("line {}, column {}", row + 1, column + 1),
            Places::Spreadsheet => format!("{}{}", letters(column), row + 1),
        }
    }

    /// Name of a row in the naming scheme: "line 3" or "row 3".
    pub(super) fn row_place(&self, row: u32) -> String {
        match self.places {
            Places::Lines => format!("line {}", row + 1),
            Places::Spreadsheet => format!("row {}", row + 1),
        }
    }
}

/// Letters of a spreadsheet column: A, ..., Z, AA, ... The number counts from 0.
pub(super) fn letters(column: u32) -> String {
    let mut number = column + 1;
    let mut letters = Vec::new();
    while number > 0 {
        let digit = (number - 1) % 26;
        letters.push(char::from(b'A' + digit as u8));
        number = (number - 1) / 26;
    }
    letters.iter().rev().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_called_as_in_spreadsheets() {
        for (column, name) in [(0, "A"), (25, "Z"), (26, "AA"), (701, "ZZ"), (702, "AAA")] {
            assert_eq!(letters(column), name);
        }
    }

    #[test]
    fn a_table_of_a_million_cells_is_refused() {
        let mut sheet = Sheet::new("", Places::Lines);
        let filled = (0..1_000_000).try_for_each(|row| sheet.put(row, 0, Cell::Number(1.0)));
        assert!(filled.unwrap_err().contains("not a table of hardpoints"));
        assert_eq!(sheet.cells.len(), Sheet::MOST_CELLS);
    }
}
