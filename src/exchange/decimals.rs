//! Numbers in a text table: decimal points or commas, and units after numbers.

use super::cell::{Cell, Sheet};
use super::header::{Columns, text};
use super::unit::FileUnit;
use crate::model::LengthUnit;
use crate::report::unit_in_words;

/// Largest absolute value of a number in a file.
pub(super) const LARGEST: f64 = 1e12;

/// Number notation of a table: the decimal sign, and the unit of length after coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Decimals {
    /// True if the decimal sign is a comma.
    comma: bool,
    /// Unit of length that all coordinates have after their numbers, in the same cells. `None` without such units.
    pub(super) unit: Option<FileUnit>,
}

impl Decimals {
    /// Finds the number notation of a table from its coordinates. If all coordinates are whole numbers, other cells of the sheet
    /// decide. `headers` are the rows and the columns of all headers, from top to bottom; there is at least one.
    ///
    /// # Errors
    /// 1,250 may mean 1250 or 1.25, commas and points are mixed, or only some coordinates have a unit.
    pub(super) fn of(sheet: &Sheet, headers: &[(u32, Columns)]) -> Result<Self, String> {
        let texts = || {
            sheet.cells.iter().filter_map(|((row, column), cell)| {
                let text = digits(cell).filter(|_| is_coordinate(headers, *row, *column))?;
                Some((*row, *column, text))
            })
        };
        let unit = unit_of_cells(sheet, headers)?;
        let Some((row, column, first)) = texts().find(|(_, _, text)| text.contains(',')) else {
            let has_point = texts().any(|(_, _, text)| text.contains('.'));
            let comma = !has_point && has_decimal_comma(sheet);
            return Ok(Decimals { comma, unit });
        };
        let place = sheet.place(row, column);
        if let Some((row, column, other)) = texts().find(|(_, _, text)| text.contains('.')) {
            return Err(format!(
                "{place} contains {first:?}, {} contains {other:?}: commas and points are mixed, \
                 so it is not clear which is the decimal sign",
                sheet.place(row, column)
            ));
        }
        let all = texts()
            .filter_map(|(_, _, text)| could_be_thousands(text))
            .all(|could| could);
        let some_without = texts().any(|(_, _, text)| !text.contains(',') && text != "0");
        let numbers = sheet.cells.iter().any(|((row, column), cell)| {
            matches!(cell, Cell::Number(_)) && is_coordinate(headers, *row, *column)
        });
        if all && (some_without || numbers) {
            return Err(format!(
                "{place} contains {first:?}, in which the comma may be a decimal sign or separate \
                 thousands; write it with a point, or without the comma"
            ));
        }
        Ok(Decimals { comma: true, unit })
    }

    /// Number of a cell, without the unit after it.
    ///
    /// # Errors
    /// The cell contains no number in this notation.
    pub(super) fn number(self, cell: &Cell) -> Result<f64, String> {
        match cell {
            Cell::Number(number) => Ok(*number),
            Cell::Text(text) => plain_number(text, self.comma),
            Cell::Unusable(what) => Err(format!("expected a number, found {what}")),
        }
    }

    /// True if a cell is a number in this notation, with or without a unit.
    pub(super) fn is_number(self, cell: &Cell) -> bool {
        self.number(cell).is_ok()
    }
}

/// True if a cell is a number with a decimal point or a decimal comma, with or without a unit.
pub(super) fn is_number(cell: &Cell) -> bool {
    match cell {
        Cell::Number(_) => true,
        Cell::Text(text) => plain_number(text, true).is_ok(),
        Cell::Unusable(_) => false,
    }
}

/// Columns of the header that applies to a row: the last header above it. The first header also applies to the rows above it.
fn columns_at(headers: &[(u32, Columns)], row: u32) -> &Columns {
    let above = headers.partition_point(|(header, _)| *header < row);
    &headers[above.saturating_sub(1)].1
}

/// True if the cell at this row and column is in a column of coordinates.
fn is_coordinate(headers: &[(u32, Columns)], row: u32, column: u32) -> bool {
    let mut triples = columns_at(headers, row).triples.iter();
    triples.any(|triple| triple.columns.contains(&column))
}

/// Text of a cell that consists only of digits, signs and the letter of an exponent, without a unit.
fn digits(cell: &Cell) -> Option<&str> {
    let (text, _) = split_unit(text(cell)?);
    let is_number = text
        .chars()
        .all(|c| c.is_ascii_digit() || "+-.,eE\u{2212}".contains(c));
    (is_number && text.contains(|c: char| c.is_ascii_digit())).then_some(text)
}

/// True if the comma of a number may separate thousands, as in 1,250. `None` for a number without a comma.
fn could_be_thousands(text: &str) -> Option<bool> {
    let (whole, rest) = text
        .trim_start_matches(['+', '-', '\u{2212}'])
        .split_once(',')?;
    Some((1..=3).contains(&whole.len()) && !whole.starts_with('0') && rest.len() == 3)
}

/// True if a number in the cells of the sheet has a decimal comma, and no number has a decimal point.
fn has_decimal_comma(sheet: &Sheet) -> bool {
    let mut texts = sheet.cells.values().filter_map(digits);
    let has_point = texts.clone().any(|text| text.contains('.'));
    !has_point && texts.any(|text| could_be_thousands(text) == Some(false))
}

/// Unit that all coordinates have in their own cells, as in `4.7"` or `205 mm`. `None` if no coordinate has one. Zeros and single
/// values of the wheel need no unit.
///
/// # Errors
/// Only some coordinates have a unit, or their units differ.
fn unit_of_cells(sheet: &Sheet, headers: &[(u32, Columns)]) -> Result<Option<FileUnit>, String> {
    // A row with one number, such as an angle, is a value of the wheel.
    let is_point = |row: u32| {
        let mut triples = columns_at(headers, row).triples.iter();
        triples.any(|triple| {
            let cells = triple.columns.into_iter();
            let cells = cells.filter_map(|column| sheet.cell(row, column));
            cells.filter(|cell| is_number(cell)).count() > 1
        })
    };
    let is_zero = |cell: &Cell| matches!(cell, Cell::Number(0.0)) || text(cell) == Some("0");
    let mut first: Option<(u32, u32, Option<FileUnit>)> = None;
    for ((row, column), cell) in &sheet.cells {
        let is_read = is_coordinate(headers, *row, *column) && is_number(cell) && is_point(*row);
        if !is_read || is_zero(cell) {
            continue;
        }
        let unit = unit_in(cell);
        let (other_row, other_column, other) = *first.get_or_insert((*row, *column, unit));
        if unit != other {
            let state = |unit: Option<FileUnit>| match unit {
                Some(unit) => format!("is marked as {}", unit_in_words(unit.symbol)),
                None => "has no unit".to_owned(),
            };
            return Err(format!(
                "{} {}, {} {}: give all coordinates the same unit, or remove the units from the cells",
                sheet.place(other_row, other_column),
                state(other),
                sheet.place(*row, *column),
                state(unit)
            ));
        }
    }
    Ok(first.and_then(|(.., unit)| unit))
}

/// Unit of length after the number of a cell.
pub(super) fn unit_in(cell: &Cell) -> Option<FileUnit> {
    split_unit(text(cell)?).1
}

/// Splits a text into a number and the unit of length after it: `205 mm`, `4.7"`. A text without such a unit stays whole.
fn split_unit(text: &str) -> (&str, Option<FileUnit>) {
    let text = text.trim();
    let marked = text.strip_suffix(['"', '\u{2033}', '\u{201d}']);
    if let Some(number) = marked.or_else(|| text.strip_suffix("''")) {
        return (number.trim_end(), Some(FileUnit::of(LengthUnit::Inch)));
    }
    let number = text.trim_end_matches(char::is_alphabetic);
    match FileUnit::named(&text[number.len()..]) {
        Some(unit) if bare_number(number, true).is_some() => (number.trim_end(), Some(unit)),
        _ => (text, None),
    }
}

/// Parses a number with a decimal point, or if `comma` is true with a decimal comma or point. A unit of length after it is ignored.
///
/// # Errors
/// The text is not a number, or its absolute value is above [`LARGEST`].
pub(super) fn plain_number(text: &str, comma: bool) -> Result<f64, String> {
    let number = bare_number(split_unit(text).0, comma);
    number.ok_or_else(|| format!("expected a number, found {text:?}"))
}

/// Length of a command line, with or without a unit: `0.5` or `0.5mm`. Lengths in cm and ft are converted to mm and inches. `None`
/// if the text is not a length.
pub fn length_with_unit(text: &str) -> Option<(f64, Option<LengthUnit>)> {
    let (number, unit) = split_unit(text);
    let length = bare_number(number, false)?;
    Some(match unit {
        Some(unit) => (unit.to_study(length), Some(unit.unit)),
        None => (length, None),
    })
}

/// Parses a number without a unit. `None` if the text is not a number, or if its absolute value is above [`LARGEST`].
fn bare_number(text: &str, comma: bool) -> Option<f64> {
    let plain = text.trim().replace('\u{2212}', "-");
    let plain = if comma {
        plain.replacen(',', ".", 1)
    } else {
        plain
    };
    // The standard library would also parse "nan" and "inf", so a digit is required.
    let has_digit = plain.contains(|c: char| c.is_ascii_digit());
    let number = plain.parse::<f64>().ok();
    number.filter(|number| has_digit && number.abs() <= LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If all coordinates are whole numbers, another value of the file shows the decimal comma.
    #[test]
    fn whole_coordinates_leave_the_notation_to_other_values() {
        for (values, comma) in [
            ("camber;-0,5", true),
            ("camber;-0,5\nradius;1,250", true),
            ("radius;1,250", false),
            ("camber;-0,5\ntoe;0.1", false),
            ("camber;-1", false),
        ] {
            let text = format!("{values}\nname;side;x;y;z\na;left;1;2;3\nb;left;4;5;6\n");
            let sheet = crate::exchange::delimited::read(&text).unwrap();
            let row = sheet.rows()[sheet.rows().len() - 3];
            let header = crate::exchange::header::header(&sheet, row, None).unwrap();
            let headers = [(row, header.unwrap().columns)];
            let found = Decimals::of(&sheet, &headers).unwrap();
            assert_eq!(found.comma, comma, "{values}");
        }
    }

    #[test]
    fn numbers_end_at_a_million_million() {
        assert_eq!(plain_number("1e12", false), Ok(1e12));
        assert_eq!(plain_number("-1e12", false), Ok(-1e12));
        for text in ["1.0001e12", "-1.0001e12", "inf", "NaN", "1,5"] {
            assert!(plain_number(text, false).is_err(), "{text}");
        }
        assert_eq!(plain_number("\u{2212}1,5", true), Ok(-1.5));
        let decimals = Decimals {
            comma: false,
            unit: None,
        };
        for text in ["2.5\"", "2.5 in", "2.5mm", " 2.5 cm ", "2.5 ''", "25e-1 ft"] {
            let cell = Cell::Text(text.to_owned());
            assert_eq!(decimals.number(&cell), Ok(2.5), "{text}");
            assert!(unit_in(&cell).is_some(), "{text}");
        }
        for text in ["2.5 s", "mm", "2.5 mm 3", "R 2.5 mm"] {
            let cell = Cell::Text(text.to_owned());
            assert!(decimals.number(&cell).is_err(), "{text}");
            assert_eq!(unit_in(&cell), None, "{text}");
        }
    }
}
