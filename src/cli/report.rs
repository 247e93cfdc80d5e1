//! `hardpoint report`, and `--report` and `--plots` of the commands that run something.

use super::exit::{Exit, Stop};
use super::{ReportArguments, RunArguments};
use crate::report::{FinishedRun, Run, SweepRun, page, pictures, sweep_page};
use crate::results::{Claim, RunDirectory, temporary, unwritten};
use std::io::Write;
use std::path::{Path, PathBuf};

pub(super) fn run(arguments: &ReportArguments) -> Result<Exit, Stop> {
    let run = FinishedRun::read(&arguments.run).map_err(Stop::wrong_input)?;
    if arguments.plots.is_some() && matches!(run, FinishedRun::Sweep(_)) {
        return Err(Stop::wrong_input(format!(
            "--plots makes pictures of curves, {} is a sweep; each plot of its page has a button that \
             saves it as SVG",
            arguments.run.display()
        )));
    }
    let directory = RunDirectory::reopen(&arguments.run, &["report.html"], arguments.force);
    let directory = directory.map_err(Stop::wrong_input)?;
    let html = match &run {
        FinishedRun::Curves(run) => page(run),
        FinishedRun::Sweep(sweep) => sweep_page(sweep),
    };
    write_page(&html, &directory)?;
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", arguments.run.join("report.html").display())?;
    drop(directory);
    if let (Some(plots), FinishedRun::Curves(run)) = (&arguments.plots, &run) {
        let names = write_pictures(run, plots, arguments.force)?;
        writeln!(out, "{}: {}", plots.display(), names.join(", "))?;
    }
    Ok(Exit::Done)
}

/// What a run is asked to show besides its results.
pub(super) struct ReportOptions {
    page: bool,
    plots: Option<PathBuf>,
    force: bool,
}

impl ReportOptions {
    /// Finds out whether it can be written, before anything is computed.
    pub(super) fn open(arguments: &RunArguments) -> Result<Self, Stop> {
        let plots = arguments.plots.as_deref();
        let to_stdout = arguments.out.as_deref() == Some(Path::new("-"));
        if to_stdout && (arguments.report || plots.is_some()) {
            return Err(Stop::wrong_input(
                "--report and --plots are made of a run's directory; with --out - there is none",
            ));
        }
        if let Some(plots) = plots {
            let made = std::fs::create_dir_all(plots).and_then(|()| temporary(plots));
            made.map_err(|e| Stop::wrong_input(unwritten(plots)(e)))?;
        }
        Ok(ReportOptions {
            page: arguments.report,
            plots: arguments.plots.clone(),
            force: arguments.force,
        })
    }

    /// Reads the finished run back and shows it. Returns the files written into the run's directory.
    pub(super) fn show(&self, directory: Option<&RunDirectory>) -> Result<Vec<&'static str>, Stop> {
        let mut files = Vec::new();
        let Some(directory) = directory else {
            return Ok(files);
        };
        if !self.page && self.plots.is_none() {
            return Ok(files);
        }
        let run = Run::read(directory.path()).map_err(Stop::wrong_input)?;
        if self.page {
            write_page(&page(&run), directory)?;
            files.push("report.html");
        }
        if let Some(plots) = &self.plots {
            let same = |path: &Path| path.canonicalize().ok();
            match same(plots) == same(directory.path()) {
                true => {
                    for picture in pictures(&run) {
                        let written = directory.write(&picture.name, &picture.contents);
                        written.map_err(Stop::unwritten)?;
                    }
                }
                false => {
                    write_pictures(&run, plots, self.force)?;
                }
            }
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

/// Writes pictures of a run. They are redrawn in a moment, so that those of any other run are replaced;
/// what is not a picture of ours is not.
fn write_pictures(run: &Run, plots: &Path, force: bool) -> Result<Vec<String>, Stop> {
    let pictures = pictures(run);
    let names: Vec<&str> = pictures.iter().map(|p| p.name.as_str()).collect();
    let claim = Claim {
        command: "report --plots",
        study: "",
        digest: String::new(),
        files: &names,
        force,
        ..Claim::default()
    };
    let directory = RunDirectory::claim(plots, &claim).map_err(Stop::wrong_input)?;
    for picture in &pictures {
        let written = directory.write(&picture.name, &picture.contents);
        written.map_err(Stop::unwritten)?;
    }
    Ok(pictures.into_iter().map(|picture| picture.name).collect())
}
