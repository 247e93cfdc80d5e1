//! Text tables separated by commas, semicolons or tabs.

use super::cell::{Cell, Places, Sheet};

/// Reads a table. The separator is the comma, semicolon or tab that splits the largest number of lines.
pub(super) fn read(text: &str) -> Result<Sheet, String> {
    let text = text.trim_start_matches('\u{feff}');
    let mut sheet = Sheet::new("", Places::Lines);
    let reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator(text))
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut lines = Lines {
        text,
        at: 0,
        line: 0,
    };
    let mut next = 0;
    for record in reader.into_records() {
        let record = record.map_err(|error| error.to_string())?;
        let start = record.position().map_or(0, |p| p.byte() as usize);
        // Rows may end with any kind of line break.
        let row = lines.of(start).max(next);
        next = row + 1;
        for (column, text) in record.iter().enumerate() {
            if !text.is_empty() {
                let column = u32::try_from(column).map_err(|_| "a line has too many columns")?;
                sheet.put(row, column, Cell::Text(text.to_owned()))?;
            }
        }
    }
    if sheet.cells.is_empty() {
        Err("the file is empty".to_owned())
    } else {
        Ok(sheet)
    }
}

/// Counts line numbers of a text for rising positions.
struct Lines<'a> {
    text: &'a str,
    at: usize,
    line: u32,
}

impl Lines<'_> {
    /// Line number, from 0, of the first row at or after a byte position. It skips blank lines and comments.
    fn of(&mut self, start: usize) -> u32 {
        let bytes = self.text.as_bytes();
        let mut start = start.clamp(self.at, bytes.len());
        while start < bytes.len() {
            if bytes[start] == b'#' {
                let end = bytes[start..].iter().position(|byte| *byte == b'\n');
                start = end.map_or(bytes.len(), |end| start + end);
            } else if !bytes[start].is_ascii_whitespace() {
                break;
            } else {
                start += 1;
            }
        }
        let passed = bytes[self.at..start].iter().filter(|byte| **byte == b'\n');
        self.line = self.line.saturating_add(passed.count() as u32);
        self.at = start;
        self.line
    }
}

/// Finds the separator. A table with decimal commas does not use commas as separators. So semicolon and tab have priority if they
/// split any line.
fn separator(text: &str) -> u8 {
    let lines = || {
        text.lines()
            .filter(|line| !line.trim().is_empty() && !line.starts_with('#'))
            .take(1000)
    };
    let parted = |separator: char| lines().filter(move |line| line.matches(separator).count() >= 2);
    let half = lines().count().div_ceil(2);
    let usual = [';', '\t'].into_iter();
    let found = usual
        .max_by_key(|separator| parted(*separator).count())
        .filter(|separator| parted(*separator).count() >= half.max(1));
    found.map_or(b',', |separator| separator as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<Vec<String>> {
        let sheet = read(text).unwrap();
        let cell = |(_, cell): (u32, &Cell)| match cell {
            Cell::Text(text) => text.clone(),
            other => panic!("{other:?}"),
        };
        let row = |row: u32| sheet.row(row).map(cell).collect();
        sheet.rows().into_iter().map(row).collect()
    }

    #[test]
    fn three_separators_say_the_same() {
        let expected = [["name", "x", "y", "z"], ["a", "1.5", "2", "3"]];
        for separator in [",", ";", "\t"] {
            for end in ["\n", "\r\n", "\r"] {
                let lines = expected.map(|row| row.join(separator));
                assert_eq!(texts(&lines.join(end)), expected, "{separator:?} {end:?}");
            }
        }
    }

    #[test]
    fn decimal_commas_do_not_part_cells() {
        assert_eq!(
            texts("n;x;y;z\na;1,5;2,25;3,0\n")[1],
            ["a", "1,5", "2,25", "3,0"]
        );
        assert_eq!(texts("n,x,y,z\na,\"1,5\",2,3\n")[1], ["a", "1,5", "2", "3"]);
    }

    #[test]
    fn lines_keep_their_numbers() {
        let sheet = read("# points\n\nname,x,y,z\na,1,2,3\n").unwrap();
        assert_eq!(sheet.rows(), [2, 3]);
        assert_eq!(sheet.place(3, 1), "line 4, column 2");
    }
}
