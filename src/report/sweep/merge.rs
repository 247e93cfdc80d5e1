//! Joins the parts of a sweep to one file.

use super::directory::{MergeError, SweepDirectory};
use super::part::{self, Pending};
use super::table_file::open_lines;
use crate::report::finished::NotARun;
use crate::results::RunDirectory;
use crate::sweep::{SweepRecord, SweepStatistics};
use std::io::{self, BufRead};
use std::path::{Path, PathBuf};

/// All parts of a sweep, in any directories.
#[derive(Debug)]
pub struct Parts {
    /// Description of the sweep in which all blocks form a single part.
    pub record: SweepRecord,
    /// Statistics of all parts.
    pub statistics: SweepStatistics,
    /// For each part, the index of its directory in `directories`.
    places: Vec<usize>,
    directories: Vec<SweepDirectory>,
}

impl Parts {
    /// Reads the directories, and checks that together they contain every part of one sweep. It also checks the checksums of the
    /// files. If several directories contain a part, the first one is used.
    pub fn read(paths: &[PathBuf]) -> Result<Self, NotARun> {
        let directories: Result<Vec<_>, _> = paths
            .iter()
            .map(|path| SweepDirectory::read(path))
            .collect();
        let directories = directories?;
        let Some(first) = directories.first() else {
            let reason = "no directories were given".to_owned();
            return Err(NotARun::at(Path::new("merge"), reason));
        };
        if let Some(other) = directories.iter().find(|d| d.record != first.record) {
            let reason = format!("not of the same sweep as {}", first.path().display());
            return Err(NotARun::at(other.path(), reason));
        }
        let mut statistics = SweepStatistics::empty(&first.record);
        let (mut places, mut missing) = (Vec::new(), Vec::new());
        for number in 0..first.record.parts() {
            let mut found = None;
            for (place, directory) in directories.iter().enumerate() {
                if let Some(part) = directory.part(number)? {
                    directory.verify(number)?;
                    found = Some((place, part));
                    break;
                }
            }
            match found {
                Some((place, part)) => {
                    statistics.absorb(&first.record, &part.statistics);
                    places.push(place);
                }
                None => missing.push(number.to_string()),
            }
        }
        if !missing.is_empty() {
            let reason = format!(
                "{} of {} parts are missing ({}{}); `hardpoint sweep` with --resume or --shard \
                 computes them",
                missing.len(),
                first.record.parts(),
                missing[..missing.len().min(10)].join(", "),
                if missing.len() > 10 { ", ..." } else { "" },
            );
            return Err(NotARun::at(first.path(), reason));
        }
        Ok(Parts {
            record: SweepRecord {
                blocks_of_part: first.record.blocks().max(first.record.blocks_of_part),
                ..first.record.clone()
            },
            statistics,
            places,
            directories,
        })
    }

    /// Directories that contain the parts.
    pub fn directories(&self) -> impl Iterator<Item = &Path> {
        self.directories.iter().map(SweepDirectory::path)
    }

    /// Joins the files of all parts in a directory. After each part of the rows, calls `watch` with its number of designs. The
    /// directory must not contain any of the parts, because its parts are removed first.
    pub fn join(&self, into: &RunDirectory, mut watch: impl FnMut(u64)) -> Result<(), MergeError> {
        let directory = SweepDirectory::prepare(into, &self.record, true)?;
        let rows = self.joined(&directory, SweepRecord::rows_name, &mut watch)?;
        let curves = if self.record.curves {
            Some(self.joined(&directory, SweepRecord::curves_name, &mut |_| {})?)
        } else {
            None
        };
        let statistics = self.statistics.clone();
        part::put(into.path(), &self.record, 0, rows, curves, statistics)?;
        Ok(())
    }

    /// Writes one header, then the rows of all parts, to a temporary file. `name` returns the name of a part's file from the
    /// description of the sweep.
    fn joined(
        &self,
        into: &SweepDirectory,
        name: impl Fn(&SweepRecord, u64) -> String,
        watch: &mut dyn FnMut(u64),
    ) -> Result<Pending, MergeError> {
        let mut joined: Option<Pending> = None;
        for (number, place) in (0..).zip(&self.places) {
            let source = &self.directories[*place];
            let path = source.path().join(name(&source.record, number));
            let unreadable = |e: io::Error| NotARun::at(&path, e.to_string());
            let mut lines = open_lines(&path).map_err(unreadable)?;
            let mut header = Vec::new();
            lines.read_until(b'\n', &mut header).map_err(unreadable)?;
            let mut file = match joined.take() {
                Some(file) => file,
                None => Pending::begin(into.path(), "merge", name(&self.record, 0), &header)?,
            };
            file.table.copy_rows(&mut lines)?;
            joined = Some(file);
            watch(source.record.designs_of_part(number));
        }
        joined.ok_or_else(|| NotARun::at(into.path(), "there are no parts".to_owned()).into())
    }
}
