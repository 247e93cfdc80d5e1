//! Distance of a motion to the limits, in words.

use crate::analyse::Range;
use crate::curves::Curves;
use crate::derive::MotionPoint;
use crate::mechanism::DesignFault;
use crate::model;
use crate::plan::Plan;
use crate::report::{as_written, brief};
use crate::solve::Solver;
use crate::study::Study;
use std::ops::ControlFlow;

/// Distance from the drive values to the nearest limit of all these ranges. Negative if a value is beyond it.
pub(crate) fn travel_left<'r>(ranges: impl Iterator<Item = &'r Range>, values: &[f64]) -> f64 {
    let left = ranges.flat_map(|range| values.iter().map(move |value| range.margin(*value)));
    left.fold(f64::INFINITY, f64::min)
}

/// Smallest distance to a singular pose over the motion of the study, in words.
pub(super) fn margin(
    study: &Study,
    plan: &Plan,
    solver: &mut Solver,
    by_rack: &[(f64, Range)],
    moved: &Curves,
) -> Result<String, DesignFault> {
    let unit = study.wheel().length_unit.symbol();
    let drive = plan.drive.in_kernel();
    let values = plan.station_order.values();
    let mut least = (f64::INFINITY, 0.0);
    for rack in &plan.racks {
        let rack = rack * plan.rack_sign;
        solver.for_each_pose(drive, &plan.station_order, rack, |solver, station, pose| {
            let value = values[station];
            if let Ok(pose) = pose {
                let point = MotionPoint { drive, value, rack };
                let distance = solver.conditioning(pose, &point).distance;
                if distance < least.0 {
                    least = (distance, value);
                }
            }
            ControlFlow::Continue(())
        })?;
    }
    let (distance, at) = least;
    let reached = moved.stations.len() - moved.failed();
    let stations = match moved.failed() {
        0 => "Over the study's motion".to_owned(),
        _ => format!(
            "Over the {reached} of {} stations that the mechanism can reach",
            moved.stations.len()
        ),
    };
    if reached == 0 {
        return Ok("The mechanism can reach no station of the study's motion.".to_owned());
    }
    let mut text = format!(
        "{stations} the mechanism stays at least {} {unit} away from a dead centre or fold. It is nearest at {} {}.",
        brief(distance),
        plan.drive.name(),
        as_written(plan.drive.printed(at))
    );
    if drive == model::Drive::Travel {
        let reached = || by_rack.iter().filter(|(_, range)| !range.is_empty());
        let where_reached = if reached().count() == by_rack.len() {
            ""
        } else {
            " at the rack positions that can be reached"
        };
        let left = travel_left(reached().map(|(_, range)| range), values);
        text += &if left >= 0.0 {
            format!(
                " Nearest travel limit{where_reached}: {} {unit} away.",
                brief(left)
            )
        } else {
            format!(
                " The motion goes {} {unit} beyond the travel limit{where_reached}.",
                brief(-left)
            )
        };
    }
    Ok(text)
}
