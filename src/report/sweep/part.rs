//! A part of a sweep: its rows, its curves and its statistics. They appear together when the part is complete.
//!
//! A process holds a lock on the part that it computes. It writes the files under other names and then renames them, the rows
//! last. So if the rows exist, the part is complete, even after a crash. Several processes on several machines may compute parts
//! in one directory.

use super::directory::SweepDirectory;
use super::table_file::TableFile;
use super::text::SweepText;
use crate::results::{Lock, NotLocked, Owner, TEMPORARY, WriteError, temporary_of, unwritten};
use crate::sweep::csv::rows_header;
use crate::sweep::{SweepRecord, SweepStatistics, Swept, in_order};
use crate::threads::stoppable;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tempfile::NamedTempFile;

/// Version of the format of the statistics file. The program reads no files of other versions.
pub(super) const FORM: u32 = 2;

/// Content of the statistics file of a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartRecord {
    /// Equal to `FORM`.
    pub form: u32,
    /// Digest of the sweep to which the part belongs.
    pub digest: String,
    /// Number of the part, from 0.
    pub part: u64,
    /// Length of the file with the part's rows, in bytes.
    pub rows_length: u64,
    /// Length of the file with the part's curves, in bytes, if there is one.
    pub curves_length: Option<u64>,
    /// Checksum of the file with the part's rows. `None` in records of older versions.
    #[serde(default)]
    pub rows_checksum: Option<String>,
    /// Checksum of the file with the part's curves, if there is one.
    #[serde(default)]
    pub curves_checksum: Option<String>,
    /// Statistics of the part's rows.
    pub statistics: SweepStatistics,
}

/// Outcome of the attempt to compute a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartOutcome {
    /// The part is complete. This process or another process has computed it.
    Whole,
    /// The computation was interrupted. No file of the part is kept.
    Interrupted,
    /// Another process is computing the part.
    Busy,
}

/// Computes a part on the threads of the current rayon pool. Does nothing if the part is complete or another process computes
/// it. If another thread sets `flag`, the computation stops, and blocks in progress are dropped. Calls `watch` after every
/// finished block with the number of its designs.
pub fn write_part(
    swept: Swept<'_>,
    text: &SweepText,
    directory: &SweepDirectory,
    part: u64,
    flag: &Arc<AtomicBool>,
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
        |worker, block| stoppable(flag, || text.finish(record, worker, block)),
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

/// Completes the files of a part and gives them their final names, the rows last.
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
        rows_checksum: rows.checksum.clone(),
        curves_checksum: curves.as_ref().and_then(|c| c.checksum.clone()),
        statistics,
    };
    let statistics = part_record.write(directory, record)?;
    if let Some(curves) = curves {
        curves.persist(directory)?;
    }
    statistics.persist(directory)?;
    rows.persist(directory)
}

impl PartRecord {
    /// Replaces the statistics file of a complete part by this record.
    pub(super) fn replace(&self, directory: &Path, record: &SweepRecord) -> Result<(), WriteError> {
        self.write(directory, record)?.persist(directory)
    }

    /// Writes the statistics file of the part under a temporary name.
    fn write(&self, directory: &Path, record: &SweepRecord) -> Result<Whole, WriteError> {
        let name = record.statistics_name(self.part);
        let path = directory.join(&name);
        let text = serde_json::to_string(self).expect("JSON can store statistics") + "\n";
        let written = || -> std::io::Result<NamedTempFile> {
            let mut file = temporary_of(directory, &format!("part-{:09}", self.part))?;
            file.write_all(text.as_bytes())?;
            file.flush()?;
            Ok(file)
        };
        Ok(Whole {
            length: text.len() as u64,
            checksum: None,
            temporary: written().map_err(unwritten(&path))?,
            name,
        })
    }
}

/// Table of rows or curves that is being written under a temporary name.
pub(super) struct Pending {
    name: String,
    temporary: NamedTempFile,
    pub table: TableFile,
}

/// Complete file that still has a temporary name.
struct Whole {
    name: String,
    temporary: NamedTempFile,
    length: u64,
    /// Checksum of a table. `None` for a statistics file.
    checksum: Option<String>,
}

impl Pending {
    /// Starts a table. `stem` is the beginning of its temporary name, and `name` its final name.
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

    /// Writes the end of the table. Returns the complete file, still under its temporary name.
    fn finish(self) -> Result<Whole, WriteError> {
        let checksum = self.table.finish()?;
        let metadata = self.temporary.as_file().metadata();
        Ok(Whole {
            length: metadata.map_err(unwritten(self.temporary.path()))?.len(),
            checksum,
            temporary: self.temporary,
            name: self.name,
        })
    }
}

impl Whole {
    /// Gives the file its final name. An existing file is replaced.
    fn persist(self, directory: &Path) -> Result<(), WriteError> {
        let path = directory.join(&self.name);
        let persisted = self.temporary.persist(&path);
        persisted.map_err(|e| unwritten(&path)(e.error))?;
        Ok(())
    }
}

/// Removes temporary files of processes that died while they computed a part. The caller must hold the lock on the part.
fn clear_leftovers(directory: &Path, stem: &str) {
    let prefix = format!("{TEMPORARY}{stem}-");
    let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
    for entry in entries {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}
