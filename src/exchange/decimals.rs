//! Numbers in a text table: decimal points or commas, and inch marks.

use super::cell::{Cell, Sheet};
use super::header::{Columns, text};

/// Largest number that a file may contain.
pub(super) const LARGEST: f64 = 1e12;

/// Number notation of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decimals {
    comma: bool,
    /// True if all coordinates have an inch mark.
    pub(super) inches: bool,
}

impl Decimals {
    /// Finds the number notation of a table's coordinates. Refuses a table in which 1,250 may mean 1250 or 1.25.
    pub(super) fn of(sheet: &Sheet, columns: &Columns) -> Result<Self, String> {
        let places = || columns.triples.iter().flat_map(|triple| triple.columns);
        let texts = || {
            sheet.cells.iter().filter_map(|((row, column), cell)| {
                let text = text(cell).filter(|_| places().any(|known| known == *column))?;
                let text = without_mark(text);
                let is_number = text
                    .chars()
                    .all(|c| c.is_ascii_digit() || "+-.,eE\u{2212}".contains(c));
                (is_number && text.contains(|c: char| c.is_ascii_digit()))
                    .then_some((*row, *column, text))
            })
        };
        let inches = inches(sheet, columns)?;
        let Some((row, column, first)) = texts().find(|(_, _, text)| text.contains(',')) else {
            return Ok(Decimals {
                comma: false,
                inches,
            });
        };
        let place = sheet.place(row, column);
        if let Some((row, column, other)) = texts().find(|(_, _, text)| text.contains('.')) {
            return Err(format!(
                "{place} contains {first:?}, {} contains {other:?}: commas and points are mixed, \
                 so it is not clear which is the decimal sign",
                sheet.place(row, column)
            ));
        }
        let thousand = |text: &str| {
            let (whole, rest) = text
                .trim_start_matches(['+', '-', '\u{2212}'])
                .split_once(',')?;
            let could_be =
                (1..=3).contains(&whole.len()) && !whole.starts_with('0') && rest.len() == 3;
            Some(could_be)
        };
        let all = texts()
            .filter_map(|(_, _, text)| thousand(text))
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

    pub(super) fn number(self, cell: &Cell) -> Result<f64, String> {
        match cell {
            Cell::Number(number) => Ok(*number),
            Cell::Text(text) => plain_number(text, self.comma),
            Cell::Unusable(what) => Err(format!("expected a number, found {what}")),
        }
    }
}

/// True if all coordinates have an inch mark. Refuses a table in which only some of them have it.
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

/// Removes a trailing inch mark from a number.
fn without_mark(text: &str) -> &str {
    let text = text.trim();
    let bare = text.strip_suffix(['"', '\u{2033}', '\u{201d}']);
    bare.or_else(|| text.strip_suffix("''"))
        .map_or(text, str::trim_end)
}

/// Parses a number.
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
