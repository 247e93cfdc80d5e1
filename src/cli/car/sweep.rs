//! `hardpoint sweep` of a car.

use super::super::SweepArguments;
use super::super::exit::{Exit, Stop};
use super::super::sweep::{Ready, carry_out, check_number, is_to_stdout};
use super::{KEPT_NAMES, kept};
use crate::report::{SweepText, settings_of_car};
use crate::study::CarStudy;
use crate::sweep::{CarNotBegun, CarSweepPlan, Swept};
use std::io::Write;

pub(in crate::cli) fn sweep(arguments: &SweepArguments) -> Result<Exit, Stop> {
    let path = &arguments.study.study;
    let study = CarStudy::read(path, &arguments.study.set)?;
    let Some(sweep) = &study.sweep else {
        return Err(Stop::no_section(path, "sweep", "the designs to solve"));
    };
    let plan = CarSweepPlan::of(&study, sweep).map_err(|reason| match reason {
        CarNotBegun::Fault(fault) => Stop::in_file(path, study.car.describe_fault(&fault)),
        CarNotBegun::Columns(fault) => Stop::in_file(path, fault),
    })?;
    if let Some(number) = arguments.design {
        return print_settings(&study, &plan, number);
    }
    is_to_stdout(arguments, sweep.format)?;
    let ready = Ready {
        swept: Swept::Car(&plan),
        text: SweepText::without_curves(),
        inputs: study.inputs.clone(),
        kept_names: &KEPT_NAMES,
        kept: &|directory| kept(&study, directory),
        draw: &|_, _| Ok(()),
    };
    carry_out(arguments, &ready, || ())
}

/// Prints the `--set` options that change the study to one design of the sweep.
fn print_settings(study: &CarStudy, plan: &CarSweepPlan<'_>, number: u64) -> Result<Exit, Stop> {
    check_number(number, &plan.record).map_err(Stop::wrong_input)?;
    let values = plan.values(number);
    let variables = study.sweep.iter().flat_map(|sweep| &sweep.variables);
    let variables: Vec<_> = variables.cloned().collect();
    let mut out = std::io::stdout().lock();
    for setting in settings_of_car(study, &plan.car(&values), &variables, &values) {
        writeln!(out, "--set '{setting}'")?;
    }
    Ok(Exit::Done)
}
