//! Tables for the terminal, and the same as CSV or JSON.

use serde_json::{Map, Value};

/// How a table is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Aligned columns for reading.
    Text,
    /// Comma-separated values.
    Csv,
    /// A list of objects.
    Json,
}

/// A table of text cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table.
    pub fn new<const N: usize>(header: [&str; N]) -> Self {
        Table {
            header: header.map(str::to_owned).to_vec(),
            rows: Vec::new(),
        }
    }

    /// An empty table whose columns depend on what is shown.
    pub fn with_columns(header: Vec<String>) -> Self {
        Table {
            header,
            rows: Vec::new(),
        }
    }

    /// Adds a row, which has a cell for each column.
    pub fn push_row(&mut self, row: Vec<String>) {
        assert_eq!(row.len(), self.header.len());
        self.rows.push(row);
    }

    /// Adds a row, which has a cell for each column.
    pub fn push<const N: usize>(&mut self, row: [String; N]) {
        assert_eq!(N, self.header.len());
        self.rows.push(row.to_vec());
    }

    /// Whether it has no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Its first rows, and how many more there are.
    pub fn first(mut self, most: usize) -> (Self, usize) {
        let more = self.rows.len().saturating_sub(most);
        self.rows.truncate(most);
        (self, more)
    }

    /// Names of the columns.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// Cells, row by row.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// The table as text, ending in a line break.
    pub fn render(&self, format: Format) -> String {
        match format {
            Format::Text => self.text(),
            Format::Csv => {
                let mut writer = csv::Writer::from_writer(Vec::new());
                for row in std::iter::once(&self.header).chain(&self.rows) {
                    writer.write_record(row).expect("rows of one length");
                }
                let bytes = writer.into_inner().expect("memory takes everything");
                String::from_utf8(bytes).expect("cells are text")
            }
            Format::Json => {
                let rows: Vec<Value> = self.rows.iter().map(|row| self.object(row)).collect();
                let text = serde_json::to_string_pretty(&rows).expect("plain values");
                text + "\n"
            }
        }
    }

    fn object(&self, row: &[String]) -> Value {
        let mut object = Map::new();
        for (name, cell) in self.header.iter().zip(row) {
            let number = cell.parse::<f64>().ok().filter(|v| v.is_finite());
            let value = number.map_or_else(|| Value::from(cell.as_str()), Value::from);
            object.insert(name.clone(), value);
        }
        Value::Object(object)
    }

    /// The first column to the left, numbers to the right.
    fn text(&self) -> String {
        let lines = || std::iter::once(&self.header).chain(&self.rows);
        let widths: Vec<usize> = (0..self.header.len())
            .map(|k| lines().map(|l| l[k].chars().count()).max().unwrap_or(0))
            .collect();
        let is_number = |k: usize| {
            self.rows.iter().all(|r| {
                r[k].is_empty()
                    || r[k].starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c))
            })
        };
        let mut text = String::new();
        for line in lines() {
            let mut out = String::from("  ");
            for (k, cell) in line.iter().enumerate() {
                let padding = " ".repeat(widths[k] - cell.chars().count());
                if k > 0 && is_number(k) {
                    out.push_str(&padding);
                    out.push_str(cell);
                } else {
                    out.push_str(cell);
                    out.push_str(&padding);
                }
                out.push_str("  ");
            }
            text.push_str(out.trim_end());
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_formats_say_the_same() {
        let mut table = Table::new(["output", "min"]);
        table.push(["camber_deg".to_owned(), "-1.5".to_owned()]);
        table.push(["toe_deg".to_owned(), "10".to_owned()]);
        let text = "  output       min\n  camber_deg  -1.5\n  toe_deg       10\n";
        assert_eq!(table.render(Format::Text), text);
        assert_eq!(
            table.render(Format::Csv),
            "output,min\ncamber_deg,-1.5\ntoe_deg,10\n"
        );
        let json: Value = serde_json::from_str(&table.render(Format::Json)).unwrap();
        assert_eq!(json[0]["min"], -1.5);
        assert_eq!(json[1]["output"], "toe_deg");
    }
}
