//! Wheel loads and stiffnesses, from the forces of springs and anti-roll bars by virtual work.
//!
//! U is the energy of springs and bars, and U_zi its derivative with respect to the travel z_i of wheel i. C_i' is the
//! velocity of the carrier's point at the contact point with respect to this travel. The load of the wheel along the normal
//! n of the ground is F_i = U_zi/(n.C_i'). The weight of suspension parts is neglected. The anti-roll bar adds the energy
//! k_b (b_l - b_r)^2/2, with the rate k_b and the angles b_l and b_r of its levers. Springs between the rockers add the
//! energies of [`RockerSprings`](crate::axle::RockerSprings).

use super::rigid;
use crate::axle::reading::WheelParts;
use crate::axle::rocker_springs::{RockerForces, RockerMotion};
use crate::axle::state::{AxleState, Motion};
use crate::model::Side;
use crate::number::{Each, Real, Scalar};
use std::f64::consts::PI;

/// Force of a spring with its stops.
pub(crate) fn spring_force<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    let (length, _, design) = state.wheel(side).reading.spring_length();
    match &state.setup.springs {
        Some(springs) => springs[side as usize].force(length, design),
        None => state.like().constant(f64::NAN),
    }
}

/// Load of a wheel from the spring of this wheel alone.
fn spring_load<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    let wheel = state.wheel(side);
    let (_, by_travel, _) = wheel.reading.spring_length();
    -(spring_force(state, side) * by_travel) / wheel.rise()
}

/// Torque of the anti-roll bar.
pub(crate) fn bar_torque<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let rate = state.setup.bar_rate.unwrap_or(f64::NAN);
    let angle = |side| state.wheel(side).reading.bar_angle().0;
    (angle(Side::Left) - angle(Side::Right)).scaled(rate)
}

/// Forces of the springs between the rockers of both wheels.
fn rocker_forces<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> RockerForces<T> {
    let motions = state.readings.each_ref().each(RockerMotion::read);
    let laws = &state.setup.rocker_springs;
    laws.map(|c| state.like().constant(c)).forces(&motions)
}

/// Force of the heave spring.
pub(crate) fn heave_spring_force<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    rocker_forces(state).heave_spring
}

/// Length of the heave spring.
pub(crate) fn heave_spring_length<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    rocker_forces(state).heave_spring_length
}

/// Shortening of the heave spring per travel, if both wheels rise equally on level pads.
pub(crate) fn heave_spring_motion_ratio<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let pads = state.on_pads();
    -heave_spring_length(&pads.moving(Motion::Heave))[1]
}

/// Torque of the T-bar.
pub(crate) fn t_bar_torque<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    rocker_forces(state).t_bar
}

/// Torque of the heave bar.
pub(crate) fn heave_bar_torque<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    rocker_forces(state).heave_bar
}

/// Load of a wheel from its own spring and from the springs between the rockers, without the anti-roll bar.
fn sprung_load<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    let own = match state.setup.springs {
        Some(_) => Some(spring_load(state, side)),
        None => None,
    };
    if state.setup.rocker_springs.are_none() {
        return own.unwrap_or_else(|| state.like().constant(f64::NAN));
    }
    let shared = rocker_forces(state).work[side as usize] / state.wheel(side).rise();
    match own {
        Some(own) => own + shared,
        None => shared,
    }
}

/// Load of a wheel from its spring, the anti-roll bar and the springs between the rockers.
pub(crate) fn wheel_load<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    if state.carriers.is_rigid() {
        return rigid::wheel_loads(state)[side as usize];
    }
    let spring = sprung_load(state, side);
    if state.setup.bar_rate.is_none() {
        return spring;
    }
    let wheel = state.wheel(side);
    let (_, by_travel) = wheel.reading.bar_angle();
    let bar = bar_torque(state) * by_travel / wheel.rise();
    match side {
        Side::Left => spring + bar,
        Side::Right => spring - bar,
    }
}

/// Derivative of the wheel load with respect to the height of the wheel's pad, from the springs alone. The body is level,
/// and the other pad does not move. Anti-roll bar, springs between rockers and tyre are not included.
pub(crate) fn wheel_rate<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    if state.carriers.is_rigid() {
        return rigid::wheel_rate(state, side);
    }
    let motion = match side {
        Side::Left => Motion::TravelLeft,
        Side::Right => Motion::TravelRight,
    };
    let pads = state.on_pads();
    spring_load(&pads.moving(motion), side)[1] / pads.wheel(side).rise()
}

fn loads<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> [T; 2] {
    [
        wheel_load(state, Side::Left),
        wheel_load(state, Side::Right),
    ]
}

/// Sum of both wheel loads.
pub(crate) fn axle_load<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let [left, right] = loads(state);
    left + right
}

/// Moment of the wheel loads about the vehicle's centre line.
pub(crate) fn roll_moment<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let [left, right] = loads(state);
    (state.track() * (right - left)).scaled(0.5)
}

/// Roll moment per roll angle on a rig. Body and rack are fixed. The wheels are on level pads, and the wheel centres move
/// equally and oppositely. As on a rig, the roll angle is the angle of the line through both contact points.
pub(crate) fn roll_stiffness<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let pads = state.on_pads();
    let rig = pads.moving(Motion::OpposedTravels);
    let angle = (-rig.mismatch()).atan2(rig.track());
    roll_moment(&rig)[1] / angle[1]
}

/// Roll stiffness on a rig, in series with both tyres. Each tyre deflects by the load on the tyre divided by the tyre
/// rate.
pub(crate) fn roll_stiffness_with_tyres<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let track = state.on_pads().track();
    let tyre = state.setup.tyre_rate.unwrap_or(f64::NAN);
    in_series(roll_stiffness(state), (track * track).scaled(0.5 * tyre))
}

/// Rate of two springs in series.
fn in_series<T: Scalar>(one: T, other: T) -> T {
    one * other / (one + other)
}

/// Roll moment per roll angle on a plane ground, with constant mean travel and rack.
pub(crate) fn roll_stiffness_on_road<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    roll_moment(&state.moving(Motion::Roll))[1]
}

/// Roll moment per roll angle on a plane ground, with constant sum of the wheel loads and constant rack.
pub(crate) fn roll_stiffness_at_load<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let plane = state.on_plane();
    let (rolling, derivative_by_heave) = (plane.moving(Motion::Roll), plane.moving(Motion::Heave));
    let sinking = axle_load(&rolling)[1] / axle_load(&derivative_by_heave)[1];
    roll_moment(&rolling)[1] - roll_moment(&derivative_by_heave)[1] * sinking
}

/// Half the derivative of the axle load with respect to heave of the wheel centres, from the springs alone. The rack is
/// fixed. On a plane ground, the roll angle is fixed, too. On pads, the travels of both wheels change equally.
pub(crate) fn ride_rate_without_tyres<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    axle_load(&state.moving(Motion::Heave))[1].scaled(0.5)
}

/// Ride rate: the rate of the springs in series with a tyre, if the study gives a tyre rate.
pub(crate) fn ride_rate<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let rate = ride_rate_without_tyres(state);
    match state.setup.tyre_rate {
        None => rate,
        Some(tyre) => in_series(rate, rate.constant(tyre)),
    }
}

/// Natural frequency in Hz. `rate` is the rate at each wheel, `mass` the mass for both wheels together.
fn frequency<T: Scalar, W: WheelParts<T>>(
    state: &AxleState<T, W>,
    rate: T,
    mass: Option<f64>,
) -> T {
    let per_mass = 2.0 * state.setup.per_metre / mass.unwrap_or(f64::NAN);
    rate.scaled(per_mass).sqrt().scaled(0.5 / PI)
}

/// Natural frequency of the sprung mass in heave.
pub(crate) fn ride_frequency<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    frequency(state, ride_rate(state), state.setup.sprung_mass)
}

/// Natural frequency of the wheels between springs and tyres, with the body fixed.
pub(crate) fn wheel_hop_frequency<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let tyre = state.setup.tyre_rate.unwrap_or(f64::NAN);
    // Both wheels of a solid axle hop together. For independent wheels the rate is the same, whether the wheels hop together
    // or alone.
    let rate = if state.carriers.is_rigid() {
        axle_load(&state.on_pads().moving(Motion::Heave))[1].scaled(0.5)
    } else {
        (wheel_rate(state, Side::Left) + wheel_rate(state, Side::Right)).scaled(0.5)
    };
    frequency(state, rate + rate.constant(tyre), state.setup.unsprung_mass)
}
