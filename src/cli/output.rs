//! Where a run's results go: a directory with a summary on standard output, or the main CSV on
//! standard output with everything else on standard error.

use super::exit::Stop;
use super::interrupt;
use super::terminal;
use super::{RunArguments, TableFormat};
use crate::mechanism::DesignFault;
use crate::report::{Format, Table, Tables, counted};
use crate::results::{Claim, RunDirectory, study_digest};
use crate::study::Study;
use std::cell::RefCell;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// The study as it was run, with what `--set` changed and target curves from files in it: what is made of the
/// results later needs no other file.
pub(super) const STUDY_COPY: &str = "study.toml";

/// The files of a solve.
const CURVE_FILES: [&str; 4] = [
    "curves.csv",
    "sensitivities.csv",
    "summary.json",
    "report.json",
];

/// The files of a tuning.
const TUNING_FILES: [&str; 7] = [
    "curves.csv",
    "curves_before.csv",
    "optimised.toml",
    "front.csv",
    "history.csv",
    "summary.json",
    "report.json",
];

/// The files of a set-up.
const SETUP_FILES: [&str; 4] = ["curves.csv", "setup.csv", "effects.csv", "summary.json"];

/// The files of rig tests.
const KC_FILES: [&str; 4] = [
    "kc.csv",
    "levels.csv",
    "compliance_matrix.csv",
    "summary.json",
];

/// The files of builds.
const TOLERANCE_FILES: [&str; 9] = [
    "tolerance.csv",
    "contributors.csv",
    "curves.csv",
    "curves_p1.csv",
    "curves_p5.csv",
    "curves_p95.csv",
    "curves_p99.csv",
    "summary.json",
    "report.json",
];

pub(super) struct Output {
    directory: Option<RunDirectory>,
    format: Format,
    /// What is printed at the end, where programs read it.
    tables: RefCell<Tables>,
}

/// What a command writes, and to where.
pub(super) struct Destination<'a> {
    /// As in `--out`; `-` is standard output.
    out: Option<&'a Path>,
    /// Where it goes if that is not given.
    default: PathBuf,
    /// As in `--force`.
    force: bool,
    /// How tables are printed.
    format: Format,
}

impl<'a> Destination<'a> {
    /// As arguments give it; results that go by this name go below `out` where they give none.
    pub(super) fn of(
        out: Option<&'a Path>,
        name: &str,
        force: bool,
        format: TableFormat,
    ) -> Result<Self, Stop> {
        let default = match out {
            Some(_) => PathBuf::new(),
            None => default_directory(name)?,
        };
        Ok(Destination {
            out,
            default,
            force,
            format: format.into(),
        })
    }

    /// The directory, if it is not standard output.
    pub(super) fn path(&self) -> &Path {
        self.out.unwrap_or(&self.default)
    }

    /// Whether a copy of the study has its place there: not where one of the run's own inputs stands under that
    /// name.
    pub(super) fn keeps_study(&self, inputs: &[PathBuf]) -> bool {
        let copy = self.path().join(STUDY_COPY).canonicalize().ok();
        let is_input = |path: &PathBuf| copy.is_some() && path.canonicalize().ok() == copy;
        !inputs.iter().any(is_input)
    }
}

/// The directory for the results of a study where none is given, below `out`.
fn default_directory(name: &str) -> Result<PathBuf, Stop> {
    let is_plain = !["", ".", ".."].contains(&name) && !name.contains(['/', '\\']);
    match is_plain {
        true => Ok(PathBuf::from("out").join(name)),
        false => Err(Stop::wrong_input(format!(
            "the study is called {name:?}, from its file's name, which is no name for a directory below \
             out: give one with --out"
        ))),
    }
}

/// The file with the curves of a named motion.
pub(super) fn motion_file(name: &str) -> String {
    format!("curves_{name}.csv")
}

impl Output {
    /// Opens the output of a command, so that a place that cannot be written is known before the work is
    /// done.
    pub(super) fn open(
        arguments: &RunArguments,
        study: &Study,
        command: &str,
    ) -> Result<Self, Stop> {
        let mut files = match command {
            "optimise" => TUNING_FILES.to_vec(),
            "setup" => SETUP_FILES.to_vec(),
            "kc" => KC_FILES.to_vec(),
            "tolerance" => TOLERANCE_FILES.to_vec(),
            _ => CURVE_FILES.to_vec(),
        };
        files.extend(arguments.report.then_some("report.html"));
        let of_motions: Vec<String> = match command {
            // Those of an axle's study are for constraints.
            "solve" if study.axle.is_none() => {
                let names = study.motions.iter().map(|(name, _)| name);
                names.map(|name| motion_file(name.as_str())).collect()
            }
            _ => Vec::new(),
        };
        files.extend(of_motions.iter().map(String::as_str));
        let (out, format) = (arguments.out.as_deref(), arguments.study.format);
        let destination = Destination::of(out, &study.name, arguments.force, format)?;
        let inputs = inputs(study, &arguments.study.study);
        let keeps_study = destination.keeps_study(&inputs);
        files.extend(keeps_study.then_some(STUDY_COPY));
        let claim = Claim {
            command,
            study: &study.name,
            digest: study_digest(study),
            files: &files,
            inputs: &inputs,
            ..Claim::default()
        };
        let output = Output::at(&destination, claim)?;
        if keeps_study {
            output.keep_study(study)?;
        }
        Ok(output)
    }

    /// Writes the study as it is run, where there is a directory.
    pub(super) fn keep_study(&self, study: &Study) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => {
                let text = study.text_in(directory.path());
                self.file(STUDY_COPY, text.as_bytes())
            }
            None => Ok(()),
        }
    }

    /// Opens a directory, or standard output for `-`. Where results of another state of the study are in
    /// the way in the directory that nobody has asked for, they are moved aside; elsewhere the run is
    /// refused.
    pub(super) fn at(destination: &Destination<'_>, claim: Claim<'_>) -> Result<Self, Stop> {
        let format = destination.format;
        if destination.out == Some(Path::new("-")) {
            return Ok(Output {
                directory: None,
                format,
                tables: RefCell::default(),
            });
        }
        let claim = Claim {
            force: destination.force,
            set_aside: destination.out.is_none(),
            ..claim
        };
        let path = destination.path();
        let directory = RunDirectory::claim(path, &claim).map_err(Stop::wrong_input)?;
        if let Some(place) = directory.set_aside() {
            terminal::note(&format!(
                "The results that were in {} are now in {}.\n",
                path.display(),
                place.display()
            ));
        }
        Ok(Output {
            directory: Some(directory),
            format,
            tables: RefCell::default(),
        })
    }

    /// Writes the main CSV: to the directory under this name, or to standard output.
    pub(super) fn main_csv(&self, name: &str, contents: &[u8]) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => directory.write(name, contents).map_err(Stop::unwritten),
            None => Ok(io::stdout().write_all(contents)?),
        }
    }

    /// Writes another file, where there is a directory.
    pub(super) fn file(&self, name: &str, contents: &[u8]) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => directory.write(name, contents).map_err(Stop::unwritten),
            None => Ok(()),
        }
    }

    /// Removes a file of an earlier run: beside the new results it would speak of others.
    pub(super) fn without(&self, name: &str) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => directory.remove(name).map_err(Stop::unwritten),
            None => Ok(()),
        }
    }

    /// Writes a file where there is something to write, and returns its name; else removes that of an earlier run.
    pub(super) fn file_if_any<'n>(
        &self,
        name: &'n str,
        contents: Option<Vec<u8>>,
    ) -> Result<Option<&'n str>, Stop> {
        match &contents {
            Some(contents) => self.file(name, contents)?,
            None => self.without(name)?,
        }
        Ok(contents.map(|_| name))
    }

    /// The directory, where there is one.
    pub(super) fn directory(&self) -> Option<&RunDirectory> {
        self.directory.as_ref()
    }

    /// Writes a record for programs, on one line.
    pub(super) fn record(&self, name: &str, record: &impl serde::Serialize) -> Result<(), Stop> {
        let text = serde_json::to_string(record).expect("records are plain data");
        self.file(name, (text + "\n").as_bytes())
    }

    /// Writes a summary as JSON.
    pub(super) fn json(&self, name: &str, summary: &impl serde::Serialize) -> Result<(), Stop> {
        let text = serde_json::to_string_pretty(summary).expect("summaries are plain data");
        self.file(name, (text + "\n").as_bytes())
    }

    /// Whether the summary is for reading.
    pub(super) fn is_text(&self) -> bool {
        self.format == Format::Text
    }

    /// Prints text of the summary. With another format than text only tables are printed, so that
    /// standard output can be read by a program; the rest goes to standard error.
    pub(super) fn say(&self, text: &str) -> Result<(), Stop> {
        if terminal::is_quiet() {
            return Ok(());
        }
        match (self.directory.is_some(), self.is_text()) {
            (true, true) => terminal::print(text)?,
            (false, true) => terminal::note(text),
            // Without the empty lines that set it off from tables.
            (_, false) => terminal::note(&format!("{}\n", text.trim_matches('\n'))),
        }
        Ok(())
    }

    /// Prints text between tables: to a reader, as a program knows its tables by their names.
    pub(super) fn text_only(&self, text: &str) -> Result<(), Stop> {
        match self.is_text() {
            true => self.say(text),
            false => Ok(()),
        }
    }

    /// Says what was asked for and could not be had: an error, also where quiet was asked for.
    pub(super) fn say_failure(&self, text: &str) -> Result<(), Stop> {
        match terminal::is_quiet() {
            true => terminal::eprint(text.trim_start_matches('\n')),
            false => self.say(text)?,
        }
        Ok(())
    }

    /// Says remarks, each set off by itself.
    pub(super) fn say_remarks(
        &self,
        remarks: impl IntoIterator<Item = impl std::fmt::Display>,
    ) -> Result<(), Stop> {
        let mut remarks = remarks.into_iter();
        remarks.try_for_each(|remark| self.say(&format!("\n{remark}\n")))
    }

    /// Says remarks. Where something that was asked for could not be had, the warnings among them say what: also where
    /// quiet was asked for.
    pub(super) fn say_plausibility(
        &self,
        remarks: impl IntoIterator<Item = String>,
        is_complete: bool,
    ) -> Result<(), Stop> {
        for remark in remarks {
            let text = format!("\n{remark}\n");
            match !is_complete && remark.starts_with("warning: ") {
                true => self.say_failure(&text)?,
                false => self.say(&text)?,
            }
        }
        Ok(())
    }

    /// Prints a table of the summary; for programs, which know it by its name, at the end.
    pub(super) fn table(&self, name: &'static str, table: &Table) -> Result<(), Stop> {
        match self.is_text() {
            true => self.say(&table.text(terminal::width()))?,
            false => self.tables.borrow_mut().push(name, table.clone()),
        }
        Ok(())
    }

    /// Hands a table to programs; to readers it is said in words.
    pub(super) fn table_for_programs(&self, name: &'static str, table: impl FnOnce() -> Table) {
        if !self.is_text() {
            self.tables.borrow_mut().push(name, table());
        }
    }

    /// Notes that a signal has stopped the work, before a summary is written.
    pub(super) fn mark_interrupted(&self) {
        if let Some(directory) = &self.directory {
            directory.mark_interrupted();
        }
    }

    /// Records the run as finished, or as interrupted: before anything is printed, as whoever reads that may stop.
    pub(super) fn finish(&self) -> Result<(), Stop> {
        // A signal that comes now is too late to interrupt the run.
        interrupt::stops_by_itself();
        match &self.directory {
            Some(directory) => directory.finish().map_err(Stop::unwritten),
            None => Ok(()),
        }
    }

    /// Records a run that has not done all of its work, and that a later one goes on with.
    pub(super) fn leave_unfinished(&self) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => directory.leave_unfinished().map_err(Stop::unwritten),
            None => Ok(()),
        }
    }

    /// Says where the results are, and prints the tables where programs read them.
    pub(super) fn print_files(&self, files: &[&str]) -> Result<(), Stop> {
        if !self.is_text() {
            let text = self.tables.borrow().render(self.format, terminal::width());
            match self.directory {
                Some(_) => io::stdout().write_all(text.as_bytes())?,
                None => terminal::eprint(&text),
            }
        }
        match &self.directory {
            Some(directory) => self.say(&format!(
                "\n{}: {}\n",
                directory.path().display(),
                files.join(", ")
            )),
            None => Ok(()),
        }
    }
}

/// The study that a run's directory keeps, of a tuning the tuned one.
pub(super) fn kept_study(directory: &Path, overrides: &[String]) -> Result<Option<Study>, Stop> {
    let kept = ["optimised.toml", STUDY_COPY].map(|name| directory.join(name));
    let kept = kept.iter().find(|file| file.is_file());
    Ok(kept.map(|file| Study::read(file, overrides)).transpose()?)
}

/// All the files a run reads.
pub(super) fn inputs(study: &Study, path: &Path) -> Vec<PathBuf> {
    let mut inputs = study.inputs.clone();
    inputs.push(path.to_owned());
    inputs
}

/// The rayon pool of a run that can be divided into so many pieces of work. More threads than cores, or
/// than pieces, buy nothing but memory: they are not started, and that is said.
pub(super) fn pool(asked: Option<NonZeroUsize>, pieces: u64) -> Result<rayon::ThreadPool, Stop> {
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let useful = cores
        .min(usize::try_from(pieces).unwrap_or(usize::MAX))
        .max(1);
    let threads = asked.map_or(useful, |asked| asked.get().min(useful));
    if let Some(asked) = asked.filter(|asked| asked.get() > threads) {
        terminal::note(&format!(
            "Runs on {threads} of the {asked} threads asked for: there are {} and {} of work.\n",
            counted(cores, "core"),
            counted(pieces, "piece")
        ));
    }
    crate::threads::pool(threads)
        .map_err(|e| Stop::wrong_input(format!("cannot start {threads} threads: {e}")))
}

/// A design that cannot be solved is a mistake of the study.
pub(super) fn design_fault(study: &Study, path: &Path, fault: &DesignFault) -> Stop {
    Stop::in_file(path, fault.describe(&study.suspension.mechanism))
}
