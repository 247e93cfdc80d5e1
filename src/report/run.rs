//! A finished run, read from its directory or from its files in memory.

use super::curve_table::CurveTable;
use super::finished::{NotARun, in_form};
use super::record::{DesignRecord, FORM, MotionRecord, Record};
use super::{SolveSummary, Table, ToleranceSummary, TuningSummary};
use crate::study::{LONGEST_TABLE, read_bytes};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

/// A finished run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Record of the run, with its drawing.
    pub record: Record,
    /// Curves of each design in the record, over the study's own motion, then over each named motion.
    pub curves: Vec<CurveTable>,
    /// Summary of the run.
    pub summary: Summary,
    /// True if a signal ended the run early. Then it has only the finished results.
    pub interrupted: bool,
    /// Convergence history of an optimisation.
    pub history: Option<CurveTable>,
    /// Names of the run's files with results: the curves first, then the other files.
    pub files: Vec<String>,
}

/// Summary of a run, from `summary.json`.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Summary {
    /// Summary of a solve.
    Solve(Box<SolveSummary>),
    /// Summary of an optimisation.
    Optimise(Box<TuningSummary>),
    /// Summary of a tolerance analysis.
    Tolerance(Box<ToleranceSummary>),
}

impl Summary {
    /// Result of the run in one line.
    pub fn headline(&self) -> String {
        match self {
            Summary::Solve(solve) => solve.headline(),
            Summary::Optimise(tuning) => tuning.headline(),
            Summary::Tolerance(tolerance) => tolerance.headline(),
        }
    }

    /// Tables of a solve: ranges of columns, number of stations for each status, and stations without a pose. `None` for another
    /// command.
    pub fn tables(&self) -> Option<[Table; 3]> {
        match self {
            Summary::Solve(s) => Some([s.table(), s.stations_table(), s.failures_table()]),
            Summary::Optimise(_) | Summary::Tolerance(_) => None,
        }
    }

    /// Summary of a solve. `None` for another command.
    pub fn of_solve(&self) -> Option<&SolveSummary> {
        match self {
            Summary::Solve(solve) => Some(solve),
            Summary::Optimise(_) | Summary::Tolerance(_) => None,
        }
    }
}

impl Run {
    /// Reads the directory of a run.
    pub fn read(directory: &Path) -> Result<Run, NotARun> {
        let folder = Folder::Directory(directory);
        if !directory.is_dir() {
            return Err(folder.error(None, "there is no such directory"));
        }
        Run::of_folder(&folder)
    }

    /// Reads a run from files in memory, by their names.
    pub fn of_files(files: &BTreeMap<String, Vec<u8>>) -> Result<Run, NotARun> {
        Run::of_folder(&Folder::Memory(files))
    }

    fn of_folder(folder: &Folder<'_>) -> Result<Run, NotARun> {
        if !folder.has("report.json") {
            return Err(folder.error(
                None,
                "not the directory of a run: there is no report.json, which `hardpoint solve`, `optimise` \
                 and `tolerance` write, nor a sweep.json of `hardpoint sweep`",
            ));
        }
        let text = folder.bytes("report.json")?;
        let record = in_form::<Record>(&text, FORM, ["hardpoint", "study"]);
        let record = record.map_err(|why| folder.error(Some("report.json"), &why))?;
        let mut curves = Vec::new();
        let mut files = Vec::new();
        for motion in record.all_motions() {
            for (design, table) in motion.designs.iter().zip(folder.tables(motion)?) {
                curves.push(table);
                files.push(design.curves.clone());
            }
        }
        let optimised = record.command == "optimise";
        let state: State = folder.json("summary.json")?;
        // A run that ended between two writes has no results.
        if state.interrupted && !state.has_results() {
            let message = "a signal ended the run before it had results; run the study again";
            return Err(folder.error(Some("summary.json"), message));
        }
        let summary = match record.command.as_str() {
            "optimise" => Summary::Optimise(Box::new(folder.json("summary.json")?)),
            "tolerance" => Summary::Tolerance(Box::new(folder.json("summary.json")?)),
            _ => Summary::Solve(folder.json("summary.json")?),
        };
        let history = if optimised {
            Some(folder.table("history.csv")?)
        } else {
            None
        };
        let others = [
            "sensitivities.csv",
            "history.csv",
            "side_effects.csv",
            "front.csv",
            "kc.csv",
            "summary.json",
            "optimised.toml",
            "tolerance.csv",
            "contributors.csv",
        ];
        let there = others.iter().filter(|name| folder.has(name));
        files.extend(there.map(|name| (*name).to_owned()));
        Ok(Run {
            record,
            curves,
            summary,
            interrupted: state.interrupted,
            history,
            files,
        })
    }
}

/// State of a run in `summary.json` (such as whether it was interrupted), and the other keys of this file.
#[derive(Deserialize)]
struct State {
    #[serde(default)]
    interrupted: bool,
    #[serde(flatten)]
    others: serde_json::Map<String, serde_json::Value>,
}

impl State {
    /// True if the summary has a key that is not part of the run's state.
    fn has_results(&self) -> bool {
        let own = ["finished", "command"];
        self.others.keys().any(|key| !own.contains(&key.as_str()))
    }
}

/// Location of a run's files: a directory or memory.
enum Folder<'a> {
    Directory(&'a Path),
    Memory(&'a BTreeMap<String, Vec<u8>>),
}

impl Folder<'_> {
    fn error(&self, name: Option<&str>, reason: &str) -> NotARun {
        let path = match self {
            Folder::Directory(directory) => directory,
            Folder::Memory(_) => Path::new("results"),
        };
        let path = name.map_or_else(|| path.to_owned(), |name| path.join(name));
        NotARun::at(path, reason)
    }

    fn has(&self, name: &str) -> bool {
        match self {
            Folder::Directory(directory) => directory.join(name).is_file(),
            Folder::Memory(files) => files.contains_key(name),
        }
    }

    /// Content of the file with this name, which must be in the folder itself.
    fn bytes(&self, name: &str) -> Result<Cow<'_, [u8]>, NotARun> {
        // The names come from a file, so they could lead out of the directory.
        if Path::new(name).file_name() != Some(name.as_ref()) {
            return Err(self.error(
                Some("report.json"),
                &format!("{name:?} is not the name of a file"),
            ));
        }
        let bytes = match self {
            Folder::Directory(directory) => {
                read_bytes(&directory.join(name), LONGEST_TABLE).map(Cow::Owned)
            }
            Folder::Memory(files) => {
                let bytes = files.get(name).map(|bytes| Cow::Borrowed(&bytes[..]));
                bytes.ok_or_else(|| "there is no such file".to_owned())
            }
        };
        bytes.map_err(|e| self.error(Some(name), &e))
    }

    fn json<T: DeserializeOwned>(&self, name: &str) -> Result<T, NotARun> {
        let problem =
            |e: serde_json::Error| format!("not in the form that `hardpoint` writes: {e}");
        serde_json::from_slice(&self.bytes(name)?).map_err(|e| self.error(Some(name), &problem(e)))
    }

    /// Curves of the designs over a motion. An error if a file has other stations than the record, or lacks a column.
    fn tables(&self, motion: &MotionRecord) -> Result<Vec<CurveTable>, NotARun> {
        let table = |design: &DesignRecord| {
            let table = self.table(&design.curves)?;
            let absent = |name: &&String| table.column(name).is_none();
            let columns = motion.outputs.iter().map(|o| &o.column);
            let moving = [&motion.drive].into_iter().chain(&motion.rack);
            let mut needed = columns.chain(moving).chain(&motion.further);
            if table.rows() != design.stations {
                let message = format!(
                    "expected the {} stations listed in report.json, found {}; run the study again",
                    design.stations,
                    table.rows()
                );
                return Err(self.error(Some(&design.curves), &message));
            }
            let absent = needed.find(absent).map(String::as_str);
            let has_status = table.status.len() == design.stations;
            if let Some(name) = absent.or((!has_status).then_some("status")) {
                let message = format!(
                    "there is no column {name}, which report.json lists; run the study again"
                );
                return Err(self.error(Some(&design.curves), &message));
            }
            Ok(table)
        };
        motion.designs.iter().map(table).collect()
    }

    fn table(&self, name: &str) -> Result<CurveTable, NotARun> {
        CurveTable::read(&self.bytes(name)?).map_err(|e| self.error(Some(name), &e))
    }
}
