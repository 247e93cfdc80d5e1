//! `hardpoint sweep`

use super::SweepArguments;
use super::exit::{Exit, Stop};
use super::output::{Output, design_fault, pool};
use super::progress;
use super::report::show_sweep;
use super::terminal;
use crate::report::{NotThisSweep, SweepFiles, SweepSummary, SweepText, WriteError, pareto_csv};
use crate::study::{FileFormat, Order, Outputs, Study};
use crate::sweep::{NotBegun, SweepPlan, SweepRecord, SweepStatistics, in_order};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

pub(super) fn run(arguments: &SweepArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    let Some(sweep) = &study.sweep else {
        return Err(Stop::wrong_input(format!(
            "{}: there is no [sweep] section, which says which designs are looked at",
            path.display()
        )));
    };
    let plan = SweepPlan::of(&study, sweep, arguments.shard).map_err(|reason| match reason {
        NotBegun::Designs(errors) => errors.into(),
        NotBegun::Fault(fault) => design_fault(&study, path, &fault),
        NotBegun::TwoColumns(name) => Stop::wrong_input(format!(
            "{}: two columns of the results would be called {name}; give a variable another name",
            path.display()
        )),
    })?;
    if let Some(number) = arguments.design {
        return print_design(&study, &plan, number);
    }
    let pool = pool(arguments.threads)?;
    let out = match (&arguments.out, arguments.shard) {
        (Some(out), _) => out.clone(),
        (None, None) => PathBuf::from("out").join(&study.name),
        (None, Some([i, n])) => PathBuf::from("out")
            .join(&study.name)
            .join(format!("shard-{i}-of-{n}")),
    };
    if arguments.resume && out == Path::new("-") {
        return Err(Stop::wrong_input(
            "--resume goes on with the files of a directory; with --out - there are none",
        ));
    }
    if arguments.report && out == Path::new("-") {
        return Err(Stop::wrong_input(
            "--report is made of a run's directory; with --out - there is none",
        ));
    }
    if sweep.format == FileFormat::Parquet && out == Path::new("-") {
        return Err(Stop::wrong_input(
            "Parquet is written to a directory; --out - needs format = \"csv\" in [sweep]",
        ));
    }
    let output = Output::at(&out, arguments.study.format.into(), "sweep")?;
    let left_out = left_out(&study.outputs);
    if !left_out.is_empty() {
        terminal::note(&format!(
            "A sweep keeps values, and slopes in the design position: {} of [outputs] it leaves to \
             `hardpoint solve` (`--design N` prints the study of a design).\n",
            left_out.join(", ")
        ));
    }
    let record = &plan.record;
    let text = SweepText::of(&plan, &study, output.directory().is_some());
    let (mut files, mut tally, next) = match output.directory() {
        Some(directory) if arguments.resume => {
            SweepFiles::resume(record, &text, directory).map_err(not_this)?
        }
        directory => {
            let files = SweepFiles::begin(record, &text, directory);
            let files = files.map_err(|error| match directory {
                Some(_) => Stop::wrong_input(error),
                None => unwritten(error),
            })?;
            (files, SweepStatistics::empty(record), record.blocks().start)
        }
    };
    pool.install(|| sweep_blocks(&plan, &text, &mut files, &mut tally, next))
        .and_then(|()| files.finish())
        .map_err(unwritten)?;
    finish(&output, record, &tally, arguments.report)
}

/// What of the outputs a study asks for has no place in the results of a sweep.
fn left_out(outputs: &Outputs) -> Vec<&'static str> {
    let asked = [
        ("order", outputs.order != Order::Position),
        ("sensitivities", !outputs.sensitivities.is_empty()),
        ("certify", outputs.certify),
        ("loads", !outputs.loads.is_empty()),
    ];
    asked
        .into_iter()
        .filter_map(|(key, asked)| asked.then_some(key))
        .collect()
}

/// Does the blocks from `next` on, until the end or Ctrl-C.
fn sweep_blocks(
    plan: &SweepPlan,
    text: &SweepText,
    files: &mut SweepFiles,
    tally: &mut SweepStatistics,
    next: u64,
) -> Result<(), WriteError> {
    let record = &plan.record;
    let line = progress::line(record.own_designs(), "designs");
    line.set_position(tally.designs);
    line.reset_eta();
    let interrupt = progress::interrupt_flag();
    let done = in_order(
        next..record.blocks().end,
        || plan.worker().expect("the same design was accepted before"),
        |worker, block| {
            let go_on = !interrupt.load(Ordering::SeqCst);
            go_on.then(|| text.finish(record, worker, block))
        },
        |finished| {
            files.append(&finished)?;
            tally.absorb(record, &finished.tally);
            line.set_position(tally.designs);
            Ok(())
        },
    );
    line.finish_and_clear();
    done
}

/// Writes and says what a sweep, or all of its shards together, came to.
pub(super) fn finish(
    output: &Output,
    record: &SweepRecord,
    tally: &SweepStatistics,
    with_page: bool,
) -> Result<Exit, Stop> {
    let summary = SweepSummary::of(record, tally);
    let mut files = vec![record.file_name("designs")];
    files.extend(record.curves.then(|| record.file_name("curves")));
    if let Some(pareto) = pareto_csv(record, tally) {
        output.file("pareto.csv", &pareto)?;
        files.push("pareto.csv".to_owned());
    }
    output.json("summary.json", &summary)?;
    files.extend(["summary.json", "sweep.json"].map(str::to_owned));
    if let Some(directory) = output.directory().filter(|_| with_page) {
        show_sweep(directory)?;
        files.push("report.html".to_owned());
    }

    output.say(&format!("{}: {}\n\n", record.study, summary.headline()))?;
    let failures = summary.failures_table();
    if !(output.is_text() && failures.is_empty()) {
        output.table("not_solved", &failures)?;
        output.say("\n")?;
    }
    output.table("outputs", &summary.outputs_table())?;
    output.table_for_programs("effects", || summary.effects_table());
    let best = summary.best_table();
    if !best.is_empty() {
        output.say("\nBest by misfit, in tolerances:\n\n")?;
    }
    if !(output.is_text() && best.is_empty()) {
        output.table("best", &best)?;
    }
    if let Some(count) = summary.on_front() {
        output.say(&format!(
            "\nOn the Pareto front of {} targets: {count} designs\n",
            record.targets.len()
        ))?;
    }
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    output.print_files(&files)?;
    Ok(match summary.is_complete() {
        true => Exit::Done,
        false => Exit::Incomplete,
    })
}

/// Prints the study with the hardpoints of one design.
fn print_design(study: &Study, plan: &SweepPlan, number: u64) -> Result<Exit, Stop> {
    let designs = plan.record.designs;
    if number >= designs {
        return Err(Stop::wrong_input(format!(
            "there is no design {number}; the sweep has {designs}, numbered from 0"
        )));
    }
    let text = study.with_design(&plan.design(number));
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(Exit::Done)
}

/// `3/8`, counted from 1.
pub(super) fn shard(text: &str) -> Result<[u64; 2], String> {
    let parts = text
        .split_once('/')
        .and_then(|(i, n)| Some([i.trim().parse().ok()?, n.trim().parse().ok()?]));
    match parts {
        Some([i, n]) if (1..=n).contains(&i) => Ok([i, n]),
        _ => Err("expected a part and the number of parts, from 1/4 to 4/4".to_owned()),
    }
}

pub(super) fn not_this(error: NotThisSweep) -> Stop {
    Stop::wrong_input(error)
}

fn unwritten(error: WriteError) -> Stop {
    match error.source.kind() {
        ErrorKind::BrokenPipe => Stop::ClosedPipe,
        _ => Stop::unwritten(error),
    }
}
