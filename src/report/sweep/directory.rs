//! Directory of a sweep: its description in `sweep.json`, and its parts.

use super::checksum::checksum;
use super::part::{FORM as PART_FORM, PartRecord};
use super::summary::{SweepSummary, pareto_csv};
use super::table_file::open_lines;
use crate::report::finished::{NotARun, in_form};
use crate::results::{RunDirectory, WriteError};
use crate::sweep::csv::RowsReader;
use crate::sweep::{FORM, Rows, SweepRecord, SweepStatistics};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// Reason why parts cannot be joined, or why their statistics cannot be summed again.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// The directories do not contain all parts of one sweep, or a file of a part is damaged.
    #[error(transparent)]
    Parts(#[from] NotARun),
    /// The result cannot be written.
    #[error(transparent)]
    Unwritten(#[from] WriteError),
}

/// Directory of a sweep.
#[derive(Clone, Debug)]
pub struct SweepDirectory {
    path: PathBuf,
    /// Description of the sweep: the content of `sweep.json`.
    pub record: SweepRecord,
}

/// Statistics of the complete parts of a sweep, and the numbers of its missing parts.
#[derive(Clone, Debug)]
pub struct Done {
    /// Merged statistics of all complete parts, in order.
    pub statistics: SweepStatistics,
    /// Numbers of the parts that are missing or incomplete, in rising order.
    pub missing: Vec<u64>,
}

/// Names of the files with a sweep's parts, for all numbers and formats. A star represents digits.
const PART_FILES: [&str; 10] = [
    "designs.csv",
    "designs.parquet",
    "designs.json",
    "curves.csv",
    "curves.parquet",
    "part-*.csv",
    "part-*.parquet",
    "part-*.json",
    "curves-*.csv",
    "curves-*.parquet",
];

impl SweepDirectory {
    /// Names of the files that a sweep writes. A star represents the numbers of the parts.
    pub fn files(record: &SweepRecord) -> Vec<String> {
        let mut names = vec!["sweep.json".to_owned()];
        names.extend(SweepDirectory::part_files(record));
        names.extend(["summary.json", "shown_designs.json"].map(str::to_owned));
        names.extend((record.deviations().len() > 1).then(|| "pareto.csv".to_owned()));
        names
    }

    /// Names of the files with the parts, as lists of files show them. A star represents the numbers of the parts.
    pub fn part_files(record: &SweepRecord) -> Vec<String> {
        let mut names = vec![record.rows_name(0), record.statistics_name(0)];
        names.extend(record.curves.then(|| record.curves_name(0)));
        let starred = names.iter().map(|name| name.replace("000000000", "*"));
        starred.collect()
    }

    /// Prepares a claimed directory for a sweep. It keeps existing parts of this sweep, unless `anew` is true. It also keeps the
    /// parts of a sweep with fewer designs of the same sequence, except a last part that changes. It removes all other parts.
    pub fn prepare(
        directory: &RunDirectory,
        record: &SweepRecord,
        anew: bool,
    ) -> Result<Self, WriteError> {
        let there = read_record(directory.path()).ok();
        let is_this = there.as_ref() == Some(record);
        // If a sweep gets more samples, all parts except the last one stay the same.
        let shorter = there.filter(|there| record.continues(there) && there.parts() > 1);
        match shorter {
            _ if is_this && !anew => {}
            Some(shorter) if !anew => {
                let last = shorter.parts() - 1;
                if shorter.designs_of_part(last) != record.designs_of_part(last) {
                    directory.remove_all(&[
                        &shorter.rows_name(last),
                        &shorter.statistics_name(last),
                        &shorter.curves_name(last),
                    ])?;
                }
            }
            _ => {
                // This file is removed first, because no part counts as a part of a sweep without `sweep.json`.
                directory.remove("sweep.json")?;
                directory.remove_all(&PART_FILES)?;
            }
        }
        let names = SweepDirectory::part_files(record);
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        directory.record(&names)?;
        directory.record(&["sweep.json"])?;
        if anew || !is_this {
            let json = serde_json::to_string_pretty(record).expect("JSON can store records");
            directory.write("sweep.json", (json + "\n").as_bytes())?;
        }
        Ok(SweepDirectory {
            path: directory.path().to_owned(),
            record: record.clone(),
        })
    }

    /// Writes the files that are computed from the statistics of the parts: `summary.json`, and `pareto.csv` if there is a
    /// front.
    pub fn write_summary(
        directory: &RunDirectory,
        record: &SweepRecord,
        statistics: &SweepStatistics,
    ) -> Result<(), WriteError> {
        if let Some(pareto) = pareto_csv(record, statistics) {
            directory.write("pareto.csv", &pareto)?;
        }
        let summary = SweepSummary::of(record, statistics);
        let json = serde_json::to_string_pretty(&summary).expect("JSON can store summaries");
        directory.write("summary.json", (json + "\n").as_bytes())
    }

    /// Reads the description of the sweep in a directory. Returns an error if the directory has no sweep.
    pub fn read(path: &Path) -> Result<Self, NotARun> {
        Ok(SweepDirectory {
            path: path.to_owned(),
            record: read_record(path)?,
        })
    }

    /// Path of the directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// True if the file with the rows of a part exists. The program writes this file last, so such a part is complete.
    pub fn has_rows(&self, part: u64) -> bool {
        self.path.join(self.record.rows_name(part)).is_file()
    }

    /// Record of a part. `None` if the part is not complete. An error if its files do not belong to this sweep.
    pub fn part(&self, part: u64) -> Result<Option<PartRecord>, NotARun> {
        let found = self.written(part)?;
        found.map(|found| self.renewed(found)).transpose()
    }

    /// Record of a part with the statistics that this version computes. If the statistics have other dimensions, it sums them again
    /// from the rows. The number of levels (intervals of a variable's range) grows with the number of designs
    /// ([`SweepStatistics::are_of`]), so it changes if a sweep is extended. Other versions may also store fewer numbers. The new
    /// sums have the same bits as the sums of a sweep that runs at once.
    fn renewed(&self, mut found: PartRecord) -> Result<PartRecord, NotARun> {
        let record = &self.record;
        if found.statistics.are_of(record) {
            return Ok(found);
        }
        self.verify(found.part)?;
        let mut statistics = SweepStatistics::empty(record);
        // The rows do not show which designs were solved one by one.
        statistics.one_by_one = found.statistics.one_by_one;
        self.each_block(found.part, |rows| {
            statistics.absorb(record, &SweepStatistics::of(record, rows));
        })?;
        found.statistics = statistics;
        Ok(found)
    }

    /// Record of a part, if the part is complete. Checks the lengths of its files, but not their checksums. The statistics may have
    /// the smaller number of levels (intervals of a variable's range) of a sweep with fewer designs.
    fn written(&self, part: u64) -> Result<Option<PartRecord>, NotARun> {
        if !self.has_rows(part) {
            return Ok(None);
        }
        let record = &self.record;
        let [rows, curves, statistics] = [
            record.rows_name(part),
            record.curves_name(part),
            record.statistics_name(part),
        ]
        .map(|name| self.path.join(name));
        let bytes = std::fs::read(&statistics).map_err(|e| wrong(&statistics, &e.to_string()))?;
        let found: PartRecord = serde_json::from_slice(&bytes).map_err(|e| {
            let reason = format!("not in the format of `hardpoint sweep`: {e}");
            wrong(&statistics, &reason)
        })?;
        let is_ours = found.form == PART_FORM && found.part == part;
        let designs = record.designs_of_part(part);
        if !is_ours || found.digest != record.digest || found.statistics.designs != designs {
            return Err(self.not_of_this_part(part));
        }
        let mut lengths = vec![(&rows, Some(found.rows_length))];
        lengths.extend(record.curves.then_some((&curves, found.curves_length)));
        for (path, expected) in lengths {
            let length = path
                .metadata()
                .map_err(|e| wrong(path, &e.to_string()))?
                .len();
            if Some(length) != expected {
                let reason = "changed since it was written: it has another length";
                return Err(wrong(path, reason));
            }
        }
        Ok(Some(found))
    }

    /// Error for a statistics file of another part or another sweep.
    fn not_of_this_part(&self, part: u64) -> NotARun {
        let statistics = self.path.join(self.record.statistics_name(part));
        wrong(&statistics, "it does not belong to this part of this sweep")
    }

    /// Sums the statistics of kept parts again from their rows, if they have other dimensions, and writes them.
    pub fn renew_statistics(&self) -> Result<(), MergeError> {
        let record = &self.record;
        for part in 0..record.parts() {
            let Some(found) = self.written(part)? else {
                continue;
            };
            if !found.statistics.are_of(record) {
                self.renewed(found)?.replace(&self.path, record)?;
            }
        }
        Ok(())
    }

    /// Reads the rows of a complete part and passes each block to `take`, in order.
    pub fn each_block(&self, part: u64, mut take: impl FnMut(&Rows)) -> Result<(), NotARun> {
        let path = self.path.join(self.record.rows_name(part));
        let wrong = |reason: String| NotARun::at(&path, reason);
        let mut reader = self.rows(part)?;
        for block in self.record.blocks_of(part) {
            let rows = reader.block(block).map_err(|e| wrong(e.to_string()))?;
            take(&rows.ok_or_else(|| {
                wrong("it has fewer rows than this part of the sweep has designs".to_owned())
            })?);
        }
        Ok(())
    }

    /// Checks that the files of a complete part have the bytes that the sweep wrote. It reads the whole files. Parts without
    /// checksums (from older versions) and incomplete parts pass.
    pub fn verify(&self, part: u64) -> Result<(), NotARun> {
        let Some(found) = self.written(part)? else {
            return Ok(());
        };
        let record = &self.record;
        let mut files = vec![(record.rows_name(part), found.rows_checksum)];
        files.extend(
            record
                .curves
                .then(|| (record.curves_name(part), found.curves_checksum)),
        );
        for (name, expected) in files {
            let path = self.path.join(name);
            let sum = File::open(&path).and_then(checksum);
            let sum = sum.map_err(|e| wrong(&path, &e.to_string()))?;
            if expected.is_some_and(|expected| expected != sum) {
                let reason = "changed since it was written: it has another checksum";
                return Err(wrong(&path, reason));
            }
        }
        Ok(())
    }

    /// Statistics of all complete parts, added in order, and the numbers of the incomplete parts.
    pub fn done(&self) -> Result<Done, NotARun> {
        let mut done = Done {
            statistics: SweepStatistics::empty(&self.record),
            missing: Vec::new(),
        };
        for part in 0..self.record.parts() {
            match self.part(part)? {
                Some(found) => done.statistics.absorb(&self.record, &found.statistics),
                None => done.missing.push(part),
            }
        }
        Ok(done)
    }

    /// Reads the rows of a part, block by block.
    fn rows(&self, part: u64) -> Result<RowsReader<'_>, NotARun> {
        let path = self.path.join(self.record.rows_name(part));
        open_lines(&path)
            .and_then(|lines| RowsReader::new(&self.record, lines))
            .map_err(|e| NotARun::at(path, e))
    }
}

/// Error in a file of a part, with advice.
fn wrong(path: &Path, reason: &str) -> NotARun {
    let what = "remove the part's files and `hardpoint sweep` computes them again";
    NotARun::at(path, format!("{reason}; {what}"))
}

/// Reads `sweep.json` in a sweep's directory.
fn read_record(directory: &Path) -> Result<SweepRecord, NotARun> {
    let path = directory.join("sweep.json");
    let wrong = |reason: String| NotARun::at(&path, reason);
    let text = std::fs::read(&path).map_err(|e| match e.kind() {
        io::ErrorKind::NotFound => NotARun::at(
            directory,
            "it is not the directory of a sweep: there is no sweep.json",
        ),
        _ => wrong(e.to_string()),
    })?;
    let record: SweepRecord = in_form(&text, FORM, ["hardpoint sweep", "sweep"]).map_err(wrong)?;
    if !["csv", "parquet"].contains(&record.format.as_str()) {
        let format = &record.format;
        return Err(wrong(format!(
            "expected the format csv or parquet, found {format:?}"
        )));
    }
    let is_sound = record.designs > 0 && record.block() > 0 && record.blocks_of_part > 0;
    if is_sound && record.designs <= crate::study::MOST_DESIGNS {
        Ok(record)
    } else {
        Err(wrong("not in the format of `hardpoint sweep`".to_owned()))
    }
}
