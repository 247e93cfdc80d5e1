//! `hardpoint solve`

use super::RunArguments;
use super::exit::{Exit, Stop};
use super::motions::NamedCurves;
use super::output::{Output, design_fault};
use super::report::Wanted;
use crate::curves::curves;
use crate::plan::Plan;
use crate::report::{
    FailureRange, Record, SolveSummary, curves_csv, doubts, remarks, sensitivities_csv,
};
use crate::study::Study;

pub(super) fn run(arguments: &RunArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = Study::read(path, &arguments.study.set)?;
    if let Some(axle) = &study.axle {
        return super::axle::solve(arguments, &study, axle);
    }
    let plan = Plan::of(&study);
    let suspension = &study.suspension;
    let fault = |fault| design_fault(&study, path, &fault);
    let curves = curves(suspension, &plan).map_err(fault)?;
    let output = Output::open(arguments, &study, "solve")?;
    let wanted = Wanted::open(arguments)?;

    let length = suspension.length_unit;
    let summary = SolveSummary::of(&study, &curves);
    let mut files = vec!["curves.csv"];
    output.main_csv("curves.csv", &curves_csv(&curves, &plan, length))?;
    let sensitive = !plan.sensitivities.is_empty();
    let csv = sensitive.then(|| sensitivities_csv(&curves, &plan, &suspension.mechanism, length));
    files.extend(output.file_if_any("sensitivities.csv", csv)?);
    let of_motions = NamedCurves::all(&study).map_err(fault)?;
    for motion in &of_motions {
        let csv = curves_csv(&motion.curves, &motion.plan, length);
        output.file(&motion.file, &csv)?;
        files.push(&motion.file);
    }
    output.json("summary.json", &summary)?;
    files.push("summary.json");
    if output.directory().is_some() {
        let design = ("design", "curves.csv", suspension, &curves);
        let record = Record::of("solve", &study, &plan, &[design]).map_err(fault)?;
        output.record("report.json", &record)?;
        files.push("report.json");
    }
    files.extend(wanted.show(output.directory())?);

    output.say(&format!(
        "{}: {}, {}\n\n",
        study.name,
        suspension.mechanism.topology.name,
        summary.headline()
    ))?;
    output.table_for_programs("stations", || summary.stations_table());
    output.table("outputs", &summary.table())?;
    output.table_for_programs("not_solved", || summary.failures_table());
    let doubts = doubts(suspension).map_err(fault)?;
    let mut complete = curves.are_complete();
    let said = doubts.into_iter().chain(remarks(&study, &curves));
    output.say_doubts(said, complete)?;
    for failure in FailureRange::all(&curves, plan.drive, study.suspension.length_unit) {
        output.say_failure(&format!("\nnot solved: {failure}\n"))?;
    }
    for motion in &of_motions {
        complete &= motion.curves.are_complete();
        for failure in motion.failures(length) {
            output.say_failure(&format!("\n{failure}\n"))?;
        }
        let (name, stations) = (&motion.name, motion.curves.stations.len());
        output.say(&format!("\nmotion {name}: {stations} stations\n"))?;
    }
    output.print_files(&files)?;
    Ok(Exit::of(complete))
}
