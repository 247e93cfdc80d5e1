//! `hardpoint compare` of cars.

use super::super::compare::{CompareArguments, labels, print_tables, write};
use super::super::exit::{Exit, Stop};
use super::super::terminal::note;
use super::{solver, source};
use crate::report::{CarComparison, CarResults, Format, Tables};
use std::path::Path;

/// True if all sources are cars. Refuses a mixture of cars and other studies.
pub(in crate::cli) fn are_cars(arguments: &CompareArguments) -> Result<bool, Stop> {
    let sources = &arguments.sources;
    let cars = sources
        .iter()
        .filter(|path| source::file_of(path).is_some());
    match cars.count() {
        0 => Ok(false),
        count if count == sources.len() => Ok(true),
        _ => {
            let mut files = sources.iter().filter(|path| *path != Path::new("-"));
            if let Some(missing) = files.find(|path| !path.exists()) {
                // Reading this missing file returns an error, which says that the file cannot be read.
                source::read(missing, &[])?;
            }
            Err(Stop::wrong_input(
                "a car can be compared with cars only; compare its axles with other axles",
            ))
        }
    }
}

pub(in crate::cli) fn compare(arguments: &CompareArguments) -> Result<Exit, Stop> {
    let mut studies = Vec::new();
    let mut inputs = Vec::new();
    for path in &arguments.sources {
        let file = source::file_of(path).unwrap_or_else(|| path.clone());
        let study = source::read(&file, &[])?;
        inputs.extend(study.inputs.iter().cloned());
        studies.push((study, file));
    }
    let mut all = Vec::new();
    for ((study, file), label) in studies.iter().zip(labels(&arguments.sources)) {
        let results = CarResults::solve(study, &mut solver(study, file)?, study.cases.len());
        all.push((label, results));
    }
    let comparison = CarComparison::of(&all).map_err(Stop::wrong_input)?;
    write(arguments, &inputs, &comparison.csv(), None)?;
    let mut tables = Tables::default();
    let format: Format = arguments.format.into();
    let found = [
        ("figures", comparison.table()),
        ("changes", comparison.changes_table()),
    ];
    let is_equal = found.iter().all(|(_, table)| table.is_empty());
    for (name, table) in found {
        if format != Format::Text || !table.is_empty() {
            tables.push(name, table);
        }
    }
    print_tables(arguments, &tables)?;
    if is_equal {
        note("no differences\n");
    }
    if let Some(out) = arguments.directory() {
        note(&format!("\n{}: comparison.csv\n", out.display()));
    }
    Ok(Exit::of(
        all.iter().all(|(_, results)| results.is_complete()),
    ))
}
