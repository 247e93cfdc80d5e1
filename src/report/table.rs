//! Tables for the terminal, also as CSV or JSON.
//!
//! A cell has two forms. People see a text with a sensible number of digits; programs get the exact number. A column may be for
//! people only or for programs only. For example, people see a range in one column, but programs get two numbers.

mod cell;
mod layout;
#[cfg(test)]
mod tests;

use super::text::printable_json;
pub use cell::Cell;
use layout::{Layout, line, pieces};
use serde_json::{Map, Value};

/// Format of printed tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Aligned columns for people.
    Text,
    /// Comma-separated values.
    Csv,
    /// JSON: an object that contains a list of objects for each table.
    Json,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Heading for people.
    title: String,
    /// Name for programs, if it differs from the title.
    name: Option<&'static str>,
    /// True if text output and pages have the column.
    readers: bool,
    /// True if CSV and JSON have the column.
    programs: bool,
}

impl Column {
    /// Column for people only.
    pub fn for_readers(title: impl Into<String>) -> Self {
        Column {
            programs: false,
            ..Column::from(title.into())
        }
    }

    /// Column for programs only.
    pub fn for_programs(title: impl Into<String>) -> Self {
        Column {
            readers: false,
            ..Column::from(title.into())
        }
    }

    /// Column whose name for programs differs from its title.
    pub fn named(title: impl Into<String>, name: &'static str) -> Self {
        Column {
            name: Some(name),
            ..Column::from(title.into())
        }
    }

    /// Name of the column for programs, before equal names get a number. Spaces and hyphens become underscores: `at design` ->
    /// `at_design`.
    fn key(&self) -> String {
        self.name.unwrap_or(&self.title).replace([' ', '-'], "_")
    }
}

impl From<String> for Column {
    fn from(title: String) -> Self {
        Column {
            title,
            name: None,
            readers: true,
            programs: true,
        }
    }
}

impl From<&str> for Column {
    fn from(title: &str) -> Self {
        title.to_owned().into()
    }
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
    /// Number of leading columns for people that together identify a row.
    keys: usize,
    /// Indices of the rows that are headings of the rows below them.
    headings: Vec<usize>,
}

impl Table {
    /// Makes an empty table.
    pub fn new<const N: usize>(header: [&str; N]) -> Self {
        Table::with_columns(header)
    }

    /// Makes an empty table from a list of columns. The list may depend on the content or the format of the table.
    pub fn with_columns(columns: impl IntoIterator<Item: Into<Column>>) -> Self {
        Table {
            columns: columns.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
            keys: 1,
            headings: Vec::new(),
        }
    }

    /// Sets the number of leading columns for people that together identify a row.
    pub fn keyed(mut self, keys: usize) -> Self {
        self.keys = keys;
        self
    }

    /// Adds a row with one cell for each column, including columns for people only and for programs only.
    pub fn push_row(&mut self, row: impl IntoIterator<Item: Into<Cell>>) {
        let row: Vec<Cell> = row.into_iter().map(Into::into).collect();
        assert_eq!(row.len(), self.columns.len());
        self.rows.push(row);
    }

    /// Adds a heading for the rows below it. Its row has one filled cell, the first one.
    pub fn push_heading(&mut self, title: impl Into<Cell>) {
        self.headings.push(self.rows.len());
        let mut row = vec![title.into()];
        row.resize_with(self.columns.len(), || "".into());
        self.rows.push(row);
    }

    /// True if the row with this index is a heading for the rows below it.
    pub(super) fn is_heading(&self, row: usize) -> bool {
        self.headings.contains(&row)
    }

    /// Adds a row with one cell per column.
    pub fn push<const N: usize>(&mut self, row: [impl Into<Cell>; N]) {
        self.push_row(row);
    }

    /// Appends the rows of tables with equal columns. If the tables have names, a first column with the title `name` contains
    /// the name of each row's table. A table without a name must be the only one; it stays unchanged. `None` without tables.
    pub fn stacked<'n>(
        name: &str,
        tables: impl IntoIterator<Item = (Option<&'n str>, Table)>,
    ) -> Option<Table> {
        let mut stacked: Option<Table> = None;
        for (of, mut table) in tables {
            if let Some(of) = of {
                table.columns.insert(0, Column::from(name));
                table
                    .rows
                    .iter_mut()
                    .for_each(|row| row.insert(0, of.into()));
                table.keys += 1;
            }
            match &mut stacked {
                Some(stacked) => {
                    let above = stacked.rows.len();
                    let headings = table.headings.iter().map(|row| row + above);
                    stacked.headings.extend(headings);
                    stacked.rows.append(&mut table.rows);
                }
                None => stacked = Some(table),
            }
        }
        stacked
    }

    /// True if the table has no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Keeps the first `most` rows, and returns the table and the number of omitted rows.
    pub fn first(mut self, most: usize) -> (Self, usize) {
        let more = self.rows.len().saturating_sub(most);
        self.rows.truncate(most);
        (self, more)
    }

    /// Headings of the columns for people.
    pub fn header(&self) -> Vec<&str> {
        let columns = self.columns.iter().filter(|c| c.readers);
        columns.map(|c| c.title.as_str()).collect()
    }

    /// Cells for people, row by row.
    pub fn rows(&self) -> impl Iterator<Item = Vec<&Cell>> {
        self.rows.iter().map(|row| {
            let cells = row.iter().zip(&self.columns);
            cells
                .filter(|(_, c)| c.readers)
                .map(|(cell, _)| cell)
                .collect()
        })
    }

    /// Names of the columns for programs, each once. If the name of a run or a goal is also the name of an earlier column, it
    /// gets a number: `unit_2`.
    fn program_keys(&self) -> Vec<String> {
        let mut keys: Vec<String> = Vec::new();
        for column in self.columns.iter().filter(|c| c.programs) {
            let key = column.key();
            let numbered = (2..).map(|number| format!("{key}_{number}"));
            let mut names = std::iter::once(key.clone()).chain(numbered);
            keys.extend(names.find(|name| !keys.contains(name)));
        }
        keys
    }

    /// Table as CSV that ends with a line break. With `name`, a first column `table` contains the name in every row.
    pub fn csv(&self, name: Option<&str>) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut write = |first: Option<&str>, cells: Vec<String>| {
            let line = first.into_iter().chain(cells.iter().map(String::as_str));
            writer
                .write_record(line)
                .expect("all rows have the same length");
        };
        write(name.map(|_| "table"), self.program_keys());
        for row in &self.rows {
            let cells = row.iter().zip(&self.columns).filter(|(_, c)| c.programs);
            write(name, cells.map(|(cell, _)| cell.csv()).collect());
        }
        let bytes = writer
            .into_inner()
            .expect("writing to memory does not fail");
        String::from_utf8(bytes).expect("all cells are text")
    }

    /// Table as a JSON list of objects.
    pub fn json(&self) -> Value {
        let keys = self.program_keys();
        let object = |row: &Vec<Cell>| {
            let cells = row.iter().zip(&self.columns).filter(|(_, c)| c.programs);
            let cells = cells.map(|(cell, _)| cell.data.clone());
            Value::Object(keys.iter().cloned().zip(cells).collect::<Map<_, _>>())
        };
        Value::from(self.rows.iter().map(object).collect::<Vec<Value>>())
    }

    /// Table for people, with lines of at most `width` characters if its numbers allow it. First it breaks texts and headings. If
    /// that is not enough, it splits the columns into several tables. Each of them repeats the columns that identify a row
    /// ([`Table::keyed`]). The first column is aligned to the left, numbers to the right.
    pub fn text(&self, width: usize) -> String {
        let header = self.header();
        let rows: Vec<Vec<&Cell>> = self.rows().collect();
        let layout: Vec<Layout> = (0..header.len())
            .map(|k| Layout::of(header[k], rows.iter().map(|row| row[k]), k == 0, width))
            .collect();
        let natural: Vec<usize> = layout.iter().map(|l| l.natural).collect();
        let mut widths = natural.clone();
        let room = |widths: &[usize]| widths.iter().map(|w| w + 2).sum::<usize>();
        while room(&widths) > width {
            let wider = (0..widths.len()).filter(|k| widths[*k] > layout[*k].least);
            // Sentences are broken before names, because names are easier to read without a break.
            let Some(widest) = wider.max_by_key(|k| (layout[*k].prose, widths[*k])) else {
                break;
            };
            widths[widest] -= 1;
        }
        if room(&widths) > width {
            // After the split into several tables, headings need no break.
            let first = natural[0].min((width / 2).max(layout[0].least));
            let most = width.saturating_sub(first + 4);
            let fitting =
                |(layout, natural): (&Layout, &usize)| (*natural).min(most.max(layout.least));
            widths = layout.iter().zip(&natural).map(fitting).collect();
            widths[0] = first;
        }
        let mut text = String::new();
        for piece in pieces(&widths, width, self.keys) {
            if !text.is_empty() {
                text.push('\n');
            }
            let shown = piece.iter().map(|k| (header[*k], widths[*k], &layout[*k]));
            line(&mut text, shown);
            for row in &rows {
                let shown = piece
                    .iter()
                    .map(|k| (row[*k].text(), widths[*k], &layout[*k]));
                line(&mut text, shown);
            }
        }
        text
    }
}

/// Tables of a command in order, with their names for programs.
#[derive(Clone, Debug, Default)]
pub struct Tables(Vec<(&'static str, Table)>);

impl Tables {
    /// Adds a table.
    pub fn push(&mut self, name: &'static str, table: Table) {
        self.0.push((name, table));
    }

    /// Text of all tables. In CSV, empty lines separate the tables, and the first column `table` contains their name. Empty
    /// tables are left out of CSV if another table has rows. In JSON, the tables are lists in one object.
    pub fn render(&self, format: Format, width: usize) -> String {
        let is_omissible = |table: &Table| format == Format::Csv && table.rows.is_empty();
        let has_rows = self.0.iter().any(|(_, table)| !table.rows.is_empty());
        let each = |render: &dyn Fn(&'static str, &Table) -> String| {
            let tables = self.0.iter();
            let shown = tables.filter(|(_, table)| !(has_rows && is_omissible(table)));
            let all: Vec<String> = shown.map(|(name, table)| render(name, table)).collect();
            all.join("\n")
        };
        match format {
            Format::Text => each(&|_, table| table.text(width)),
            Format::Csv => each(&|name, table| table.csv(Some(name))),
            Format::Json => {
                let named = self
                    .0
                    .iter()
                    .map(|(name, table)| ((*name).to_owned(), table.json()));
                let object = Value::Object(named.collect());
                let text = serde_json::to_string_pretty(&object).expect("plain values");
                printable_json(&text) + "\n"
            }
        }
    }
}
