//! `hardpoint export` of a car: hardpoints of both axles, or results of all load cases.

use super::super::exit::{Exit, Stop};
use super::super::export::{ExportArguments, Target, say};
use super::super::save::{file_of_out, note_saved, save};
use super::{solver, source};
use crate::exchange::{
    Page, car_point_pages, car_points_csv, cases_in, csv, page_of_csv, suspensions_ini_of_car,
    workbook,
};
use crate::report::CarResults;
use crate::study::CarStudy;
use std::io::Write;
use std::path::Path;

pub(in crate::cli) fn export(arguments: &ExportArguments, file: &Path) -> Result<Exit, Stop> {
    let study = source::read(file, &arguments.set)?;
    check_call(arguments, &study)?;
    let points = || car_point_pages(&study, arguments.unit, arguments.frame);
    let bytes = match arguments.to {
        Target::Assetto => {
            let text = suspensions_ini_of_car(&study);
            say(text.map_err(|reason| Stop::in_file(file, reason))?)
        }
        Target::Xlsx => {
            let mut pages = points().to_vec();
            pages.push(cases(&study, file, arguments)?);
            workbook(&pages)
        }
        _ if arguments.curves => csv(&cases(&study, file, arguments)?.rows),
        _ => car_points_csv(points()),
    };
    match file_of_out(&arguments.out) {
        None => std::io::stdout().write_all(&bytes)?,
        Some(out) => {
            save(out, &bytes, arguments.force, &study.inputs)?;
            note_saved(out);
        }
    }
    Ok(Exit::Done)
}

/// Refuses formats and options that only work for a single axle.
fn check_call(arguments: &ExportArguments, study: &CarStudy) -> Result<(), Stop> {
    let axles = study.inputs[1..].iter();
    let axles: Vec<String> = axles.map(|path| path.display().to_string()).collect();
    if !matches!(arguments.to, Target::Csv | Target::Xlsx | Target::Assetto) {
        return Err(Stop::wrong_input(format!(
            "a car can be exported to csv, xlsx and assetto; for other formats export its axles: {}",
            axles.join(", ")
        )));
    }
    let of_one_axle = [
        (arguments.round.is_some(), "--round"),
        (arguments.design.is_some(), "--design"),
        (arguments.names.is_some(), "--names"),
    ];
    if let Some((_, option)) = of_one_axle.iter().find(|(given, _)| *given) {
        return Err(Stop::wrong_input(format!(
            "{option} works for a single axle; export the axles: {}",
            axles.join(", ")
        )));
    }
    Ok(())
}

/// Results of all load cases, in the unit and axes of the file.
fn cases(study: &CarStudy, file: &Path, arguments: &ExportArguments) -> Result<Page, Stop> {
    let results = CarResults::solve(study, &mut solver(study, file)?, study.cases.len());
    let page = page_of_csv("cases", &results.cases_csv());
    let page = page.map_err(|reason| Stop::in_file(file, reason))?;
    Ok(cases_in(study, arguments.unit, arguments.frame, page))
}
