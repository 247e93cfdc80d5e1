//! Target curves in CSV files.

use super::error::{Problems, Source, StudyError, StudyErrors};
use super::source::{LONGEST_TEXT, read_text};
use super::value::{Number, Text};
use std::path::Path;
use std::sync::Arc;

/// Reads a curve from a file with these two columns; its path is relative to the study's directory.
pub fn read(
    path: &Text,
    directory: &Path,
    columns: [&str; 2],
    problems: &mut Problems,
) -> Option<Vec<[f64; 2]>> {
    let full = directory.join(path.get_ref());
    let text = match read_text(&full, LONGEST_TEXT) {
        Ok(text) => text,
        Err(reason) => {
            let error = problems.add(
                path.span(),
                format!("cannot read {}: {reason}", full.display()),
            );
            error.help("the path is relative to the study file");
            return None;
        }
    };
    let source = Arc::new(Source {
        name: full.display().to_string(),
        text,
    });
    match curve(&source, columns) {
        Ok(curve) => Some(curve),
        Err(errors) => {
            problems.append(errors);
            None
        }
    }
}

fn curve(source: &Arc<Source>, columns: [&str; 2]) -> Result<Vec<[f64; 2]>, StudyErrors> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(source.text.as_bytes());
    let expected = format!("expected the columns {},{}", columns[0], columns[1]);
    let mut header_seen = false;
    let mut curve: Vec<[f64; 2]> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| StudyError::of_file(&source.name, e.to_string()))?;
        let start = record.position().map_or(0, |p| p.byte() as usize);
        let error = |message: String| Err(at_record(source, start, message));
        if !header_seen {
            header_seen = true;
            if record.iter().ne(columns) {
                let found = record.iter().collect::<Vec<_>>().join(",");
                return error(format!("{expected}, found {found}"));
            }
            continue;
        }
        if record.len() != 2 {
            return error(format!("expected two values, found {}", record.len()));
        }
        let mut row = [0.0; 2];
        for ((place, text), column) in row.iter_mut().zip(&record).zip(columns) {
            *place = match Number::parsed(text) {
                Ok(number) => number,
                Err(wanted) => {
                    return error(format!("expected {wanted} as {column}, found {text:?}"));
                }
            };
        }
        if let Some([before, _]) = curve.last().filter(|[before, _]| *before >= row[0]) {
            return error(format!(
                "{} does not rise above {before}, the one before",
                row[0]
            ));
        }
        curve.push(row);
    }
    if curve.len() < 2 {
        let message = match header_seen {
            false => format!("the file is empty; {expected}"),
            true => format!("a curve has at least two points, found {}", curve.len()),
        };
        return Err(StudyError::of_file(&source.name, message).into());
    }
    Ok(curve)
}

/// A mistake in the record that starts at this byte, or after the blank lines there.
fn at_record(source: &Arc<Source>, start: usize, message: String) -> StudyErrors {
    let rest = source.text.get(start..).unwrap_or("");
    let blank = rest.len() - rest.trim_start().len();
    let span = start + blank..source.text.len();
    StudyError::new(source.clone(), Some(span), message).into()
}
