//! Numbers in a text table: decimal points or commas, and inch marks.

use super::cell::{Cell, Sheet};
use super::header::{Columns, text};

/// Largest absolute value of a number in a file.
pub(super) const LARGEST: f64 = 1e12;

/// Number notation of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decimals {
    /// True if the decimal sign is a comma.
    comma: bool,
    /// True if all coordinates have an inch mark.
    pub(super) inches: bool,
}

impl Decimals {
    /// Finds the number notation of a table from its coordinates. If all coordinates are whole numbers, other cells of the sheet
    /// decide.
    ///
    /// # Errors
    /// 1,250 may mean 1250 or 1.25, commas and points are mixed, or only some coordinates have inch marks.
    pub(super) fn of(sheet: &Sheet, columns: &Columns) -> Result<Self, String> {
        let places = || columns.triples.iter().flat_map(|triple| triple.columns);
        let texts = || {
            sheet.cells.iter().filter_map(|((row, column), cell)| {
                let text = digits(cell).filter(|_| places().any(|known| known == *column))?;
                Some((*row, *column, text))
            })
        };
        let inches = inches(sheet, columns)?;
        let Some((row, column, first)) = texts().find(|(_, _, text)| text.contains(',')) else {
            let has_point = texts().any(|(_, _, text)| text.contains('.'));
            let comma = !has_point && has_decimal_comma(sheet);
            return Ok(Decimals { comma, inches });
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
        let numbers = sheet.cells.iter().any(|((_, column), cell)| {
            matches!(cell, Cell::Number(_)) && places().any(|known| known == *column)
        });
        if all && (some_without || numbers) {
            return Err(format!(
                "{place} contains {first:?}, in which the comma may be a decimal sign or separate \
                 thousands; write it with a point, or without the comma"
            ));
        }
        Ok(Decimals {
            comma: true,
            inches,
        })
    }

    /// Number of a cell.
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
}

/// Text of a cell that consists only of digits, signs and the letter of an exponent, without an inch mark.
fn digits(cell: &Cell) -> Option<&str> {
    let text = without_mark(text(cell)?);
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

/// True if a number of the sheet has a decimal comma, and none has a point.
fn has_decimal_comma(sheet: &Sheet) -> bool {
    let mut texts = sheet.cells.values().filter_map(digits);
    let has_point = texts.clone().any(|text| text.contains('.'));
    !has_point && texts.any(|text| could_be_thousands(text) == Some(false))
}

/// True if all coordinates have an inch mark. Zeros and single values of the wheel need no mark.
///
/// # Errors
/// Only some coordinates have an inch mark.
fn inches(sheet: &Sheet, columns: &Columns) -> Result<bool, String> {
    let is_coordinate = |column: &u32| {
        let mut triples = columns.triples.iter();
        triples.any(|triple| triple.columns.contains(column))
    };
    let (mut marked, mut plain) = (None, None);
    for ((row, column), cell) in &sheet.cells {
        let is_number = match cell {
            Cell::Number(_) => true,
            Cell::Text(text) => plain_number(text, true).is_ok(),
            Cell::Unusable(_) => false,
        };
        // Zero needs no inch mark, because it is the same in every unit.
        let is_zero = matches!(cell, Cell::Number(0.0)) || text(cell) == Some("0");
        if !is_coordinate(column) || !is_number || is_zero {
            continue;
        }
        let has_mark = text(cell).is_some_and(|text| without_mark(text) != text.trim());
        let seen = if has_mark { &mut marked } else { &mut plain };
        *seen = seen.or(Some((*row, *column)));
    }
    // A single number in the first column, such as an angle, has no inch mark.
    let is_figure = |row: u32| {
        let triple = &columns.triples[0];
        sheet.cell(row, triple.columns[1]).is_none()
    };
    match (marked, plain) {
        (Some((row, column)), Some((other, other_column))) if !is_figure(other) => Err(format!(
            "{} is marked as inches and {} is not: mark all coordinates or none",
            sheet.place(row, column),
            sheet.place(other, other_column)
        )),
        (marked, _) => Ok(marked.is_some()),
    }
}

/// Removes blanks and a trailing inch mark from a number.
fn without_mark(text: &str) -> &str {
    let text = text.trim();
    let bare = text.strip_suffix(['"', '\u{2033}', '\u{201d}']);
    bare.or_else(|| text.strip_suffix("''"))
        .map_or(text, str::trim_end)
}

/// Parses a number with a decimal point, or if `comma` is true with a decimal comma or point. An inch mark is ignored.
///
/// # Errors
/// The text is not a number, or its absolute value is above [`LARGEST`].
pub(super) fn plain_number(text: &str, comma: bool) -> Result<f64, String> {
    let plain = without_mark(text).replace('\u{2212}', "-");
    let plain = if comma {
        plain.replacen(',', ".", 1)
    } else {
        plain
    };
    // The standard library would also parse "nan" and "inf", so a digit is required.
    let is_number = plain.contains(|c: char| c.is_ascii_digit());
    let number = plain
        .parse::<f64>()
        .ok()
        .filter(|n| is_number && n.abs() <= LARGEST);
    number.ok_or_else(|| format!("expected a number, found {text:?}"))
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
            let found = Decimals::of(&sheet, &header.unwrap().columns).unwrap();
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
        assert_eq!(plain_number("2.5\"", false), Ok(2.5));
    }
}
