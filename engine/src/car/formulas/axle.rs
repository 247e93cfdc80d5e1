//! Formulas for one axle. Index 0 is the front axle.

use super::super::catalogue::WheelPlace;
use super::super::equations::{Balance, SIDE_FORCES};
use super::super::rates::Solved;
use super::{car, frequency, wheel};

use crate::number::{Each, Scalar, Vector3};

fn both<T: Scalar>(
    state: &Balance<T>,
    axle: usize,
    of: impl Fn(&Balance<T>, WheelPlace) -> T,
) -> [T; 2] {
    [0, 1].each(|side| of(state, WheelPlace(2 * axle + side)))
}

/// Half the difference of a component of the wheel loads (see equation (9) of the module `car`), right wheel minus left
/// wheel.
fn transfer<T: Scalar>(
    state: &Balance<T>,
    axle: usize,
    of: impl Fn(&Balance<T>, WheelPlace) -> T,
) -> T {
    let [left, right] = both(state, axle, of);
    (right - left).scaled(0.5)
}

pub(in crate::car) fn load_transfer<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    transfer(state, axle, wheel::load)
}

pub(in crate::car) fn elastic<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    transfer(state, axle, wheel::elastic)
}

pub(in crate::car) fn geometric<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    transfer(state, axle, wheel::geometric)
}

pub(in crate::car) fn longitudinal<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    transfer(state, axle, wheel::longitudinal)
}

pub(in crate::car) fn unsprung<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    transfer(state, axle, wheel::unsprung)
}

pub(in crate::car) fn load<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    let [left, right] = both(state, axle, wheel::load);
    left + right
}

pub(in crate::car) fn side_force<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.unknowns[SIDE_FORCES + axle]
}

pub(in crate::car) fn track<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    let [left, right] = [0, 1].each(|side| state.wheels[2 * axle + side].contact);
    state.road.left.dot(left - right)
}

pub(in crate::car) fn mean_steer<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    let [left, right] = both(state, axle, wheel::steer);
    (left + right).scaled(0.5)
}

/// Velocities of the axle at its two contact points, and its angular velocity, for a solid axle or twist beam. For a
/// twist beam, this is the angular velocity of the left carrier. The left wheel rises and the right wheel falls. The
/// rotation of steered knuckles relative to the axle is not included.
fn by_difference<T: Scalar>(
    state: &Balance<T>,
    axle: usize,
) -> Option<([Vector3<T>; 2], Vector3<T>)> {
    let [left, right] = [0, 1].each(|side| &state.wheels[2 * axle + side]);
    if let Some(body) = &left.corner.axle {
        let at = |contact: Vector3<T>| body.velocity + body.turn.cross(contact - body.point);
        return Some(([at(left.contact), at(right.contact)], body.turn));
    }
    let turn = left.corner.own.turn - left.corner.other?.turn;
    let velocities = [
        left.contact_rate - left.contact_by_other?,
        right.contact_by_other? - right.contact_rate,
    ];
    Some((velocities, turn))
}

/// Computes the loads of both wheels of an axle that balance given forces at the contact points.
fn loads_by<T: Scalar>(state: &Balance<T>, axle: usize, forces: [Vector3<T>; 2]) -> [T; 2] {
    let up = state.road.up;
    let [left, right] = [0, 1].each(|side| &state.wheels[2 * axle + side]);
    let [left_force, right_force] = forces;
    let by_left = left_force.dot(left.contact_rate);
    let by_right = right_force.dot(right.contact_rate);
    let (a, d) = (up.dot(left.contact_rate), up.dot(right.contact_rate));
    match (left.contact_by_other, right.contact_by_other) {
        (Some(left_other), Some(right_other)) => {
            let by_left = by_left + right_force.dot(right_other);
            let by_right = by_right + left_force.dot(left_other);
            let (b, c) = (up.dot(right_other), up.dot(left_other));
            let determinant = a * d - b * c;
            [
                (b * by_right - d * by_left) / determinant,
                (c * by_left - a * by_right) / determinant,
            ]
        }
        _ => [-(by_left / a), -(by_right / d)],
    }
}

/// Height at which a lateral force causes no roll. `forces` are the forces at the two contact points; their sum is a unit
/// lateral force.
fn height_of_transfer<T: Scalar>(state: &Balance<T>, axle: usize, forces: [Vector3<T>; 2]) -> T {
    let [left, right] = loads_by(state, axle, forces);
    track(state, axle).scaled(0.5) * (right - left)
}

pub(in crate::car) fn roll_centre_height<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    if let Some(([left, right], turn)) = by_difference(state, axle) {
        let rolling = turn.dot(state.road.forward).scaled(2.0);
        return (left + right).dot(state.road.left) / rolling;
    }
    let [left, right] = both(state, axle, wheel::jacking);
    track(state, axle) * left * right / (left + right)
}

pub(in crate::car) fn roll_centre_lateral<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    if let Some(([left, right], turn)) = by_difference(state, axle) {
        let rolling = turn.dot(state.road.forward).scaled(2.0);
        return -((left + right).dot(state.road.up) / rolling);
    }
    let [left, right] = both(state, axle, wheel::jacking);
    track(state, axle).scaled(0.5) * (left - right) / (left + right)
}

pub(in crate::car) fn force_roll_centre_height<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    height_of_transfer(
        state,
        axle,
        [state.road.left * state.unknowns[0].constant(0.5); 2],
    )
}

pub(in crate::car) fn roll_axis_height<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    let across = |side: usize| {
        let wheel = &state.wheels[2 * axle + side];
        wheel.across * wheel.share
    };
    height_of_transfer(state, axle, [across(0), across(1)])
}

pub(in crate::car) fn bar_torque<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.bars[axle]
}

/// Torque of a twist beam. In the equations, the beam is a bar whose rate is a quarter of the beam's rate, and whose
/// angle is twice the beam's angle.
pub(in crate::car) fn beam_torque<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    -state.bars[axle].scaled(2.0)
}

pub(in crate::car) fn heave_spring_force<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.rockers[axle].heave_spring
}

pub(in crate::car) fn heave_spring_length<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.rockers[axle].heave_spring_length
}

pub(in crate::car) fn heave_spring_travel<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.rockers[axle].heave_spring_travel
}

pub(in crate::car) fn t_bar_torque<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.rockers[axle].t_bar
}

pub(in crate::car) fn heave_bar_torque<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.rockers[axle].heave_bar
}

pub(in crate::car) fn downforce<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.air[axle]
}

pub(in crate::car) fn ride_height<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    state.ride_heights[axle]
}

pub(in crate::car) fn roll_steer_gradient<T: Scalar>(solved: &Solved<'_, T>, axle: usize) -> T {
    mean_steer(&solved.by_ay, axle)[1]
}

pub(in crate::car) fn pitch_steer_gradient<T: Scalar>(solved: &Solved<'_, T>, axle: usize) -> T {
    mean_steer(&solved.by_ax, axle)[1]
}

/// Increase of the sum of both wheel loads per rise of the ground.
pub(in crate::car) fn ride_rate<T: Scalar>(solved: &Solved<'_, T>, axle: usize) -> T {
    load(&solved.by_heave, axle)[1]
}

pub(in crate::car) fn ride_frequency<T: Scalar>(solved: &Solved<'_, T>, axle: usize) -> T {
    let state = &solved.now;
    let (mass, _) = state.sprung;
    let share = car::front_share_at_cg(state);
    let own = match axle {
        0 => share,
        _ => share.one() - share,
    };
    let per_metre = solved.car.per_metre();
    frequency(ride_rate(solved, axle).scaled(per_metre) / (mass * own))
}
