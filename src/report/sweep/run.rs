//! A sweep that has ended, read back from its directory.

use super::files::{NotThisSweep, read_record};
use super::rows_csv;
use super::shown::{Choice, ShownDesigns};
use super::summary::SweepSummary;
use super::table_file::open_lines;
use crate::sweep::SweepRecord;
use std::io;
use std::path::Path;

/// A sweep that has ended.
#[derive(Clone, Debug)]
pub struct SweepRun {
    /// What it is.
    pub record: SweepRecord,
    /// What it came to.
    pub summary: SweepSummary,
    /// How designs were chosen.
    pub choice: Choice,
    /// The rows of those.
    pub shown: ShownDesigns,
    /// The files there are, by name.
    pub files: Vec<String>,
}

impl SweepRun {
    /// Reads a sweep's directory, in constant memory. The rows must be those the summary speaks of.
    pub fn read(directory: &Path) -> Result<Self, NotThisSweep> {
        let record = read_record(directory)?;
        let wrong = |name: &str, reason: String| NotThisSweep {
            path: directory.join(name),
            reason,
        };
        if !["csv", "parquet"].contains(&record.format.as_str()) {
            let reason = format!(
                "expected the format csv or parquet, found {:?}",
                record.format
            );
            return Err(wrong("sweep.json", reason));
        }
        let text = std::fs::read(directory.join("summary.json")).map_err(|e| match e.kind() {
            io::ErrorKind::NotFound => NotThisSweep {
                path: directory.to_owned(),
                reason:
                    "the sweep has not ended, there is no summary.json; `hardpoint sweep` with \
                         --resume goes on with it"
                        .to_owned(),
            },
            _ => wrong("summary.json", e.to_string()),
        })?;
        let summary: SweepSummary = serde_json::from_slice(&text).map_err(|e| {
            let reason = format!("not as `hardpoint sweep` writes it: {e}");
            wrong("summary.json", reason)
        })?;
        let choice = Choice::of(&record, &summary);
        let name = record.file_name("designs");
        let unreadable = |e: io::Error| wrong(&name, e.to_string());
        let mut reader = open_lines(&directory.join(&name))
            .and_then(|lines| rows_csv::Reader::new(&record, lines))
            .map_err(unreadable)?;
        let mut shown = ShownDesigns::default();
        let mut done = 0;
        for block in record.blocks() {
            let Some((rows, _)) = reader.block(block).map_err(unreadable)? else {
                break;
            };
            done += rows.designs() as u64;
            shown.take(&rows, &choice);
        }
        if done != summary.done {
            let reason = format!(
                "expected the {} designs that summary.json speaks of, found {done}; run the sweep again",
                summary.done
            );
            return Err(wrong(&name, reason));
        }
        let misfit = record.misfit().map(|m| record.variables.len() + m);
        for best in &summary.best {
            let row = shown.row(best.design);
            let value = misfit.zip(row).and_then(|(m, row)| shown.columns[m][row]);
            if value != Some(best.misfit) {
                let reason = format!(
                    "design {} has another misfit than in summary.json; run the sweep again",
                    best.design
                );
                return Err(wrong(&name, reason));
            }
        }
        let mut files = vec![name];
        for name in [
            &*record.file_name("curves"),
            "pareto.csv",
            "summary.json",
            "sweep.json",
        ] {
            files.extend(directory.join(name).is_file().then(|| name.to_owned()));
        }
        Ok(SweepRun {
            record,
            summary,
            choice,
            shown,
            files,
        })
    }
}
