//! `hardpoint report`, and the options `--report` and `--plots` of other commands.

use super::exit::{Exit, Stop};
use super::output::{Destination, Output};
use super::{ReportArguments, RunArguments};
use crate::report::{
    FinishedRun, Picture, Record, Run, SweepRun, car_page, page, picture_names, pictures,
    sweep_page,
};
use crate::results::{Claim, Manifest, Refusal, RunDirectory};
use crate::study::Study;
use std::io::Write;
use std::path::{Path, PathBuf};

pub(super) fn run(arguments: &ReportArguments) -> Result<Exit, Stop> {
    let run = FinishedRun::read(&arguments.run).map_err(Stop::wrong_input)?;
    if arguments.plots.is_some() && matches!(run, FinishedRun::Car(_)) {
        return Err(Stop::wrong_input(format!(
            "--plots makes pictures of curves, but {} is a run of a car; its page has pictures",
            arguments.run.display()
        )));
    }
    if arguments.plots.is_some() && matches!(run, FinishedRun::Sweep(_)) {
        return Err(Stop::wrong_input(format!(
            "--plots makes pictures of curves, but {} is a sweep; each plot of its page has a \
             button that saves it as SVG",
            arguments.run.display()
        )));
    }
    if let (Some(plots), FinishedRun::Curves(run)) = (&arguments.plots, &run) {
        check_pictures(plots, &picture_names(&run.record), arguments.force)?;
    }
    let directory = RunDirectory::reopen(&arguments.run, &["report.html"], arguments.force);
    let directory = directory.map_err(Stop::wrong_input)?;
    let html = match &run {
        FinishedRun::Curves(run) => page(run),
        FinishedRun::Sweep(sweep) => sweep_page(sweep),
        FinishedRun::Car(car) => car_page(car),
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

/// Options for pages and pictures of a run.
pub(super) struct ReportOptions {
    page: bool,
    plots: Option<PathBuf>,
    force: bool,
}

impl ReportOptions {
    /// Checks before the run that the pictures can be written. `record` describes their curves.
    pub(super) fn open(
        arguments: &RunArguments,
        study: &Study,
        record: impl FnOnce() -> Result<Record, String>,
    ) -> Result<Self, Stop> {
        let plots = arguments.plots.as_deref();
        let to_stdout = arguments.out.as_deref() == Some(Path::new("-"));
        if to_stdout && (arguments.report || plots.is_some()) {
            return Err(Stop::wrong_input(
                "--report and --plots need a directory and do not work with --out -",
            ));
        }
        if let Some(plots) = plots {
            let record = record().map_err(|why| Stop::in_file(&arguments.study.study, why))?;
            let mut names = picture_names(&record);
            let (out, format) = (arguments.out.as_deref(), arguments.study.format);
            let results = Destination::of(out, &study.name, arguments.force, format)?;
            if is_same(plots, results.path()) {
                // In the run's own directory, the pictures of a run belong to its results.
                let drawn = Manifest::read(plots).unwrap_or_default();
                names.retain(|name| drawn.author(name).is_none());
            }
            check_pictures(plots, &names, arguments.force)?;
        }
        Ok(ReportOptions {
            page: arguments.report,
            plots: arguments.plots.clone(),
            force: arguments.force,
        })
    }

    /// Reads the finished run and makes its page and pictures. Returns the page's file, if any; the output lists the pictures.
    pub(super) fn show(&self, output: &Output) -> Result<Vec<&'static str>, Stop> {
        let mut files = Vec::new();
        let Some(directory) = output.directory() else {
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
            let names = if is_same(plots, directory.path()) {
                write_all(pictures(&run), directory)?
            } else {
                write_pictures(&run, plots, self.force)?
            };
            output.list_pictures(plots, names);
        }
        Ok(files)
    }
}

/// Reads the directory of a sweep and makes its page.
pub(super) fn show_sweep(directory: &RunDirectory) -> Result<(), Stop> {
    let sweep = SweepRun::read(directory.path()).map_err(Stop::wrong_input)?;
    write_page(&sweep_page(&sweep), directory)
}

fn write_page(page: &str, directory: &RunDirectory) -> Result<(), Stop> {
    let written = directory.write("report.html", page.as_bytes());
    written.map_err(Stop::unwritten)
}

/// Claims the directory of the pictures.
fn claim_of_pictures<'a>(names: &'a [&'a str], force: bool) -> Claim<'a> {
    Claim {
        command: "report --plots",
        study: "",
        digest: String::new(),
        files: names,
        force,
        ..Claim::default()
    }
}

fn no_place_for_pictures(refusal: Refusal) -> Stop {
    Stop::wrong_input(refusal.with_option("--plots"))
}

/// Refuses pictures that could not be written.
fn check_pictures(plots: &Path, names: &[String], force: bool) -> Result<(), Stop> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    RunDirectory::check(plots, &claim_of_pictures(&names, force)).map_err(no_place_for_pictures)
}

/// True if two paths lead to the same directory.
fn is_same(one: &Path, other: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    one == other || (real(one).is_some() && real(one) == real(other))
}

/// Writes the pictures of a run. It may replace pictures of other runs, because they can be made again, but it replaces no other
/// files.
fn write_pictures(run: &Run, plots: &Path, force: bool) -> Result<Vec<String>, Stop> {
    let pictures = pictures(run);
    let names: Vec<&str> = pictures.iter().map(|p| p.name.as_str()).collect();
    let claim = claim_of_pictures(&names, force);
    let directory = RunDirectory::claim(plots, &claim).map_err(no_place_for_pictures)?;
    write_all(pictures, &directory)
}

/// Writes pictures and returns their names.
fn write_all(pictures: Vec<Picture>, directory: &RunDirectory) -> Result<Vec<String>, Stop> {
    let written = pictures.into_iter().map(|picture| {
        let written = directory.write(&picture.name, &picture.contents);
        written.map_err(Stop::unwritten)?;
        Ok(picture.name)
    });
    written.collect()
}
