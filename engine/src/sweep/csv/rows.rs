//! Writes and reads rows of designs as CSV.

use super::cells::{append_number, append_text, append_whole, next_cell};
use crate::sweep::{Candidate, Failing, Rows, SweepRecord};
use std::io::{self, BufRead, ErrorKind};

/// Header line of the rows of a sweep, including the line end.
pub fn rows_header(record: &SweepRecord) -> Vec<u8> {
    let mut line = record.columns().join(",").into_bytes();
    line.push(b'\n');
    line
}

/// Appends the rows of a block.
pub fn append_rows(rows: &Rows, to: &mut Vec<u8>) {
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

/// Appends the row of a stored design.
pub fn append_candidate(candidate: &Candidate, to: &mut Vec<u8>) {
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

/// Reads rows back, block by block.
pub struct RowsReader<'r> {
    record: &'r SweepRecord,
    lines: Box<dyn BufRead>,
    line: String,
}

impl<'r> RowsReader<'r> {
    /// Reads the header, which must match this sweep.
    pub fn new(record: &'r SweepRecord, mut lines: Box<dyn BufRead>) -> io::Result<Self> {
        let mut line = String::new();
        lines.read_line(&mut line)?;
        if line.as_bytes() != rows_header(record) {
            return Err(wrong("the columns differ from those of sweep.json"));
        }
        Ok(RowsReader {
            record,
            lines,
            line,
        })
    }

    /// Rows of a block. `None` if the file ends before these rows.
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
                let message = format!("the row of design {design} was changed or is incomplete");
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
    let at = if at.is_empty() {
        None
    } else {
        Some(at.parse().ok()?)
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
