//! Track, roll centre, jacking, and what rolling does to a wheel.
//!
//! In front view the reaction of a side force on a locked wheel runs along the normal to C' through C: one
//! unit of it inboard along the ground brings j units of load, j = (C'.o)/(C'.n) with o outboard along the
//! ground. Both normals meet in the roll centre. With eta along the ground from midway between the contact
//! points, to the left, and zeta above it
//!
//! ```text
//! d/2 + (track/2 - eta) j_l = zeta = -d/2 + (track/2 + eta) j_r
//! zeta = (track j_l j_r + (d/2) (j_r - j_l))/(j_l + j_r)
//! eta  = ((track/2) (j_l - j_r) + d)/(j_l + j_r)
//! ```
//!
//! where d is how much higher the left contact point is: 0 on a plane, else the point is above the mean of both.
//!
//! Equal side forces make the same roll moment at the height track (j_l + j_r)/4, which stays finite.

use super::wheel;
use crate::axle::state::{Motion, State};
use crate::model::Side;
use crate::number::{Real, Scalar};

/// Load gained per side force inboard.
pub(crate) fn jacking_coefficient<T: Scalar>(state: &State<T>, side: Side) -> T {
    let wheel = wheel(state, side);
    let velocity = wheel.contact_velocity();
    velocity.dot(wheel.ground.outboard()) / velocity.dot(wheel.ground.normal())
}

/// The same for a force across the wheel instead of across the vehicle.
pub(crate) fn side_force_jacking<T: Scalar>(state: &State<T>, side: Side) -> T {
    let wheel = wheel(state, side);
    let (velocity, normal) = (wheel.contact_velocity(), wheel.ground.normal());
    let a = wheel.reading.spin_axis();
    let across = (a - normal * a.dot(normal)).normalised();
    velocity.dot(across) / velocity.dot(normal)
}

fn jacking<T: Scalar>(state: &State<T>) -> [T; 2] {
    [Side::Left, Side::Right].map(|side| jacking_coefficient(state, side))
}

/// Track at the ground.
pub(crate) fn track<T: Scalar>(state: &State<T>) -> T {
    state.track()
}

/// Track less that of the design position.
pub(crate) fn track_change<T: Scalar>(state: &State<T>) -> T {
    let radius = state.setup.wheel_radius.unwrap_or(f64::NAN);
    let level = crate::axle::Ground::level(state.like());
    let [left, right] = state.readings.map(|reading| {
        reading.design_centre().y + level.contact_lever(reading.design_spin_axis(), radius).y
    });
    state.track() - (left + right)
}

/// Roll angle of the body.
pub(crate) fn roll_angle<T: Scalar>(state: &State<T>) -> T {
    state.roll
}

/// Height of the kinematic roll centre above the ground; on pads above the mean of both.
pub(crate) fn roll_centre_height<T: Scalar>(state: &State<T>) -> T {
    let [left, right] = jacking(state);
    let higher = state.mismatch().scaled(0.5);
    (state.track() * (left * right) + higher * (right - left)) / (left + right)
}

/// The kinematic roll centre along the ground, from midway between the contact points.
pub(crate) fn roll_centre_lateral<T: Scalar>(state: &State<T>) -> T {
    let [left, right] = jacking(state);
    (state.track().scaled(0.5) * (left - right) + state.mismatch()) / (left + right)
}

/// Height at which equal side forces roll the body.
pub(crate) fn force_roll_centre_height<T: Scalar>(state: &State<T>) -> T {
    let [left, right] = jacking(state);
    (state.track() * (left + right)).scaled(0.25)
}

/// Lift per side force to the left, shared equally.
pub(crate) fn jacking_force_ratio<T: Scalar>(state: &State<T>) -> T {
    let [left, right] = jacking(state);
    (right - left).scaled(0.5)
}

/// How the kinematic roll centre rises in roll.
pub(crate) fn roll_centre_migration_vertical<T: Scalar>(state: &State<T>) -> T {
    roll_centre_height(&state.moving(Motion::Roll))[1]
}

/// How it moves sideways in roll.
pub(crate) fn roll_centre_migration_lateral<T: Scalar>(state: &State<T>) -> T {
    roll_centre_lateral(&state.moving(Motion::Roll))[1]
}

/// How the force-based height changes in roll.
pub(crate) fn force_roll_centre_migration<T: Scalar>(state: &State<T>) -> T {
    force_roll_centre_height(&state.moving(Motion::Roll))[1]
}

/// Whether the normals through both contact points are so nearly parallel that their meeting point says
/// nothing: further than a hundred tracks to the side.
pub(crate) fn normals_are_parallel(state: &State<f64>) -> bool {
    let [left, right] = jacking(state);
    // Written so that NaN is parallel.
    !((left - right).abs() <= 200.0 * (left + right).abs() && left + right != 0.0)
}

/// Camber against the normal of the ground.
pub(crate) fn camber_to_road<T: Scalar>(state: &State<T>, side: Side) -> T {
    let wheel = wheel(state, side);
    -wheel.reading.spin_axis().dot(wheel.ground.normal()).asin()
}

/// Camber by the roll angle.
pub(crate) fn roll_camber<T: Scalar>(state: &State<T>, side: Side) -> T {
    let rolling = state.moving(Motion::Roll);
    let a = wheel(&rolling, side).reading.spin_axis();
    (-a.z.asin())[1]
}

/// Camber to the road by the roll angle.
pub(crate) fn roll_camber_to_road<T: Scalar>(state: &State<T>, side: Side) -> T {
    camber_to_road(&state.moving(Motion::Roll), side)[1]
}
