//! `hardpoint export` of a car: points of both axles, and the results of the cases.

use super::super::exit::{Exit, Stop};
use super::super::export::{ExportArguments, Target, say};
use super::super::save::{file_of_out, save};
use super::{solver, source};
use crate::exchange::{
    Outgoing, Page, Value, csv, page_of_csv, point_rows, suspensions_ini_of_car, workbook,
};
use crate::number::Vector3;
use crate::report::CarResults;
use crate::study::{CarStudy, Study};
use std::io::Write;
use std::path::Path;

pub(in crate::cli) fn export(arguments: &ExportArguments, file: &Path) -> Result<Exit, Stop> {
    let study = source::read(file, &arguments.set)?;
    check_call(arguments, &study)?;
    let bytes = match arguments.to {
        Target::Assetto => {
            let text = suspensions_ini_of_car(&study);
            say(text.map_err(|reason| Stop::in_file(file, reason))?)
        }
        Target::Xlsx => {
            let mut pages = points(&study, arguments).to_vec();
            pages.push(cases(&study, file)?);
            workbook(&pages)
        }
        _ if arguments.curves => csv(&cases(&study, file)?.rows),
        _ => {
            let text = |text: &str| vec![Value::Text(text.to_owned())];
            let [front, rear] = points(&study, arguments).map(|page| page.rows);
            // Both axles have the same header.
            let header = front
                .iter()
                .take(1)
                .map(|row| [text("axle"), row.clone()].concat());
            let mut rows: Vec<Vec<Value>> = header.collect();
            for (end, own) in [("front", front), ("rear", rear)] {
                let own = own.into_iter().skip(1);
                rows.extend(own.map(|row| [text(end), row].concat()));
            }
            csv(&rows)
        }
    };
    match file_of_out(&arguments.out) {
        None => std::io::stdout().write_all(&bytes)?,
        Some(out) => save(out, &bytes, arguments.force, &study.inputs)?,
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

/// Points of both axles, in the axes of the car.
fn points(study: &CarStudy, arguments: &ExportArguments) -> [Page; 2] {
    [0, 1].map(|axle| {
        let own = placed(study, axle);
        let outgoing = Outgoing::of(&own, arguments.unit, arguments.frame);
        Page {
            name: format!("{}_hardpoints", ["front", "rear"][axle]),
            rows: point_rows(&outgoing),
        }
    })
}

/// Study of an axle whose points are at their places in the car.
fn placed(study: &CarStudy, axle: usize) -> Study {
    let mut own = study.axles[axle].clone();
    if axle == 0 {
        return own;
    }
    let offset = study.car.rear_offset;
    let shift = |design: &mut [Vector3<f64>], offset: Vector3<f64>| {
        for point in design {
            *point = *point + offset;
        }
    };
    shift(&mut own.wheel_mut().design, offset);
    if let Some(both) = own.axle_mut()
        && let Some(right) = &mut both.axle.right
    {
        // The right wheel is stored as a left wheel, so y changes its sign.
        let mirrored = Vector3::new(offset.x, -offset.y, offset.z);
        shift(&mut right.design, mirrored);
    }
    own
}

/// Results of the load cases.
fn cases(study: &CarStudy, file: &Path) -> Result<Page, Stop> {
    let results = CarResults::solve(study, &mut solver(study, file)?, study.cases.len());
    page_of_csv("cases", &results.cases_csv()).map_err(|reason| Stop::in_file(file, reason))
}
