//! `hardpoint report`, and `--report` and `--plots` of the commands that run something.

use super::exit::{Exit, Stop};
use super::{ReportArguments, RunArguments};
use crate::report::{FinishedRun, Run, RunDirectory, SweepRun, page, pictures, sweep_page};
use std::io::Write;
use std::path::Path;

pub(super) fn run(arguments: &ReportArguments) -> Result<Exit, Stop> {
    let run = FinishedRun::read(&arguments.run).map_err(Stop::wrong_input)?;
    if arguments.plots.is_some() && matches!(run, FinishedRun::Sweep(_)) {
        return Err(Stop::wrong_input(format!(
            "--plots makes pictures of curves, {} is a sweep; each plot of its page has a button that \
             saves it as SVG",
            arguments.run.display()
        )));
    }
    let directory = RunDirectory::create(&arguments.run).map_err(Stop::wrong_input)?;
    let plots = arguments.plots.as_deref().map(RunDirectory::create);
    let plots = plots.transpose().map_err(Stop::wrong_input)?;
    let html = match &run {
        FinishedRun::Curves(run) => page(run),
        FinishedRun::Sweep(sweep) => sweep_page(sweep),
    };
    write_page(&html, &directory)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", arguments.run.join("report.html").display())?;
    if let (Some(plots), FinishedRun::Curves(run)) = (plots, &run) {
        let names = write_pictures(run, &plots)?;
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
        let Some(directory) = directory else {
            return Ok(files);
        };
        if !self.page {
            directory.remove("report.html").map_err(Stop::unwritten)?;
        }
        if !self.page && self.plots.is_none() {
            return Ok(files);
        }
        let run = Run::read(directory.path()).map_err(Stop::wrong_input)?;
        if self.page {
            write_page(&page(&run), directory)?;
            files.push("report.html");
        }
        if let Some(plots) = &self.plots {
            write_pictures(&run, plots)?;
        }
        Ok(files)
    }
}

/// Reads a sweep's directory back and makes its page.
pub(super) fn show_sweep(directory: &RunDirectory) -> Result<(), Stop> {
    let sweep = SweepRun::read(directory.path()).map_err(Stop::wrong_input)?;
    write_page(&sweep_page(&sweep), directory)
}

fn write_page(page: &str, directory: &RunDirectory) -> Result<(), Stop> {
    let written = directory.write("report.html", page.as_bytes());
    written.map_err(Stop::unwritten)
}

fn write_pictures(run: &Run, directory: &RunDirectory) -> Result<Vec<String>, Stop> {
    let mut names = Vec::new();
    for picture in pictures(run) {
        let written = directory.write(&picture.name, &picture.contents);
        written.map_err(Stop::unwritten)?;
        names.push(picture.name);
    }
    Ok(names)
}
