//! Formulas for one wheel in a state.

use super::super::catalogue::WheelPlace;
use super::super::equations::{Balance, TRAVELS, WheelState};
use super::super::rates::Solved;
use crate::number::{Scalar, Vector3};

fn of<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> &WheelState<T> {
    &state.wheels[place.0]
}

pub(in crate::car) fn travel<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    state.unknowns[TRAVELS + place.0]
}

pub(in crate::car) fn load<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).load
}

pub(in crate::car) fn elastic<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).parts[0]
}

pub(in crate::car) fn geometric<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).parts[1]
}

pub(in crate::car) fn longitudinal<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).parts[2]
}

pub(in crate::car) fn unsprung<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).parts[3]
}

pub(in crate::car) fn side_force<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).side_force
}

pub(in crate::car) fn longitudinal_force<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).longitudinal_force
}

pub(in crate::car) fn share<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).share
}

pub(in crate::car) fn friction_demand<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    let wheel = of(state, place);
    let squared = wheel.side_force.squared() + wheel.longitudinal_force.squared();
    // The square root is omitted at zero, because its derivative is infinite there.
    if squared.value() == 0.0 {
        squared
    } else {
        squared.sqrt() / wheel.load
    }
}

pub(in crate::car) fn gap<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    let gap = of(state, place).gap;
    if state.lifted[place.0] {
        gap
    } else {
        gap.zero()
    }
}

pub(in crate::car) fn loaded_radius<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).radius
}

pub(in crate::car) fn camber<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    -of(state, place).corner.spin.z.asin()
}

pub(in crate::car) fn camber_to_road<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    -state.road.up.dot(of(state, place).corner.spin).asin()
}

pub(in crate::car) fn steer<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    let corner = &of(state, place).corner;
    let sign = corner.sign;
    -corner.spin.x.scaled(sign).atan2(corner.spin.y.scaled(sign))
}

pub(in crate::car) fn toe<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    steer(state, place).scaled(-of(state, place).corner.sign)
}

pub(in crate::car) fn steer_to_road<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    let corner = &of(state, place).corner;
    let along = |direction: Vector3<T>| corner.spin.dot(direction).scaled(corner.sign);
    -along(state.road.forward).atan2(along(state.road.left))
}

pub(in crate::car) fn contact_x<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).contact.x
}

pub(in crate::car) fn contact_y<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).contact.y
}

pub(in crate::car) fn contact_z<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).contact.z
}

pub(in crate::car) fn spring_force<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).spring_force
}

pub(in crate::car) fn spring_length<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    of(state, place).corner.spring
}

pub(in crate::car) fn spring_travel<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    let corner = &of(state, place).corner;
    corner.design_spring - corner.spring
}

/// Compression of the bump stop, 0 without contact.
pub(in crate::car) fn bump_stop_compression<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    let stop = of(state, place).stop_gaps[0];
    beyond(spring_travel(state, place), stop)
}

/// Extension of the spring beyond the gap of the rebound stop, 0 without contact.
pub(in crate::car) fn rebound_stop_extension<T: Scalar>(
    state: &Balance<T>,
    place: WheelPlace,
) -> T {
    let stop = of(state, place).stop_gaps[1];
    beyond(-spring_travel(state, place), stop)
}

/// Returns the excess of a number over the limit `end`; 0 below the limit, NaN without a limit.
fn beyond<T: Scalar>(number: T, end: Option<f64>) -> T {
    match end {
        None => number.constant(f64::NAN),
        Some(end) if number.value() > end => number - number.constant(end),
        Some(_) => number.zero(),
    }
}

/// Increase of the wheel load per unit of side force. The force acts inboard, in the lateral direction of the car on
/// the ground.
pub(in crate::car) fn jacking<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    let wheel = of(state, place);
    let rate = wheel.contact_rate;
    rate.dot(state.road.left).scaled(wheel.corner.sign) / rate.dot(state.road.up)
}

/// Increase of the wheel load per unit of side force. The force acts inboard, in the direction of the tyre's lateral
/// forces.
pub(in crate::car) fn side_force_jacking<T: Scalar>(state: &Balance<T>, place: WheelPlace) -> T {
    let wheel = of(state, place);
    let rate = wheel.contact_rate;
    rate.dot(wheel.across).scaled(wheel.corner.sign) / rate.dot(state.road.up)
}

pub(in crate::car) fn camber_gradient<T: Scalar>(solved: &Solved<'_, T>, place: WheelPlace) -> T {
    camber_to_road(&solved.by_ay, place)[1]
}
