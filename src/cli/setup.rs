//! `hardpoint setup`

use super::RunArguments;
use super::exit::{Exit, Stop};
use super::output::{Output, design_fault};
use super::terminal;
use crate::assembly::{Assembler, NoSetUp, SetUp};
use crate::report::{SetUpSummary, adjusted, brief, set_up_refusal};
use crate::solved::Solved;
use crate::study::{Drive, Setup, Study};

pub(super) fn run(arguments: &RunArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    let why = "adjustments are found for one wheel at a time";
    super::axle::refuse(&study, path, "setup", why)?;
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
    let fault = |fault| design_fault(&study, path, &fault);
    let assembler = Assembler::new(&study.suspension).map_err(fault)?;
    let found = match SetUp::solve(&study, setup, &assembler) {
        Ok(found) => found,
        Err(NoSetUp::Fault(reason)) => return Err(fault(reason)),
        Err(none) => return not_met(arguments, &study, setup, &assembler, &none),
    };
    let output = Output::open(arguments, &study, "setup")?;
    let summary = SetUpSummary::of(&study, setup, &found);

    // Curves about the new resting position, in every output of the study.
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
    output.file("setup.csv", summary.steps_table().csv(None).as_bytes())?;
    output.file("effects.csv", summary.effects_table().csv(None).as_bytes())?;
    files.insert(files.len() - 1, "effects.csv");
    output.json("summary.json", &summary)?;
    output.finish()?;

    let topology = study.suspension.mechanism.topology.name;
    output.say(&format!("{}: {topology}\n", study.name))?;
    print(&output, &summary)?;
    output.print_files(&files)?;
    Ok(Exit::of(complete && summary.met))
}

/// Prints the summary: to a reader in narrow tables, to a program in two.
fn print(output: &Output, summary: &SetUpSummary) -> Result<(), Stop> {
    print_effects(output, summary)?;
    if !output.is_text() {
        output.table("steps", &summary.steps_table())?;
    }
    let width = terminal::width();
    output.text_only("\nInstructions, in this order (with rounded amounts)\n\n")?;
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
            "\nnot met: {} ends at {} ({} with rounded amounts), not {}\n",
            s.column,
            brief(set),
            brief(rounded),
            brief(wanted)
        ))?;
    }
    Ok(())
}

/// Prints the effects of the adjustments.
fn print_effects(output: &Output, summary: &SetUpSummary) -> Result<(), Stop> {
    if output.is_text() {
        output.text_only("\nEffect of each adjustment\n\n")?;
        output.text_only(&summary.effects_for_readers().text(terminal::width()))
    } else {
        output.table("effects", &summary.effects_table())
    }
}

/// Prints the reason why there is no set-up, and the effect of each adjustment.
fn not_met(
    arguments: &RunArguments,
    study: &Study,
    setup: &Setup,
    assembler: &Assembler,
    none: &NoSetUp,
) -> Result<Exit, Stop> {
    let reason = set_up_refusal(study, setup, none);
    let reason = format!("{}: {reason}", arguments.study.study.display());
    let Ok(drawn) = SetUp::drawn(study, setup, assembler) else {
        return Err(Stop::not_met(reason));
    };
    let summary = SetUpSummary::of(study, setup, &drawn);
    let output = Output::open(arguments, study, "setup")?;
    for former in ["curves.csv", "setup.csv", "summary.json"] {
        output.without(former)?;
    }
    output.file("effects.csv", summary.effects_table().csv(None).as_bytes())?;
    output.finish()?;
    terminal::eprint(&format!("error: {reason}\n"));
    print_effects(&output, &summary)?;
    output.print_files(&["effects.csv"])?;
    Ok(Exit::Incomplete)
}
