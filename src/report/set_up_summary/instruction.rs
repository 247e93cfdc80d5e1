//! Instruction of a step of a set-up, in workshop terms.

use crate::assembly::{BuildParameter, PARTS_OF_A_TURN};
use crate::model::{Axis, Body, Mechanism, PointId, Suspension};
use crate::report::text::counted;
use crate::study::{Adjustment, Increment};

/// Instruction for a mechanic, such as "shorten by 1 3/16 turns" or "move outboard by 3 shims: 1.5 mm, relative to the wheel
/// carrier". `amount` is the rounded amount in the length unit. Directions refer to the vehicle, so they hold for both wheels and
/// for any axes of the study.
pub(super) fn instruction(adjustment: &Adjustment, suspension: &Suspension, amount: f64) -> String {
    let size = |amount: f64| {
        // Six decimals remove the digits from rounding errors of a multiple of the step.
        let text = format!("{:.6}", amount.abs());
        let text = text.trim_end_matches('0').trim_end_matches('.');
        format!("{text} {}", suspension.length_unit.symbol())
    };
    if amount == 0.0 {
        return "leave as it is".to_owned();
    }
    let (verb, reference) = match adjustment.change.0 {
        BuildParameter::Length(_) if amount > 0.0 => ("lengthen".to_owned(), String::new()),
        BuildParameter::Length(_) => ("shorten".to_owned(), String::new()),
        BuildParameter::Coordinate(id, axis) => {
            // `adjustment.change` includes the sign of its axis. For a right wheel, amounts are those of its mirror image,
            // which is a left wheel. So the sign from the frame of the right wheel would be wrong.
            let (_, per_unit) = adjustment.change;
            let amount = per_unit * amount;
            let mechanism = &suspension.mechanism;
            let direction = direction(axis, amount, mechanism.is_single(id));
            let carrier = carrier(mechanism, id);
            (
                format!("move {direction}"),
                format!(", relative to the {carrier}"),
            )
        }
    };
    let done = match adjustment.increment {
        Increment::Thread { per_turn } => {
            format!("{verb} by {}", turns((amount / per_turn).abs()))
        }
        Increment::Free => format!("{verb} by {}", size(amount)),
        Increment::Shims { step } => {
            let number = (amount / step).round().abs() as u64;
            format!("{verb} by {}: {}", counted(number, "shim"), size(amount))
        }
    };
    done + &reference
}

/// Name of the part on which a point is mounted: an adjustment moves the point relative to this part. If the wheel carrier is not
/// a part of its own, the name is that of the axle or arm.
fn carrier(mechanism: &Mechanism, id: PointId) -> String {
    let body = mechanism.body(id);
    let mut named = mechanism.bodies.iter();
    match (body, named.find(|(_, own)| *own == body)) {
        (Body::Rack, _) => "rack".to_owned(),
        (Body::SteeringGear(_), _) => "steering gear".to_owned(),
        (Body::Knuckle, None | Some(("knuckle", _))) => "wheel carrier".to_owned(),
        (_, Some((name, _))) => name.replace('_', " "),
        (_, None) => "chassis".to_owned(),
    }
}

/// Direction of a displacement along an axis of the kernel's frame, in words. For a point that exists only once on a solid axle
/// (`is_single`), y is a direction of the vehicle: left or right. For other points, y is outboard or inboard.
fn direction(axis: Axis, amount: f64, is_single: bool) -> &'static str {
    match (axis, amount > 0.0) {
        (Axis::Y, true) if is_single => "to the left",
        (Axis::Y, false) if is_single => "to the right",
        (Axis::X, true) => "forward",
        (Axis::X, false) => "rearward",
        (Axis::Y, true) => "outboard",
        (Axis::Y, false) => "inboard",
        (Axis::Z, true) => "up",
        (Axis::Z, false) => "down",
    }
}

/// Number of turns in sixteenths: "1/16 turn", "1 turn", "2 3/8 turns".
fn turns(turns: f64) -> String {
    let mut parts = (turns * PARTS_OF_A_TURN).round() as u64;
    let mut of = PARTS_OF_A_TURN as u64;
    let whole = parts / of;
    parts %= of;
    while parts > 0 && parts.is_multiple_of(2) {
        (parts, of) = (parts / 2, of / 2);
    }
    let unit = if whole > 1 || (whole == 1 && parts > 0) {
        "turns"
    } else {
        "turn"
    };
    match (whole, parts) {
        (_, 0) => format!("{whole} {unit}"),
        (0, _) => format!("{parts}/{of} {unit}"),
        _ => format!("{whole} {parts}/{of} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::turns;

    #[test]
    fn turns_are_reduced_sixteenths() {
        let cases = [
            (0.0625, "1/16 turn"),
            (0.5, "1/2 turn"),
            (1.0, "1 turn"),
            (1.0625, "1 1/16 turns"),
            (2.375, "2 3/8 turns"),
            (3.0, "3 turns"),
        ];
        for (number, text) in cases {
            assert_eq!(turns(number), text);
        }
    }
}
