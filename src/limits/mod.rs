//! Limits of a mechanism as a table: ranges of travel, rack and arm angle, and the parts that end these ranges.

mod builds;
mod elastic;
mod margin;
mod row;

use crate::analyse::{Limits, Range, RangeEnd, RockerRange};
use crate::axle::{Axle, AxleEnd, AxleLimits, TravelRanges};
use crate::checked::{NamedCurves, motion_alone, not_solved};
use crate::curves::Curves;
use crate::mechanism::{DesignFault, Toggle};
use crate::model::{self, Axis, RockerId, Side};
use crate::plan::Plan;
use crate::report::{Table, as_written};
use crate::solve::Solver;
use crate::solved::Solved;
use crate::study::{AxleStudy, Drive, Study, Vehicle, WheelStudy};
pub use builds::{NearestEnd, NearestLimits, VehicleLimits};
use margin::{Ranges, margin, travel_left};
use row::{LOST, Row, at_toggle, because};
pub use row::{LimitEnd, LimitRow};

/// Limits of the mechanism of a study, with the texts below their table.
pub(crate) struct LimitTable {
    /// A row for each quantity, with the limits of this quantity while the other quantities stay constant.
    rows: Vec<LimitRow>,
    /// Sentences below the table.
    pub(crate) notes: Vec<String>,
    /// Stations of the study's own motion and of its named motions that are not solved, one range per line.
    pub(crate) failures: Vec<String>,
}

/// Rows of limits, and sentences below their table.
type Found = (Vec<LimitRow>, Vec<String>);

impl LimitTable {
    /// Finds the limits of one wheel or of an axle. An error explains why the design has no position.
    pub(crate) fn of(study: &Study) -> Result<Self, String> {
        let alone = motion_alone(study);
        let ((rows, notes), solved) = match &study.vehicle {
            Vehicle::Axle(both) => {
                let found = match &both.axle.elastic {
                    Some(elastic) => elastic::of_axle(study, both, elastic),
                    None => of_axle(study, both),
                };
                (found?, Solved::of(&alone)?)
            }
            Vehicle::Wheel(own) => {
                let fault = |fault: DesignFault| fault.describe(&own.suspension.mechanism);
                match &own.compliance {
                    Some(elastic) => {
                        let found = elastic::of_wheel(study, own, elastic).map_err(fault)?;
                        (found, Solved::of(&alone)?)
                    }
                    None => {
                        let mut limits = WheelLimits::of(own).map_err(fault)?;
                        let solved = Solved::of(&alone)?;
                        let notes = limits.notes(study, &solved.curves).map_err(fault)?;
                        ((limits.rows(study), notes), solved)
                    }
                }
            }
        };
        let of_motions = NamedCurves::all(&alone)?;
        let failures = not_solved(&solved, &of_motions, study.wheel());
        Ok(LimitTable {
            rows,
            notes,
            failures,
        })
    }

    /// Table of the limits with their causes, one row for each quantity.
    pub(crate) fn table(&self) -> Table {
        row::table(&self.rows)
    }
}

/// Ranges of travel and rack in the motion of one wheel. Each range has the name of its quantity in the table of limits. Empty for
/// an axle.
pub(crate) fn motion_ranges(study: &Study) -> Vec<(String, [f64; 2])> {
    let Some(own) = study.one_wheel() else {
        return Vec::new();
    };
    let ends = |values: &[f64]| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (least < most).then_some([least, most])
    };
    let motion = &own.motion;
    let rack = format!("rack_{}", own.suspension.length_unit.symbol());
    let travel = match motion.drive {
        Drive::Travel => Some(driven(study, String::new()).quantity),
        _ => None,
    };
    let travel = travel.zip(ends(&motion.values));
    travel
        .into_iter()
        .chain(ends(&motion.rack).map(|ends| (rack, ends)))
        .collect()
}

/// Limits of a rigid wheel.
struct WheelLimits<'s> {
    solver: Solver<'s>,
    limits: Limits,
    plan: Plan,
    by_rack: Vec<(f64, Range)>,
}

impl<'s> WheelLimits<'s> {
    fn of(own: &'s WheelStudy) -> Result<Self, DesignFault> {
        let suspension = &own.suspension;
        let mut solver = Solver::new(&suspension.mechanism, &suspension.design)?;
        let limits = solver.limits()?;
        let plan = Plan::of(own);
        let by_rack = ranges_by_rack(&plan, &mut solver)?;
        Ok(WheelLimits {
            solver,
            limits,
            plan,
            by_rack,
        })
    }

    /// Notes on the distances between the study's motion and the limits. `moved` has the curves over this motion. Empty for the
    /// drive of Attia's paper.
    fn notes(&mut self, study: &Study, moved: &Curves) -> Result<Vec<String>, DesignFault> {
        if study.motion().drive == Drive::PaperTheta {
            return Ok(Vec::new());
        }
        let ranges = Ranges {
            by_rack: &self.by_rack,
            rockers: &self.limits.rockers,
        };
        margin(study, &self.plan, &mut self.solver, ranges, moved)
    }

    fn rows(&self, study: &Study) -> Vec<LimitRow> {
        wheel_rows(study, &self.limits, &self.by_rack)
    }
}

/// Limits of an axle without elastic parts. For independent wheels, the limits of rack and roll name the wheel that causes them.
fn of_axle(study: &Study, both: &AxleStudy) -> Result<Found, String> {
    let axle = &both.axle;
    let limits = axle.limits().map_err(|f| axle.describe_fault(f))?;
    let mut notes = Vec::new();
    if axle.setup.wheel_radius.is_some() && limits.roll.iter().any(Option::is_none) {
        notes.push("The roll angle at the ends of the travels is not known.".to_owned());
    }
    Ok((axle_rows(study, axle, &limits), notes))
}

/// Rows of the table of limits, one for each quantity of an axle without elastic parts. The row for roll needs the wheel radius.
fn axle_rows(study: &Study, axle: &Axle, limits: &AxleLimits) -> Vec<LimitRow> {
    let travels = travel_rows(axle, limits).into_iter();
    let mut rows: Vec<LimitRow> = travels
        .map(|(row, range)| row.between(study, &range.lower, &range.upper))
        .collect();
    if let TravelRanges::OfWheels(travels) = &limits.travels {
        for (side, travel) in Side::ALL.into_iter().zip(travels) {
            for range in &limits.rockers[side as usize] {
                let name = format!("{}_{}", side.name(), rod_travel(study, range.rocker));
                rows.push(toggles(name, "rack 0", range, travel));
            }
        }
    }
    let end = |end: &AxleEnd| {
        let why = match &end.end {
            RangeEnd::Fold(limit) => because(limit, study),
            RangeEnd::Toggle { rod, .. } => at_toggle(*rod),
            _ => LOST.to_owned(),
        };
        let why = if axle.is_rigid() {
            why
        } else {
            end.side.about(&why)
        };
        (Some(end.value), why)
    };
    if let Some(ends) = &limits.rack {
        rows.push(Row::axle_rack(axle).with(ends.each_ref().map(end)));
    }
    if axle.setup.wheel_radius.is_some() {
        let ends = limits.roll.each_ref().map(Option::as_ref);
        let unknown = || (None, "not known".to_owned());
        rows.push(Row::roll().with(ends.map(|known| known.map_or_else(unknown, end))));
    }
    rows
}

/// Rows for the travels of an axle, with the ranges of these travels. The travels are left and right travel, or for a solid axle
/// heave and travel difference.
fn travel_rows<'l>(axle: &Axle, limits: &'l AxleLimits) -> Vec<(Row, &'l Range)> {
    match &limits.travels {
        TravelRanges::OfWheels(ranges) => {
            let rows = Side::ALL.map(|side| Row::wheel_travel(axle, side));
            rows.into_iter().zip(ranges).collect()
        }
        TravelRanges::OfAxle {
            heave,
            half_difference,
        } => vec![
            (
                Row::length_of_axle(axle, "heave", "travel difference 0", 1.0),
                heave,
            ),
            // The travel difference is travel of the left wheel minus travel of the right wheel.
            (
                Row::length_of_axle(axle, "travel_difference", "heave 0", 2.0),
                half_difference,
            ),
        ],
    }
}

/// Range of the study's drive at each requested rack displacement, in the study's axes.
fn ranges_by_rack(plan: &Plan, solver: &mut Solver) -> Result<Vec<(f64, Range)>, DesignFault> {
    let drive = plan.drive.in_kernel();
    let mut range = |rack: f64| Ok((rack, solver.drive_range(drive, rack * plan.rack_sign)?));
    plan.racks.iter().map(|rack| range(*rack)).collect()
}

/// Words for the middle position of the rack, in which other quantities move to their limits. Empty without a rack.
fn straight(limits: &Limits) -> &'static str {
    match &limits.rack {
        Some(_) => "rack 0",
        None => "",
    }
}

/// Rows for travel, rack and arm angle of a wheel, each with the range of the quantity while the other quantities stay constant.
/// [`toggles`] makes the rows of rockers.
fn ranges<'l>(
    study: &Study,
    limits: &'l Limits,
    by_rack: &'l [(f64, Range)],
) -> Vec<(Row, &'l Range)> {
    let row = |quantity: &str, at: &str, factor: f64| Row {
        quantity: quantity.to_owned(),
        at: at.to_owned(),
        factor,
    };
    let (unit, straight) = (study.wheel().length_unit.symbol(), straight(limits));
    let travel = format!("travel_{unit}");
    let mut rows = vec![(row(&travel, straight, 1.0), &limits.travel)];
    if let Some(range) = &limits.rack {
        let sign = study.wheel().frame.sign(Axis::Y);
        rows.push((row(&format!("rack_{unit}"), "travel 0", sign), range));
    }
    if let Some(range) = &limits.arm_angle {
        let degrees = 1.0_f64.to_degrees();
        rows.push((row("arm_angle_deg", straight, degrees), range));
    }
    let moved = by_rack.iter().filter(|(rack, _)| *rack != 0.0);
    let at = |rack: f64| format!("rack {}", as_written(rack));
    rows.extend(moved.map(|(rack, range)| (driven(study, at(*rack)), range)));
    rows
}

/// Row for the study's drive (travel or arm angle). `at` describes the rack position in words.
fn driven(study: &Study, at: String) -> Row {
    let (quantity, factor) = match study.motion().drive.in_kernel() {
        model::Drive::Travel => (
            format!("travel_{}", study.wheel().length_unit.symbol()),
            1.0,
        ),
        model::Drive::ArmAngle => ("arm_angle_deg".to_owned(), 1.0_f64.to_degrees()),
    };
    Row {
        quantity,
        at,
        factor,
    }
}

/// Name of the quantity "wheel travel at which a rocker's rod is at toggle" (dead centre), such as `pushrod_travel_mm`.
fn rod_travel(study: &Study, rocker: RockerId) -> String {
    let rod = study.wheel().mechanism.rocker(rocker).rod.to_string();
    let unit = study.wheel().length_unit.symbol();
    format!("{}_travel_{unit}", rod.replace(' ', "_"))
}

/// Row of the wheel travels at which the rod of a rocker is at toggle (at the dead centre of its rocker). If a toggle is beyond the
/// end of the wheel's travel, the row has that end instead.
fn toggles(quantity: String, at: &str, range: &RockerRange, travel: &Range) -> LimitRow {
    let end = |toggle: Option<Toggle>, end: &RangeEnd| match toggle {
        Some(Toggle { travel, rod }) => {
            LimitEnd::new(Some(travel), format!("the {rod} is at toggle"))
        }
        None => LimitEnd::new(Some(end.value()), "the wheel's travel ends"),
    };
    LimitRow {
        quantity,
        at: at.to_owned(),
        ends: [
            end(range.lower, &travel.lower),
            end(range.upper, &travel.upper),
        ],
    }
}

/// Rows of the table of limits, one for each quantity of a rigid wheel while the other quantities stay constant.
fn wheel_rows(study: &Study, limits: &Limits, by_rack: &[(f64, Range)]) -> Vec<LimitRow> {
    let ranges = ranges(study, limits, by_rack).into_iter();
    let mut rows: Vec<LimitRow> = ranges.map(|(row, range)| row.of(study, range)).collect();
    if study.motion().rack_moves {
        let ranges = || by_rack.iter().map(|(_, range)| range);
        let lower = ranges().max_by(|a, b| a.ends()[0].total_cmp(&b.ends()[0]));
        let upper = ranges().min_by(|a, b| a.ends()[1].total_cmp(&b.ends()[1]));
        if let (Some(lower), Some(upper)) = (lower, upper) {
            let row = driven(study, "every rack".to_owned());
            rows.push(if ranges().any(Range::is_empty) {
                row.of_no_rack()
            } else {
                row.between(study, &lower.lower, &upper.upper)
            });
        }
    }
    let toggle_rows = limits.rockers.iter().map(|range| {
        let name = rod_travel(study, range.rocker);
        toggles(name, straight(limits), range, &limits.travel)
    });
    rows.extend(toggle_rows);
    rows
}
