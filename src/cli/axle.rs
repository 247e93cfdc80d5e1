//! `hardpoint solve`, `optimise` and `check` of an axle; what other commands say of one.

use super::choices::Choices;
use super::exit::{Exit, Stop};
use super::optimise::{say_openings, say_outcome, tune_with_progress};
use super::output::{Output, pool};
use super::printer::Printer;
use super::progress;
use super::report::Wanted;
use super::tolerance::FANS;
use super::{RunArguments, StudyArguments};
use crate::axle::{Axle, AxleCurves, AxlePlan, axle_curves};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::optimise::{Best, moved_design};
use crate::report::{
    AxleSummary, PriceRecord, Record, SolvedAxle, TuningSummary, axle_curves_csv, axle_doubts,
    axle_sensitivities_csv, history_csv, variable_doubts, wheel_doubts,
};
use crate::study::{AxleStudy, Optimise, Study};
use crate::tolerance::{MonteCarlo, Problem};
use nalgebra::DVector;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Refuses a study of an axle in a command that knows one wheel; `why` says so in a sentence.
pub(super) fn refuse(study: &Study, path: &Path, command: &str, why: &str) -> Result<(), Stop> {
    match study.axle {
        None => Ok(()),
        Some(_) => Err(Stop::in_file(
            path,
            format!(
                "axle: `hardpoint {command}` is not yet there for an axle: {why}; without [axle] the study is of \
                 one wheel"
            ),
        )),
    }
}

pub(super) fn fault(path: &Path, axle: &Axle, fault: (Side, DesignFault)) -> Stop {
    Stop::in_file(path, axle.describe_fault(fault))
}

fn said(
    path: &Path,
    axle: &Axle,
    plan: &AxlePlan,
    curves: &AxleCurves,
) -> Result<Vec<String>, Stop> {
    let mut said = wheel_doubts(axle).map_err(|f| fault(path, axle, f))?;
    said.extend(axle_doubts(axle, curves, axle.turns_against(plan)));
    Ok(said)
}

/// Writes the record of a run, and page and pictures where they are wanted; the files that makes.
fn show(
    output: &Output,
    wanted: &Wanted,
    study: &Study,
    (plan, designs): (&AxlePlan, &[SolvedAxle<'_>]),
    command: &str,
    path: &Path,
) -> Result<Vec<&'static str>, Stop> {
    let (Some(axle), Some(_)) = (&study.axle, output.directory()) else {
        return Ok(Vec::new());
    };
    let record = Record::of_axle(command, study, axle, plan, designs);
    let record = record.map_err(|f| fault(path, &axle.axle, f))?;
    output.record("report.json", &record)?;
    let mut files = vec!["report.json"];
    files.extend(wanted.show(output.directory())?);
    Ok(files)
}

pub(super) fn solve(
    arguments: &RunArguments,
    study: &Study,
    AxleStudy { axle, plan }: &AxleStudy,
) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let curves = axle_curves(axle, plan).map_err(|f| fault(path, axle, f))?;
    let design = axle_curves(axle, &plan.at_design()).map_err(|f| fault(path, axle, f))?;
    let output = Output::open(arguments, study, "solve")?;
    let wanted = Wanted::open(arguments)?;
    let summary = AxleSummary::of(&study.name, axle, plan, &curves, &design);
    let mut files = vec!["curves.csv"];
    output.main_csv("curves.csv", &axle_curves_csv(axle, plan, &curves))?;
    let sensitive = !plan.sensitivities.is_empty();
    let csv = sensitive.then(|| axle_sensitivities_csv(axle, plan, &curves));
    files.extend(output.file_if_any("sensitivities.csv", csv)?);
    output.json("summary.json", &summary)?;
    files.push("summary.json");
    let designs = [("design", "curves.csv", axle, &curves)];
    files.extend(show(
        &output,
        &wanted,
        study,
        (plan, &designs),
        "solve",
        path,
    )?);
    output.say(&format!("{}\n\n", summary.headline()))?;
    output.table("outputs", &summary.table())?;
    let remarks = said(path, axle, plan, &curves)?;
    let remarks = remarks.into_iter().chain(summary.remarks());
    let is_complete = curves.are_complete();
    output.say_doubts(remarks, is_complete)?;
    for failure in summary.failures() {
        output.say_failure(&format!("\n{failure}\n"))?;
    }
    output.print_files(&files)?;
    Ok(Exit::of(is_complete))
}

/// The axle of a tuned design.
fn tuned_axle(axle: &Axle, optimise: &Optimise, best: &Best) -> Axle {
    let mut tuned = axle.clone();
    tuned.left.design.clone_from(&best.design);
    if let (Some(own), Some(right)) = (&axle.right, &mut tuned.right) {
        let x = DVector::from_column_slice(&best.offsets);
        let (frame, variables) = (&axle.left.frame, &optimise.variables);
        moved_design(&own.design, frame, variables, &x, &mut right.design);
    }
    tuned
}

pub(super) fn optimise(
    arguments: &RunArguments,
    study: &Study,
    both: &AxleStudy,
    optimise: &Optimise,
    prices: bool,
) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let pool = pool(arguments.threads, optimise.starts as u64)?;
    let axle = &both.axle;
    let plan = both.plan_with(&optimise.targets);
    let solved = |axle: &Axle| axle_curves(axle, &plan).map_err(|f| fault(path, axle, f));
    let before = solved(axle)?;
    let output = Output::open(arguments, study, "optimise")?;
    let wanted = Wanted::open(arguments)?;
    let tuning = pool
        .install(|| tune_with_progress(study, optimise))
        .map_err(|f| fault(path, axle, (Side::Left, f)))?;
    let choices = pool
        .install(|| Choices::of(study, optimise, &tuning, prices))
        .map_err(|f| fault(path, axle, (Side::Left, f)))?;
    let kept = tuning.best.as_ref().map(|best| &best.offsets[..]);
    let mut summary = TuningSummary::of(study, optimise, &tuning, None);
    summary.prices = PriceRecord::all(optimise, &choices.prices, kept);
    let mut files = vec!["curves_before.csv", "history.csv", "summary.json"];
    files.extend(choices.write(&output, study, optimise)?);
    output.file("curves_before.csv", &axle_curves_csv(axle, &plan, &before))?;
    output.file("history.csv", &history_csv(&tuning.starts))?;
    output.json("summary.json", &summary)?;
    output.without("sensitivities.csv")?;
    say_outcome(&output, study, &summary)?;
    let tuned = tuning
        .best
        .as_ref()
        .map(|best| tuned_axle(axle, optimise, best));
    let after = tuned.as_ref().map(solved).transpose()?;
    let mut designs = vec![("before", "curves_before.csv", axle, &before)];
    let mut complete = choices.say(&output, optimise, &summary)? & !summary.falls_short();
    let mut refused = None;
    if let (Some(best), Some(tuned), Some(after)) = (&tuning.best, &tuned, &after) {
        designs.push(("after", "curves.csv", tuned, after));
        let design = axle_curves(tuned, &plan.at_design()).map_err(|f| fault(path, axle, f))?;
        complete &= after.are_complete();
        output.main_csv("curves.csv", &axle_curves_csv(tuned, &plan, after))?;
        if !plan.sensitivities.is_empty() {
            let csv = axle_sensitivities_csv(tuned, &plan, after);
            output.file("sensitivities.csv", &csv)?;
            files.push("sensitivities.csv");
        }
        let right = tuned.right.as_ref().map(|right| right.design.as_slice());
        let text = study.with_designs(&best.design, right);
        output.file("optimised.toml", text.as_bytes())?;
        let directory = path.parent().unwrap_or(Path::new(""));
        refused = Study::from_text("optimised.toml", &text, directory).err();
        files = [&["curves.csv", "optimised.toml"], &files[..]].concat();
        let curves = AxleSummary::of(&study.name, tuned, &plan, after, &design);
        let remarks = said(path, tuned, &plan, after)?;
        let remarks = remarks.into_iter().chain(curves.remarks());
        output.say_doubts(remarks, after.are_complete())?;
        for failure in curves.failures() {
            output.say_failure(&format!("\n{failure}\n"))?;
        }
    } else {
        complete = false;
        output.without("curves.csv")?;
        output.without("optimised.toml")?;
    }
    let given = &designs[..];
    files.extend(show(
        &output,
        &wanted,
        study,
        (&plan, given),
        "optimise",
        path,
    )?);
    output.say_remarks(variable_doubts(study))?;
    complete &= refused.is_none();
    say_openings(&output, study, &summary, refused)?;
    output.print_files(&files)?;
    let interrupted = progress::interrupt_flag().load(Ordering::SeqCst);
    Ok(Exit::of(complete && !interrupted))
}

/// Writes the curves of the drawing and of percentiles of builds, each at every station by itself, with what a page needs; the
/// files that makes.
pub(super) fn fans(
    output: &Output,
    study: &Study,
    AxleStudy { axle, plan }: &AxleStudy,
    problem: &Problem,
    builds: &MonteCarlo,
) -> Result<Vec<&'static str>, Stop> {
    let plan = plan.quantities_alone();
    let path = Path::new(&study.name);
    let drawn = axle_curves(axle, &plan).map_err(|f| fault(path, axle, f))?;
    let of_percentile = |percentile: usize| {
        let mut curves = drawn.clone();
        for (number, station) in curves.stations.iter_mut().enumerate() {
            for (k, value) in station.values.iter_mut().enumerate() {
                let spread = &builds.spreads[problem.cell(k, number)];
                let found = spread.percentiles[percentile] * drawn.columns[k].factor;
                if let Ok(value) = value {
                    *value = found;
                }
            }
        }
        curves
    };
    let fans = FANS.map(|(name, file, percentile)| (name, file, of_percentile(percentile)));
    let fans = fans.iter();
    let mut designs: Vec<SolvedAxle<'_>> = fans
        .map(|(name, file, curves)| (*name, *file, axle, curves))
        .collect();
    // What matters most is the last.
    designs.push(("drawn", "curves.csv", axle, &drawn));
    for (_, file, _, curves) in &designs {
        output.file(file, &axle_curves_csv(axle, &plan, curves))?;
    }
    let both = AxleStudy {
        axle: axle.clone(),
        plan: plan.clone(),
    };
    let record = Record::of_axle("tolerance", study, &both, &plan, &designs);
    output.record("report.json", &record.map_err(|f| fault(path, axle, f))?)?;
    let mut files: Vec<_> = FANS.iter().map(|(_, file, _)| *file).collect();
    files.extend(["curves.csv", "report.json"]);
    Ok(files)
}

pub(super) fn check(
    arguments: &StudyArguments,
    study: &Study,
    AxleStudy { axle, plan }: &AxleStudy,
) -> Result<Exit, Stop> {
    let path = &arguments.study;
    let curves = axle_curves(axle, &plan.values_alone()).map_err(|f| fault(path, axle, f))?;
    let design = axle_curves(axle, &plan.at_design()).map_err(|f| fault(path, axle, f))?;
    let summary = AxleSummary::of(&study.name, axle, plan, &curves, &design);
    let mut out = Printer::new(arguments.format);
    out.say(&format!("{}: valid\n\n", path.display()))?;
    let mut remarks = said(path, axle, plan, &curves)?;
    remarks.extend(variable_doubts(study));
    for remark in remarks.into_iter().chain(summary.remarks()) {
        out.remark(&format!("{remark}\n\n"))?;
    }
    for failure in summary.failures() {
        out.failure(&format!("{failure}\n\n"))?;
    }
    out.say(&format!("{}\n\n", summary.headline()))?;
    if let Some(optimise) = &study.optimise {
        out.say(&format!(
            "tuning (optimise only): {} variables, {} targets, {} starts\n\n",
            optimise.variables.len(),
            optimise.targets.len(),
            optimise.starts
        ))?;
    }
    if let Some(sweep) = &study.sweep {
        out.say(&format!("{}\n\n", super::check::swept(study, sweep)))?;
    }
    if let Some(tolerance) = &study.tolerance {
        let said = super::check::scattered(tolerance);
        let problem = Problem::of(study, tolerance);
        let why = problem.ok().and_then(|problem| problem.not_in_lanes());
        let why = why.map_or_else(String::new, |why| {
            format!(
                " Its builds are solved one by one, not in SIMD lanes, {}.",
                why.describe()
            )
        });
        out.say(&format!("{said}{why}\n\n"))?;
    }
    out.table("outputs", summary.table())?;
    out.finish()?;
    Ok(Exit::of(curves.are_complete()))
}
