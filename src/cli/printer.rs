//! Standard output of a command that writes no files: text and tables for people, or only tables for programs.

use super::exit::Stop;
use super::terminal;
use crate::report::{Format, Table, Tables};
use std::io::{self, Write};

pub(super) struct Printer {
    format: Format,
    tables: Tables,
}

impl Printer {
    pub(super) fn new(format: impl Into<Format>) -> Self {
        Printer {
            format: format.into(),
            tables: Tables::default(),
        }
    }

    /// Prints text for people, except with `--quiet`.
    pub(super) fn say(&self, text: &str) -> Result<(), Stop> {
        if self.format == Format::Text && !terminal::is_quiet() {
            Ok(terminal::print(text)?)
        } else {
            Ok(())
        }
    }

    /// Prints a remark for people, except with `--quiet`. In formats for programs, the remark goes to standard error.
    pub(super) fn remark(&self, text: &str) -> Result<(), Stop> {
        match self.format {
            Format::Text => self.say(text)?,
            Format::Csv | Format::Json => terminal::note(text.trim_start_matches('\n')),
        }
        Ok(())
    }

    /// Prints the sentence about a request that could not be met. It is an error, so it is also printed with `--quiet`.
    pub(super) fn failure(&self, text: &str) -> Result<(), Stop> {
        if terminal::is_quiet() {
            terminal::eprint(&format!("{}\n", text.trim_matches('\n')))
        } else {
            self.remark(text)?
        }
        Ok(())
    }

    /// Prints a requested table. In formats for programs it is printed at the end.
    pub(super) fn table(&mut self, name: &'static str, table: Table) -> Result<(), Stop> {
        match self.format {
            Format::Text => terminal::print(&table.text(terminal::width()))?,
            Format::Csv | Format::Json => self.tables.push(name, table),
        }
        Ok(())
    }

    /// Prints the collected tables in formats for programs. Text output has printed them already.
    pub(super) fn finish(self) -> Result<(), Stop> {
        if self.format != Format::Text {
            let text = self.tables.render(self.format, terminal::width());
            io::stdout().write_all(text.as_bytes())?;
        }
        Ok(())
    }
}
