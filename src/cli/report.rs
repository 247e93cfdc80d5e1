//! `hardpoint report`, and the options `--report` and `--plots` of other commands.

use super::exit::{Exit, Stop};
use super::output::{Destination, Output};
use super::{CurveArguments, ReportArguments, RunArguments};
use crate::report::{
    FinishedRun, Picture, Record, Run, SweepRun, car_page, page, picture_names, pictures,
    sweep_page,
};
use crate::results::{Claim, Manifest, Refusal, RunDirectory, SUMMARY, study_digest};
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
    let pictures = arguments.plots.as_ref().map(|plots| {
        let manifest = Manifest::read(&arguments.run).unwrap_or_default();
        let main = manifest.author(SUMMARY);
        let (command, study, digest) = main.map_or_else(Default::default, |main| {
            (&*main.command, &*main.study, main.digest.clone())
        });
        PictureDirectory::of(plots, command, (study, digest), arguments.force)
    });
    if let (Some(pictures), FinishedRun::Curves(run)) = (&pictures, &run) {
        pictures.check(&picture_names(&run.record))?;
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
    if let (Some(pictures), FinishedRun::Curves(run)) = (&pictures, &run) {
        let names = pictures.write(run)?;
        writeln!(out, "{}: {}", pictures.path.display(), names.join(", "))?;
    }
    Ok(Exit::Done)
}

/// Refuses a page and pictures if the results go to standard output. `plots` is the directory of the pictures, if any.
pub(super) fn refuse_without_directory(
    arguments: &RunArguments,
    plots: Option<&Path>,
) -> Result<(), Stop> {
    let options = [(arguments.report, "--report"), (plots.is_some(), "--plots")];
    let given = options.into_iter().find(|(is_given, _)| *is_given);
    match given {
        Some((_, option)) if arguments.out.as_deref() == Some(Path::new("-")) => {
            Err(Stop::wrong_input(format!(
                "{option} needs a directory and does not work with --out -"
            )))
        }
        _ => Ok(()),
    }
}

/// Options for pages and pictures of a run.
pub(super) struct ReportOptions {
    page: bool,
    pictures: Option<PictureDirectory>,
}

impl ReportOptions {
    /// Reads the options `--report` and `--plots`. Returns an error if the pictures cannot be written, before a command writes its
    /// first file. `record` describes the curves in the pictures.
    pub(super) fn open(
        arguments: &CurveArguments,
        study: &Study,
        command: &str,
        record: impl FnOnce() -> Result<Record, String>,
    ) -> Result<Self, Stop> {
        let plots = arguments.plots.as_deref();
        let arguments = &arguments.run;
        refuse_without_directory(arguments, plots)?;
        let pictures = plots.map(|plots| {
            let of = (study.name.as_str(), study_digest(study));
            PictureDirectory::of(plots, command, of, arguments.force)
        });
        if let Some(pictures) = &pictures {
            let record = record().map_err(|why| Stop::in_file(&arguments.study.study, why))?;
            let mut names = picture_names(&record);
            let (out, format) = (arguments.out.as_deref(), arguments.study.format);
            let results = Destination::of(out, &study.name, arguments.force, format)?;
            if is_same(&pictures.path, results.path()) {
                // Pictures that a run has written into its own directory count as results of the run, so they are not checked
                // here.
                let drawn = Manifest::read(&pictures.path).unwrap_or_default();
                names.retain(|name| drawn.author(name).is_none());
            }
            pictures.check(&names)?;
        }
        Ok(ReportOptions {
            page: arguments.report,
            pictures,
        })
    }

    /// Reads the finished run and makes its page and pictures. Returns the name of the page's file, if
    /// any. The output lists the pictures.
    pub(super) fn show(&self, output: &Output) -> Result<Vec<&'static str>, Stop> {
        let mut files = Vec::new();
        let Some(directory) = output.directory() else {
            return Ok(files);
        };
        if !self.page && self.pictures.is_none() {
            return Ok(files);
        }
        let run = Run::read(directory.path()).map_err(Stop::wrong_input)?;
        if self.page {
            write_page(&page(&run), directory)?;
            files.push("report.html");
        }
        if let Some(own) = &self.pictures {
            let names = if is_same(&own.path, directory.path()) {
                write_all(pictures(&run), directory)?
            } else {
                own.write(&run)?
            };
            output.list_pictures(&own.path, names);
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

/// Directory of pictures, with the run that they show. Without `--force`, new pictures replace only pictures of the same command
/// and study.
struct PictureDirectory {
    path: PathBuf,
    command: String,
    study: String,
    digest: String,
    force: bool,
}

impl PictureDirectory {
    fn of(path: &Path, command: &str, (study, digest): (&str, String), force: bool) -> Self {
        PictureDirectory {
            path: path.to_owned(),
            command: format!("{command} --plots"),
            study: study.to_owned(),
            digest,
            force,
        }
    }

    fn claim<'a>(&'a self, names: &'a [&'a str]) -> Claim<'a> {
        Claim {
            command: &self.command,
            study: &self.study,
            digest: self.digest.clone(),
            files: names,
            force: self.force,
            ..Claim::default()
        }
    }

    /// Returns an error if the pictures cannot be written.
    fn check(&self, names: &[String]) -> Result<(), Stop> {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        RunDirectory::check(&self.path, &self.claim(&names)).map_err(no_place_for_pictures)
    }

    /// Writes the pictures of a run, and removes other pictures of the same command and study.
    fn write(&self, run: &Run) -> Result<Vec<String>, Stop> {
        let pictures = pictures(run);
        let names: Vec<&str> = pictures.iter().map(|p| p.name.as_str()).collect();
        let directory = RunDirectory::claim(&self.path, &self.claim(&names));
        let directory = directory.map_err(no_place_for_pictures)?;
        let names = write_all(pictures, &directory)?;
        directory.finish().map_err(Stop::unwritten)?;
        Ok(names)
    }
}

fn no_place_for_pictures(refusal: Refusal) -> Stop {
    Stop::wrong_input(refusal.with_option("--plots"))
}

/// True if two paths lead to the same directory.
fn is_same(one: &Path, other: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    one == other || (real(one).is_some() && real(one) == real(other))
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
