//! `hardpoint limits` of a car: accelerations at which a wheel lifts, and at which the equilibrium ends.

use super::super::LimitsArguments;
use super::super::exit::{Exit, Stop};
use super::super::printer::Printer;
use super::super::terminal;
use super::solver;
use crate::report::{car_limits, lift_limits_table};
use crate::study::CarStudy;

pub(in crate::cli) fn limits(arguments: &LimitsArguments) -> Result<Exit, Stop> {
    if arguments.builds.is_some() || arguments.report.is_some() {
        return Err(Stop::wrong_input(
            "`hardpoint limits` of a car prints a table, without --builds and --report",
        ));
    }
    let path = &arguments.study.study;
    let study = CarStudy::read(path, &arguments.study.set)?;
    let limits = car_limits(&study, &mut solver(&study, path)?);
    let mut out = Printer::new(arguments.study.format);
    if !terminal::is_quiet() {
        let name = &study.name;
        out.say(&format!(
            "{name}: accelerations at which the first wheel lifts and at which equilibrium ends, by direction \
             and by case (search up to 5 g)\n\n"
        ))?;
    }
    out.table("lift_limits", lift_limits_table(&limits, &study.car))?;
    out.finish()?;
    Ok(Exit::of(limits.iter().all(|limit| limit.has_start())))
}
