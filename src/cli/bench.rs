//! `hardpoint bench`

use super::exit::{Exit, Stop};
use super::output::{Destination, Output, design_fault, inputs};
use super::terminal::width;
use super::{BenchArguments, BenchKind};
use crate::bench::accuracy::{Accuracy, Subject};
use crate::bench::effects::Effects;
use crate::bench::equilibria::Equilibria;
use crate::bench::throughput::Throughput;
use crate::bench::{Clock, Machine, Unmeasurable};
use crate::model::Topology;
use crate::report::{
    Table, accuracy_picture, accuracy_summary, accuracy_table, effects_table, equilibria_table,
    throughput_table,
};
use crate::results::{Claim, study_digest};
use crate::study::Study;
use serde::Serialize;
use std::path::Path;

/// Content of `machine.json`: conditions of the measurement.
#[derive(Serialize)]
struct Circumstances<'a> {
    benchmark: &'a str,
    study: &'a str,
    topology: &'a str,
    #[serde(flatten)]
    machine: &'a Machine,
}

pub(super) fn run(arguments: &BenchArguments) -> Result<Exit, Stop> {
    let template = Path::new("macpherson.toml");
    let path = arguments.study.as_deref().unwrap_or(template);
    let study = measured_study(arguments)?;
    let stop = |reason: Unmeasurable| match reason {
        Unmeasurable::Design(fault) => design_fault(&study, path, &fault),
        other => Stop::in_file(path, other),
    };
    let wheel = study.one_wheel();
    // These checks come before any file is written.
    match (wheel, arguments.kind) {
        (None, kind) => refuse_for_axle(kind, path)?,
        (Some(wheel), BenchKind::Equilibria) if wheel.compliance.is_none() => {
            return Err(stop(Unmeasurable::Rigid));
        }
        (Some(_), BenchKind::Equilibria) => {}
        (Some(wheel), _) => {
            Subject::of(wheel).map_err(stop)?;
        }
    }
    let name = format!("bench_{}", study.name);
    let (out, format) = (arguments.out.as_deref(), arguments.format);
    let destination = Destination::of(out, &name, arguments.force, format)?;
    let kind = match arguments.kind {
        BenchKind::Throughput => "throughput",
        BenchKind::Accuracy => "accuracy",
        BenchKind::Effects => "effects",
        BenchKind::Equilibria => "equilibria",
    };
    let names = [".csv", ".svg", "_machine.json"].map(|end| format!("{kind}{end}"));
    let [csv_name, svg_name, machine_name] = names.each_ref().map(String::as_str);
    let mut files = vec![csv_name, machine_name];
    if arguments.kind == BenchKind::Accuracy {
        files.insert(1, svg_name);
    }
    let claim = Claim {
        command: &format!("bench {kind}"),
        study: &study.name,
        digest: study_digest(&study),
        files: &files,
        inputs: &inputs(&study, path),
        ..Claim::default()
    };
    let output = Output::at(&destination, claim)?;
    let clock = Clock {
        samples: arguments.samples,
        ..Clock::default()
    };
    let machine = Machine::here(&clock);
    output.say(&format!("{}: {}\n\n", study.name, machine.line()))?;

    let threads = arguments.threads.unwrap_or(machine.cores);
    let measured = measure(&study, arguments.kind, threads, &clock, &machine).map_err(stop)?;
    let (table, picture) = measured;
    output.main_csv(csv_name, table.csv(None).as_bytes())?;
    if let Some((svg, _)) = &picture {
        output.file(svg_name, svg.as_bytes())?;
    }
    let circumstances = Circumstances {
        benchmark: kind,
        study: &study.name,
        topology: study.wheel().mechanism.topology.name,
        machine: &machine,
    };
    output.json(machine_name, &circumstances)?;
    output.finish()?;
    if output.directory().is_some() {
        match &picture {
            // The full table has about a hundred rows, so people get the brief one.
            Some((_, brief)) => {
                output.table_for_programs(kind, || table.clone());
                output.text_only(&brief.text(width()))?;
                output.text_only("\n")?;
            }
            None => output.table(kind, &table)?,
        }
    }
    // With standard output as target, the table is already printed as the main CSV.
    output.print_files(&files)?;
    Ok(Exit::Done)
}

/// Study that the call names, or the template of a strut.
fn measured_study(arguments: &BenchArguments) -> Result<Study, Stop> {
    Ok(match &arguments.study {
        Some(path) if arguments.kind == BenchKind::Equilibria => {
            Study::read_elastic(path, &arguments.set)?
        }
        Some(path) => Study::read(path, &arguments.set)?,
        None => {
            let strut = Topology::named("macpherson").expect("it is in the catalogue");
            Study::from_text("macpherson.toml", strut.template, Path::new(""))?
        }
    })
}

/// SVG picture of measurements, with a short table.
type Picture = (String, Table);

/// Table of the measurements. Accuracy also has a picture.
fn measure(
    study: &Study,
    kind: BenchKind,
    threads: usize,
    clock: &Clock,
    machine: &Machine,
) -> Result<(Table, Option<Picture>), Unmeasurable> {
    Ok(match (kind, study.one_wheel()) {
        (BenchKind::Accuracy, Some(wheel)) => {
            let found = Accuracy::measure(wheel, clock)?;
            let caption = format!("{}, {}", study.name, machine.line());
            let picture = (accuracy_picture(&found, &caption), accuracy_summary(&found));
            (accuracy_table(&found), Some(picture))
        }
        (BenchKind::Effects, Some(wheel)) => {
            (effects_table(&Effects::measure(wheel, clock)?), None)
        }
        (BenchKind::Equilibria, Some(wheel)) => {
            (equilibria_table(&Equilibria::measure(wheel, clock)?), None)
        }
        // The other kinds were refused for axles before.
        _ => (
            throughput_table(&Throughput::measure(study, threads, clock)?),
            None,
        ),
    })
}

/// Refuses measurements that only make sense for one wheel.
fn refuse_for_axle(kind: BenchKind, path: &Path) -> Result<(), Stop> {
    let why = match kind {
        BenchKind::Throughput => return Ok(()),
        BenchKind::Accuracy => {
            "accuracy compares formulations, starts and precisions of one wheel's equations, and each wheel of an axle \
             is solved by the same equations"
        }
        BenchKind::Equilibria => "equilibria are measured for one wheel with elastic parts",
        BenchKind::Effects => {
            "effects times what each output adds to the position of one wheel, in an order for one wheel"
        }
    };
    Err(Stop::in_file(
        path,
        format!(
            "axle: {why}; remove [axle] to measure the left wheel, or use `hardpoint bench throughput`"
        ),
    ))
}
