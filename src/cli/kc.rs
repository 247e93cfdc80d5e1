//! `hardpoint kc`: simulates the tests of a kinematics and compliance rig.

use super::exit::{Exit, Stop};
use super::output::Output;
use super::report::refuse_without_directory;
use super::terminal;
use super::{KcArguments, Names};
use crate::report::{OtherProgram, counted, kc_page};
use crate::rig::{OTHER_TABLES, RigTests};
use crate::study::Study;

pub(super) fn run(arguments: &KcArguments) -> Result<Exit, Stop> {
    let other = arguments.names.map(other_program).transpose()?;
    let arguments = &arguments.run;
    let path = &arguments.study.study;
    let study = Study::read_elastic(path, &arguments.study.set)?;
    refuse_without_directory(arguments, None)?;
    let tests = RigTests::of(&study, other).map_err(|why| Stop::in_file(path, why))?;
    let output = Output::open(arguments, &study, "kc")?;
    let files = write_files(&output, &study, &tests, arguments.report)?;
    output.finish()?;

    print_summary(&output, &study, &tests)?;
    let results = &tests.results;
    output.say_remarks(results.warnings())?;
    for failure in results.failures() {
        output.say_failure(&format!("\nnot solved: {failure}\n"))?;
    }
    output.print_files(&files)?;
    Ok(Exit::of(results.is_complete()))
}

/// Program whose names and definitions `--names` requests for the results. Returns an error for SPMM, because no published
/// definition gives all signs of its results.
fn other_program(names: Names) -> Result<OtherProgram, Stop> {
    match names {
        Names::Adams => Ok(OtherProgram::Adams),
        Names::Altair => Ok(OtherProgram::Altair),
        Names::Spmm => Err(Stop::wrong_input(
            "--names spmm is not available: no published definition of these sheets gives all \
             signs, and sheets differ in the sign of toe and side force. kc.csv uses the signs \
             in docs/compliance.md",
        )),
    }
}

/// Writes the tables of the test results, `summary.json` and, if `report` is true, the page. Returns the names of the files.
fn write_files(
    output: &Output,
    study: &Study,
    tests: &RigTests<'_>,
    report: bool,
) -> Result<Vec<&'static str>, Stop> {
    let mut files = Vec::new();
    for (name, csv) in tests.tables() {
        match name {
            "kc.csv" => output.main_csv(name, &csv)?,
            name => output.file(name, &csv)?,
        }
        files.push(name);
    }
    for name in OTHER_TABLES.iter().filter(|name| !files.contains(*name)) {
        output.without(name)?;
    }
    output.json("summary.json", &tests.summary())?;
    files.push("summary.json");
    if report {
        let page = kc_page(&study.name, &tests.results);
        output.file("report.html", page.as_bytes())?;
        files.push("report.html");
    }
    Ok(files)
}

/// Prints the design loads at the contact points and the tables of the test results, with a note about the signs of the results.
fn print_summary(output: &Output, study: &Study, tests: &RigTests<'_>) -> Result<(), Stop> {
    let results = &tests.results;
    let stations = counted(results.stations.len(), "station");
    let parts = match tests.elastic_parts() {
        0 => "rigid mechanism".to_owned(),
        parts => counted(parts, "elastic part"),
    };
    output.say(&format!("{}: {parts}, {stations}\n", study.name))?;
    match results.design_loads[..] {
        [load] => output.say(&format!("design load: {load:.0} N at the contact point\n"))?,
        [left, right] => output.say(&format!(
            "design loads: {left:.0} N and {right:.0} N at the left and the right contact point\n"
        ))?,
        _ => {}
    }
    output.table_for_programs("figures", || results.table());
    for (place, table) in results.tables_for_readers() {
        output.text_only(&format!("\n{place}\n\n{}", table.text(terminal::width())))?;
    }
    let signs = if results.is_axle {
        "Results of a wheel have the signs of a left wheel. Results of the axle are for loads to the left."
    } else {
        "Results have the signs of a left wheel."
    };
    let is_any_solved = results
        .stations
        .iter()
        .any(|station| station.outcomes.is_ok());
    if is_any_solved {
        output.text_only(&format!(
            "\nDerivatives at the station, and secants over the window. {signs} Signs: docs/compliance.md\n"
        ))?;
    }
    Ok(())
}
