//! `hardpoint limits`: finds the limits of travel, rack and arm, with the cause of each limit.

use super::exit::{Exit, Stop};
use super::printer::Printer;
use super::save::{note_saved, save};
use super::{LimitsArguments, StudyArguments};
use crate::limits::{LimitTable, motion_ranges};
use crate::report::{LimitsSheet, limits_page};
use crate::study::{CarStudy, Study};
use std::path::Path;

pub(super) fn run(arguments: &LimitsArguments) -> Result<Exit, Stop> {
    if CarStudy::is_at(&arguments.study.study) {
        return super::car::limits(arguments);
    }
    let (builds, page) = (arguments.builds, arguments.report.as_deref());
    let force = arguments.force;
    let arguments = &arguments.study;
    let path = &arguments.study;
    let study = Study::read_elastic(path, &arguments.set)?;
    if let Some(count) = builds {
        return super::limits_of_builds::run(arguments, &study, count);
    }
    let stop = |why| Stop::in_file(path, why);
    let limits = LimitTable::of(&study).map_err(stop)?;
    if let Some(page) = page {
        save_page(page, force, arguments, &study, &limits)?;
    }
    let mut out = Printer::new(arguments.format);
    out.table("limits", limits.table())?;
    for note in &limits.notes {
        out.say(&format!("\n{note}\n"))?;
    }
    for failure in &limits.failures {
        out.failure(&format!("\n{failure}\n"))?;
    }
    out.finish()?;
    Ok(Exit::of(limits.failures.is_empty()))
}

fn save_page(
    path: &Path,
    force: bool,
    arguments: &StudyArguments,
    study: &Study,
    limits: &LimitTable,
) -> Result<(), Stop> {
    let page = limits_page(&LimitsSheet {
        study: &study.name,
        limits: &limits.table(),
        motion: &motion_ranges(study),
        notes: &limits.notes,
        failures: &limits.failures,
    });
    let inputs = [arguments.study.clone()];
    save(path, page.as_bytes(), force, &inputs)?;
    note_saved(path);
    Ok(())
}
