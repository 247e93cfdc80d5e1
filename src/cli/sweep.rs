//! `hardpoint sweep`: solves a batch of designs, which is divided into numbered parts.

mod finish;

use super::SweepArguments;
use super::exit::{Exit, Stop};
use super::output::{Destination, Output, STUDY_COPY, design_fault, inputs, pool};
use super::report::show_sweep;
use super::terminal;
use super::{interrupt, progress};
use crate::report::{
    DrawnDesigns, MergeError, NotARun, PartOutcome, SweepDirectory, SweepSummary, SweepText,
    TableFile, counted, rows_header, write_part,
};
use crate::results::{Claim, Sharing, WriteError};
use crate::study::{CarStudy, FileFormat, Order, Study, Vehicle};
use crate::sweep::{NotBegun, SweepPlan, SweepRecord, SweepStatistics, Swept, in_order};
use std::io::{ErrorKind, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

pub(super) use finish::finish;
use finish::finish_shard;

/// Interval between two checks of a part of the sweep that another process is computing.
const WAIT: Duration = Duration::from_millis(200);

/// A sweep that is ready to run.
pub(super) struct Ready<'s> {
    /// Sweep to be computed.
    pub swept: Swept<'s>,
    /// Formatter of the results as text.
    pub text: SweepText,
    /// Files that the command has read: the study, and files that it names.
    pub inputs: Vec<PathBuf>,
    /// Names of the copies of studies that are kept with the results.
    pub kept_names: &'s [&'static str],
    /// Returns the texts of the copies of studies. The argument is the directory of the results, which must exist.
    pub kept: &'s dyn Fn(&Path) -> Vec<String>,
    /// Writes the data of the designs that the report page shows, at the end of the sweep.
    pub draw: &'s dyn Fn(&Output, &SweepStatistics) -> Result<(), Stop>,
}

pub(super) fn run(arguments: &SweepArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    if CarStudy::is_at(path) {
        return super::car::sweep(arguments);
    }
    run_study(arguments, &Study::read_elastic(path, &arguments.study.set)?)
}

/// Runs the sweep of a study. The path in the arguments names the study in messages.
pub(super) fn run_study(arguments: &SweepArguments, study: &Study) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let Some(sweep) = &study.sweep else {
        let what = "the designs to solve";
        return Err(Stop::no_section(path, "sweep", what));
    };
    let plan = SweepPlan::of(study, sweep).map_err(|reason| match reason {
        NotBegun::Designs(errors) => errors.into(),
        NotBegun::Fault(fault) => design_fault(study, path, &fault),
        NotBegun::Columns(fault) => Stop::in_file(path, fault),
    })?;
    if let Some(number) = arguments.design {
        return print_design(study, &plan, number);
    }
    let to_stdout = is_to_stdout(arguments, sweep.format)?;
    let left_out = left_out(study);
    let before = || {
        if !left_out.is_empty() {
            terminal::note(&format!(
                "A sweep ignores {} of [outputs]: it only stores values, and derivatives in the design \
                 position. To compute the rest for a design, print its study with `--design N` and use \
                 `hardpoint solve`.\n",
                left_out.join(", ")
            ));
        }
        if plan.has_other_numbers() {
            terminal::note(
                "The results number the designs from 0, in the order of the file. The column `design` of the file is not read.\n",
            );
        }
        if study.optimise.as_ref().is_some_and(|o| o.scatter.is_some()) {
            terminal::note(
                "The sweep compares nominal designs with the targets, without the builds of optimise.scatter.\n",
            );
        }
        let results = plan.results_in_designs();
        if results > 0 {
            let columns = counted(results as u64, "column");
            terminal::note(&format!(
                "The file of designs is a result of a sweep. Its {columns} with results are not read.\n"
            ));
        }
        if let Some(why) = super::check::one_by_one(&plan) {
            terminal::note(&format!("{why}\n"));
        }
    };
    let ready = Ready {
        swept: Swept::Suspension(&plan),
        text: SweepText::of(&plan, study, !to_stdout),
        inputs: inputs(study, path),
        kept_names: &[STUDY_COPY],
        kept: &|directory| vec![study.text_in(directory)],
        draw: &|output, statistics| draw(output, study, &plan, statistics, path),
    };
    carry_out(arguments, &ready, before)
}

/// Returns true if the designs go to standard output. In this case, refuses options that need a directory.
pub(super) fn is_to_stdout(arguments: &SweepArguments, format: FileFormat) -> Result<bool, Stop> {
    let to_stdout = arguments.out.as_deref() == Some(Path::new("-"));
    if to_stdout {
        needs_no_directory(arguments, format)?;
    }
    Ok(to_stdout)
}

/// Runs a sweep. Calls `note`, which prints remarks, after the run has claimed its output directory.
pub(super) fn carry_out(
    arguments: &SweepArguments,
    ready: &Ready<'_>,
    note: impl FnOnce(),
) -> Result<Exit, Stop> {
    let (swept, text) = (ready.swept, &ready.text);
    let record = swept.record();
    let pool = pool(arguments.threads, record.blocks())?;
    let output = open(arguments, ready)?;
    note();
    let Some(claimed) = output.directory() else {
        let statistics = pool
            .install(|| to_standard_output(swept, text))
            .map_err(unwritten)?;
        return finish(&output, record, &statistics, false);
    };
    // Several shards share a directory, so a shard never discards finished parts, even with `--force`.
    let anew = arguments.force && !arguments.resume && arguments.shard.is_none();
    let directory = SweepDirectory::prepare(claimed, record, anew).map_err(Stop::unwritten)?;
    directory.renew_statistics().map_err(|error| match error {
        MergeError::Parts(error) => not_this(error),
        MergeError::Unwritten(error) => Stop::unwritten(error),
    })?;
    let parts = match arguments.shard {
        None => 0..record.parts(),
        Some(shard) => {
            claimed.share().map_err(Stop::unwritten)?;
            record.parts_of(shard)
        }
    };
    for part in parts.clone() {
        directory.verify(part).map_err(not_this)?;
    }
    let missing = directory.done().map_err(not_this)?.missing;
    if !missing.is_empty() {
        // These files summarise earlier results. They would contradict the parts that are computed now, so they are
        // removed.
        for name in [
            "summary.json",
            "pareto.csv",
            "shown_designs.json",
            "report.html",
        ] {
            claimed.remove(name).map_err(Stop::unwritten)?;
        }
    }
    let own_are_whole = pool
        .install(|| sweep_parts(swept, text, &directory, parts.clone()))
        .map_err(unwritten)?;
    let done = directory.done();
    let done = done.map_err(|error| not_this(error).after_its_input())?;
    let interrupted = !own_are_whole && interrupt::is_raised();
    if interrupted {
        claimed.mark_interrupted();
    }
    if let Some(shard) = arguments.shard
        && !done.missing.is_empty()
    {
        output.leave_unfinished()?;
        let exit = finish_shard(&output, record, shard, parts, &done.missing)?;
        return Ok(if interrupted { Exit::Interrupted } else { exit });
    }
    if interrupted {
        finish(&output, record, &done.statistics, false)?;
        return Ok(Exit::Interrupted);
    }
    (ready.draw)(&output, &done.statistics)?;
    let exit = finish(&output, record, &done.statistics, arguments.report)?;
    // For a shard, the exit code states whether its own parts are complete. Workflow engines treat every code but 0 as a failure.
    Ok(if arguments.shard.is_some() && own_are_whole {
        Exit::Done
    } else {
        exit
    })
}

/// Refuses options that need a directory if the output is not a directory.
fn needs_no_directory(arguments: &SweepArguments, format: FileFormat) -> Result<(), Stop> {
    let refused = [
        (
            arguments.resume,
            "--resume continues a sweep in a directory and does not work with --out -",
        ),
        (
            arguments.report,
            "--report needs a directory and does not work with --out -",
        ),
        (
            arguments.shard.is_some(),
            "--shard needs a directory and does not work with --out -",
        ),
        (
            format == FileFormat::Parquet,
            "Parquet is written to a directory; --out - needs format = \"csv\" in [sweep]",
        ),
    ];
    match refused.iter().find(|(asked, _)| *asked) {
        Some((_, message)) => Err(Stop::wrong_input(message)),
        None => Ok(()),
    }
}

/// Claims the directory of a sweep.
fn open(arguments: &SweepArguments, ready: &Ready<'_>) -> Result<Output, Stop> {
    let record = ready.swept.record();
    let (out, format) = (arguments.out.as_deref(), arguments.study.format);
    let destination = Destination::of(out, &record.study, arguments.force, format)?;
    let keeps_study = destination.keeps_study(&ready.inputs);
    let kept_names = if keeps_study { ready.kept_names } else { &[] };
    let mut files = SweepDirectory::files(record);
    files.extend(arguments.report.then(|| "report.html".to_owned()));
    let mut files: Vec<&str> = files.iter().map(String::as_str).collect();
    files.extend(kept_names);
    let there = if arguments.resume {
        SweepDirectory::read(destination.path()).ok()
    } else {
        None
    };
    if let Some(there) = there.as_ref().filter(|_| !arguments.force) {
        refuse_other_hypercube(&there.record, record, destination.path())?;
    }
    let smaller = there.filter(|there| record.continues(&there.record));
    let claim = Claim {
        command: "sweep",
        study: &record.study,
        digest: record.run_digest(),
        former: smaller.map(|smaller| smaller.record.run_digest()),
        files: &files,
        inputs: &ready.inputs,
        resume: arguments.resume || arguments.shard.is_some(),
        sharing: match arguments.shard {
            None => Sharing::Alone,
            Some(_) => Sharing::Together,
        },
        ..Claim::default()
    };
    let output = Output::at(&destination, claim)?;
    // The texts name other files relative to the directory of the results. So they are made after this directory exists.
    let texts = if keeps_study {
        (ready.kept)(destination.path())
    } else {
        Vec::new()
    };
    for (name, text) in kept_names.iter().zip(texts) {
        output.file(name, text.as_bytes())?;
    }
    Ok(output)
}

/// Refuses to continue a Latin hypercube with another number of designs. `there` describes the sweep in the directory `path`.
fn refuse_other_hypercube(
    there: &SweepRecord,
    record: &SweepRecord,
    path: &Path,
) -> Result<(), Stop> {
    let same = SweepRecord {
        designs: record.designs,
        digest: record.digest.clone(),
        ..there.clone()
    };
    if record.method != "latin_hypercube" || there.designs == record.designs || same != *record {
        return Ok(());
    }
    Err(Stop::wrong_input(format!(
        "{} has a Latin hypercube of {} designs, but the study has one of {}. All its designs depend on their \
         number, so --resume cannot extend it: give another directory with --out, or replace it with --force. \
         method = \"sobol\" can be extended",
        path.display(),
        there.designs,
        record.designs
    )))
}

/// Writes the curves and the mechanism of the designs that the report page shows. Writes nothing for an axle, for standard output,
/// and before the first design is finished.
pub(super) fn draw(
    output: &Output,
    study: &Study,
    plan: &SweepPlan,
    statistics: &SweepStatistics,
    path: &Path,
) -> Result<(), Stop> {
    // The page of an axle shows no mechanism.
    let Vehicle::Wheel(own) = &study.vehicle else {
        return Ok(());
    };
    if output.directory().is_none() || statistics.designs == 0 {
        return Ok(());
    }
    let summary = SweepSummary::of(&plan.record, statistics);
    let drawn = DrawnDesigns::of(study, own, plan, &summary);
    output.record(
        "shown_designs.json",
        &drawn.map_err(|fault| design_fault(study, path, &fault).after_its_input())?,
    )
}

/// Keys of the requested outputs that a sweep does not compute.
fn left_out(study: &Study) -> Vec<&'static str> {
    let asked: Vec<(&'static str, bool)> = match &study.vehicle {
        // A sweep computes points, so points are not in the list of omitted outputs.
        Vehicle::Wheel(own) => vec![
            ("order", own.outputs.order != Order::Position),
            ("sensitivities", !own.outputs.sensitivities.is_empty()),
            ("certify", own.outputs.certify),
            ("loads", !own.outputs.loads.is_empty()),
            (
                "lengths, plunges, articulations and clearances",
                !own.outputs.measures.is_empty(),
            ),
        ],
        Vehicle::Axle(both) => vec![
            ("sensitivities", !both.plan.sensitivities.is_empty()),
            ("points", !both.plan.points.is_empty()),
            ("knuckle", both.plan.knuckle),
            ("certify", both.plan.certify),
            ("loads", both.plan.loads.iter().any(|on| !on.is_empty())),
        ],
    };
    asked
        .into_iter()
        .filter_map(|(key, asked)| asked.then_some(key))
        .collect()
}

/// Computes parts until all are complete or Ctrl-C stops the command. Returns true if all are complete. This process waits for
/// parts that another process computes. If the other process dies, this process computes the parts itself.
fn sweep_parts(
    swept: Swept<'_>,
    text: &SweepText,
    directory: &SweepDirectory,
    parts: Range<u64>,
) -> Result<bool, WriteError> {
    let record = swept.record();
    let designs = |parts: &[u64]| -> u64 { parts.iter().map(|p| record.designs_of_part(*p)).sum() };
    let all: Vec<u64> = parts.collect();
    let mut left: Vec<u64> = all
        .iter()
        .copied()
        .filter(|p| !directory.has_rows(*p))
        .collect();
    let line = progress::line(designs(&all), "designs");
    line.set_position(designs(&all) - designs(&left));
    line.reset_eta();
    interrupt::stops_by_itself();
    let flag = interrupt::flag();
    let result = 'rounds: loop {
        let before = left.len();
        let mut busy = Vec::new();
        for part in left {
            match write_part(swept, text, directory, part, flag, |designs| {
                line.inc(designs)
            }) {
                Ok(PartOutcome::Whole) => {}
                Ok(PartOutcome::Busy) => busy.push(part),
                Ok(PartOutcome::Interrupted) => break 'rounds Ok(false),
                Err(error) => break 'rounds Err(error),
            }
        }
        if busy.is_empty() {
            break Ok(true);
        }
        if interrupt::is_raised() {
            break Ok(false);
        }
        if busy.len() == before {
            std::thread::sleep(WAIT);
        }
        left = busy;
    };
    line.finish_and_clear();
    result
}

/// Writes the rows of all designs to standard output. The function accumulates statistics in the same way as a sweep that
/// writes parts.
fn to_standard_output(swept: Swept<'_>, text: &SweepText) -> Result<SweepStatistics, WriteError> {
    let record = swept.record();
    let line = progress::line(record.designs, "designs");
    let mut out = TableFile::standard_output(&rows_header(record))?;
    let mut all = SweepStatistics::empty(record);
    for part in 0..record.parts() {
        let mut statistics = SweepStatistics::empty(record);
        in_order(
            record.blocks_of(part),
            || swept.worker(),
            |worker, block| (!interrupt::is_raised()).then(|| text.finish(record, worker, block)),
            |finished| {
                out.append(&finished.designs)?;
                statistics.absorb(record, &finished.statistics);
                line.inc(finished.statistics.designs);
                Ok(())
            },
        )?;
        if interrupt::is_raised() {
            interrupt::end();
        }
        all.absorb(record, &statistics);
    }
    out.finish()?;
    line.finish_and_clear();
    Ok(all)
}

/// Checks that a sweep has a design with this number. The error states the number of designs in words.
pub(super) fn check_number(number: u64, record: &SweepRecord) -> Result<(), String> {
    let designs = record.designs;
    if number < designs {
        return Ok(());
    }
    Err(format!(
        "there is no design {number}; the sweep has {designs}, numbered from 0"
    ))
}

/// Prints the study with the hardpoints of one design.
fn print_design(study: &Study, plan: &SweepPlan, number: u64) -> Result<Exit, Stop> {
    check_number(number, &plan.record).map_err(Stop::wrong_input)?;
    let text = study.with_points_of(&plan.moved(number));
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(Exit::Done)
}

/// Parses the number of a shard, such as `3/8`: the third of eight shards.
pub(super) fn shard(text: &str) -> Result<[u64; 2], String> {
    let parts = text
        .split_once('/')
        .and_then(|(i, n)| Some([i.trim().parse().ok()?, n.trim().parse().ok()?]));
    match parts {
        Some([i, n]) if (1..=n).contains(&i) => Ok([i, n]),
        _ => Err("expected I/N with I from 1 to N, as in 3/8".to_owned()),
    }
}

pub(super) fn not_this(error: NotARun) -> Stop {
    Stop::wrong_input(error)
}

fn unwritten(error: WriteError) -> Stop {
    match error.source.kind() {
        ErrorKind::BrokenPipe => Stop::ClosedPipe,
        _ => Stop::unwritten(error),
    }
}
