//! `hardpoint setup`

use super::RunArguments;
use super::exit::{Exit, Stop};
use super::output::Output;
use super::terminal;
use crate::assembly::{Assembler, Miss, NoSetUp, SetUp};
use crate::mechanism::DesignFault;
use crate::report::{SetUpSide, SetUpSummary, Table, brief, static_column};
use crate::solved::Solved;
use crate::study::{Drive, Setup, Study};
use serde::Serialize;
use std::path::Path;

pub(super) fn run(arguments: &RunArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    let Some(setup) = &study.setup else {
        let what = "what may be adjusted and what is wanted";
        return Err(Stop::no_section(path, "setup", what));
    };
    if arguments.report || arguments.plots.is_some() {
        return Err(Stop::wrong_input(
            "`hardpoint setup` writes tables and curves.csv, without --report and --plots; those are options of \
             `solve`, `sweep`, `optimise` and `tolerance`",
        ));
    }
    let wheels = WheelToSetUp::all(&study, path)?;
    let found: Result<Vec<SetUp>, (&WheelToSetUp, NoSetUp)> = wheels
        .iter()
        .map(|wheel| wheel.solve(setup).map_err(|none| (wheel, none)))
        .collect();
    let found = match found {
        Ok(found) => found,
        Err((wheel, NoSetUp::Fault(reason))) => return Err(wheel.fault(path, &reason)),
        Err((wheel, none)) => return not_met(arguments, setup, &wheels, wheel, &none),
    };
    let output = Output::open(arguments, &study, "setup")?;
    let pairs = wheels.iter().zip(&found);
    let summaries = pairs.map(|(wheel, found)| wheel.summary(setup, found));
    let summaries: Vec<SetUpSummary> = summaries.collect();
    let adjusted = adjusted(&study, &found);
    let by_theta = adjusted.motion.drive == Drive::PaperTheta;
    let mut complete = true;
    let mut files = vec!["setup.csv", "summary.json"];
    if by_theta {
        output.without("curves.csv")?;
    } else {
        let solved = Solved::of(&adjusted).map_err(|why| Stop::unsolved(path, why))?;
        complete = solved.is_complete();
        output.main_csv("curves.csv", &solved.csv())?;
        files.insert(0, "curves.csv");
    }
    let steps = stacked(&summaries, SetUpSummary::steps_table);
    output.file("setup.csv", steps.csv(None).as_bytes())?;
    let effects = stacked(&summaries, SetUpSummary::effects_table);
    output.file("effects.csv", effects.csv(None).as_bytes())?;
    files.insert(files.len() - 1, "effects.csv");
    let met = summaries.iter().all(|summary| summary.met);
    match &summaries[..] {
        [summary] => output.json("summary.json", summary)?,
        wheels => output.json("summary.json", &Wheels { met, wheels })?,
    }
    output.finish()?;

    let topology = study.suspension.mechanism.topology.name;
    output.say(&format!("{}: {topology}\n", study.name))?;
    print_effects(&output, &summaries)?;
    if !output.is_text() {
        output.table("steps", &steps)?;
    }
    for summary in &summaries {
        print(&output, summary)?;
    }
    output.print_files(&files)?;
    Ok(Exit::of(complete && met))
}

/// `summary.json` where each wheel is set up by itself.
#[derive(Serialize)]
struct Wheels<'s> {
    met: bool,
    wheels: &'s [SetUpSummary],
}

/// A wheel to set up.
struct WheelToSetUp {
    side: Option<SetUpSide>,
    /// The study with this wheel as its suspension.
    study: Study,
    assembler: Assembler,
}

impl WheelToSetUp {
    /// The wheels that are set up one by one: of an axle both if the right one is no mirror image.
    fn all(study: &Study, path: &Path) -> Result<Vec<Self>, Stop> {
        let mut wheels = vec![(None, study.suspension.clone())];
        if let Some(both) = &study.axle {
            wheels[0].0 = Some(SetUpSide::Both);
            if let Some(right) = &both.axle.right {
                wheels[0].0 = Some(SetUpSide::Left);
                wheels.push((Some(SetUpSide::Right), right.clone()));
            }
        }
        let wheel = |(side, suspension)| {
            let mut study = study.clone();
            study.suspension = suspension;
            let assembler = Assembler::new(&study.suspension);
            let assembler = assembler.map_err(|fault| fault_of(side, &study, path, &fault))?;
            Ok(WheelToSetUp {
                side,
                study,
                assembler,
            })
        };
        wheels.into_iter().map(wheel).collect()
    }

    fn solve(&self, setup: &Setup) -> Result<SetUp, NoSetUp> {
        SetUp::solve(&self.study, setup, &self.assembler)
    }

    fn summary(&self, setup: &Setup, found: &SetUp) -> SetUpSummary {
        SetUpSummary::of(&self.study, setup, self.side, found)
    }

    fn fault(&self, path: &Path, fault: &DesignFault) -> Stop {
        fault_of(self.side, &self.study, path, fault)
    }
}

/// A design that cannot be solved; names the wheel where wheels are set up one by one.
fn fault_of(side: Option<SetUpSide>, study: &Study, path: &Path, fault: &DesignFault) -> Stop {
    let reason = fault.describe(&study.suspension.mechanism);
    Stop::in_file(path, format!("{}{reason}", of_wheel(side)))
}

/// Words before a sentence about one wheel of two: "left wheel: ".
fn of_wheel(side: Option<SetUpSide>) -> String {
    match side {
        None | Some(SetUpSide::Both) => String::new(),
        Some(side) => format!("{}: ", side.wheels()),
    }
}

/// The study about the new resting position, with every output.
fn adjusted(study: &Study, found: &[SetUp]) -> Study {
    let mut adjusted = study.clone();
    let mut wheels = found
        .iter()
        .map(|found| found.last().built.suspension.clone());
    adjusted.suspension = wheels.next().expect("a set-up is of a wheel at least");
    if let Some(both) = &mut adjusted.axle {
        both.axle = both
            .axle
            .with_wheels(adjusted.suspension.clone(), wheels.next());
    }
    adjusted.formulation = crate::study::Formulation::KnucklePose;
    adjusted
}

/// The tables of all wheels as one, with a column for the side in the study of an axle.
fn stacked(summaries: &[SetUpSummary], table: fn(&SetUpSummary) -> Table) -> Table {
    let tables = summaries
        .iter()
        .map(|s| (s.side.map(SetUpSide::name), table(s)));
    Table::stacked("side", tables).expect("a set-up is of a wheel at least")
}

/// Prints the summary of a wheel to a reader, in narrow tables.
fn print(output: &Output, summary: &SetUpSummary) -> Result<(), Stop> {
    let width = terminal::width();
    output.text_only(&format!(
        "\n{}set up, in this order (amounts rounded to what a mechanic can make)\n\n",
        heading(summary)
    ))?;
    output.text_only(&summary.instructions().text(width))?;
    output.text_only("\nstatic values after each step, with computed amounts\n")?;
    for table in summary.values_after_steps() {
        output.text_only(&format!("\n{}", table.text(width)))?;
    }
    let results = summary.results();
    if !results.is_empty() {
        output.text_only("\nwanted values, with computed and with rounded amounts\n\n")?;
        output.text_only(&results.text(width))?;
        output.text_only(
            "\nAllowed error: half a step of the shims, half a sixteenth of a turn of the threads. \
             ride_height_change is positive where the car becomes higher.\n",
        )?;
    }
    for s in summary.not_met() {
        let (Some(wanted), Some(set), Some(rounded)) = (s.wanted, s.set, s.set_rounded) else {
            continue;
        };
        output.say_failure(&format!(
            "\nnot met: {}{} ends at {} ({} with rounded amounts), not {}\n",
            of_wheel(summary.side),
            s.column,
            brief(set),
            brief(rounded),
            brief(wanted)
        ))?;
    }
    Ok(())
}

/// Words before the title of a wheel's table: "both wheels: ".
fn heading(summary: &SetUpSummary) -> String {
    let side = summary.side.map(|side| format!("{}: ", side.wheels()));
    side.unwrap_or_default()
}

/// Prints the effects of the adjustments.
fn print_effects(output: &Output, summaries: &[SetUpSummary]) -> Result<(), Stop> {
    if !output.is_text() {
        return output.table("effects", &stacked(summaries, SetUpSummary::effects_table));
    }
    for summary in summaries {
        let title = format!("\n{}what each adjustment does\n\n", heading(summary));
        output.text_only(&title)?;
        output.text_only(&summary.effects_for_readers().text(terminal::width()))?;
    }
    Ok(())
}

/// Says why there is no set-up, and what each adjustment does to the design.
fn not_met(
    arguments: &RunArguments,
    setup: &Setup,
    wheels: &[WheelToSetUp],
    failed: &WheelToSetUp,
    none: &NoSetUp,
) -> Result<Exit, Stop> {
    let study = &failed.study;
    let length = study.suspension.length_unit;
    let reason = match none {
        NoSetUp::Fault(reason) => reason.describe(&study.suspension.mechanism),
        NoSetUp::Reject(reject) => reject.to_string(),
        NoSetUp::Absurd { adjustment, amount } => format!(
            "what is wanted would take {} of {} of {}, more than a tenth of the suspension's size",
            brief(*amount),
            length.symbol(),
            setup.adjust[*adjustment].name
        ),
        NoSetUp::OutOfReach(missed) => {
            let words = |miss: &Miss| {
                let (column, wanted) = (static_column(miss.of, length), brief(miss.wanted));
                match miss.value.is_finite() {
                    true => format!("{column} ends at {}, not {wanted}", brief(miss.value)),
                    false => format!("{column} has no value, not {wanted}"),
                }
            };
            let missed: Vec<String> = missed.iter().map(words).collect();
            format!("what is wanted cannot be met: {}", missed.join("; "))
        }
        NoSetUp::Unsettled => {
            "what is wanted cannot be met: the adjustments move none of it".to_owned()
        }
    };
    let path = arguments.study.study.display();
    let reason = format!("{path}: {}{reason}", of_wheel(failed.side));
    let summaries = wheels.iter().map(|wheel| {
        let drawn = SetUp::drawn(&wheel.study, setup, &wheel.assembler)?;
        Ok(wheel.summary(setup, &drawn))
    });
    let Ok(summaries) = summaries.collect::<Result<Vec<_>, NoSetUp>>() else {
        return Err(Stop::not_met(reason));
    };
    let output = Output::open(arguments, &wheels[0].study, "setup")?;
    for former in ["curves.csv", "setup.csv", "summary.json"] {
        output.without(former)?;
    }
    let effects = stacked(&summaries, SetUpSummary::effects_table);
    output.file("effects.csv", effects.csv(None).as_bytes())?;
    output.finish()?;
    terminal::eprint(&format!("error: {reason}\n"));
    print_effects(&output, &summaries)?;
    output.print_files(&["effects.csv"])?;
    Ok(Exit::Incomplete)
}
