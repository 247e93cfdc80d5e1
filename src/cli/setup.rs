//! `hardpoint setup`: computes the adjustments that give the target static values.

use super::RunArguments;
use super::exit::{Exit, Stop};
use super::output::Output;
use super::report::refuse_without_directory;
use super::terminal;
use crate::checked::not_solved;
use crate::report::{SetUpSummary, ends_at, set_up_page};
use crate::set_up::{Refusal, about, effects_table, set_up};
use crate::solved::Solved;
use crate::study::{Drive, Study};

pub(super) fn run(arguments: &RunArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read_elastic(path, &arguments.study.set)?;
    let Some(setup) = &study.setup else {
        let what = "the adjustments and the target values";
        return Err(Stop::no_section(path, "setup", what));
    };
    refuse_without_directory(arguments, None)?;
    let found = match set_up(&study, setup) {
        Ok(found) => found,
        Err(Refusal::Design(reason)) => return Err(Stop::in_file(path, reason)),
        Err(Refusal::NotMet(reason, nominal)) => {
            return not_met(arguments, &study, &reason, &nominal);
        }
    };
    let output = Output::open(arguments, &study, "setup")?;

    // Curves over the motion around the new static position, with every output of the study. The drive of Attia's paper has none.
    let by_theta = found.adjusted.motion().drive == Drive::PaperTheta;
    let solved = (!by_theta).then(|| Solved::of(&found.adjusted));
    let solved = solved.transpose();
    let solved = solved.map_err(|why| Stop::unsolved(path, why))?;
    let mut files = vec!["setup.csv", "summary.json"];
    match &solved {
        None => output.without("curves.csv")?,
        Some(solved) => {
            output.main_csv("curves.csv", &solved.csv())?;
            files.insert(0, "curves.csv");
        }
    }
    let steps = found.steps_table();
    output.file("setup.csv", steps.csv(None).as_bytes())?;
    output.file("effects.csv", found.effects_table().csv(None).as_bytes())?;
    files.insert(files.len() - 1, "effects.csv");
    output.json("summary.json", &found.record())?;
    if arguments.report {
        output.file("report.html", set_up_page(&found.wheels).as_bytes())?;
        files.push("report.html");
    }
    output.finish()?;

    let topology = study.wheel().mechanism.topology.name;
    output.say(&format!("{}: {topology}\n", study.name))?;
    print_effects(&output, &found.wheels)?;
    if !output.is_text() {
        output.table("steps", &steps)?;
    }
    for summary in &found.wheels {
        print(&output, summary)?;
    }
    let incomplete = solved.filter(|solved| !solved.is_complete());
    if let Some(solved) = &incomplete {
        say_missing(&output, solved, &found.adjusted)?;
    }
    output.print_files(&files)?;
    Ok(Exit::of(incomplete.is_none() && found.met()))
}

/// Prints the missing values and the unsolved stations around the new static position.
fn say_missing(output: &Output, solved: &Solved, study: &Study) -> Result<(), Stop> {
    output.say_plausibility(solved.remarks(), false)?;
    for failure in not_solved(solved, &[], study.wheel()) {
        output.say_failure(&format!("\n{failure}\n"))?;
    }
    Ok(())
}

/// Prints the set-up of a wheel as text: instructions, effects of the steps, static values, and target values that are not met.
fn print(output: &Output, summary: &SetUpSummary) -> Result<(), Stop> {
    let width = terminal::width();
    output.text_only(&format!(
        "\n{}, in this order (with rounded amounts)\n\n",
        title(summary, "Instructions")
    ))?;
    output.text_only(&summary.instructions().text(width))?;
    output.text_only("\neffect of each step, with rounded amounts\n\n")?;
    output.text_only(&summary.effects_of_steps().text(width))?;
    output.text_only("\nstatic values after each step, with computed amounts\n")?;
    for table in summary.values_after_steps() {
        output.text_only(&format!("\n{}", table.text(width)))?;
    }
    let results = summary.results();
    if !results.is_empty() {
        output
            .text_only("\ntarget values: results with computed and with rounded adjustments\n\n")?;
        output.text_only(&results.text(width))?;
        output.text_only(
            "\nAllowed error: the effect of half a shim step and of 1/32 turn of each \
             thread. ride_height_change is positive if the car becomes higher.\n",
        )?;
    }
    for s in summary.not_met() {
        let (Some(wanted), Some(set), Some(rounded)) = (s.wanted, s.set, s.set_rounded) else {
            continue;
        };
        let missed = format!(
            "{} {}; with rounded amounts it {}",
            s.column,
            ends_at(set, wanted),
            ends_at(rounded, wanted)
        );
        output.say_failure(&format!("\nnot met: {}\n", about(summary.side, &missed)))?;
    }
    Ok(())
}

/// Adds the wheels of an axle to a title, as in "Instructions for both wheels".
fn title(summary: &SetUpSummary, title: &str) -> String {
    match summary.side {
        None => title.to_owned(),
        Some(side) => format!("{title} for the {}", side.wheels()).replace("the both", "both"),
    }
}

/// Prints the effect of each adjustment on the static values.
fn print_effects(output: &Output, wheels: &[SetUpSummary]) -> Result<(), Stop> {
    if !output.is_text() {
        return output.table("effects", &effects_table(wheels));
    }
    for summary in wheels {
        let title = title(summary, "Effect of each adjustment");
        output.text_only(&format!("\n{title}\n\n"))?;
        output.text_only(&summary.effects_for_readers().text(terminal::width()))?;
        if let Some(note) = summary.effects_note() {
            output.text_only(&format!("\n{note}\n"))?;
        }
    }
    Ok(())
}

/// Prints the reason why no set-up meets the target values, and the effect of each adjustment on the nominal design. Returns an
/// error if no effect is known.
fn not_met(
    arguments: &RunArguments,
    study: &Study,
    reason: &str,
    nominal: &[SetUpSummary],
) -> Result<Exit, Stop> {
    let reason = format!("{}: {reason}", arguments.study.study.display());
    if nominal.is_empty() {
        return Err(Stop::not_met(reason));
    }
    let output = Output::open(arguments, study, "setup")?;
    for former in ["curves.csv", "setup.csv", "summary.json"] {
        output.without(former)?;
    }
    output.file("effects.csv", effects_table(nominal).csv(None).as_bytes())?;
    output.finish()?;
    terminal::eprint(&format!("error: {reason}\n"));
    print_effects(&output, nominal)?;
    output.print_files(&["effects.csv"])?;
    Ok(Exit::Incomplete)
}
