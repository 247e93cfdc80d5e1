//! `hardpoint merge`

use super::MergeArguments;
use super::exit::{Exit, Stop};
use super::output::Output;
use super::progress;
use super::sweep::{finish, not_this};
use crate::report::{MergeError, Parts};
use std::path::Path;

pub(super) fn run(arguments: &MergeArguments) -> Result<Exit, Stop> {
    if arguments.out == Path::new("-") {
        return Err(Stop::wrong_input("merge writes to a directory, not to -"));
    }
    let parts = Parts::read(&arguments.parts).map_err(not_this)?;
    let resolved = |path: &Path| path.canonicalize().ok();
    let target = resolved(&arguments.out);
    if parts
        .directories()
        .any(|part| target.is_some() && resolved(part) == target)
    {
        return Err(Stop::wrong_input(format!(
            "{} is one of the shards; expected another directory for the result",
            arguments.out.display()
        )));
    }
    // Read through first: nothing is written unless every shard is whole.
    let line = progress::line(parts.record.designs, "designs");
    let tally = parts.tally(|designs| line.inc(designs));
    line.finish_and_clear();
    let tally = tally.map_err(not_this)?;
    let output = Output::at(&arguments.out, arguments.format.into(), "sweep")?;
    if let Some(directory) = output.directory() {
        parts.join(directory).map_err(|error| match error {
            MergeError::Parts(error) => not_this(error),
            MergeError::Unwritten(error) => Stop::unwritten(error),
        })?;
    }
    finish(&output, &parts.record, &tally, false)
}
