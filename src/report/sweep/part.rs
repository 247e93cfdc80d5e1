//! A part of a sweep: its rows, its curves and its statistics, which appear together when it is whole.
//!
//! Whoever does a part holds a lock on it; its files are written under other names and renamed, the rows last. So
//! a part whose rows are there is whole, whatever has happened to those who worked on it, and several processes on
//! several machines may do the parts of one directory.

use super::directory::SweepDirectory;
use super::table_file::TableFile;
use super::text::SweepText;
use crate::results::{Lock, NotLocked, Owner, TEMPORARY, WriteError, temporary_of, unwritten};
use crate::sweep::csv::rows_header;
use crate::sweep::{SweepRecord, SweepStatistics, Swept, in_order};
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::Path;
use tempfile::NamedTempFile;

/// The form of the statistics' file. A reader takes no other.
pub(super) const FORM: u32 = 2;

/// The file with the statistics of a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartRecord {
    /// `FORM`.
    pub form: u32,
    /// Digest of the sweep.
    pub digest: String,
    /// Number of the part, from 0.
    pub part: u64,
    /// Length of the file with its rows, in bytes.
    pub rows_length: u64,
    /// Length of the file with its curves, where there is one.
    pub curves_length: Option<u64>,
    /// Statistics of its rows.
    pub statistics: SweepStatistics,
}

/// The outcome of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartOutcome {
    /// The part is complete, done by this process or another.
    Whole,
    /// The sweep was interrupted; nothing of the part is kept.
    Interrupted,
    /// Another process is working on it.
    Busy,
}

/// Does a part, unless it is whole already or another process is at it, on the threads of the current rayon
/// pool. `go_on` is asked before every block, `watch` hears of every block's designs.
pub fn write_part(
    swept: Swept<'_>,
    text: &SweepText,
    directory: &SweepDirectory,
    part: u64,
    go_on: impl Fn() -> bool + Sync,
    mut watch: impl FnMut(u64) + Send,
) -> Result<PartOutcome, WriteError> {
    let record = swept.record();
    let is_whole = || directory.has_rows(part);
    if is_whole() {
        return Ok(PartOutcome::Whole);
    }
    let stem = format!("part-{part:09}");
    let path = directory.path().join(format!("{TEMPORARY}{stem}.lock"));
    let owner = Owner::here(&format!("hardpoint sweep {}, part {part}", record.study));
    let _lock = match Lock::at_once(&path, &owner) {
        Ok(lock) => lock,
        Err(NotLocked::Held(_)) => return Ok(PartOutcome::Busy),
        Err(NotLocked::Failed(error)) => return Err(unwritten(&path)(error)),
    };
    if is_whole() {
        return Ok(PartOutcome::Whole);
    }
    clear_leftovers(directory.path(), &stem);
    let begin = |name: String, header: &[u8]| Pending::begin(directory.path(), &stem, name, header);
    let mut rows = begin(record.rows_name(part), &rows_header(record))?;
    let curves = text.curves_header();
    let curves = curves.map(|header| begin(record.curves_name(part), header));
    let mut curves = curves.transpose()?;
    let mut statistics = SweepStatistics::empty(record);
    let blocks = record.blocks_of(part);
    let mut left = blocks.end - blocks.start;
    in_order(
        blocks,
        || swept.worker(),
        |worker, block| go_on().then(|| text.finish(record, worker, block)),
        |finished| {
            rows.table.append(&finished.designs)?;
            if let Some(curves) = &mut curves {
                curves.table.append(&finished.curves)?;
            }
            statistics.absorb(record, &finished.statistics);
            left -= 1;
            watch(finished.statistics.designs);
            text.give_back(finished.designs);
            Ok(())
        },
    )?;
    if left > 0 {
        return Ok(PartOutcome::Interrupted);
    }
    put(directory.path(), record, part, rows, curves, statistics)?;
    Ok(PartOutcome::Whole)
}

/// Ends the files of a part and puts them in their places, the rows last.
pub(super) fn put(
    directory: &Path,
    record: &SweepRecord,
    part: u64,
    rows: Pending,
    curves: Option<Pending>,
    statistics: SweepStatistics,
) -> Result<(), WriteError> {
    let rows = rows.finish()?;
    let curves = curves.map(Pending::finish).transpose()?;
    let part_record = PartRecord {
        form: FORM,
        digest: record.digest.clone(),
        part,
        rows_length: rows.length,
        curves_length: curves.as_ref().map(|c| c.length),
        statistics,
    };
    let name = record.statistics_name(part);
    let path = directory.join(&name);
    let text = serde_json::to_string(&part_record).expect("statistics are plain data") + "\n";
    let written = || -> std::io::Result<NamedTempFile> {
        let mut file = temporary_of(directory, &format!("part-{part:09}"))?;
        file.write_all(text.as_bytes())?;
        file.flush()?;
        Ok(file)
    };
    let statistics = Whole {
        length: text.len() as u64,
        temporary: written().map_err(unwritten(&path))?,
        name,
    };
    if let Some(curves) = curves {
        curves.persist(directory)?;
    }
    statistics.persist(directory)?;
    rows.persist(directory)
}

/// A table that is being written beside its place.
pub(super) struct Pending {
    name: String,
    temporary: NamedTempFile,
    pub table: TableFile,
}

/// A file that is whole, beside its place.
struct Whole {
    name: String,
    temporary: NamedTempFile,
    length: u64,
}

impl Pending {
    pub(super) fn begin(
        directory: &Path,
        stem: &str,
        name: String,
        header: &[u8],
    ) -> Result<Self, WriteError> {
        let path = directory.join(&name);
        let temporary = temporary_of(directory, stem).map_err(unwritten(&path))?;
        let file = temporary.as_file().try_clone().map_err(unwritten(&path))?;
        Ok(Pending {
            table: TableFile::begin(file, path, header)?,
            temporary,
            name,
        })
    }

    fn finish(self) -> Result<Whole, WriteError> {
        self.table.finish()?;
        let metadata = self.temporary.as_file().metadata();
        Ok(Whole {
            length: metadata.map_err(unwritten(self.temporary.path()))?.len(),
            temporary: self.temporary,
            name: self.name,
        })
    }
}

impl Whole {
    fn persist(self, directory: &Path) -> Result<(), WriteError> {
        let path = directory.join(&self.name);
        let persisted = self.temporary.persist(&path);
        persisted.map_err(|e| unwritten(&path)(e.error))?;
        Ok(())
    }
}

/// Removes remains of processes that died while they computed a part.
fn clear_leftovers(directory: &Path, stem: &str) {
    let prefix = format!("{TEMPORARY}{stem}-");
    let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
    for entry in entries {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}
