//! Warnings about an axle: about the curves, the springs, the steering, and the hardpoints of both wheels.

use super::{track_doubt, wheel_plausibility};
use crate::ask::{Need, Unit};
use crate::axle::{
    Axle, AxleCurves, AxlePlan, BeyondCurve, ForcePart, Law, Quantity, WheelQuantity, axle_curves,
};
use crate::car::GRAVITY;
use crate::curves::Column;
use crate::mechanism::DesignFault;
use crate::model::{Axis, LengthUnit, PointId, Side, Suspension};
use crate::report::figure::{as_written, brief};
use crate::report::station_label::place_in_words;

/// Largest plausible difference between two forces in the design position: the load that the springs carry, and the weight of the
/// sprung mass. It is a fraction of this weight.
const OFF_BALANCE: f64 = 0.05;

/// Warnings about an axle, one per line: about its curves, and about both wheels in the design position. For a right wheel with
/// its own hardpoints, warnings that the left wheel also has are omitted.
pub fn both_wheels_plausibility(
    axle: &Axle,
    plan: &AxlePlan,
    curves: &AxleCurves,
) -> Result<Vec<String>, (Side, DesignFault)> {
    let mut found = wheel_plausibility(&axle.left).map_err(|fault| (Side::Left, fault))?;
    let wheels = Side::ALL.map(|side| axle.suspension(side));
    found.extend(track_doubt(wheels).map_err(|fault| (Side::Left, fault))?);
    if let Some(own) = &axle.right {
        let of_right = wheel_plausibility(own).map_err(|fault| (Side::Right, fault))?;
        let new: Vec<_> = of_right.iter().filter(|d| !found.contains(d)).collect();
        let named =
            |doubt: &&String| doubt.replacen("please check: ", "please check: right wheel: ", 1);
        found.extend(new.iter().map(named).collect::<Vec<_>>());
        found.extend(across(&axle.left, own));
    }
    found.extend(axle_plausibility(
        axle,
        plan,
        curves,
        axle.turns_against(plan),
    ));
    found.extend(off_balance(axle, plan)?);
    Ok(found)
}

/// Warning if the springs carry a clearly different load in the design position than the weight of `sprung_mass`. An error names
/// the wheel whose design position cannot be solved.
fn off_balance(axle: &Axle, plan: &AxlePlan) -> Result<Option<String>, (Side, DesignFault)> {
    let loads = axle.quantities("wheel_load");
    let (true, Some(mass)) = (
        loads.iter().all(|load| axle.has(*load)),
        axle.setup.sprung_mass,
    ) else {
        return Ok(None);
    };
    let at_rest = axle_curves(axle, &AxlePlan::of(plan.motion.at_design(), loads))?;
    let station = &at_rest.curves.stations[0];
    let (Some(left), Some(right)) = (station.value(0), station.value(1)) else {
        return Ok(None);
    };
    let weight = mass * GRAVITY * Unit::Force.printed_factor(axle.left.length_unit);
    if (left + right - weight).abs() <= OFF_BALANCE * weight {
        return Ok(None);
    }
    let unit = &at_rest.curves.columns[0].unit;
    let [left, right, weight] = [left, right, weight].map(|load| format!("{load:.0}"));
    Ok(Some(format!(
        "please check: the design position is not the static position. There the springs carry {left} {unit} (left) and {right} \
         {unit} (right), but sprung_mass weighs {weight} {unit}. Correct the force of the springs or sprung_mass"
    )))
}

/// Warning about a soft spring, for an axle with lengths in inches and forces in newtons. The rate of the spring may be in
/// pounds-force per inch.
fn soft_spring(axle: &Axle) -> Option<String> {
    // 40 lbf/in, converted to N/in (7 N/mm). Springs of cars are stiffer.
    const LEAST: f64 = 40.0 * 4.448_221_615_260_5;
    let Law::Linear { rate, .. } = &axle.setup.springs.as_ref()?[0].spring else {
        return None;
    };
    let is_soft = axle.left.length_unit == LengthUnit::Inch && *rate < LEAST;
    is_soft.then(|| {
        format!(
            "please check: the rate of [spring] is {} N/in. For rates in lbf/in give force_unit = \"lbf\" in [suspension]",
            as_written(*rate)
        )
    })
}

/// Warnings about the curves of an axle, one per line. `turns_against` is true if the wheels turn in the opposite direction to the
/// steering wheel.
pub fn axle_plausibility(
    axle: &Axle,
    plan: &AxlePlan,
    found: &AxleCurves,
    turns_against: bool,
) -> Vec<String> {
    let mut remarks: Vec<String> = soft_spring(axle).into_iter().collect();
    if turns_against {
        remarks.push(turned_against(axle));
    }
    remarks.extend(lifted(plan, found));
    let reads_springs = |quantity: &Quantity| {
        let needs = quantity.info().needs;
        needs.contains(&Need::SpringForce) || needs.contains(&Need::Springs)
    };
    if plan.quantities.iter().any(reads_springs) {
        remarks.extend(pulling(axle, found));
        let beyond = axle.beyond_force_curves(found);
        remarks.extend(beyond.iter().map(|beyond| beyond_curve(axle, beyond)));
    }
    remarks
}

/// Warning about the sign of `c_factor`. The steering arms determine the correct sign, regardless of the position of the rack.
fn turned_against(axle: &Axle) -> String {
    let c_factor = axle.setup.c_factor.unwrap_or(0.0);
    let printed = c_factor * axle.left.frame.sign(Axis::Y);
    let shown = as_written(printed);
    let (to, sign) = (
        if c_factor < 0.0 { "left" } else { "right" },
        if printed < 0.0 { "above" } else { "below" },
    );
    format!(
        "please check: with c_factor = {shown} the wheels turn against the steering wheel. In a left turn this rack must \
         move to the {to}: give a c_factor {sign} 0"
    )
}

/// Warning about the station with the largest tension of a spring. `None` if no spring is in tension.
fn pulling(axle: &Axle, found: &AxleCurves) -> Option<String> {
    let pull = axle.pulling_spring(found)?;
    let length = axle.left.length_unit;
    let force = brief(pull.force * Unit::Force.printed_factor(length));
    Some(format!(
        "warning: the force of the {} spring falls to {force} {} at {}: there the spring would pull, and a coil spring would leave \
         its seat",
        pull.side.name(),
        Unit::Force.suffix(length),
        place_in_words(&found.curves, pull.station)
    ))
}

/// Warning about the station with the smallest wheel load, if the load is below 0.
fn lifted(plan: &AxlePlan, found: &AxleCurves) -> Option<String> {
    let curves = &found.curves;
    let loads = plan
        .quantities
        .iter()
        .filter_map(|quantity| match quantity {
            Quantity::Wheel(side, WheelQuantity::WheelLoad) => Some((*side, quantity.name())),
            _ => None,
        });
    let values = loads.flat_map(|(side, name)| {
        let is_load = |column: &Column| column.by.is_none() && column.output == name;
        let column = curves.columns.iter().position(is_load);
        let stations = curves.stations.iter().enumerate();
        stations.filter_map(move |(k, station)| Some((station.value(column?)?, side, k, column?)))
    });
    let (load, side, station, column) = values.min_by(|(a, ..), (b, ..)| a.total_cmp(b))?;
    let side = side.name();
    (load < 0.0).then(|| {
        format!(
            "warning: the load of the {side} wheel falls to {} {} at {}: the wheel would lift off \
             the ground there",
            brief(load),
            curves.columns[column].unit,
            place_in_words(curves, station)
        )
    })
}

/// Warning about a spring or bump stop that leaves the range of its force curve.
fn beyond_curve(axle: &Axle, beyond: &BeyondCurve) -> String {
    let unit = axle.left.length_unit.symbol();
    let [value, end, travel] = [beyond.value, beyond.end, beyond.travel].map(brief);
    let side = beyond.side.name();
    let (part, is) = match beyond.part {
        ForcePart::Spring => ("spring", format!("{value} {unit} long")),
        ForcePart::BumpStop => ("bump stop", format!("compressed by {value} {unit}")),
    };
    format!(
        "please check: {side} wheel at travel {travel} {unit}: the {part} is {is}, beyond the end of its force_curve at \
         {end} {unit}. Beyond this end the force follows a straight line. Add points to the curve"
    )
}

/// Warning about hardpoints of a right wheel that are on the side of the left wheel, well away from the centre plane. Probably
/// their y has the wrong sign. In the kernel's frame, y is positive on the side of the wheel to which a design belongs.
fn across(left: &Suspension, right: &Suspension) -> Option<String> {
    let centre = |of: &Suspension| of.design[of.mechanism.wheel_centre.0].y.abs();
    let off = 0.1 * centre(left);
    let points = left
        .mechanism
        .points
        .iter()
        .zip(left.design.iter().zip(&right.design));
    // A point that exists only once on a rigid axle belongs to both wheels.
    let is_single = |number: usize| left.mechanism.is_single(PointId(number));
    let across = points.enumerate().filter(|(number, (_, (left, right)))| {
        left.y > off && right.y < -off && !is_single(*number)
    });
    let names: Vec<&str> = across.map(|(_, (point, _))| point.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "please check: right wheel: {} at the left wheel's side: give the points of [axle.right.hardpoints] with the actual sign of y",
            match names.as_slice() {
                [one] => format!("{one} is"),
                _ => format!("{} are", names.join(", ")),
            }
        )
    })
}
