//! Destination of a run's results: a directory or standard output. With a directory, the summary goes to standard output.
//! Otherwise the main CSV goes to standard output, and the summary goes to standard error.

use super::exit::Stop;
use super::interrupt;
use super::terminal;
use super::{RunArguments, TableFormat};
use crate::in_motions::files_in_motions;
use crate::mechanism::DesignFault;
use crate::report::{Format, Table, Tables, counted};
use crate::results::{Claim, Manifest, RunDirectory, study_digest};
use crate::study::Study;
use std::cell::RefCell;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// Study of the run. It includes the changes of `--set` and the target curves from files. Later commands need no other file,
/// except the file of the designs of a sweep.
pub(super) const STUDY_COPY: &str = "study.toml";

/// Files of `solve`.
const CURVE_FILES: [&str; 4] = [
    "curves.csv",
    "sensitivities.csv",
    "summary.json",
    "report.json",
];

/// Files of `optimise`.
const TUNING_FILES: [&str; 10] = [
    "curves.csv",
    "sensitivities.csv",
    "kc.csv",
    "curves_before.csv",
    "optimised.toml",
    "side_effects.csv",
    "front.csv",
    "history.csv",
    "summary.json",
    "report.json",
];

/// Files of `setup`.
const SETUP_FILES: [&str; 4] = ["curves.csv", "setup.csv", "effects.csv", "summary.json"];

/// Files of `kc`.
const KC_FILES: [&str; 5] = [
    "kc.csv",
    "levels.csv",
    "compliance_matrix.csv",
    "sensitivities.csv",
    "summary.json",
];

/// Files of `tolerance`.
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
    /// Machine-readable tables of the summary. The command prints them at its end.
    tables: RefCell<Tables>,
    /// Directory of the pictures, and their file names. `None` without pictures.
    pictures: RefCell<Option<(PathBuf, Vec<String>)>>,
}

/// Files of a command, and their destination.
pub(super) struct Destination<'a> {
    /// Value of `--out`. `-` means standard output.
    out: Option<&'a Path>,
    /// Default destination.
    default: PathBuf,
    /// Value of `--force`.
    force: bool,
    /// Format of printed tables.
    format: Format,
}

impl<'a> Destination<'a> {
    /// Reads the destination from the arguments. The default is the folder `name` below `out`.
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

    /// Path of the directory. The path has no meaning if the output is standard output.
    pub(super) fn path(&self) -> &Path {
        self.out.unwrap_or(&self.default)
    }

    /// True if the directory can hold a copy of the study: no input of the run is this file.
    pub(super) fn keeps_study(&self, inputs: &[PathBuf]) -> bool {
        let copy = self.path().join(STUDY_COPY).canonicalize().ok();
        let is_input = |path: &PathBuf| copy.is_some() && path.canonicalize().ok() == copy;
        !inputs.iter().any(is_input)
    }
}

/// Default directory for the results of a study, below `out`.
fn default_directory(name: &str) -> Result<PathBuf, Stop> {
    let is_plain = !["", ".", ".."].contains(&name) && !name.contains(['/', '\\']);
    if is_plain {
        Ok(PathBuf::from("out").join(name))
    } else {
        Err(Stop::wrong_input(format!(
            "the name of the study, {name:?}, comes from its file and cannot be the name of a \
             directory below out: give a directory with --out"
        )))
    }
}

impl Output {
    /// Opens the output of a command. This happens before the work, so that a directory without write access is found early.
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
            "solve" | "optimise" => files_in_motions(study, command == "optimise"),
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

    /// Writes the study of the run, if the output is a directory.
    pub(super) fn keep_study(&self, study: &Study) -> Result<(), Stop> {
        if self.directory.is_none() {
            return Ok(());
        }
        let text = self.text_here(study, study.text.clone());
        self.file(STUDY_COPY, text.as_bytes())
    }

    /// Text of a study for a file of the output. The paths of other files become relative to the directory of the output.
    pub(super) fn text_here(&self, study: &Study, text: String) -> String {
        match &self.directory {
            Some(directory) => study.with_paths_in(text, directory.path()),
            None => text,
        }
    }

    /// Opens a directory, or standard output for `-`. If the default directory holds results of another command or version of the
    /// study, it moves them aside. In a directory that the user has chosen, such results are an error without `--force`.
    pub(super) fn at(destination: &Destination<'_>, claim: Claim<'_>) -> Result<Self, Stop> {
        let format = destination.format;
        if destination.out == Some(Path::new("-")) {
            return Ok(Output {
                directory: None,
                format,
                tables: RefCell::default(),
                pictures: RefCell::default(),
            });
        }
        let claim = Claim {
            force: destination.force,
            set_aside: destination.out.is_none(),
            ..claim
        };
        let path = destination.path();
        let directory = RunDirectory::claim(path, &claim).map_err(Stop::wrong_input)?;
        say_set_aside(path, &directory);
        Ok(Output {
            directory: Some(directory),
            format,
            tables: RefCell::default(),
            pictures: RefCell::default(),
        })
    }

    /// Writes the main CSV of the run to the directory under the name `name`, or to standard output.
    pub(super) fn main_csv(&self, name: &str, contents: &[u8]) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => directory.write(name, contents).map_err(Stop::unwritten),
            None => Ok(io::stdout().write_all(contents)?),
        }
    }

    /// Writes another file, if the output is a directory.
    pub(super) fn file(&self, name: &str, contents: &[u8]) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => directory.write(name, contents).map_err(Stop::unwritten),
            None => Ok(()),
        }
    }

    /// Removes a file of an earlier run, because it would contradict the new results.
    pub(super) fn without(&self, name: &str) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => directory.remove(name).map_err(Stop::unwritten),
            None => Ok(()),
        }
    }

    /// Writes a file and returns its name. If `contents` is `None`, removes the file of an earlier run and returns `None`.
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

    /// Directory of the results. `None` if the output is standard output.
    pub(super) fn directory(&self) -> Option<&RunDirectory> {
        self.directory.as_ref()
    }

    /// Writes a record for programs as one line of JSON.
    pub(super) fn record(&self, name: &str, record: &impl serde::Serialize) -> Result<(), Stop> {
        let text = serde_json::to_string(record).expect("JSON can store records");
        self.file(name, (text + "\n").as_bytes())
    }

    /// Writes a summary as JSON.
    pub(super) fn json(&self, name: &str, summary: &impl serde::Serialize) -> Result<(), Stop> {
        let text = serde_json::to_string_pretty(summary).expect("JSON can store summaries");
        self.file(name, (text + "\n").as_bytes())
    }

    /// True if the summary is text for people.
    pub(super) fn is_text(&self) -> bool {
        self.format == Format::Text
    }

    /// Prints text of the summary. In formats other than text, standard output only has tables for programs, so the text goes to
    /// standard error.
    pub(super) fn say(&self, text: &str) -> Result<(), Stop> {
        if terminal::is_quiet() {
            return Ok(());
        }
        match (self.directory.is_some(), self.is_text()) {
            (true, true) => terminal::print(text)?,
            (false, true) => terminal::note(text),
            // A text without tables above or below needs no empty lines around it.
            (_, false) => terminal::note(&format!("{}\n", text.trim_matches('\n'))),
        }
        Ok(())
    }

    /// Prints text between tables, but only if the output is text. In other formats, the tables have names instead.
    pub(super) fn text_only(&self, text: &str) -> Result<(), Stop> {
        if self.is_text() {
            self.say(text)
        } else {
            Ok(())
        }
    }

    /// Prints the sentence about a request that could not be met. It is an error, so it is also printed with `--quiet`.
    pub(super) fn say_failure(&self, text: &str) -> Result<(), Stop> {
        if terminal::is_quiet() {
            terminal::eprint(text.trim_start_matches('\n'))
        } else {
            self.say(text)?
        }
        Ok(())
    }

    /// Prints remarks, separated by empty lines.
    pub(super) fn say_remarks(
        &self,
        remarks: impl IntoIterator<Item = impl std::fmt::Display>,
    ) -> Result<(), Stop> {
        let mut remarks = remarks.into_iter();
        remarks.try_for_each(|remark| self.say(&format!("\n{remark}\n")))
    }

    /// Prints remarks. If `is_complete` is false (a request could not be met), warnings are also printed with `--quiet`.
    pub(super) fn say_plausibility(
        &self,
        remarks: impl IntoIterator<Item = String>,
        is_complete: bool,
    ) -> Result<(), Stop> {
        for remark in remarks {
            let text = format!("\n{remark}\n");
            if !is_complete && remark.starts_with("warning: ") {
                self.say_failure(&text)?
            } else {
                self.say(&text)?
            }
        }
        Ok(())
    }

    /// Prints a table of the summary. In formats for programs, the table is printed at the end under this name.
    pub(super) fn table(&self, name: &'static str, table: &Table) -> Result<(), Stop> {
        if self.is_text() {
            self.say(&table.text(terminal::width()))?
        } else {
            self.tables.borrow_mut().push(name, table.clone())
        }
        Ok(())
    }

    /// Prints a table in formats for programs only. The text output has sentences instead.
    pub(super) fn table_for_programs(&self, name: &'static str, table: impl FnOnce() -> Table) {
        if !self.is_text() {
            self.tables.borrow_mut().push(name, table());
        }
    }

    /// Records that a signal has stopped the work, before a summary is written.
    pub(super) fn mark_interrupted(&self) {
        if let Some(directory) = &self.directory {
            directory.mark_interrupted();
        }
    }

    /// Records the run as finished or interrupted. This happens before all printing, because the program that reads the output
    /// may end early.
    pub(super) fn finish(&self) -> Result<(), Stop> {
        // A signal that arrives from here on does not interrupt the run.
        interrupt::stops_by_itself();
        match &self.directory {
            Some(directory) => directory.finish().map_err(Stop::unwritten),
            None => Ok(()),
        }
    }

    /// Records an unfinished run that a later run continues.
    pub(super) fn leave_unfinished(&self) -> Result<(), Stop> {
        match &self.directory {
            Some(directory) => directory.leave_unfinished().map_err(Stop::unwritten),
            None => Ok(()),
        }
    }

    /// Prints the paths of the results, and in formats for programs the tables.
    pub(super) fn print_files(&self, files: &[&str]) -> Result<(), Stop> {
        if !self.is_text() {
            let text = self.tables.borrow().render(self.format, terminal::width());
            match self.directory {
                Some(_) => io::stdout().write_all(text.as_bytes())?,
                None => terminal::eprint(&text),
            }
        }
        let Some(directory) = &self.directory else {
            return Ok(());
        };
        let mut text = format!("\n{}: {}\n", directory.path().display(), files.join(", "));
        if let Some((plots, names)) = &*self.pictures.borrow() {
            text += &format!("{}: {}\n", plots.display(), names.join(", "));
        }
        text += &in_words(&directory.removed());
        self.say(&text)
    }

    /// Records the pictures of the run, for the list of its files.
    pub(super) fn list_pictures(&self, plots: &Path, names: Vec<String>) {
        *self.pictures.borrow_mut() = Some((plots.to_owned(), names));
    }
}

/// Sentence that lists the removed files of an earlier run, and the options that write them again. Empty without
/// removed files.
fn in_words(removed: &[String]) -> String {
    if removed.is_empty() {
        return String::new();
    }
    let has = |ends: &[&str]| {
        removed
            .iter()
            .any(|name| ends.iter().any(|end| name.ends_with(end)))
    };
    let pages = has(&[".html"]).then_some("--report writes the page again");
    let pictures = has(&[".svg", ".png"]).then_some("--plots writes pictures again");
    let again = pages.into_iter().chain(pictures);
    let again: String = again.map(|option| format!("; {option}")).collect();
    let names = removed.join(", ");
    format!("Removed files of an earlier run: {names}{again}.\n")
}

/// Study that a run keeps in its directory. After a tuning it is the tuned study. `None` if the directory has no study.
pub(super) fn kept_study(directory: &Path, overrides: &[String]) -> Result<Option<Study>, Stop> {
    let kept = ["optimised.toml", STUDY_COPY].map(|name| directory.join(name));
    let kept = kept.iter().find(|file| file.is_file());
    Ok(kept
        .map(|file| Study::read_elastic(file, overrides))
        .transpose()?)
}

/// True if the curves of a directory belong to a set-up. The study in the directory is the one before the adjustments.
pub(super) fn is_set_up(directory: &Path) -> bool {
    let manifest = Manifest::read(directory).unwrap_or_default();
    let author = ["curves.csv", "setup.csv"]
        .into_iter()
        .find_map(|name| manifest.author(name));
    author.is_some_and(|run| run.command == "setup")
}

/// Says where earlier results are now, if the run has moved them aside.
pub(super) fn say_set_aside(path: &Path, directory: &RunDirectory) {
    if let Some(place) = directory.set_aside() {
        terminal::note(&format!(
            "The results that were in {} are now in {}.\n",
            path.display(),
            place.display()
        ));
    }
}

/// All files that a run reads.
pub(super) fn inputs(study: &Study, path: &Path) -> Vec<PathBuf> {
    let mut inputs = study.inputs.clone();
    inputs.push(path.to_owned());
    inputs
}

/// Thread pool of a run with this number of pieces of work. It has at most one thread per core and per piece, because more
/// threads would only use memory. If more threads were requested, the function prints the smaller number.
pub(super) fn pool(asked: Option<NonZeroUsize>, pieces: u64) -> Result<rayon::ThreadPool, Stop> {
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let useful = cores
        .min(usize::try_from(pieces).unwrap_or(usize::MAX))
        .max(1);
    let threads = asked.map_or(useful, |asked| asked.get().min(useful));
    if let Some(asked) = asked.filter(|asked| asked.get() > threads) {
        terminal::note(&format!(
            "Only {threads} of the {asked} requested threads are used: there are {} and {} of work.\n",
            counted(cores, "core"),
            counted(pieces, "piece")
        ));
    }
    crate::threads::pool(threads)
        .map_err(|e| Stop::wrong_input(format!("cannot start {threads} threads: {e}")))
}

/// Reports a design that cannot be solved as an error of the study.
pub(super) fn design_fault(study: &Study, path: &Path, fault: &DesignFault) -> Stop {
    Stop::in_file(path, fault.describe(&study.wheel().mechanism))
}
