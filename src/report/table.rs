//! Tables for the terminal, also as CSV or JSON.
//!
//! A cell has two forms. People see a text with a sensible number of digits; programs get the exact number. A column may be for
//! only one of them. For example, people see a range in one column, but programs get two numbers.

use super::figure::{brief, figure, figures, with_decimals};
use super::shortest;
use super::text::{broken, printable, printable_json, widest};
use serde_json::{Map, Value};

/// Format of printed tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Aligned columns for people.
    Text,
    /// Comma-separated values.
    Csv,
    /// JSON object with a list of objects for each table.
    Json,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    title: String,
    /// Name for programs, if it differs from the title.
    name: Option<&'static str>,
    readers: bool,
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

    /// Name for programs: `at design` becomes `at_design`.
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

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    shown: String,
    data: Value,
}

impl Cell {
    /// Cell with a number. People see six digits, and 0 for a rounding error in this unit.
    pub fn figure(value: f64, unit: &str) -> Self {
        Cell::shown(value, figure(value, unit))
    }

    /// Cells with numbers that people compare side by side.
    pub fn figures<const N: usize>(
        values: [Option<f64>; N],
        unit: &str,
    ) -> impl Iterator<Item = Self> {
        let cells = values.into_iter().zip(figures(values, unit));
        cells.map(|(value, text)| Cell::by(value, |_| text))
    }

    /// Cell with a number for programs and this text for people.
    pub fn shown(value: f64, text: impl Into<String>) -> Self {
        Cell {
            shown: text.into(),
            data: Value::from(value + 0.0),
        }
    }

    /// Cell with a number for programs. `show` makes the text for people. Empty without a value.
    pub fn by<T: Into<String>>(value: impl Into<Option<f64>>, show: impl FnOnce(f64) -> T) -> Self {
        let value = value.into();
        value.map(|value| Cell::shown(value, show(value))).into()
    }

    /// Cell whose text people see only in the row above.
    pub fn repeated(text: &str) -> Self {
        Cell {
            shown: String::new(),
            data: Value::from(text),
        }
    }

    /// Cell with `data` for programs and words for people.
    pub fn in_words(data: impl Into<Value>, words: &str) -> Self {
        Cell {
            shown: words.to_owned(),
            data: data.into(),
        }
    }

    /// Cell with a measured number. People and programs get the same number of decimals.
    pub fn rounded(value: f64, decimals: usize) -> Self {
        let text = with_decimals(value, decimals);
        Cell::shown(text.parse().unwrap_or(value), text)
    }

    /// Text for people.
    pub fn text(&self) -> &str {
        &self.shown
    }

    /// Number in the cell, if it has one.
    pub fn number(&self) -> Option<f64> {
        self.data.as_f64()
    }

    /// True if the cell is aligned like a number.
    pub fn is_number(&self) -> bool {
        self.data.is_number()
            || self
                .shown
                .starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c))
    }

    /// Text for a CSV file.
    fn csv(&self) -> String {
        match &self.data {
            Value::Null => String::new(),
            Value::String(text) => printable(text),
            Value::Number(number) => match number.as_f64().filter(|_| number.is_f64()) {
                Some(value) => shortest(value),
                None => number.to_string(),
            },
            other => other.to_string(),
        }
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Cell::shown(value, brief(value))
    }
}

impl From<bool> for Cell {
    fn from(value: bool) -> Self {
        Cell {
            shown: if value { "yes" } else { "no" }.to_owned(),
            data: value.into(),
        }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell {
            data: match text.is_empty() {
                true => Value::Null,
                false => Value::from(text.as_str()),
            },
            shown: text,
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

macro_rules! whole_numbers {
    ($($kind:ty),*) => {$(
        impl From<$kind> for Cell {
            fn from(value: $kind) -> Self {
                Cell { shown: value.to_string(), data: value.into() }
            }
        }
    )*};
}
whole_numbers!(u32, u64, usize);

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or_else(|| Cell::from(""), Into::into)
    }
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
    /// Number of leading columns for people that identify a row.
    keys: usize,
}

impl Table {
    /// Makes an empty table.
    pub fn new<const N: usize>(header: [&str; N]) -> Self {
        Table::with_columns(header)
    }

    /// Makes an empty table whose columns depend on its content or its format.
    pub fn with_columns(columns: impl IntoIterator<Item: Into<Column>>) -> Self {
        Table {
            columns: columns.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
            keys: 1,
        }
    }

    /// Sets the number of leading columns for people that together identify a row.
    pub fn keyed(mut self, keys: usize) -> Self {
        self.keys = keys;
        self
    }

    /// Adds a row with one cell per column.
    pub fn push_row(&mut self, row: impl IntoIterator<Item: Into<Cell>>) {
        let row: Vec<Cell> = row.into_iter().map(Into::into).collect();
        assert_eq!(row.len(), self.columns.len());
        self.rows.push(row);
    }

    /// Adds a row with one cell per column.
    pub fn push<const N: usize>(&mut self, row: [impl Into<Cell>; N]) {
        self.push_row(row);
    }

    /// Joins tables with equal columns below each other. A first column `name` states the table of each row. If the table has no
    /// name, there must be only one table, and it stays unchanged.
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
                Some(stacked) => stacked.rows.append(&mut table.rows),
                None => stacked = Some(table),
            }
        }
        stacked
    }

    /// True if the table has no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Keeps the first rows, and returns the number of omitted rows.
    pub fn first(mut self, most: usize) -> (Self, usize) {
        let more = self.rows.len().saturating_sub(most);
        self.rows.truncate(most);
        (self, more)
    }

    /// Names of the columns for people.
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

    /// Table as CSV that ends with a line break. With `name`, a first column `table` contains the name in every row.
    pub fn csv(&self, name: Option<&str>) -> String {
        let for_programs = |of: &Vec<String>| -> Vec<String> {
            let cells = of.iter().zip(&self.columns).filter(|(_, c)| c.programs);
            cells.map(|(cell, _)| cell.clone()).collect()
        };
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut write = |first: Option<&str>, cells: Vec<String>| {
            let cells = for_programs(&cells);
            let line = first.into_iter().chain(cells.iter().map(String::as_str));
            writer.write_record(line).expect("rows of one length");
        };
        let header = self.columns.iter().map(Column::key).collect();
        write(name.map(|_| "table"), header);
        for row in &self.rows {
            write(name, row.iter().map(Cell::csv).collect());
        }
        let bytes = writer.into_inner().expect("memory takes everything");
        String::from_utf8(bytes).expect("cells are text")
    }

    /// Table as a JSON list of objects.
    pub fn json(&self) -> Value {
        let object = |row: &Vec<Cell>| {
            let cells = row.iter().zip(&self.columns).filter(|(_, c)| c.programs);
            let named = cells.map(|(cell, column)| (column.key(), cell.data.clone()));
            Value::Object(named.collect::<Map<_, _>>())
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

/// Layout of a column.
struct Layout {
    to_the_right: bool,
    /// True if some cell has several words.
    prose: bool,
    natural: usize,
    /// Smallest width. Numbers and short names are never broken; names longer than half of the line may be.
    least: usize,
}

/// Smallest width of a text column.
const LEAST: usize = 14;

impl Layout {
    fn of<'a>(
        header: &str,
        cells: impl Iterator<Item = &'a Cell> + Clone,
        first: bool,
        width: usize,
    ) -> Self {
        let shown = cells.clone().map(|cell| cell.text().chars().count());
        let longest = shown.max().unwrap_or(0);
        let natural = longest.max(header.chars().count());
        let prose = cells.clone().any(|cell| cell.text().contains(' '));
        let mut cells = cells.filter(|cell| !cell.text().is_empty());
        let numbers = cells.all(Cell::is_number);
        let whole = |name: &str| match name.contains(' ') {
            true => widest(name),
            false => name.chars().count(),
        };
        let fits = |length: usize| 2 * length + 4 <= width;
        let words = cells.clone().flat_map(|cell| cell.text().split(' '));
        let longest_word = words.map(|word| word.chars().count()).max().unwrap_or(0);
        Layout {
            to_the_right: numbers && !first,
            prose,
            natural,
            least: match (numbers, prose) {
                (true, _) if fits(whole(header)) => longest.max(whole(header)).min(natural),
                (true, _) => longest.max(widest(header)).min(natural),
                (false, false) if fits(natural) => natural,
                (false, true) if fits(longest_word) => natural.min(LEAST.max(longest_word)),
                (false, _) => natural.min(LEAST),
            },
        }
    }
}

/// Splits columns into groups that fit side by side. Each group begins with the first `keys` columns, or with the first column
/// alone if the space is too small.
fn pieces(widths: &[usize], width: usize, keys: usize) -> Vec<Vec<usize>> {
    let taken = |keys: usize| widths[..keys].iter().map(|w| w + 2).sum::<usize>();
    let widest = widths.iter().skip(keys).max().unwrap_or(&0);
    let keys = match taken(keys) + widest + 2 <= width {
        true => keys,
        false => 1,
    };
    let mut pieces = vec![Vec::new()];
    let mut room = 0;
    for (k, own) in widths.iter().enumerate() {
        let piece = pieces.last_mut().expect("there is one");
        if room + own + 2 > width && piece.len() > keys {
            pieces.push((0..keys).chain([k]).collect());
            room = taken(keys) + own + 2;
        } else {
            piece.push(k);
            room += own + 2;
        }
    }
    pieces
}

/// Writes a row with as many lines as its cells need.
fn line<'a>(text: &mut String, cells: impl Iterator<Item = (&'a str, usize, &'a Layout)>) {
    let cells: Vec<_> = cells
        .map(|(cell, width, l)| (broken(cell, width), width, l))
        .collect();
    let height = cells
        .iter()
        .map(|(lines, ..)| lines.len())
        .max()
        .unwrap_or(0);
    for number in 0..height.max(1) {
        let mut out = String::new();
        for (lines, width, layout) in &cells {
            let cell = lines.get(number).map_or("", String::as_str);
            let padding = " ".repeat(width.saturating_sub(cell.chars().count()));
            out.push_str("  ");
            match layout.to_the_right {
                true => out.extend([&padding, cell]),
                false => out.extend([cell, &padding]),
            }
        }
        text.push_str(out.trim_end());
        text.push('\n');
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

    /// Text of all tables. In CSV, empty lines separate them, and the first column `table` contains their name; empty tables are
    /// left out if there are others. In JSON, they are lists in one object.
    pub fn render(&self, format: Format, width: usize) -> String {
        let is_nameless = |table: &Table| format == Format::Csv && table.rows.is_empty();
        let has_rows = self.0.iter().any(|(_, table)| !table.rows.is_empty());
        let each = |render: &dyn Fn(&'static str, &Table) -> String| {
            let tables = self.0.iter();
            let said = tables.filter(|(_, table)| !(has_rows && is_nameless(table)));
            let all: Vec<String> = said.map(|(name, table)| render(name, table)).collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let readers = Column::for_readers("range");
        let programs = ["range min", "range max"].map(Column::for_programs);
        let columns = [Column::from("output"), "min".into(), readers].into_iter();
        let mut table = Table::with_columns(columns.chain(programs));
        let row = |name: &str, min: f64, [low, high]: [f64; 2]| -> [Cell; 5] {
            let range = Cell::from(format!("{low} .. {high}"));
            [name.into(), min.into(), range, low.into(), high.into()]
        };
        table.push(row("camber_deg", -1.5, [-5.0, 5.0]));
        table.push(row("toe_deg", 1.0 / 3.0, [0.25, 10.0]));
        table
    }

    #[test]
    fn a_reader_sees_digits_that_matter_and_a_program_gets_the_number() {
        let mut tables = Tables::default();
        tables.push("outputs", table());
        assert_eq!(
            tables.render(Format::Text, 80),
            "  output           min       range\n  camber_deg      -1.5     -5 .. 5\n  toe_deg     0.333333  0.25 .. 10\n"
        );
        assert_eq!(
            tables.render(Format::Csv, 80),
            "table,output,min,range_min,range_max\noutputs,camber_deg,-1.5,-5.0,5.0\n\
             outputs,toe_deg,0.3333333333333333,0.25,10.0\n"
        );
        let json: Value = serde_json::from_str(&tables.render(Format::Json, 80)).unwrap();
        assert_eq!(json["outputs"][1]["min"].as_f64(), Some(1.0 / 3.0));
        assert_eq!(json["outputs"][0]["range_max"], 5.0);
        assert_eq!(json["outputs"][1]["output"], "toe_deg");
    }

    #[test]
    fn a_table_without_rows_is_no_line_that_nobody_can_name() {
        let mut tables = Tables::default();
        tables.push("none", Table::new(["study"]));
        assert_eq!(tables.render(Format::Csv, 80), "table,study\n");
        tables.push("outputs", table());
        assert!(tables.render(Format::Csv, 80).starts_with("table,output,"));
        assert!(tables.render(Format::Json, 80).contains("\"none\": []"));
    }

    #[test]
    fn what_says_what_a_row_is_of_stands_in_every_piece() {
        let names = ["adjustment", "per", "camber_deg", "toe_deg", "caster_deg"];
        let mut table = Table::new(names).keyed(2);
        for per in ["mm", "turn"] {
            let head = [Cell::from("lower arm, front stud"), per.into()];
            table.push_row(head.into_iter().chain([0.123456; 3].map(Cell::from)));
        }
        let text = table.text(46);
        let pieces: Vec<&str> = text.split("\n\n").collect();
        assert!(pieces.len() > 1, "{text}");
        for piece in pieces {
            let [header, mm, turn] = [0, 1, 2].map(|line| piece.lines().nth(line).unwrap());
            assert!(header.starts_with("  adjustment"), "{text}");
            assert!(
                header.contains(" per ") && mm.contains(" mm ") && turn.contains(" turn "),
                "{text}"
            );
        }
        // If the space is too small, only the first column is repeated.
        let names = [Cell::from("n".repeat(14)), "m".repeat(14).into()];
        let mut table = Table::new(["a", "b", "c", "d"]).keyed(2);
        table.push_row(names.into_iter().chain([-0.123456e-10; 2].map(Cell::from)));
        let text = table.text(40);
        assert!(
            text.lines().all(|line| line.chars().count() <= 40),
            "{text}"
        );
    }

    /// Output to a pipe breaks no name, for any number of columns.
    #[test]
    fn names_are_not_broken() {
        let columns = [
            "camber_gain_deg_per_mm",
            "roll_centre_height_mm",
            "half_track_change_mm",
        ];
        let sides = ["left", "right"];
        let all = columns
            .iter()
            .flat_map(|c| sides.map(|side| format!("{c}_{side}")));
        let all: Vec<String> = all.collect();
        let header = ["hardpoint".to_owned()].into_iter().chain(all.clone());
        let mut table = Table::with_columns(header.map(Column::from));
        for name in ["upper_front_link_outer", "lower_rear_link_inner"] {
            let numbers = (0..6).map(|k| Cell::from(0.123456 * f64::from(k)));
            table.push_row([Cell::from(name)].into_iter().chain(numbers));
        }
        let text = table.text(100);
        let longest = text.lines().map(|line| line.chars().count()).max();
        assert!(longest <= Some(100), "{text}");
        for name in all
            .iter()
            .map(String::as_str)
            .chain(["upper_front_link_outer"])
        {
            assert!(text.contains(name), "{name}:\n{text}");
        }
        assert!(text.contains("\n\n"), "{text}");
    }

    #[test]
    fn text_that_looks_like_a_number_stays_text() {
        let mut table = Table::new(["study", "misfit"]);
        table.push([Cell::from("1e5"), Cell::from(f64::NAN)]);
        assert_eq!(table.json()[0]["study"], "1e5");
        assert!(table.json()[0]["misfit"].is_null());
        assert_eq!(table.csv(None), "study,misfit\n1e5,\n");
    }

    #[test]
    fn lines_are_no_longer_than_the_width() {
        let mut wide = Table::new(["effect", "because of", "what", "cost"]);
        let because = "motion_ratio, spring_length, anti_roll_bar_angle (line 51)";
        wide.push([
            Cell::from("rocker"),
            because.into(),
            "turned by the pushrod".into(),
            0.25.into(),
        ]);
        let columns = (0..20).map(|k| format!("upper_front_link_inner_{k}_mm"));
        let mut long = Table::with_columns(["design".to_owned()].into_iter().chain(columns));
        long.push_row((0..21).map(|k| Cell::from(f64::from(k) / 7.0)));
        for table in [&wide, &long] {
            for width in [40, 60, 80, 100, 200] {
                let text = table.text(width);
                let longest = text.lines().map(|l| l.chars().count()).max().unwrap();
                assert!(longest <= width, "{longest} of {width}:\n{text}");
                // No text is lost.
                let letters = |text: &str| text.chars().filter(|c| !c.is_whitespace()).count();
                assert!(letters(&text) >= letters(&table.text(10_000)), "{text}");
            }
        }
        assert!(wide.text(60).lines().count() <= 1 + 4, "{}", wide.text(60));
    }
}
