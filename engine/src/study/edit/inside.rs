//! Inserts the content of other files into the text of a study.

use super::super::compliance::BushingText;
use super::super::sheet_file::SheetTarget;
use super::super::targets::FromFile;
use super::{table, target};
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, TableLike, Value};

/// Returns the text with the points of target curves and the targets of sheets written into the text, so that its targets need
/// no files. `files` holds the contents that were read, with the index of the target for each file.
pub(in crate::study) fn with_curves_inside(text: &str, files: &[(usize, FromFile)]) -> String {
    let Ok(mut document) = text.parse::<DocumentMut>() else {
        return text.to_owned();
    };
    // The loop runs backwards, because inserting the targets of a sheet shifts the indices of later targets.
    for (place, file) in files.iter().rev() {
        match file {
            FromFile::Curve(curve) => {
                let points: Array = curve
                    .iter()
                    .map(|point| Value::from(Array::from_iter(*point)))
                    .collect();
                if let Some(target) = target(document.as_table_mut(), *place) {
                    target.remove("file");
                    target.remove("column");
                    target.insert("points", Item::Value(points.into()));
                }
            }
            FromFile::Sheet(targets) => {
                put_sheet_inside(document.as_table_mut(), *place, targets);
            }
        }
    }
    document.to_string()
}

/// Replaces the target that names a sheet by the targets of the sheet.
fn put_sheet_inside(root: &mut dyn TableLike, place: usize, targets: &[SheetTarget]) {
    let Some(list) = table(root, &["optimise"]).and_then(|own| own.get_mut("targets")) else {
        return;
    };
    let pairs = |target: &SheetTarget| -> Vec<(&'static str, Value)> {
        let words = target
            .words
            .iter()
            .map(|(key, word)| (*key, word.as_str().into()));
        let numbers = target
            .numbers
            .iter()
            .map(|(key, number)| (*key, (*number).into()));
        words.chain(numbers).collect()
    };
    match list {
        Item::Value(Value::Array(array)) => {
            array.remove(place);
            for (k, target) in targets.iter().enumerate() {
                let row = InlineTable::from_iter(pairs(target));
                array.insert(place + k, row);
            }
        }
        Item::ArrayOfTables(tables) => {
            let mut all: Vec<Table> = tables.iter().cloned().collect();
            if place >= all.len() {
                return;
            }
            let rows = targets.iter().map(|target| {
                let mut row = Table::new();
                for (key, value) in pairs(target) {
                    row.insert(key, Item::Value(value));
                }
                row
            });
            all.splice(place..=place, rows);
            *tables = all.into_iter().collect();
        }
        _ => {}
    }
}

/// Returns the text with the force laws of bushings in place of the names of their files.
pub(in crate::study) fn with_bushings_inside(text: String, bushings: &[BushingText]) -> String {
    if bushings.is_empty() {
        return text;
    }
    let Ok(mut document) = text.parse::<DocumentMut>() else {
        return text;
    };
    for bushing in bushings {
        let Some(table) = table(document.as_table_mut(), &["bushings", &bushing.name]) else {
            continue;
        };
        table.remove("file");
        if bushing.curves.len() < 6 {
            let none = Array::from_iter([0.0; 6]);
            table.insert("stiffness", Item::Value(none.into()));
        }
        for (key, points) in &bushing.curves {
            let points = points
                .iter()
                .map(|point| Value::from(Array::from_iter(*point)));
            table.insert(key, Item::Value(points.collect::<Array>().into()));
        }
    }
    document.to_string()
}
