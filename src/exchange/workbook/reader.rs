//! Reads workbooks of spreadsheet programs (ECMA-376, Office Open XML, part 1, sections 12.3 and 18). It takes the values from
//! the last computation of the spreadsheet program. It does not compute formulas or run macros.

use super::archive::Archive;
use super::markup::{Element, Event, Markup};
use crate::exchange::cell::{Cell, Places, Sheet};
use std::io::BufRead;

/// Largest size of all texts in the workbook's list of shared texts, in bytes.
const MOST_SHARED: usize = 16 << 20;

/// A workbook, with its sheets by name.
pub(crate) struct Workbook {
    archive: Archive,
    /// Name of each sheet, and its member of the archive.
    sheets: Vec<(String, String)>,
    shared: Vec<String>,
    /// For each cell style, true if it shows a date.
    dates: Vec<bool>,
}

impl Workbook {
    /// Opens a workbook, but does not read its sheets yet.
    pub(crate) fn open(bytes: Vec<u8>) -> Result<Self, String> {
        let archive = Archive::open(bytes)?;
        let Some(book) = archive.member("xl/workbook.xml") else {
            return Err(what_else(&archive));
        };
        let mut named = Vec::new();
        each_element(book?, |element| {
            if element.name == "sheet" {
                // Attribute prefixes are removed, so `id` is the relationship; the sheet number is `sheetId`.
                let [name, id] = ["name", "id"].map(|key| element.attribute(key).unwrap_or(""));
                named.push((name.to_owned(), id.to_owned()));
            }
            Ok(())
        })?;
        let mut targets = Vec::new();
        if let Some(relations) = archive.member("xl/_rels/workbook.xml.rels") {
            each_element(relations?, |element| {
                if let (Some(id), Some(target)) =
                    (element.attribute("Id"), element.attribute("Target"))
                {
                    let target = match target.strip_prefix('/') {
                        Some(absolute) => absolute.to_owned(),
                        None => format!("xl/{target}"),
                    };
                    targets.push((id.to_owned(), target));
                }
                Ok(())
            })?;
        }
        let member = |id: &str| targets.iter().find(|(known, _)| known == id);
        let sheets = named.into_iter().filter_map(|(name, id)| {
            let (_, target) = member(&id)?;
            Some((name, target.clone()))
        });
        let sheets = sheets.collect();
        let shared = shared_texts(&archive)?;
        let dates = date_styles(&archive)?;
        Ok(Workbook {
            archive,
            sheets,
            shared,
            dates,
        })
    }

    /// Names of the sheets, without sheets that have no part in the archive's list of relations.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.sheets.iter().map(|(name, _)| name.as_str())
    }

    /// Reads a sheet, by its index in [`Workbook::names`].
    pub(crate) fn sheet(&self, number: usize) -> Result<Sheet, String> {
        let sheet = self.sheets.get(number);
        let (name, member) = sheet.ok_or("the workbook has no such sheet")?;
        let part = self.archive.member(member);
        let part = part.ok_or_else(|| format!("the workbook has no part {member}"))?;
        self.cells(name, part?)
    }

    fn cells(&self, name: &str, part: impl BufRead) -> Result<Sheet, String> {
        let mut sheet = Sheet::new(name, Places::Spreadsheet);
        let mut markup = Markup::new(part);
        let (mut row, mut column) = (0, 0);
        let mut first_row = true;
        while let Some(event) = markup.next()? {
            let Event::Start(element) = event else {
                continue;
            };
            match element.name.as_str() {
                "row" => {
                    // A row or cell without a position follows the previous one.
                    let next = if first_row { 0 } else { row + 1 };
                    let written = element.attribute("r").and_then(|r| r.parse::<u32>().ok());
                    row = written.map_or(next, |r| r.saturating_sub(1));
                    (column, first_row) = (0, false);
                }
                "c" => {
                    if let Some(place) = element.attribute("r") {
                        (row, column) = place_of(place)
                            .ok_or_else(|| format!("the workbook has a cell called {place:?}"))?;
                    }
                    if let Some(cell) = self.cell(&mut markup, &element)? {
                        sheet.put(row, column, cell)?;
                    }
                    column += 1;
                }
                "mergeCell" => {
                    let range = element.attribute("ref").unwrap_or("");
                    merge(&mut sheet, range)?;
                }
                _ => (),
            }
        }
        Ok(sheet)
    }

    /// Reads the value of a cell after the start of its element. `None` for an empty cell.
    fn cell<R: BufRead>(
        &self,
        markup: &mut Markup<R>,
        element: &Element,
    ) -> Result<Option<Cell>, String> {
        let kind = element.attribute("t").unwrap_or("n");
        let (mut value, mut inline, mut is_formula) = (None, String::new(), false);
        loop {
            match markup.next()? {
                Some(Event::Start(part)) => match part.name.as_str() {
                    "v" => value = Some(markup.text_of("v")?),
                    "t" => inline += &markup.text_of("t")?,
                    "f" => {
                        is_formula = true;
                        markup.text_of("f")?;
                    }
                    // The element `rPh` contains the pronunciation of a text, which is not needed.
                    "rPh" => drop(markup.text_of("rPh")?),
                    _ => (),
                },
                Some(Event::End(name)) if name == "c" => break,
                Some(_) => (),
                None => return Err("the workbook is damaged: a cell does not end".to_owned()),
            }
        }
        if kind == "inlineStr" {
            return Ok(text(inline));
        }
        let Some(value) = value.filter(|value| !value.is_empty()) else {
            let lost = "a formula whose value is not in the file (open and save it in the program \
                        that made it)";
            return Ok(is_formula.then(|| Cell::Unusable(lost.to_owned())));
        };
        Ok(match kind {
            "s" => {
                let found = value.trim().parse::<usize>().ok();
                let found = found.and_then(|number| self.shared.get(number));
                text(
                    found
                        .ok_or("the workbook has no shared text for a cell")?
                        .clone(),
                )
            }
            "str" => text(value),
            "n" => Some(self.number(&value, element)),
            "b" => Some(Cell::Unusable("true or false".to_owned())),
            "e" => Some(Cell::Unusable(format!("the error {value}"))),
            _ => Some(Cell::Unusable("a date".to_owned())),
        })
    }

    fn number(&self, value: &str, element: &Element) -> Cell {
        let style = element.attribute("s").and_then(|s| s.parse::<usize>().ok());
        let is_date = style.is_some_and(|style| self.dates.get(style) == Some(&true));
        match value.trim().parse::<f64>() {
            _ if is_date => Cell::Unusable("a date".to_owned()),
            Ok(number) if number.is_finite() => Cell::Number(number),
            _ => Cell::Unusable(format!("the number {value}")),
        }
    }
}

fn text(text: String) -> Option<Cell> {
    /// Longer texts are remarks and contain no names or numbers.
    const MOST: usize = 1000;
    let text = text.trim();
    match text.len() {
        0 => None,
        length if length > MOST => Some(Cell::Unusable("a long text".to_owned())),
        _ => Some(Cell::Text(text.to_owned())),
    }
}

/// Describes an archive that is not a workbook in this format.
fn what_else(archive: &Archive) -> String {
    let names: Vec<&str> = archive.names().collect();
    let what = if names.contains(&"content.xml") {
        "it is an OpenDocument file"
    } else if names.contains(&"xl/workbook.bin") {
        "it is a binary workbook (.xlsb)"
    } else {
        "it is not a workbook"
    };
    format!("{what}; save it as .xlsx or .csv")
}

fn each_element(
    part: impl BufRead,
    mut with: impl FnMut(&Element) -> Result<(), String>,
) -> Result<(), String> {
    let mut markup = Markup::new(part);
    while let Some(event) = markup.next()? {
        if let Event::Start(element) = event {
            with(&element)?;
        }
    }
    Ok(())
}

/// Texts that cells share.
fn shared_texts(archive: &Archive) -> Result<Vec<String>, String> {
    let Some(part) = archive.member("xl/sharedStrings.xml") else {
        return Ok(Vec::new());
    };
    let mut markup = Markup::new(part?);
    let (mut texts, mut kept) = (Vec::new(), 0);
    while let Some(event) = markup.next()? {
        match event {
            Event::Start(element) if element.name == "si" => texts.push(String::new()),
            Event::Start(element) if element.name == "rPh" => drop(markup.text_of("rPh")?),
            Event::Start(element) if element.name == "t" => {
                let more = markup.text_of("t")?;
                kept += more.len() + size_of::<String>();
                if let Some(text) = texts.last_mut() {
                    *text += &more;
                }
            }
            _ => (),
        }
        if kept.max(texts.len() * size_of::<String>()) > MOST_SHARED {
            return Err("the workbook has too much text for a table of hardpoints: copy the table into a new workbook".to_owned());
        }
    }
    Ok(texts)
}

/// Flags of the cell styles. True if the number format of the style shows dates or times.
fn date_styles(archive: &Archive) -> Result<Vec<bool>, String> {
    let Some(part) = archive.member("xl/styles.xml") else {
        return Ok(Vec::new());
    };
    let (mut formats, mut styles) = (Vec::new(), Vec::new());
    let mut markup = Markup::new(part?);
    let mut in_cell_styles = false;
    while let Some(event) = markup.next()? {
        match event {
            Event::Start(element) => {
                let id = element.attribute("numFmtId").map(str::to_owned);
                match element.name.as_str() {
                    "numFmt" => {
                        let code = element.attribute("formatCode").unwrap_or("");
                        formats.push((id, shows_a_date(code)));
                    }
                    "cellXfs" => in_cell_styles = true,
                    "xf" if in_cell_styles => {
                        let number = id.as_deref().and_then(|id| id.parse::<u32>().ok());
                        // Section 18.8.30 of the standard lists the built-in number formats.
                        let built_in = matches!(number, Some(14..=22 | 45..=47));
                        let own = formats.iter().any(|(known, date)| *known == id && *date);
                        styles.push(built_in || own);
                    }
                    _ => (),
                }
            }
            Event::End(name) if name == "cellXfs" => in_cell_styles = false,
            _ => (),
        }
    }
    Ok(styles)
}

/// True if a format code has letters of dates or times outside of quotes and brackets.
fn shows_a_date(code: &str) -> bool {
    let mut quoted = false;
    let mut bracketed = false;
    let mut escaped = false;
    code.chars().any(|c| {
        if std::mem::take(&mut escaped) {
            return false;
        }
        match c {
            '"' => quoted = !quoted,
            '[' => bracketed = true,
            ']' => bracketed = false,
            '\\' | '_' | '*' => escaped = true,
            _ => return !quoted && !bracketed && "ymdhsYMDHS".contains(c),
        }
        false
    })
}

/// Row and column of a cell name such as B3. Both count from 0.
fn place_of(place: &str) -> Option<(u32, u32)> {
    let digits = place.find(|c: char| c.is_ascii_digit())?;
    let (letters, row) = place.split_at(digits);
    let mut column = 0u32;
    for letter in letters.bytes() {
        let digit = letter.is_ascii_uppercase().then(|| letter - b'A' + 1)?;
        column = column.checked_mul(26)?.checked_add(u32::from(digit))?;
    }
    Some((
        row.parse::<u32>().ok()?.checked_sub(1)?,
        column.checked_sub(1)?,
    ))
}

/// Copies the text of the first of several merged cells to all of them. A number becomes unusable in all of them, because it would
/// wrongly become a coordinate of several points.
fn merge(sheet: &mut Sheet, range: &str) -> Result<(), String> {
    let corners = range.split_once(':');
    let corners = corners.and_then(|(first, last)| Some((place_of(first)?, place_of(last)?)));
    let Some(((top, left), (bottom, right))) = corners else {
        return Ok(());
    };
    let Some(cell) = sheet.cell(top, left).cloned() else {
        return Ok(());
    };
    let shared = match cell {
        Cell::Text(text) => Cell::Text(text),
        Cell::Number(_) | Cell::Unusable(_) => {
            Cell::Unusable(format!("one number for the merged cells {range}"))
        }
    };
    // Fills only the first rows and columns of a large merged area. Such an area is decoration, not a table of points.
    for row in top..=bottom.min(top.saturating_add(1000)) {
        for column in left..=right.min(left.saturating_add(20)) {
            sheet.put(row, column, shared.clone())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read() {
        assert_eq!(place_of("A1"), Some((0, 0)));
        assert_eq!(place_of("AB12"), Some((11, 27)));
        for wrong in ["", "A", "12", "a1", "A0", "ZZZZZZZZ1", "A99999999999"] {
            assert_eq!(place_of(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn formats_of_dates_are_told_from_others() {
        for date in ["yyyy-mm-dd", "h:mm", "[$-407]d. mmm yy"] {
            assert!(shows_a_date(date), "{date}");
        }
        for number in ["0.00", "0.0\" mm\"", "#,##0", "[Red]0", "General\\m"] {
            // The format "General" contains letters, but none of them means a date.
            assert!(!shows_a_date(number), "{number}");
        }
    }
}
