//! Tables side by side, each with its own column of names.

use super::super::cell::Sheet;
use super::super::header::{Columns, text};
use super::super::names::cut;

/// Refuses a table whose further sets of x, y and z have their own names, if these differ from the first names in the same rows.
/// The rows of such a set belong to other points.
pub(super) fn refuse(sheet: &Sheet, header: u32, columns: &Columns) -> Result<(), String> {
    let is_title = |column: &u32| {
        let words = sheet.cell(header, *column).and_then(text).map(cut);
        words.is_some_and(|words| {
            let mut words = words.iter();
            words.any(|word| {
                ["name", "names", "point", "points", "hardpoint"].contains(&word.as_str())
            })
        })
    };
    for pair in columns.triples.windows(2) {
        let [last, next] = [pair[0].columns.iter().max(), pair[1].columns.iter().min()];
        let (Some(last), Some(next)) = (last, next) else {
            continue;
        };
        let between = sheet.row(header).map(|(column, _)| column);
        let between = between.filter(|column| last < column && column < next);
        for column in between.filter(is_title) {
            for row in sheet.rows().into_iter().filter(|row| *row > header) {
                let words = |column: u32| sheet.cell(row, column).and_then(text).map(cut);
                let (first, own) = (words(columns.name), words(column));
                if own.is_some() && own != first {
                    return Err(format!(
                        "{}: this row has different points side by side. Put the tables below each other, or in files of their own",
                        sheet.row_place(row)
                    ));
                }
            }
        }
    }
    Ok(())
}
