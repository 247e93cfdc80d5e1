//! `hardpoint optimise`

use super::OptimiseArguments;
use super::choices::Choices;
use super::exit::{Exit, Stop};
use super::output::{Output, design_fault, pool};
use super::progress;
use super::report::Wanted;
use crate::curves::curves;
use crate::model::Suspension;
use crate::optimise::{Control, Tuning, tune};
use crate::plan::Plan;
use crate::report::{
    FrontRecord, PriceRecord, Record, TuningSummary, YieldRecord, curves_csv, doubts, history_csv,
    remarks, sensitivities_csv, variable_doubts,
};
use crate::study::{Optimise, Study, StudyErrors};
use crate::tolerance::{Problem, monte_carlo};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::Ordering;

/// The most free moves that are said; the page and `summary.json` have all.
const MOST_DIRECTIONS: usize = 2;

/// Says what came of a tuning: misfit, targets, variables, constraints.
pub(super) fn say_outcome(
    output: &Output,
    study: &Study,
    summary: &TuningSummary,
) -> Result<(), Stop> {
    output.say(&format!("{}: {}\n\n", study.name, summary.headline()))?;
    output.table_for_programs("misfit", || summary.misfit_table());
    if summary.has_design() {
        output.table("targets", &summary.targets_table())?;
        output.lead_on("\n  rms and worst in tolerances\n")?;
        for (_, column, by) in summary.missed() {
            output.say(&format!("  missed: {column}, by up to {by}\n"))?;
        }
        output.lead_on("\n")?;
        output.table("variables", &summary.variables_table())?;
    }
    if let Some(table) = summary.constraints_table().filter(|_| summary.has_design()) {
        output.lead_on("\n")?;
        output.table("constraints", &table)?;
    }
    output.say_remarks(summary.remarks())
}

/// Says what the tuned design lacks, what the targets leave open, and how the starts ended. `refused` are the errors
/// of the tuned study, if it is not one that can be read.
pub(super) fn say_openings(
    output: &Output,
    study: &Study,
    summary: &TuningSummary,
    refused: Option<StudyErrors>,
) -> Result<(), Stop> {
    if let Some(errors) = refused {
        output.say(&format!(
            "\nwarning: the tuned design is not one that other commands take:\n{}\n",
            errors.render(false)
        ))?;
    }
    let unit = study.suspension.length_unit.symbol();
    let unseen = summary.unseen();
    for combination in unseen.iter().take(MOST_DIRECTIONS) {
        output.say(&format!(
            "\n  the targets cannot tell the tuned design from one moved by {combination} {unit}\n"
        ))?;
    }
    if unseen.len() > MOST_DIRECTIONS {
        let more = unseen.len() - MOST_DIRECTIONS;
        output.say(&format!(
            "\n  nor by {more} more such moves, in summary.json\n"
        ))?;
    }
    output.lead_on("\n")?;
    match summary.starts_in_words().filter(|_| output.is_text()) {
        Some(words) => output.say(&format!("{words}\n"))?,
        None => output.table("starts", &summary.starts_table())?,
    }
    Ok(())
}

pub(super) fn run(arguments: &OptimiseArguments) -> Result<Exit, Stop> {
    let OptimiseArguments {
        run: arguments,
        prices,
    } = arguments;
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    let Some(optimise) = &study.optimise else {
        let what = "what may move and what is wanted";
        return Err(Stop::no_section(path, "optimise", what));
    };
    if let Some(axle) = &study.axle {
        return super::axle::optimise(arguments, &study, axle, optimise, *prices);
    }
    let pool = pool(arguments.threads, optimise.starts as u64)?;
    // Solved first: a design that is wrong must be known before anything is written.
    let plan = Plan::with_targets(&study);
    let fault = |fault| design_fault(&study, path, &fault);
    let before = curves(&study.suspension, &plan).map_err(fault)?;
    let output = Output::open(arguments, &study, "optimise")?;
    let wanted = Wanted::open(arguments)?;
    let tuning = pool
        .install(|| tune_with_progress(&study, optimise))
        .map_err(fault)?;
    let tuned = tuning.best.as_ref().map(|best| Suspension {
        design: best.design.clone(),
        ..study.suspension.clone()
    });
    let after = tuned.as_ref().map(|tuned| curves(tuned, &plan));
    let after = after.transpose().map_err(fault)?;
    let choices = pool
        .install(|| Choices::of(&study, optimise, &tuning, *prices || arguments.report))
        .map_err(fault)?;
    let kept = tuning.best.as_ref().map(|best| &best.offsets[..]);
    let mut summary = TuningSummary::of(&study, optimise, &tuning, after.as_ref());
    summary.prices = PriceRecord::all(optimise, &choices.prices, kept);
    summary.yields = pool.install(|| yields(&study, optimise, tuned.as_ref()));

    let length = study.suspension.length_unit;
    let mut complete = true;
    let mut refused = None;
    let mut files = vec!["curves_before.csv", "history.csv", "summary.json"];
    output.file("curves_before.csv", &curves_csv(&before, &plan, length))?;
    output.file("history.csv", &history_csv(&tuning.starts))?;
    output.json("summary.json", &summary)?;
    let mut designs = vec![("before", "curves_before.csv", &study.suspension, &before)];
    if let (Some(best), Some(tuned), Some(after)) = (&tuning.best, &tuned, &after) {
        complete &= after.are_complete();
        designs.push(("after", "curves.csv", tuned, after));
        output.main_csv("curves.csv", &curves_csv(after, &plan, length))?;
        let tuned = study.with_design(&best.design);
        output.file("optimised.toml", tuned.as_bytes())?;
        let directory = path.parent().unwrap_or(Path::new(""));
        refused = Study::from_text("optimised.toml", &tuned, directory).err();
        files = [&["curves.csv", "optimised.toml"], &files[..]].concat();
    } else {
        complete = false;
        output.without("curves.csv")?;
        output.without("optimised.toml")?;
    }
    let wheel = &study.suspension.mechanism;
    let sensitive = after.as_ref().filter(|_| !plan.sensitivities.is_empty());
    let csv = sensitive.map(|after| sensitivities_csv(after, &plan, wheel, length));
    files.extend(output.file_if_any("sensitivities.csv", csv)?);
    files.extend(choices.write(&output, &study, optimise)?);
    if output.directory().is_some() {
        let record = Record::of("optimise", &study, &plan, &designs).map_err(fault)?;
        let front = choices.front.as_ref();
        let front = front.map(|front| FrontRecord::of(&study, optimise, front));
        let record = Record { front, ..record };
        output.record("report.json", &record)?;
        files.push("report.json");
    }
    files.extend(wanted.show(output.directory())?);

    say_outcome(&output, &study, &summary)?;
    complete &= choices.say(&output, optimise, &summary)?;
    if let Some(yields) = &summary.yields {
        output.say(&format!("\n{}\n\n", yields.headline()))?;
        output.table("yields", &yields.table())?;
    }
    complete &= !summary.falls_short();
    let doubts = tuned.as_ref().map(doubts).transpose().map_err(fault)?;
    let doubts = doubts.into_iter().flatten().chain(variable_doubts(&study));
    let said = doubts.chain(after.iter().flat_map(|after| remarks(&study, after)));
    output.say_doubts(
        said,
        after.as_ref().is_none_or(|after| after.are_complete()),
    )?;
    complete &= refused.is_none();
    say_openings(&output, &study, &summary, refused)?;
    output.print_files(&files)?;
    let interrupted = progress::interrupt_flag().load(Ordering::SeqCst);
    Ok(Exit::of(complete && !interrupted))
}

/// Of a robust tuning, what its builds keep to before and after: by Monte Carlo, as `hardpoint tolerance` has it.
fn yields(study: &Study, optimise: &Optimise, tuned: Option<&Suspension>) -> Option<YieldRecord> {
    optimise.scatter.as_ref()?;
    let tolerance = study.tolerance.as_ref().filter(|t| !t.bands.is_empty())?;
    let of = |suspension: &Suspension| {
        let study = Study {
            suspension: suspension.clone(),
            ..study.clone()
        };
        let problem = Problem::of(&study, tolerance).ok()?;
        let drawn = problem.drawn().ok()?;
        monte_carlo(&problem, &drawn, |_| ControlFlow::Continue(())).ok()
    };
    Some(YieldRecord::of(
        tolerance,
        of(&study.suspension),
        of(tuned?),
    ))
}

pub(super) fn tune_with_progress(
    study: &Study,
    optimise: &Optimise,
) -> Result<Tuning, crate::mechanism::DesignFault> {
    let line = progress::line(optimise.starts as u64, "starts");
    let watch = |start: usize, iteration: &crate::optimise::Iteration| {
        if iteration.iteration == 0 {
            line.inc(1);
        }
        line.set_message(format!("start {start}: misfit {:.3}", iteration.misfit));
    };
    let control = Control {
        interrupt: Some(progress::interrupt_flag()),
        watch: (!line.is_hidden()).then_some(&watch),
    };
    let tuning = tune(&study.suspension, &study.motion, optimise, control);
    line.finish_and_clear();
    tuning
}
