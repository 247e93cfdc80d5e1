//! The files a sweep writes while it runs, begun anew or taken up again.
//!
//! They grow by whole blocks, and a block that cannot be written whole is taken back: whatever ends a
//! run, its files hold whole rows, and `--resume` goes on after the last whole block.

use super::curves_csv::CurvesCsv;
use super::rows_csv;
use super::table_file::{TableFile, open_lines};
use crate::report::{RunDirectory, WriteError};
use crate::study::Study;
use crate::sweep::{FORM, SweepPlan, SweepRecord, SweepStatistics, Worker};
use std::io::{self, BufRead};
use std::path::{Path, PathBuf};

/// Why a directory is not that of a sweep, or not of this one.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct NotThisSweep {
    /// The directory or file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub reason: String,
}

impl From<WriteError> for NotThisSweep {
    fn from(error: WriteError) -> Self {
        NotThisSweep {
            reason: format!("cannot be written: {}", error.source),
            path: error.path,
        }
    }
}

/// Turns finished blocks into text, in the workers.
pub struct SweepText {
    curves: Option<CurvesCsv>,
}

impl SweepText {
    /// The text of a sweep. Curves are written beside the designs, in a directory only.
    pub fn of(plan: &SweepPlan, study: &Study, in_directory: bool) -> Self {
        let curves = plan.record.curves && in_directory;
        SweepText {
            curves: curves.then(|| CurvesCsv::of(plan, study)),
        }
    }

    /// Works on a block: its rows and curves as text, and its statistics.
    pub fn finish(&self, record: &SweepRecord, worker: &mut Worker<'_>, block: u64) -> Finished {
        let rows = worker.rows(block);
        let (tally, first) = (SweepStatistics::of(record, rows), rows.first);
        let (mut designs, mut curves) = (Vec::new(), Vec::new());
        rows_csv::append(rows, &mut designs);
        if let Some(csv) = &self.curves {
            csv.append(first, worker.block(), &mut curves);
        }
        Finished {
            designs,
            curves,
            tally,
        }
    }
}

/// What has become of a block.
pub struct Finished {
    /// Its rows, as they stand in the file.
    designs: Vec<u8>,
    /// Its curves, as they stand in the file.
    curves: Vec<u8>,
    /// Its statistics.
    pub tally: SweepStatistics,
}

/// The files of a sweep that is running.
pub struct SweepFiles {
    designs: TableFile,
    curves: Option<TableFile>,
}

/// A sweep taken up again: its files, the tally of what is there and the number of the next block.
pub type Resumed = (SweepFiles, SweepStatistics, u64);

impl SweepFiles {
    /// Begins the files of a sweep, in a directory or, for the designs alone, on standard output.
    pub fn begin(
        record: &SweepRecord,
        text: &SweepText,
        directory: Option<&RunDirectory>,
    ) -> Result<Self, WriteError> {
        let header = rows_csv::header(record);
        let Some(directory) = directory else {
            return Ok(SweepFiles {
                designs: TableFile::standard_output(&header)?,
                curves: None,
            });
        };
        clear(directory)?;
        // Of another sweep, or of curves of the same study.
        for stem in ["designs", "curves"] {
            for format in ["csv", "parquet"] {
                directory.remove(&format!("{stem}.{format}"))?;
            }
        }
        directory.remove("sensitivities.csv")?;
        directory.remove("report.json")?;
        let json = serde_json::to_string_pretty(record).expect("records are plain data");
        directory.write("sweep.json", (json + "\n").as_bytes())?;
        let begin = |name: &str, header: &[u8]| {
            TableFile::begin(directory.path().join(record.file_name(name)), header)
        };
        let curves = text.curves.as_ref();
        let curves = curves.map(|csv| begin("curves", &csv.header));
        Ok(SweepFiles {
            designs: begin("designs", &header)?,
            curves: curves.transpose()?,
        })
    }

    /// Takes the files of a sweep up again. A directory without a sweep is begun.
    pub fn resume(
        record: &SweepRecord,
        text: &SweepText,
        directory: &RunDirectory,
    ) -> Result<Resumed, NotThisSweep> {
        let mut tally = SweepStatistics::empty(record);
        let mut next = record.blocks().start;
        let path = directory.path().join(record.file_name("designs"));
        if !directory.path().join("sweep.json").is_file() {
            let files = SweepFiles::begin(record, text, Some(directory))?;
            return Ok((files, tally, next));
        }
        let begun = read_record(directory.path())?;
        if begun != *record {
            return Err(NotThisSweep {
                path: directory.path().to_owned(),
                reason: difference(&begun, record),
            });
        }
        let failed = |path: &Path, e: io::Error| NotThisSweep {
            path: path.to_owned(),
            reason: format!("cannot be taken up again: {e}"),
        };
        // Nothing is there of a Parquet file whose writing was cut short.
        if !path.is_file() {
            let files = SweepFiles::begin(record, text, Some(directory))?;
            return Ok((files, tally, next));
        }
        let header = rows_csv::header(record);
        let mut length = header.len() as u64;
        let mut reader = open_lines(&path)
            .and_then(|lines| rows_csv::Reader::new(record, lines))
            .map_err(|e| failed(&path, e))?;
        let curves_path = directory.path().join(record.file_name("curves"));
        let curves = text.curves.as_ref().map(|csv| {
            let lines = Lines::open(&curves_path, &csv.header)?;
            Ok((lines, csv.rows_of_design() as u64))
        });
        let mut curves = curves.transpose().map_err(|e| failed(&curves_path, e))?;
        while next < record.blocks().end {
            let Some((rows, bytes)) = reader.block(next).map_err(|e| failed(&path, e))? else {
                break;
            };
            if let Some((lines, rows_of_design)) = &mut curves {
                let wanted = *rows_of_design * rows.designs() as u64;
                let there = lines.pass(wanted).map_err(|e| failed(&curves_path, e))?;
                if !there {
                    break;
                }
            }
            tally.absorb(record, &SweepStatistics::of(record, &rows));
            length += bytes;
            next += 1;
        }
        clear(directory)?;
        let curves = curves.zip(text.curves.as_ref());
        let curves = curves
            .map(|((lines, _), csv)| TableFile::reopen(curves_path, &csv.header, lines.length));
        let files = SweepFiles {
            designs: TableFile::reopen(path, &header, length)?,
            curves: curves.transpose()?,
        };
        Ok((files, tally, next))
    }

    /// Appends a block.
    pub fn append(&mut self, finished: &Finished) -> Result<(), WriteError> {
        // Curves first: a design that is in its file has its curves in theirs.
        if let Some(curves) = &mut self.curves {
            curves.append(&finished.curves)?;
        }
        self.designs.append(&finished.designs)
    }

    /// Ends the files, wherever the sweep is.
    pub fn finish(self) -> Result<(), WriteError> {
        if let Some(curves) = self.curves {
            curves.finish()?;
        }
        self.designs.finish()
    }
}

/// Removes what a sweep writes at its end: it would speak of another.
fn clear(directory: &RunDirectory) -> Result<(), WriteError> {
    let mut names = ["summary.json", "pareto.csv", "report.html"].into_iter();
    names.try_for_each(|name| directory.remove(name))
}

/// Reads the record of a sweep's directory.
pub fn read_record(directory: &Path) -> Result<SweepRecord, NotThisSweep> {
    let path = directory.join("sweep.json");
    let wrong = |reason: String| NotThisSweep {
        path: path.clone(),
        reason,
    };
    let text = std::fs::read(&path).map_err(|e| match e.kind() {
        io::ErrorKind::NotFound => NotThisSweep {
            path: directory.to_owned(),
            reason: "not the directory of a sweep: there is no sweep.json".to_owned(),
        },
        _ => wrong(e.to_string()),
    })?;
    let form: Form = serde_json::from_slice(&text)
        .map_err(|e| wrong(format!("not as `hardpoint sweep` writes it: {e}")))?;
    if form.form != FORM {
        return Err(wrong(format!(
            "written in form {} by hardpoint {}, this version reads form {FORM}; run the sweep again",
            form.form, form.version
        )));
    }
    serde_json::from_slice(&text)
        .map_err(|e| wrong(format!("not as `hardpoint sweep` writes it: {e}")))
}

/// The part of `sweep.json` that every form has.
#[derive(serde::Deserialize)]
struct Form {
    form: u32,
    version: String,
}

/// Why a sweep that was begun cannot be gone on with.
fn difference(begun: &SweepRecord, record: &SweepRecord) -> String {
    let part = |shard: Option<[u64; 2]>| match shard {
        None => "the whole sweep".to_owned(),
        Some([i, n]) => format!("shard {i}/{n}"),
    };
    if begun.version != record.version {
        format!(
            "was begun by hardpoint {}, this is {}; without --resume it is begun anew",
            begun.version, record.version
        )
    } else if begun.digest == record.digest && begun.shard != record.shard {
        format!(
            "was begun as {}, asked for is {}",
            part(begun.shard),
            part(record.shard)
        )
    } else {
        "was begun with another study; --resume goes on with the same one, without it the sweep is \
         begun anew"
            .to_owned()
    }
}

/// Counts its way through the lines of a file.
struct Lines {
    lines: Box<dyn BufRead>,
    line: Vec<u8>,
    /// Bytes of whole lines passed.
    length: u64,
}

impl Lines {
    fn open(path: &Path, header: &[u8]) -> io::Result<Self> {
        let mut lines = Lines {
            lines: open_lines(path)?,
            line: Vec::new(),
            length: 0,
        };
        lines.lines.read_until(b'\n', &mut lines.line)?;
        if lines.line != header {
            let message = "the columns are not those of the study";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        lines.length = header.len() as u64;
        Ok(lines)
    }

    /// Passes so many lines; false where there are fewer.
    fn pass(&mut self, count: u64) -> io::Result<bool> {
        let mut length = 0;
        for _ in 0..count {
            self.line.clear();
            length += self.lines.read_until(b'\n', &mut self.line)? as u64;
            if !self.line.ends_with(b"\n") {
                return Ok(false);
            }
        }
        self.length += length;
        Ok(true)
    }
}
