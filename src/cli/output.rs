//! Where a run's results go: a directory with a summary on standard output, or the main CSV on
//! standard output with everything else on standard error.

use super::RunArguments;
use super::exit::Stop;
use super::terminal;
use crate::mechanism::DesignFault;
use crate::report::{Format, RunDirectory, Table, Tables};
use crate::study::Study;
use std::cell::RefCell;
use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

pub(super) struct Output {
    directory: Option<RunDirectory>,
    format: Format,
    /// What is printed at the end, where programs read it.
    tables: RefCell<Tables>,
}

impl Output {
    /// Opens the output of a command, so that a place that cannot be written is known before the work is
    /// done.
    pub(super) fn open(
        arguments: &RunArguments,
        study: &Study,
        command: &str,
    ) -> Result<Self, Stop> {
        let default = PathBuf::from("out").join(&study.name);
        let format = arguments.study.format.into();
        Output::at(
            arguments.out.as_deref().unwrap_or(&default),
            format,
            command,
        )
    }

    /// Opens a directory, or standard output for `-`.
    pub(super) fn at(path: &Path, format: Format, command: &str) -> Result<Self, Stop> {
        let path = Some(path).filter(|path| *path != Path::new("-"));
        let directory = path.map(|path| RunDirectory::claim(path, command));
        let directory = directory.transpose();
        Ok(Output {
            directory: directory.map_err(Stop::wrong_input)?,
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
        match self.directory.is_some() && self.is_text() {
            true => terminal::print(text)?,
            false => terminal::note(text),
        }
        Ok(())
    }

    /// Says what was asked for and could not be had: an error, also where quiet was asked for.
    pub(super) fn say_failure(&self, text: &str) -> Result<(), Stop> {
        match terminal::is_quiet() {
            true => terminal::eprint(text.trim_start_matches('\n')),
            false => self.say(text)?,
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

/// The rayon pool of a run.
pub(super) fn pool(threads: Option<NonZeroUsize>) -> Result<rayon::ThreadPool, Stop> {
    let threads = threads.map_or(0, NonZeroUsize::get);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Stop::wrong_input(format!("cannot start {threads} threads: {e}")))
}

/// A design that cannot be solved is a mistake of the study.
pub(super) fn design_fault(study: &Study, path: &Path, fault: &DesignFault) -> Stop {
    Stop::wrong_input(format!(
        "{}: {}",
        path.display(),
        fault.describe(&study.suspension.mechanism)
    ))
}
