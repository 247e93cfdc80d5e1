//! `hardpoint limits`

use super::StudyArguments;
use super::exit::{Exit, Stop};
use super::output::design_fault;
use crate::analyse::{Limits, Range, RangeEnd};
use crate::derive::MotionPoint;
use crate::mechanism::Toggle;
use crate::model::Axis;
use crate::plan::Plan;
use crate::report::{Format, Table, shortest};
use crate::solve::Solver;
use crate::study::{Drive, Study};
use std::io::Write;
use std::ops::ControlFlow;

pub(super) fn run(arguments: &StudyArguments) -> Result<Exit, Stop> {
    let path = &arguments.study;
    let study = Study::read(path, &arguments.set)?;
    let suspension = &study.suspension;
    let fault = |fault| design_fault(&study, path, &fault);
    let mut solver = Solver::new(&suspension.mechanism, &suspension.design).map_err(fault)?;
    let limits = solver.limits().map_err(fault)?;

    let mut out = std::io::stdout().lock();
    let format = arguments.format.into();
    write!(out, "{}", table(&study, &limits).render(format))?;
    if format == Format::Text && study.motion.drive != Drive::PaperTheta {
        let margin = margin(&study, &mut solver, &limits).map_err(fault)?;
        writeln!(out, "\n{margin}")?;
    }
    Ok(Exit::Done)
}

/// How far each quantity goes from the design position, the others held there.
fn table(study: &Study, limits: &Limits) -> Table {
    let unit = study.suspension.length_unit.symbol();
    let mut table = Table::new(["quantity", "from", "because", "to", "because there"]);
    let mut push = |name: String, range: &Range, factor: f64| {
        let beyond = match (&range.lower, &range.upper) {
            (RangeEnd::FullTurn, RangeEnd::FullTurn) => "it turns right round",
            _ => "it goes on beyond half a turn",
        };
        let end = |end: &RangeEnd, turn: f64| match end {
            RangeEnd::Fold(limit) => (shortest(limit.value * factor), limit.cause.to_string()),
            RangeEnd::FullTurn => (shortest(turn * factor), beyond.to_owned()),
            RangeEnd::Unresolved(value) => (
                shortest(value * factor),
                "the path could not be followed further".to_owned(),
            ),
        };
        let turn = std::f64::consts::PI;
        let ends = [end(&range.lower, -turn), end(&range.upper, turn)];
        // Axes that point the other way swap the ends.
        let [from, to] = if factor < 0.0 {
            let [lower, upper] = ends;
            [upper, lower]
        } else {
            ends
        };
        table.push([name, from.0, from.1, to.0, to.1]);
    };
    push(format!("travel_{unit}"), &limits.travel, 1.0);
    if let Some(range) = &limits.rack {
        let sign = study.suspension.frame.sign(Axis::Y);
        push(format!("rack_{unit}"), range, sign);
    }
    if let Some(range) = &limits.arm_angle {
        push("arm_angle_deg".to_owned(), range, 1.0_f64.to_degrees());
    }
    for range in &limits.rockers {
        let rod = study.suspension.mechanism.rocker(range.rocker).rod;
        let end = |toggle: Option<Toggle>, end: &RangeEnd| match toggle {
            Some(Toggle { travel, rod }) => (shortest(travel), format!("the {rod} is at toggle")),
            None => (shortest(end.value()), "the wheel's travel ends".to_owned()),
        };
        let from = end(range.lower, &limits.travel.lower);
        let to = end(range.upper, &limits.travel.upper);
        let name = format!("{}_travel_{unit}", rod.to_string().replace(' ', "_"));
        table.push([name, from.0, from.1, to.0, to.1]);
    }
    table
}

/// The least distance to a singularity over the motion of the study, in words.
fn margin(
    study: &Study,
    solver: &mut Solver,
    limits: &Limits,
) -> Result<String, crate::mechanism::DesignFault> {
    let plan = Plan::of(study);
    let unit = study.suspension.length_unit.symbol();
    let drive = plan.drive.in_kernel();
    let (mut least, mut unreached) = ((f64::INFINITY, 0.0), 0);
    for rack in &plan.racks {
        let rack = rack * plan.rack_sign;
        solver.for_each_pose(drive, &plan.station_order, rack, |solver, station, pose| {
            let value = plan.station_order.values()[station];
            match pose {
                Ok(pose) => {
                    let point = MotionPoint { drive, value, rack };
                    let distance = solver.conditioning(pose, &point).distance;
                    if distance < least.0 {
                        least = (distance, value);
                    }
                }
                Err(_) => unreached += 1,
            }
            ControlFlow::Continue(())
        })?;
    }
    let (distance, at) = least;
    let at = shortest(plan.drive.printed(at));
    let mut text = format!(
        "Over the study's motion the mechanism stays {distance:.3} {unit} or more from a singularity \
         (least at {} {at}).",
        plan.drive.name()
    );
    if drive == crate::model::Drive::Travel {
        let values = plan.station_order.values();
        let left = values
            .iter()
            .map(|v| limits.travel.margin(*v))
            .fold(f64::INFINITY, f64::min);
        text += &format!(" Travel left to the nearer end: {left:.3} {unit}.");
    }
    if unreached > 0 {
        text += &format!(" {unreached} stations are not reached.");
    }
    Ok(text)
}
