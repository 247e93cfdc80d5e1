//! `hardpoint merge`: joins the parts of a sweep from several directories.

use super::MergeArguments;
use super::car;
use super::exit::{Exit, Stop};
use super::output::{Destination, Output, STUDY_COPY};
use super::progress;
use super::sweep::{draw, finish, not_this};
use crate::report::{MergeError, Parts, SweepDirectory};
use crate::results::Claim;
use crate::study::{CarStudy, Study};
use crate::sweep::SweepPlan;
use std::path::{Path, PathBuf};

pub(super) fn run(arguments: &MergeArguments) -> Result<Exit, Stop> {
    if arguments.out == Path::new("-") {
        return Err(Stop::wrong_input("merge writes to a directory, not to -"));
    }
    // No file is written unless every part is complete.
    let parts = Parts::read(&arguments.parts).map_err(not_this)?;
    let resolved = |path: &Path| path.canonicalize().ok();
    let target = resolved(&arguments.out);
    if parts
        .directories()
        .any(|part| target.is_some() && resolved(part) == target)
    {
        return Err(Stop::wrong_input(format!(
            "{} holds parts of the sweep; expected another directory for the result",
            arguments.out.display()
        )));
    }
    let record = &parts.record;
    let kept = parts
        .directories()
        .find_map(|part| Kept::read(part, &record.study));
    let files = SweepDirectory::files(record);
    let mut files: Vec<&str> = files.iter().map(String::as_str).collect();
    files.extend(kept.as_ref().map_or(&[][..], Kept::names));
    let (out, format) = (Some(arguments.out.as_path()), arguments.format);
    let destination = Destination::of(out, &record.study, arguments.force, format)?;
    let claim = Claim {
        command: "merge",
        study: &record.study,
        digest: record.run_digest(),
        files: &files,
        ..Claim::default()
    };
    let output = Output::at(&destination, claim)?;
    match &kept {
        Some(Kept::Suspension(_, study)) => output.keep_study(study)?,
        Some(Kept::Car(study)) => {
            car::keep(&output, study)?;
        }
        None => {}
    }
    if let Some(directory) = output.directory() {
        let line = progress::line(record.designs, "designs");
        let joined = parts.join(directory, |designs| line.inc(designs));
        line.finish_and_clear();
        joined.map_err(|error| match error {
            MergeError::Parts(error) => not_this(error),
            MergeError::Unwritten(error) => Stop::unwritten(error),
        })?;
    }
    if let Some(Kept::Suspension(path, study)) = &kept {
        draw_again(&output, study, &parts, path)?;
    }
    finish(&output, record, &parts.statistics, false)
}

/// Study that is kept in the directories with the parts of a sweep.
enum Kept {
    /// Study of a wheel or an axle, and its path.
    Suspension(PathBuf, Box<Study>),
    /// Study of a car. It contains the studies of both axles.
    Car(Box<CarStudy>),
}

impl Kept {
    /// Reads the study that is kept in a directory with parts of a sweep. `None` if it cannot be read. The study of a wheel or an
    /// axle gets the name `name` instead of the name of its copy.
    fn read(directory: &Path, name: &str) -> Option<Self> {
        let path = directory.join(STUDY_COPY);
        if CarStudy::is_at(&path) {
            let study = CarStudy::read(&path, &[]).ok()?;
            return Some(Kept::Car(Box::new(study)));
        }
        let mut study = Study::read_elastic(&path, &[]).ok()?;
        name.clone_into(&mut study.name);
        Some(Kept::Suspension(path, Box::new(study)))
    }

    /// File names of the copies of the study in the directory of the results.
    fn names(&self) -> &'static [&'static str] {
        match self {
            Kept::Suspension(..) => &[STUDY_COPY],
            Kept::Car(_) => &car::KEPT_NAMES,
        }
    }
}

/// Solves the designs that the report page shows, because the best designs of all parts become known only after the merge. If
/// the study does not belong to these results, writes nothing, and the page shows no curves of designs.
fn draw_again(output: &Output, study: &Study, parts: &Parts, path: &Path) -> Result<(), Stop> {
    let Some(Ok(plan)) = study
        .sweep
        .as_ref()
        .map(|sweep| SweepPlan::of(study, sweep))
    else {
        return Ok(());
    };
    if plan.record.digest != parts.record.digest {
        return Ok(());
    }
    draw(output, study, &plan, &parts.statistics, path)
}
