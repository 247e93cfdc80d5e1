//! `hardpoint merge`

use super::MergeArguments;
use super::exit::{Exit, Stop};
use super::output::{Destination, Output, STUDY_COPY};
use super::progress;
use super::sweep::{finish, not_this};
use crate::report::{MergeError, Parts, SweepDirectory};
use crate::results::Claim;
use crate::study::Study;
use std::path::Path;

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
    // The study of the parts, if a part keeps one.
    let mut kept = parts.directories().map(|part| part.join(STUDY_COPY));
    let kept = kept.find_map(|path| Study::read_elastic(&path, &[]).ok());
    let files = SweepDirectory::files(record);
    let mut files: Vec<&str> = files.iter().map(String::as_str).collect();
    files.extend(kept.is_some().then_some(STUDY_COPY));
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
    if let Some(study) = &kept {
        output.keep_study(study)?;
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
    finish(&output, record, &parts.statistics, false)
}
