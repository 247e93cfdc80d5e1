//! Commands for the study of a car.

mod compare;
mod export;
mod limits;
mod optimise;
mod source;
mod sweep;
mod tolerance;

pub(super) use compare::{are_cars, compare};
pub(super) use export::export;
pub(super) use limits::limits;
pub(super) use optimise::optimise;
pub(super) use source::file_of;
pub(super) use sweep::sweep;
pub(super) use tolerance::tolerance;

use super::exit::{Exit, Stop};
use super::interrupt;
use super::output::{Destination, Output, pool};
use super::printer::Printer;
use super::report::refuse_without_directory;
use super::terminal;
use super::{CurveArguments, StudyArguments};
use crate::car::CarSolver;
use crate::report::{CarRecord, CarResults, car_page, car_study_bands_missed, counted};
use crate::results::{Claim, digest_of_texts};
use crate::study::CarStudy;
use serde_json::json;
use std::path::Path;

/// Files that the commands for cars write, except `sweep`.
const FILES: [&str; 16] = [
    "report.json",
    "report.html",
    "cases.csv",
    "cases_before.csv",
    "gg.csv",
    "sensitivities.csv",
    "tolerance.csv",
    "contributors.csv",
    "side_effects.csv",
    "summary.json",
    "study.toml",
    "front.toml",
    "rear.toml",
    "optimised.toml",
    "optimised_front.toml",
    "optimised_rear.toml",
];

fn solver<'a>(study: &'a CarStudy, path: &Path) -> Result<CarSolver<'a>, Stop> {
    let fault = |fault| Stop::in_file(path, study.car.describe_fault(&fault));
    let made = if study.sensitivities {
        CarSolver::with_racks(&study.car)
    } else {
        CarSolver::new(&study.car)
    };
    made.map_err(fault)
}

/// `hardpoint check` of a car: checks the static position.
pub(super) fn check(arguments: &StudyArguments) -> Result<Exit, Stop> {
    let path = &arguments.study;
    let study = CarStudy::read(path, &arguments.set)?;
    let results = CarResults::solve(&study, &mut solver(&study, path)?, 1);
    let mut out = Printer::new(arguments.format);
    out.say(&format!("{}: valid\n\n", path.display()))?;
    for remark in results.remarks() {
        out.remark(&format!("{remark}\n\n"))?;
    }
    for line in car_study_bands_missed(&study) {
        out.remark(&format!("{line}\n\n"))?;
    }
    for failure in results.failures() {
        out.failure(&format!("{failure}\n\n"))?;
    }
    if !terminal::is_quiet() {
        out.say(&format!("{}\n\nStatic position:\n\n", headline(&study)))?;
        out.table("static", results.static_table())?;
        out.finish()?;
    }
    Ok(Exit::of(results.is_complete()))
}

fn headline(study: &CarStudy) -> String {
    let tyres = match study.car.tyres {
        Some(_) => "tyre springs",
        None => "rigid tyres",
    };
    let cases = counted(study.cases.len(), "case");
    format!("{}: {cases}, {tyres}", study.name)
}

fn open(arguments: &CurveArguments, study: &CarStudy, command: &str) -> Result<Output, Stop> {
    if arguments.plots.is_some() {
        return Err(Stop::wrong_input(
            "--plots makes pictures of curves; pictures of a car are on its page (--report)",
        ));
    }
    let arguments = &arguments.run;
    if arguments.report && command == "tolerance" {
        return Err(Stop::wrong_input(
            "--report: `tolerance` makes no page for a car; the tables and files have all results",
        ));
    }
    refuse_without_directory(arguments, None)?;
    let (out, format) = (arguments.out.as_deref(), arguments.study.format);
    let destination = Destination::of(out, &study.name, arguments.force, format)?;
    Output::at(
        &destination,
        Claim {
            command,
            study: &study.name,
            digest: digest_of_texts(&study.texts()),
            files: &FILES,
            inputs: &study.inputs,
            ..Claim::default()
        },
    )
}

/// Names of the three studies stored with the results: the car, its front axle and its rear axle.
pub(super) const KEPT_NAMES: [&str; 3] = ["study.toml", "front.toml", "rear.toml"];

/// Texts of the three studies for files in a directory: the car, its front axle and its rear axle.
fn kept(study: &CarStudy, directory: &Path) -> Vec<String> {
    let [_, front_name, rear_name] = KEPT_NAMES;
    let [front, rear] = &study.axles;
    vec![
        crate::report::car_with_axles(&study.text, front_name, rear_name),
        front.text_in(directory),
        rear.text_in(directory),
    ]
}

/// Writes the studies of a run with its results, if the output is a directory. Returns the names of the files.
pub(super) fn keep(output: &Output, study: &CarStudy) -> Result<Vec<&'static str>, Stop> {
    let mut names = Vec::new();
    if let Some(directory) = output.directory() {
        for (name, text) in KEPT_NAMES.into_iter().zip(kept(study, directory.path())) {
            output.file(name, text.as_bytes())?;
            names.push(name);
        }
    }
    Ok(names)
}

/// Writes the data of the page, and the page itself if it is requested. Returns the names of the files.
fn page(
    output: &Output,
    record: CarRecord,
    files: &[&str],
    with_page: bool,
) -> Result<Vec<&'static str>, Stop> {
    if output.directory().is_none() {
        return Ok(Vec::new());
    }
    let mut record = record;
    record.files = files.iter().map(|name| (*name).to_owned()).collect();
    output.record("report.json", &record)?;
    let mut names = vec!["report.json"];
    if with_page {
        output.file("report.html", car_page(&record).as_bytes())?;
        names.push("report.html");
    } else {
        // A page from an earlier run would show other results, so it is removed.
        output.without("report.html")?
    }
    Ok(names)
}

/// `hardpoint solve` of a car.
pub(super) fn solve(curves: &CurveArguments) -> Result<Exit, Stop> {
    let arguments = &curves.run;
    let path = &arguments.study.study;
    let study = CarStudy::read(path, &arguments.study.set)?;
    let mut solver = solver(&study, path)?;
    let output = open(curves, &study, "solve")?;
    let results = CarResults::solve(&study, &mut solver, study.cases.len());
    let mut files = vec!["cases.csv"];
    output.main_csv("cases.csv", &results.cases_csv())?;
    interrupt::stops_by_itself();
    let map = study.gg_map.as_ref().map(|map| {
        let pool = pool(arguments.threads, map.ax.len() as u64)?;
        let own = solver.clone();
        Ok::<_, Stop>(pool.install(|| results.gg(own, map, interrupt::flag())))
    });
    let map = map.transpose()?;
    let unfinished = map.as_ref().and_then(|map| map.unfinished_in_words());
    if unfinished.is_some() {
        output.mark_interrupted();
    }
    let map_failures = map.as_ref().map_or(0, |map| map.failures);
    let (gg_csv, map) = map.map(|map| (map.csv, map.map)).unzip();
    let map = map.filter(|map| !map.ax.is_empty());
    files.extend(output.file_if_any("gg.csv", gg_csv)?);
    let sensitivities = results.sensitivities_csv(&mut solver);
    files.extend(output.file_if_any("sensitivities.csv", sensitivities)?);
    let failures = results.failures();
    let warnings = results.remarks();
    let summary = json!({
        "command": "solve",
        "study": study.name,
        "cases": results.states.len(),
        "not_solved": failures,
        "gg_map_not_solved": map_failures,
        "warnings": warnings,
    });
    output.json("summary.json", &summary)?;
    files.push("summary.json");
    files.extend(keep(&output, &study)?);
    let remarks: Vec<String> = warnings.iter().chain(&unfinished).cloned().collect();
    let record = results.record("solve", &mut solver, map, &remarks);
    let with_page = arguments.report && unfinished.is_none();
    files.extend(page(&output, record, &files, with_page)?);
    output.finish()?;
    output.say(&format!("{}\n\n", headline(&study)))?;
    output.table("cases", &results.summary_table())?;
    output.say_plausibility(warnings, results.is_complete())?;
    for failure in &failures {
        output.say_failure(&format!("\nnot solved: {failure}\n"))?;
    }
    if map_failures > 0 {
        let states = counted(map_failures, "state");
        output.say(&format!(
            "\n{states} of gg_map have no equilibrium: see the column status in gg.csv\n"
        ))?;
    }
    if let Some(words) = &unfinished {
        output.say_failure(&format!("\n{words}\n"))?;
    }
    output.print_files(&files)?;
    Ok(match unfinished {
        Some(_) => Exit::Interrupted,
        None => Exit::of(results.is_complete()),
    })
}
