//! Rows of designs as CSV, both ways. Written in the workers, so that it is done on all threads.

use crate::sweep::{Candidate, Failing, Rows, SweepRecord};
use std::borrow::Cow;
use std::io::{self, BufRead, ErrorKind, Write};

/// The first line.
pub(super) fn header(record: &SweepRecord) -> Vec<u8> {
    let mut line = record.columns().join(",").into_bytes();
    line.push(b'\n');
    line
}

/// Adds the rows of a block.
pub(super) fn append(rows: &Rows, to: &mut Vec<u8>) {
    for place in 0..rows.designs() {
        append_row(
            rows.first + place as u64,
            rows.variables(place),
            rows.outputs(place),
            rows.failing[place].as_ref(),
            to,
        );
    }
}

/// Adds the row of a design that was kept.
pub(super) fn append_candidate(candidate: &Candidate, to: &mut Vec<u8>) {
    let Candidate {
        design,
        variables,
        outputs,
        failing,
    } = candidate;
    append_row(*design, variables, outputs, failing.as_ref(), to);
}

fn append_row(
    design: u64,
    variables: &[f64],
    outputs: &[f64],
    failing: Option<&Failing>,
    to: &mut Vec<u8>,
) {
    append_whole(design, to);
    for value in variables.iter().chain(outputs) {
        to.push(b',');
        append_number(*value, to);
    }
    match failing {
        None => to.extend_from_slice(b",0,,,ok\n"),
        Some(failing) => {
            to.push(b',');
            append_whole(failing.stations, to);
            to.push(b',');
            append_number(failing.at.unwrap_or(f64::NAN), to);
            to.push(b',');
            append_text(&failing.reason, to);
            to.push(b',');
            append_text(&failing.status, to);
            to.push(b'\n');
        }
    }
}

/// Adds a number; nothing for NaN, which stands for no value.
pub(super) fn append_number(value: f64, to: &mut Vec<u8>) {
    if !value.is_nan() {
        to.extend_from_slice(zmij::Buffer::new().format(value).as_bytes());
    }
}

/// Adds a whole number.
pub(super) fn append_whole(value: u64, to: &mut Vec<u8>) {
    write!(to, "{value}").expect("memory takes everything");
}

/// Adds a text, in quotes where it needs them.
pub(super) fn append_text(text: &str, to: &mut Vec<u8>) {
    if text.contains([',', '"', '\n']) {
        to.push(b'"');
        to.extend_from_slice(text.replace('"', "\"\"").as_bytes());
        to.push(b'"');
    } else {
        to.extend_from_slice(text.as_bytes());
    }
}

/// Reads rows back, block by block.
pub struct Reader<'r, R> {
    record: &'r SweepRecord,
    lines: R,
    line: String,
}

impl<'r, R: BufRead> Reader<'r, R> {
    /// Reads the header, which must be the one of this sweep.
    pub fn new(record: &'r SweepRecord, mut lines: R) -> io::Result<Self> {
        let mut line = String::new();
        lines.read_line(&mut line)?;
        if line.as_bytes() != header(record) {
            return Err(wrong("the columns are not those of sweep.json"));
        }
        Ok(Reader {
            record,
            lines,
            line,
        })
    }

    /// The rows of a block; `None` where the file ends before they do.
    pub fn block(&mut self, block: u64) -> io::Result<Option<Rows>> {
        let range = self.record.designs_of(block);
        let mut rows = Rows {
            first: range.start,
            ..Rows::default()
        };
        for design in range {
            self.line.clear();
            self.lines.read_line(&mut self.line)?;
            let Some(line) = self.line.strip_suffix('\n') else {
                return Ok(None);
            };
            if read_row(self.record, design, line, &mut rows).is_none() {
                let message = format!("the row of design {design} is not as it was written");
                return Err(wrong(&message));
            }
        }
        Ok(Some(rows))
    }
}

fn wrong(message: &str) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, message)
}

fn read_row(record: &SweepRecord, design: u64, line: &str, rows: &mut Rows) -> Option<()> {
    let mut rest = line;
    if next_cell(&mut rest)?.parse::<u64>().ok()? != design {
        return None;
    }
    let mut number = || match &*next_cell(&mut rest)? {
        "" => Some(f64::NAN),
        cell => cell.parse().ok(),
    };
    for _ in &record.variables {
        rows.variables.push(number()?);
    }
    for _ in &record.outputs {
        rows.outputs.push(number()?);
    }
    let stations = next_cell(&mut rest)?.parse().ok()?;
    let at = next_cell(&mut rest)?;
    let at = match at.is_empty() {
        true => None,
        false => Some(at.parse().ok()?),
    };
    let (reason, status) = (next_cell(&mut rest)?, next_cell(&mut rest)?);
    let failing = || Failing {
        status: status.clone().into_owned(),
        reason: reason.into_owned(),
        stations,
        at,
    };
    rows.failing.push((status != "ok").then(failing));
    rest.is_empty().then_some(())
}

/// Takes a cell off the front of a line, with the comma after it.
fn next_cell<'l>(rest: &mut &'l str) -> Option<Cow<'l, str>> {
    let Some(mut inside) = rest.strip_prefix('"') else {
        let (cell, after) = rest.split_once(',').unwrap_or((rest, ""));
        *rest = after;
        return Some(Cow::Borrowed(cell));
    };
    let mut cell = String::new();
    loop {
        let (part, after) = inside.split_once('"')?;
        cell += part;
        match after.strip_prefix('"') {
            Some(more) => {
                cell.push('"');
                inside = more;
            }
            None => {
                *rest = after.strip_prefix(',').unwrap_or(after);
                return Some(Cow::Owned(cell));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_come_back_as_they_were_written() {
        let texts = ["plain", "a, b", "\"quoted\"", "", "say \"no, no\"", "end"];
        let mut line = Vec::new();
        for (k, text) in texts.iter().enumerate() {
            if k > 0 {
                line.push(b',');
            }
            append_text(text, &mut line);
        }
        let line = String::from_utf8(line).unwrap();
        let mut rest = line.as_str();
        for text in texts {
            assert_eq!(next_cell(&mut rest).unwrap(), text);
        }
        assert_eq!(rest, "");
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        for value in [
            0.1 + 0.2,
            1e-7,
            5e-324,
            1.7976931348623157e308,
            -12345678.9,
            0.0,
            1e16,
        ] {
            let mut text = Vec::new();
            append_number(value, &mut text);
            let read: f64 = String::from_utf8(text).unwrap().parse().unwrap();
            assert_eq!(read.to_bits(), value.to_bits());
        }
        let mut none = Vec::new();
        append_number(f64::NAN, &mut none);
        assert!(none.is_empty());
    }
}
