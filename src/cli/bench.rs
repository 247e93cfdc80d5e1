//! `hardpoint bench`: measures the computing time and the accuracy of this program on this machine.

use super::exit::{Exit, Stop};
use super::output::{Destination, Output, design_fault, inputs};
use super::terminal::width;
use super::{BenchArguments, BenchKind};
use crate::bench::accuracy::{self, Accuracy};
use crate::bench::cars::Cars;
use crate::bench::effects::Effects;
use crate::bench::equilibria::Equilibria;
use crate::bench::throughput::Throughput;
use crate::bench::{Clock, Machine, Unmeasurable};
use crate::model::Topology;
use crate::report::{
    Table, accuracy_picture, accuracy_summary, accuracy_table, effects_table, jobs_table,
    throughput_table,
};
use crate::results::{Claim, digest_of_texts, study_digest};
use crate::study::{CarStudy, Study};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Content of `KIND_machine.json`: benchmark, study and machine of the measurement.
#[derive(Serialize)]
struct Circumstances<'a> {
    benchmark: &'a str,
    study: &'a str,
    topology: &'a str,
    #[serde(flatten)]
    machine: &'a Machine,
}

/// Study whose computing time the benchmark measures.
enum Subject {
    Study(Box<Study>),
    Car(Box<CarStudy>),
}

impl Subject {
    /// Study that the command line names. The default is the template of a MacPherson strut; `cars` and `equilibria` have no
    /// default.
    fn of(arguments: &BenchArguments) -> Result<Self, Stop> {
        let changes = &arguments.set;
        Ok(match (&arguments.study, arguments.kind) {
            (Some(path), BenchKind::Cars) => {
                if path.is_file() && !CarStudy::is_at(path) {
                    let message = "`bench cars` needs a study with [car]";
                    return Err(Stop::in_file(path, message));
                }
                Subject::Car(Box::new(CarStudy::read(path, changes)?))
            }
            (None, BenchKind::Cars) => {
                let message = "`bench cars` needs a study: `hardpoint new car` writes one";
                return Err(Stop::wrong_input(message));
            }
            (None, BenchKind::Equilibria) => {
                let message = "`bench equilibria` needs a study with [compliance]: `hardpoint new double_wishbone --with bushings` writes one";
                return Err(Stop::wrong_input(message));
            }
            (Some(path), BenchKind::Equilibria) => {
                Subject::Study(Box::new(Study::read_elastic(path, changes)?))
            }
            (Some(path), _) => Subject::Study(Box::new(Study::read(path, changes)?)),
            (None, _) => {
                let strut = Topology::named("macpherson").expect("macpherson is a topology");
                let study = Study::from_text("macpherson.toml", strut.template, Path::new(""))?;
                Subject::Study(Box::new(study))
            }
        })
    }

    fn name(&self) -> &str {
        match self {
            Subject::Study(study) => &study.name,
            Subject::Car(study) => &study.name,
        }
    }

    fn topology(&self) -> &str {
        match self {
            Subject::Study(study) => study.wheel().mechanism.topology.name,
            Subject::Car(_) => "car",
        }
    }

    fn digest(&self) -> String {
        match self {
            Subject::Study(study) => study_digest(study),
            Subject::Car(study) => digest_of_texts(&study.texts()),
        }
    }

    fn inputs(&self, path: &Path) -> Vec<PathBuf> {
        match self {
            Subject::Study(study) => inputs(study, path),
            Subject::Car(study) => study.inputs.clone(),
        }
    }

    /// Refuses a study that this kind of benchmark does not support.
    fn check(&self, kind: BenchKind, path: &Path) -> Result<(), Stop> {
        let Subject::Study(study) = self else {
            return Ok(());
        };
        match (study.one_wheel(), kind) {
            (_, BenchKind::Equilibria) if study.elastic_parts().is_none() => {
                Err(stop(path, study, Unmeasurable::Rigid))
            }
            (_, BenchKind::Equilibria) => Ok(()),
            (None, kind) => refuse_for_axle(kind, study, path),
            (Some(wheel), _) => match accuracy::Subject::of(wheel) {
                Ok(_) => Ok(()),
                Err(reason) => Err(stop(path, study, reason)),
            },
        }
    }
}

/// Error for a study that the benchmark cannot measure. `reason` becomes its text.
fn stop(path: &Path, study: &Study, reason: Unmeasurable) -> Stop {
    match reason {
        Unmeasurable::Design(fault) => design_fault(study, path, &fault),
        other => Stop::in_file(path, other),
    }
}

pub(super) fn run(arguments: &BenchArguments) -> Result<Exit, Stop> {
    let template = Path::new("macpherson.toml");
    let path = arguments.study.as_deref().unwrap_or(template);
    let subject = Subject::of(arguments)?;
    // The study is checked before any file is written.
    subject.check(arguments.kind, path)?;
    let name = format!("bench_{}", subject.name());
    let (out, format) = (arguments.out.as_deref(), arguments.format);
    let destination = Destination::of(out, &name, arguments.force, format)?;
    let kind = match arguments.kind {
        BenchKind::Throughput => "throughput",
        BenchKind::Accuracy => "accuracy",
        BenchKind::Effects => "effects",
        BenchKind::Equilibria => "equilibria",
        BenchKind::Cars => "cars",
    };
    let names = [".csv", ".svg", "_machine.json"].map(|end| format!("{kind}{end}"));
    let [csv_name, svg_name, machine_name] = names.each_ref().map(String::as_str);
    let mut files = vec![csv_name, machine_name];
    if arguments.kind == BenchKind::Accuracy {
        files.insert(1, svg_name);
    }
    let claim = Claim {
        command: &format!("bench {kind}"),
        study: subject.name(),
        digest: subject.digest(),
        files: &files,
        inputs: &subject.inputs(path),
        ..Claim::default()
    };
    let output = Output::at(&destination, claim)?;
    let clock = Clock {
        samples: arguments.samples,
        ..Clock::default()
    };
    let machine = Machine::here(&clock);
    output.say(&format!("{}: {}\n\n", subject.name(), machine.line()))?;

    let threads = arguments.threads.unwrap_or(machine.cores);
    let (table, picture) = match &subject {
        Subject::Study(study) => measure(study, arguments.kind, threads, &clock, &machine)
            .map_err(|reason| stop(path, study, reason))?,
        Subject::Car(study) => {
            let found = Cars::measure(study, &clock);
            let found = found.map_err(|reason| Stop::in_file(path, reason))?;
            (jobs_table(&found.measurements), None)
        }
    };
    output.main_csv(csv_name, table.csv(None).as_bytes())?;
    if let Some((svg, _)) = &picture {
        output.file(svg_name, svg.as_bytes())?;
    }
    let circumstances = Circumstances {
        benchmark: kind,
        study: subject.name(),
        topology: subject.topology(),
        machine: &machine,
    };
    output.json(machine_name, &circumstances)?;
    output.finish()?;
    if output.directory().is_some() {
        match &picture {
            // The full table has about a hundred rows, so the text output shows the brief table.
            Some((_, brief)) => {
                output.table_for_programs(kind, || table.clone());
                output.text_only(&brief.text(width()))?;
                output.text_only("\n")?;
            }
            None => output.table(kind, &table)?,
        }
    }
    // If the results go to standard output, the main CSV already contains the table, so `print_files` prints no table.
    output.print_files(&files)?;
    Ok(Exit::Done)
}

/// SVG picture of an accuracy measurement, and the short table of its results for text output.
type Picture = (String, Table);

/// Measures the computing time of a study. Returns the table of the measurements. Only `accuracy` also returns a picture.
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
        (BenchKind::Equilibria, _) => {
            let found = Equilibria::measure(study, clock)?;
            (jobs_table(&found.measurements), None)
        }
        // For an axle, an earlier check has refused accuracy and effects, so only throughput is left here.
        _ => (
            throughput_table(&Throughput::measure(study, threads, clock)?),
            None,
        ),
    })
}

/// Returns an error for `accuracy` and `effects`, because these benchmarks measure a single wheel and the study has an axle.
fn refuse_for_axle(kind: BenchKind, study: &Study, path: &Path) -> Result<(), Stop> {
    let why = match kind {
        BenchKind::Throughput | BenchKind::Equilibria | BenchKind::Cars => return Ok(()),
        BenchKind::Accuracy => "`bench accuracy` compares ways to solve the equations of one wheel",
        BenchKind::Effects => {
            "`bench effects` measures the time that each output of one wheel takes in addition to the position"
        }
    };
    let remedy = if study.wheel().mechanism.rigid_axle.is_some() {
        "one mechanism carries both wheels of this axle: use `hardpoint bench throughput`"
    } else {
        "each wheel of an axle is solved by the same equations: remove [axle] to measure the left wheel, or use \
         `hardpoint bench throughput`"
    };
    Err(Stop::in_file(path, format!("axle: {why}; {remedy}")))
}
