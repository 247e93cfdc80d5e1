//! Distance between the motion of a study and the limits of its mechanism, in words.

use crate::analyse::{Range, RockerRange};
use crate::curves::Curves;
use crate::derive::MotionPoint;
use crate::mechanism::{DesignFault, Toggle};
use crate::model;
use crate::plan::Plan;
use crate::report::{as_written, brief, to_digits};
use crate::solve::Solver;
use crate::study::Study;
use std::ops::ControlFlow;

/// Distance from the drive values of a motion to the nearest limit of the drive, in the unit of the drive. `ranges` has the range
/// of the drive at each rack displacement; empty ranges are left out. Negative if a value is beyond the limit. Infinite if all
/// ranges are empty.
pub(super) fn travel_left<'r>(ranges: impl Iterator<Item = &'r Range>, values: &[f64]) -> f64 {
    let ranges = ranges.filter(|range| !range.is_empty());
    let left = ranges.flat_map(|range| values.iter().map(move |value| range.margin(*value)));
    left.fold(f64::INFINITY, f64::min)
}

/// Ranges of a wheel up to its limits. `by_rack` has the ranges of the drive at each rack displacement. `rockers` has the ranges
/// of the rockers with the rack in the middle.
#[derive(Clone, Copy)]
pub(super) struct Ranges<'r> {
    pub(super) by_rack: &'r [(f64, Range)],
    pub(super) rockers: &'r [RockerRange],
}

/// Describes the margins of the study's motion, one note for each: wheel travel to the travel limits and to the toggles of rockers,
/// and moves of the hardpoints to a singular pose.
pub(super) fn margin(
    study: &Study,
    plan: &Plan,
    solver: &mut Solver,
    ranges: Ranges,
    moved: &Curves,
) -> Result<Vec<String>, DesignFault> {
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
        let words = "The mechanism cannot reach any station of the study's motion.";
        return Ok(vec![words.to_owned()]);
    }
    let mut notes = Vec::new();
    if drive == model::Drive::Travel {
        let by_rack = || ranges.by_rack.iter().map(|(_, range)| range);
        let where_reached = if by_rack().any(Range::is_empty) {
            " at the rack positions that can be reached"
        } else {
            ""
        };
        let left = travel_left(by_rack(), values);
        notes.push(travel_left_in_words(left, unit, where_reached));
    }
    notes.extend(Some(toggles(ranges.rockers, moved, unit)).filter(|text| !text.is_empty()));
    notes.push(format!(
        "{stations} the hardpoints can move by about {} {unit} or more before the wheel's links reach a toggle or a turning \
         point of the path. This is an estimate from the conditioning of their equations. It is smallest at {} {} {}.",
        brief(to_digits(distance, 3)),
        plan.drive.name(),
        as_written(plan.drive.printed(at)),
        plan.drive.unit(study.wheel().length_unit)
    ));
    Ok(notes)
}

/// Sentence about the wheel travel between the motion and the nearest travel limit. `left` is this
/// travel in `unit`, negative if the motion goes beyond the limit. `where_reached` is empty, or limits the sentence to some rack
/// positions.
pub(super) fn travel_left_in_words(left: f64, unit: &str, where_reached: &str) -> String {
    if left >= 0.0 {
        let left = brief(left);
        format!("Nearest travel limit{where_reached}: {left} {unit} of wheel travel away.")
    } else {
        let beyond = brief(-left);
        format!(
            "The motion goes {beyond} {unit} of wheel travel beyond the travel limit{where_reached}."
        )
    }
}

/// Sentences about the toggles of rockers (dead centres at which a rod can no longer turn its rocker) at the ends of the wheel
/// travel. The rocker of the pushrod also moves the lever of the anti-roll bar. So the rocker and the lever end at the same toggle,
/// which is named once.
fn toggles(rockers: &[RockerRange], moved: &Curves, unit: &str) -> String {
    let travels = || moved.along("travel").flatten();
    let least = travels().fold(0.0, f64::min);
    let most = travels().fold(0.0, f64::max);
    let mut named = Vec::new();
    let mut sentences = Vec::new();
    for range in rockers {
        for (is_upper, toggle) in [(false, range.lower), (true, range.upper)] {
            let Some(Toggle { travel, rod }) = toggle else {
                continue;
            };
            if named.contains(&(is_upper, rod)) {
                continue;
            }
            named.push((is_upper, rod));
            let left = if is_upper {
                travel - most
            } else {
                least - travel
            };
            let place = if left > 0.0 {
                format!("{} {unit} beyond the motion", brief(left))
            } else {
                "within the motion".to_owned()
            };
            let travel = brief(travel);
            sentences.push(format!(
                "The {rod} reaches its toggle at travel {travel} {unit}, {place}."
            ));
        }
    }
    sentences.join(" ")
}
