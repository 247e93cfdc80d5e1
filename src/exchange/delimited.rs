//! Text tables separated by commas, semicolons or tabs, or by spaces as in a text copied from a page.

use super::cell::{Cell, Places, Sheet};
use super::decimals::plain_number;
use std::borrow::Cow;
use std::io::Read;

/// Line that the reader adds after the text of a file. This line is missing in the table if a quotation mark of the file is not
/// closed. No text contains its zero character.
const END: &[u8] = b"\n\0\n";

/// Reads a table. The separator is the semicolon or the tab if one of them splits half of the lines, else the comma. If most
/// lines end with three numbers between spaces, spaces separate the numbers from the name before them. A comment without
/// numbers, such as `# all dimensions in mm`, is read as a title.
///
/// # Errors
/// The file is empty or has too many cells, a quotation mark is not closed, or the end of a name is not clear.
pub(super) fn read(text: &str) -> Result<Sheet, String> {
    let text = text.trim_start_matches('\u{feff}');
    let text = &*in_tabs(text)?;
    let separator = separator(text);
    let text = &*with_titles(text, separator);
    let mut sheet = Sheet::new("", Places::Lines);
    let reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes().chain(END));
    let mut lines = Lines {
        text,
        at: 0,
        line: 0,
    };
    let mut next = 0;
    let mut is_closed = false;
    for record in reader.into_records() {
        let record = record.map_err(|error| error.to_string())?;
        if record.iter().eq(["\0"]) {
            is_closed = true;
            break;
        }
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
    if !is_closed {
        return Err(format!(
            "line {next}: a quotation mark before a cell has no counterpart after it, so the rest of the file cannot be read"
        ));
    }
    if sheet.cells.is_empty() {
        return Err("the file is empty".to_owned());
    }
    Ok(sheet)
}

/// Position in a text, to convert byte positions to line numbers. The byte positions must increase from call to call.
struct Lines<'a> {
    text: &'a str,
    at: usize,
    line: u32,
}

impl Lines<'_> {
    /// Line number, from 0, of the first row at or after a byte position. Skips blank lines and comments.
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

/// If spaces separate the cells of at least half of the lines, replaces the spaces between a name and the numbers after it by tabs.
/// The name may have several words.
///
/// # Errors
/// Most lines have three numbers, and another line has more. Its first number may be the end of its name.
fn in_tabs(text: &str) -> Result<Cow<'_, str>, String> {
    let half = lines_of(text).count().div_ceil(2).max(1);
    let rows: Vec<Vec<String>> = lines_of(text).filter_map(in_words).collect();
    if text.contains(['\t', ';', '"']) || rows.len() < half {
        return Ok(Cow::Borrowed(text));
    }
    let usual = rows.iter().filter(|cells| cells.len() == 4).count();
    let is_open =
        |cells: &&Vec<String>| cells.len() > 4 && cells[1].bytes().all(|b| b.is_ascii_digit());
    if 2 * usual > rows.len()
        && let Some(cells) = rows.iter().find(is_open)
    {
        return Err(format!(
            "the row {:?} has {} numbers, but most rows have 3. If the name ends with a number, write it without a blank, as in \
             LCA_1",
            cells.join(" "),
            cells.len() - 1
        ));
    }
    let mut tabs = String::with_capacity(text.len());
    for line in text.split_inclusive(['\n', '\r']) {
        let content = line.trim_end_matches(['\n', '\r']);
        match in_words(content).or_else(|| named_number(content)) {
            Some(cells) => tabs += &cells.join("\t"),
            None => tabs += content,
        }
        tabs += &line[content.len()..];
    }
    Ok(Cow::Owned(tabs))
}

/// Replaces the `#` before a title by spaces, so that every byte keeps its position. A comment with a number in a cell of its
/// own, or with three numbers, stays a comment, because it is a disabled row.
fn with_titles(text: &str, separator: u8) -> Cow<'_, str> {
    if !text.contains('#') {
        return Cow::Borrowed(text);
    }
    let is_number = |cell: &str| plain_number(cell.trim(), true).is_ok();
    let mut titles = String::with_capacity(text.len());
    for line in text.split_inclusive(['\n', '\r']) {
        let title = line.trim_start_matches('#');
        let is_row = title.trim().is_empty()
            || title.split(char::from(separator)).any(is_number)
            || title
                .split_whitespace()
                .filter(|word| is_number(word))
                .count()
                >= 3;
        if line.starts_with('#') && !title.contains('"') && !is_row {
            titles.extend(std::iter::repeat_n(' ', line.len() - title.len()));
            // Commas split a title in every table. So they are replaced by the separator of this table.
            titles += &title.replace(',', char::from(separator).encode_utf8(&mut [0; 4]));
        } else {
            titles += line;
        }
    }
    Cow::Owned(titles)
}

/// Lines with cells: no blank lines and no comments.
fn lines_of(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines();
    lines.filter(|line| !line.trim().is_empty() && !line.starts_with('#'))
}

/// Largest number of words in the header of a coordinate, such as `x left [cm]`.
const MOST_WORDS: usize = 4;

/// Cells of a line with a name followed by at least three numbers, separated by spaces. Also the cells of a header that ends with
/// x, y and z. Words such as its unit may follow each letter. `None` for any other line.
fn in_words(line: &str) -> Option<Vec<String>> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let is_number = |word: &&&str| !word.ends_with(',') && is_number(word);
    let is_axis = |(word, axis): (&&str, char)| {
        let mut letters = word.chars().flat_map(char::to_lowercase);
        letters.next() == Some(axis)
            && !letters.next().is_some_and(char::is_alphanumeric)
            && !word.contains(',')
    };
    let numbers = words.iter().rev().take_while(is_number).count();
    if numbers >= 3 && words.len() > 3 {
        let cells = (words.len() - 3).min(words.len() - numbers).max(1);
        let name = words[..cells].join(" ");
        let others = words[cells..].iter().map(|word| (*word).to_owned());
        return Some(std::iter::once(name).chain(others).collect());
    }
    // In a header, each axis may have further words, such as its unit.
    let mut starts = vec![0];
    for axis in "xyz".chars() {
        let after = starts.last()? + 1;
        let beside = words.iter().enumerate().skip(after);
        let (start, _) = beside
            .into_iter()
            .find(|(_, word)| is_axis((*word, axis)))?;
        starts.push(start);
    }
    starts.push(words.len());
    let [_, x, y, z, end] = starts[..] else {
        return None;
    };
    let is_short = [y - x, z - y, end - z].into_iter().all(|n| n <= MOST_WORDS);
    let cells = starts
        .windows(2)
        .map(|ends| words[ends[0]..ends[1]].join(" "));
    is_short.then(|| cells.collect())
}

/// True for a number with a decimal point or a decimal comma.
fn is_number(word: &str) -> bool {
    word.replace(',', ".").parse::<f64>().is_ok()
}

/// Cells of a line with a name and one number, such as `static toe 0.1 deg` or `radius = 310`: name, number, further words.
fn named_number(line: &str) -> Option<Vec<String>> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let at = words.iter().position(|word| is_number(word))?;
    let is_alone = words[at + 1..].iter().all(|word| !is_number(word));
    let name = words[..at].join(" ");
    let name = name.trim_end_matches(['=', ':', ' ']);
    if line.starts_with('#') || name.is_empty() || !is_alone {
        return None;
    }
    let mut cells = vec![name.to_owned(), words[at].to_owned()];
    cells.extend((at + 1 < words.len()).then(|| words[at + 1..].join(" ")));
    Some(cells)
}

/// Finds the separator. A table with decimal commas does not use commas as separators. So the semicolon or the tab has priority if
/// it splits at least half of the lines into three cells or more.
fn separator(text: &str) -> u8 {
    let lines = || lines_of(text).take(1000);
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

    /// Spaces separate cells if the text has no other separator. Names have several words, and numbers have decimal commas.
    #[test]
    fn spaces_separate_numbers_from_names() {
        assert_eq!(
            texts("Point X Y[mm] Z\nlower link frame 1.5 -2 3e1\nwheel centre   0 29,9 13.2\n"),
            [
                ["Point", "X", "Y[mm]", "Z"],
                ["lower link frame", "1.5", "-2", "3e1"],
                ["wheel centre", "0", "29,9", "13.2"]
            ]
        );
        assert_eq!(
            texts("Point   x [cm]   y [cm]   z up (cm)\nupper link   1.5   -2   3\n"),
            [
                ["Point", "x [cm]", "y [cm]", "z up (cm)"],
                ["upper link", "1.5", "-2", "3"]
            ]
        );
        assert_eq!(
            texts("upper 2 1.5 -2 3\n")[0],
            ["upper", "2", "1.5", "-2", "3"]
        );
        assert_eq!(
            texts(
                "# right side, in cm\na 1 2 3\nb 4 5 6\nc 7 8 9\nstatic toe 0.1 deg\nradius = 31,5\n"
            ),
            [
                vec!["right side", "in cm"],
                vec!["a", "1", "2", "3"],
                vec!["b", "4", "5", "6"],
                vec!["c", "7", "8", "9"],
                vec!["static toe", "0.1", "deg"],
                vec!["radius", "31,5"],
            ]
        );
        let sheet = read("Front axle\n\nwheel centre 0 1 2\nstrut top 3 4 5\n").unwrap();
        assert_eq!(sheet.rows(), [0, 2, 3]);
        // In this table, commas separate the cells.
        assert_eq!(
            texts("wheel centre, 0, 1, 2\n")[0],
            ["wheel centre", "0", "1", "2"]
        );
    }

    /// A name may end with a number. If the other rows have three numbers, such a row is refused.
    #[test]
    fn names_that_end_with_numbers_are_refused() {
        let refused = |row: &str| read(&format!("a 1 2 3\nb 4 5 6\n{row}\nc 7 8 9\n")).err();
        let found = refused("spring top 1 50.5 300 500").unwrap();
        assert!(
            found.contains("\"spring top 1 50.5 300 500\" has 4 numbers"),
            "{found}"
        );
        for row in ["spring_top_1 50.5 300 500", "d 1.5 2 3 0.1"] {
            assert_eq!(refused(row), None, "{row}");
        }
    }

    /// Rows behind a quotation mark that is not closed would be lost.
    #[test]
    fn quotation_marks_without_a_counterpart_are_refused() {
        for row in ["\"b,4,5,6", "\"b,4,5,6\nc,7,8,9\n", "b,4,5,\"6"] {
            let refused = read(&format!("name,x,y,z\na,1,2,3\n{row}")).unwrap_err();
            assert!(refused.starts_with("line 3: a quotation mark"), "{refused}");
        }
        for row in [
            "\"b\",4,5,6",
            "b,4\",5\",6\"",
            "\"b\n2\",4,5,6\n# 2\" rim",
            "",
        ] {
            assert!(
                read(&format!("name,x,y,z\na,1,2,3\n{row}")).is_ok(),
                "{row}"
            );
        }
    }

    #[test]
    fn lines_keep_their_numbers() {
        let sheet = read("# a,1,2,3\n\nname,x,y,z\n#\na,1,2,3\n").unwrap();
        assert_eq!(sheet.rows(), [2, 4]);
        assert_eq!(sheet.place(4, 1), "line 5, column 2");
    }

    /// A comment without numbers is a title. A row of numbers after a `#` is disabled.
    #[test]
    fn comments_are_titles() {
        let text = "# left side 2027, all in mm\n#name,x,y,z\na,1,2,3\n#b,4,5,6\n# c 7 8 9\n### upper\nd,1,1,1\n";
        assert_eq!(
            texts(text),
            [
                vec!["left side 2027", "all in mm"],
                vec!["name", "x", "y", "z"],
                vec!["a", "1", "2", "3"],
                vec!["upper"],
                vec!["d", "1", "1", "1"]
            ]
        );
        let rows = read(text).unwrap().rows();
        assert_eq!(rows, [0, 1, 2, 5, 6]);
    }
}
