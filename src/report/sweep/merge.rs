//! Joining the shards of a sweep to the bytes of one run.

use super::files::{NotThisSweep, read_record};
use super::rows_csv;
use super::table_file::{TableFile, open_lines};
use crate::report::{RunDirectory, WriteError};
use crate::sweep::{SweepRecord, SweepStatistics};
use std::io::{self, BufRead};
use std::path::{Path, PathBuf};

/// All the shards of a sweep, in order.
#[derive(Debug)]
pub struct Parts {
    /// The sweep as one run has it.
    pub record: SweepRecord,
    parts: Vec<(PathBuf, SweepRecord)>,
}

/// Why shards cannot be joined.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// They are not all the finished shards of one sweep.
    #[error(transparent)]
    Parts(#[from] NotThisSweep),
    /// The result cannot be written.
    #[error(transparent)]
    Unwritten(#[from] WriteError),
}

fn wrong(path: &Path, reason: String) -> NotThisSweep {
    NotThisSweep {
        path: path.to_owned(),
        reason,
    }
}

impl Parts {
    /// Reads what the directories hold, and sees whether together they are one whole sweep.
    pub fn read(directories: &[PathBuf]) -> Result<Self, NotThisSweep> {
        let mut parts = Vec::new();
        for directory in directories {
            parts.push((directory.clone(), read_record(directory)?));
        }
        let whole = |record: &SweepRecord| SweepRecord {
            shard: None,
            ..record.clone()
        };
        let Some((first_path, first)) = parts.first().cloned() else {
            let reason = "no directories were given".to_owned();
            return Err(wrong(Path::new("merge"), reason));
        };
        let record = whole(&first);
        let count = first.shard.map_or(1, |[_, n]| n);
        for (path, part) in &parts {
            if whole(part) != record || part.shard.map_or(1, |[_, n]| n) != count {
                let first = first_path.display();
                let reason = format!("not a shard of the same sweep as {first}");
                return Err(wrong(path, reason));
            }
        }
        parts.sort_by_key(|(_, record)| record.shard);
        let number = |record: &SweepRecord| record.shard.map_or(1, |[i, _]| i);
        for pair in parts.windows(2) {
            if number(&pair[0].1) == number(&pair[1].1) {
                let reason = format!(
                    "the same shard, {} of {count}, as {}",
                    number(&pair[1].1),
                    pair[0].0.display()
                );
                return Err(wrong(&pair[1].0, reason));
            }
        }
        let there = |i: &u64| parts.iter().any(|(_, record)| number(record) == *i);
        let missing: Vec<String> = (1..=count)
            .filter(|i| !there(i))
            .take(10)
            .map(|i| format!("{i}/{count}"))
            .collect();
        if !missing.is_empty() {
            let reason = format!("missing of its sweep: shard {}", missing.join(", "));
            return Err(wrong(&first_path, reason));
        }
        Ok(Parts { record, parts })
    }

    /// Where they are.
    pub fn directories(&self) -> impl Iterator<Item = &Path> {
        self.parts.iter().map(|(path, _)| path.as_path())
    }

    /// Sums all shards up, which must be finished; `watch` hears of every block's designs.
    pub fn tally(&self, mut watch: impl FnMut(u64)) -> Result<SweepStatistics, NotThisSweep> {
        let mut tally = SweepStatistics::empty(&self.record);
        for (directory, part) in &self.parts {
            let path = directory.join(part.file_name("designs"));
            let unreadable = |e: io::Error| wrong(&path, e.to_string());
            let mut reader = open_lines(&path)
                .and_then(|lines| rows_csv::Reader::new(part, lines))
                .map_err(unreadable)?;
            for block in part.blocks() {
                let Some((rows, _)) = reader.block(block).map_err(unreadable)? else {
                    let reason = "not finished; `hardpoint sweep` with --resume goes on with it";
                    return Err(wrong(directory, reason.to_owned()));
                };
                watch(rows.designs() as u64);
                tally.absorb(&self.record, &SweepStatistics::of(&self.record, &rows));
            }
        }
        Ok(tally)
    }

    /// Joins the files of all shards in a directory.
    pub fn join(&self, into: &RunDirectory) -> Result<(), MergeError> {
        let json = serde_json::to_string_pretty(&self.record).expect("records are plain data");
        into.write("sweep.json", (json + "\n").as_bytes())?;
        self.join_files("designs", into)?;
        if self.record.curves {
            self.join_files("curves", into)?;
        }
        Ok(())
    }

    /// One header, then the rows of all shards.
    fn join_files(&self, name: &str, into: &RunDirectory) -> Result<(), MergeError> {
        let name = self.record.file_name(name);
        let mut joined: Option<TableFile> = None;
        for (directory, _) in &self.parts {
            let path = directory.join(&name);
            let unreadable = |e: io::Error| wrong(&path, e.to_string());
            let mut lines = open_lines(&path).map_err(unreadable)?;
            let mut header = Vec::new();
            lines.read_until(b'\n', &mut header).map_err(unreadable)?;
            let mut file = match joined.take() {
                Some(file) => file,
                None => TableFile::begin(into.path().join(&name), &header)?,
            };
            file.copy_rows(&mut lines)?;
            joined = Some(file);
        }
        joined.map_or(Ok(()), TableFile::finish)?;
        Ok(())
    }
}
