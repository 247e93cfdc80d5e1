//! `hardpoint solve`: computes curves over the motion of a study.

use super::CurveArguments;
use super::exit::{Exit, Stop};
use super::output::Output;
use super::report::ReportOptions;
use super::terminal;
use crate::checked::{AllMotions, NamedCurves};
use crate::in_motions::InMotion;
use crate::report::{Record, SolveSummary, counted, curves_csv};
use crate::solved::Solved;
use crate::study::{CarStudy, Study};

pub(super) fn run(curves: &CurveArguments) -> Result<Exit, Stop> {
    let arguments = &curves.run;
    let path = &arguments.study.study;
    if CarStudy::is_at(path) {
        return super::car::solve(curves);
    }
    let study = Study::read_elastic(path, &arguments.study.set)?;
    let fault = |why| Stop::in_file(path, why);
    let solved = Solved::of(&study).map_err(fault)?;
    // The summary and the next steps may refuse the study, so they run before any file is written.
    let summary = solved.summary().map_err(fault)?;
    let in_motions = InMotion::all(&[("design", &study)], false).map_err(fault)?;
    let of_motions: Vec<NamedCurves> = in_motions.iter().filter_map(NamedCurves::of_last).collect();
    let plausibility = solved.plausibility().map_err(fault)?;
    let record = Solved::record("solve", &[("design", "curves.csv", &solved)]).map_err(fault)?;
    let record = Record {
        motions: in_motions.iter().map(|own| own.record.clone()).collect(),
        ..record
    };
    let report = ReportOptions::open(curves, &study, "solve", || Ok(record.clone()))?;
    let output = Output::open(arguments, &study, "solve")?;

    let mut files = vec!["curves.csv"];
    output.main_csv("curves.csv", &solved.csv())?;
    files.extend(output.file_if_any("sensitivities.csv", solved.sensitivities_csv())?);
    for (file, curves) in in_motions.iter().flat_map(InMotion::files) {
        output.file(file, &curves_csv(curves))?;
        files.push(file);
    }
    output.json("summary.json", &summary)?;
    files.push("summary.json");
    if output.directory().is_some() {
        output.record("report.json", &record)?;
        files.push("report.json");
    }
    files.extend(report.show(&output)?);
    output.finish()?;

    output.say(&format!("{}\n\n", summary.headline()))?;
    let [ranges, stations, not_solved] = summary.tables().expect("of a solve");
    output.table_for_programs("stations", || stations);
    output.table("outputs", &ranges)?;
    output.table_for_programs("not_solved", || not_solved);
    say_motions(
        &output,
        summary.of_solve().expect("of a solve"),
        &of_motions,
    )?;
    let motions = AllMotions {
        own: solved.curves(),
        named: &of_motions,
    };
    let complete = motions.are_complete();
    let remarks = plausibility
        .into_iter()
        .chain(motions.remarks(study.wheel()));
    output.say_plausibility(remarks, complete)?;
    for failure in solved.failures() {
        output.say_failure(&format!("\nnot solved: {failure}\n"))?;
    }
    for motion in &of_motions {
        for failure in motion.failures(study.wheel()) {
            output.say_failure(&format!("\n{failure}\n"))?;
        }
    }
    output.print_files(&files)?;
    Ok(Exit::of(complete))
}

/// Prints the ranges of the outputs over each named motion of the study.
fn say_motions(
    output: &Output,
    summary: &SolveSummary,
    motions: &[NamedCurves],
) -> Result<(), Stop> {
    if motions.is_empty() {
        return Ok(());
    }
    let named = motions.iter().map(|own| (own.name.as_str(), &own.curves));
    output.table_for_programs("motions", || summary.motions_table(named));
    for motion in motions {
        let stations = counted(motion.curves.stations.len(), "station");
        output.text_only(&format!("\nmotion {}: {stations}\n\n", motion.name))?;
        let table = summary.table_of_motion(&motion.curves);
        output.text_only(&table.text(terminal::width()))?;
    }
    Ok(())
}
