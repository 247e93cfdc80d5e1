//! `hardpoint report`, and `--report` and `--plots` of the commands that run something.

use super::exit::{Exit, Stop};
use super::{ReportArguments, RunArguments};
use crate::report::{Run, RunDirectory, page, pictures};
use std::io::Write;
use std::path::Path;

pub(super) fn run(arguments: &ReportArguments) -> Result<Exit, Stop> {
    let run = Run::read(&arguments.run).map_err(Stop::wrong_input)?;
    let directory = RunDirectory::create(&arguments.run).map_err(Stop::wrong_input)?;
    let plots = arguments.plots.as_deref().map(RunDirectory::create);
    let plots = plots.transpose().map_err(Stop::wrong_input)?;
    write_page(&run, &directory)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", arguments.run.join("report.html").display())?;
    if let Some(plots) = plots {
        let names = write_pictures(&run, &plots)?;
        writeln!(out, "{}: {}", plots.path().display(), names.join(", "))?;
    }
    Ok(Exit::Done)
}

/// What a run is asked to show besides its results.
pub(super) struct Wanted {
    page: bool,
    plots: Option<RunDirectory>,
}

impl Wanted {
    /// Finds out whether it can be written, before anything is computed.
    pub(super) fn open(arguments: &RunArguments) -> Result<Self, Stop> {
        let plots = arguments.plots.as_deref();
        let to_stdout = arguments.out.as_deref() == Some(Path::new("-"));
        if to_stdout && (arguments.report || plots.is_some()) {
            return Err(Stop::wrong_input(
                "--report and --plots are made of a run's directory; with --out - there is none",
            ));
        }
        let plots = plots.map(RunDirectory::create).transpose();
        Ok(Wanted {
            page: arguments.report,
            plots: plots.map_err(Stop::wrong_input)?,
        })
    }

    /// Reads the finished run back and shows it. Returns the files written into the run's directory.
    pub(super) fn show(&self, directory: Option<&RunDirectory>) -> Result<Vec<&'static str>, Stop> {
        let mut files = Vec::new();
        let Some(directory) = directory.filter(|_| self.page || self.plots.is_some()) else {
            return Ok(files);
        };
        let run = Run::read(directory.path()).map_err(Stop::wrong_input)?;
        if self.page {
            write_page(&run, directory)?;
            files.push("report.html");
        }
        if let Some(plots) = &self.plots {
            write_pictures(&run, plots)?;
        }
        Ok(files)
    }
}

fn write_page(run: &Run, directory: &RunDirectory) -> Result<(), Stop> {
    let page = page(run);
    let written = directory.write("report.html", page.as_bytes());
    written.map_err(Stop::unwritten)
}

fn write_pictures(run: &Run, directory: &RunDirectory) -> Result<Vec<String>, Stop> {
    let mut names = Vec::new();
    for picture in pictures(run) {
        let written = directory.write(&picture.name, picture.svg.as_bytes());
        written.map_err(Stop::unwritten)?;
        names.push(picture.name);
    }
    Ok(names)
}
