//! Formulas for the car as a whole.

use super::super::equations::{
    BODY, Balance, GROUND, LONGITUDINAL, PITCH, PITCH_MOMENT, ROLL, VERTICAL, WheelState,
};
use super::super::rates::Solved;
use super::{axle, frequency};
use crate::number::{Each, Jet, Scalar, Vector3};

pub(in crate::car) fn roll<T: Scalar>(state: &Balance<T>) -> T {
    state.unknowns[ROLL]
}

pub(in crate::car) fn pitch<T: Scalar>(state: &Balance<T>) -> T {
    state.unknowns[PITCH]
}

pub(in crate::car) fn heave<T: Scalar>(state: &Balance<T>) -> T {
    state.unknowns[GROUND] - state.road.up.dot(state.design_contact)
}

/// Rise of the body relative to its height in the car at rest.
pub(in crate::car) fn jacking_heave<T: Scalar>(solved: &Solved<'_, T>) -> T {
    heave(&solved.now).constant(solved.rest_heave) - heave(&solved.now)
}

pub(in crate::car) fn energy<T: Scalar>(state: &Balance<T>) -> T {
    state.energy
}

/// Change of each wheel load per warp of the ground. The ground rises under one diagonal pair of wheels and falls under
/// the other pair.
pub(in crate::car) fn warp_stiffness<T: Scalar>(solved: &Solved<'_, T>) -> T {
    let [a, b, c, d] = loads(&solved.by_warp).each(|load| load[1]);
    (a - b - c + d).scaled(0.25)
}

pub(in crate::car) fn rake<T: Scalar>(state: &Balance<T>) -> T {
    state.ride_heights[1] - state.ride_heights[0]
}

fn mid_contact<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    let [left, right] = [0, 1].each(|side| state.wheels[2 * axle + side].contact);
    state.road.forward.dot(left + right).scaled(0.5)
}

pub(in crate::car) fn wheelbase<T: Scalar>(state: &Balance<T>) -> T {
    mid_contact(state, 0) - mid_contact(state, 1)
}

/// Distance of the sprung mass's centre of gravity ahead of the rear axle, divided by the wheelbase.
pub(in crate::car) fn front_share_at_cg<T: Scalar>(state: &Balance<T>) -> T {
    (state.road.forward.dot(state.sprung.1) - mid_contact(state, 1)) / wheelbase(state)
}

fn height<T: Scalar>(state: &Balance<T>, point: Vector3<T>) -> T {
    state.road.up.dot(point) - state.unknowns[GROUND]
}

pub(in crate::car) fn cg_height<T: Scalar>(state: &Balance<T>) -> T {
    height(state, state.whole.1)
}

pub(in crate::car) fn sprung_cg_height<T: Scalar>(state: &Balance<T>) -> T {
    height(state, state.sprung.1)
}

type OfAxle<T> = fn(&Balance<T>, usize) -> T;

fn inclination<T: Scalar>(state: &Balance<T>, of: OfAxle<T>) -> T {
    (of(state, 0) - of(state, 1)).atan2(wheelbase(state))
}

fn at_cg<T: Scalar>(state: &Balance<T>, of: OfAxle<T>) -> T {
    let (front, rear) = (of(state, 0), of(state, 1));
    rear + (front - rear) * front_share_at_cg(state)
}

pub(in crate::car) fn roll_centre_inclination<T: Scalar>(state: &Balance<T>) -> T {
    inclination(state, axle::roll_centre_height)
}

pub(in crate::car) fn roll_centre_height_at_cg<T: Scalar>(state: &Balance<T>) -> T {
    at_cg(state, axle::roll_centre_height)
}

pub(in crate::car) fn roll_centre_moment_arm<T: Scalar>(state: &Balance<T>) -> T {
    sprung_cg_height(state) - roll_centre_height_at_cg(state)
}

pub(in crate::car) fn roll_axis_inclination<T: Scalar>(state: &Balance<T>) -> T {
    inclination(state, axle::roll_axis_height)
}

pub(in crate::car) fn roll_axis_height_at_cg<T: Scalar>(state: &Balance<T>) -> T {
    at_cg(state, axle::roll_axis_height)
}

pub(in crate::car) fn roll_axis_moment_arm<T: Scalar>(state: &Balance<T>) -> T {
    sprung_cg_height(state) - roll_axis_height_at_cg(state)
}

pub(in crate::car) fn longitudinal_force<T: Scalar>(state: &Balance<T>) -> T {
    state.unknowns[LONGITUDINAL]
}

pub(in crate::car) fn load_transfer<T: Scalar>(state: &Balance<T>) -> T {
    axle::load_transfer(state, 0) + axle::load_transfer(state, 1)
}

fn share_of_transfer<T: Scalar>(state: &Balance<T>, of: OfAxle<T>) -> T {
    of(state, 0).scaled(100.0) / load_transfer(state)
}

pub(in crate::car) fn distribution<T: Scalar>(state: &Balance<T>) -> T {
    share_of_transfer(state, axle::load_transfer)
}

pub(in crate::car) fn distribution_elastic<T: Scalar>(state: &Balance<T>) -> T {
    share_of_transfer(state, axle::elastic)
}

pub(in crate::car) fn distribution_geometric<T: Scalar>(state: &Balance<T>) -> T {
    share_of_transfer(state, axle::geometric)
}

pub(in crate::car) fn distribution_longitudinal<T: Scalar>(state: &Balance<T>) -> T {
    share_of_transfer(state, axle::longitudinal)
}

pub(in crate::car) fn distribution_unsprung<T: Scalar>(state: &Balance<T>) -> T {
    share_of_transfer(state, axle::unsprung)
}

fn loads<T: Scalar>(state: &Balance<T>) -> [T; 4] {
    state.wheels.each(|wheel| wheel.load)
}

pub(in crate::car) fn cross_weight<T: Scalar>(state: &Balance<T>) -> T {
    let [a, b, c, d] = loads(state);
    (b + c).scaled(100.0) / (a + b + c + d)
}

pub(in crate::car) fn weight_front<T: Scalar>(state: &Balance<T>) -> T {
    let [a, b, c, d] = loads(state);
    (a + b).scaled(100.0) / (a + b + c + d)
}

pub(in crate::car) fn weight_left<T: Scalar>(state: &Balance<T>) -> T {
    let [a, b, c, d] = loads(state);
    (a + c).scaled(100.0) / (a + b + c + d)
}

pub(in crate::car) fn downforce<T: Scalar>(state: &Balance<T>) -> T {
    state.air[0] + state.air[1]
}

pub(in crate::car) fn aero_balance<T: Scalar>(state: &Balance<T>) -> T {
    state.air[0].scaled(100.0) / downforce(state)
}

pub(in crate::car) fn drag<T: Scalar>(state: &Balance<T>) -> T {
    state.air[2]
}

/// Anti-effect of an axle in percent: longitudinal component of its wheel loads, divided by the longitudinal load
/// transfer. The tyres' longitudinal forces cause this load transfer.
pub(in crate::car) fn anti<T: Scalar>(state: &Balance<T>, axle: usize) -> T {
    let push = |wheel: &WheelState<T>| {
        let force = wheel.across * wheel.side_force + wheel.heading * wheel.longitudinal_force;
        force.dot(state.road.forward)
    };
    let [a, b, c, d] = state.wheels.each_ref().each(push);
    let transfer = -(a + b + c + d) * cg_height(state) / wheelbase(state);
    let parts = [0, 1].each(|side| state.wheels[2 * axle + side].parts[2]);
    let own = (parts[0] + parts[1]).scaled(match axle {
        0 => 100.0,
        _ => -100.0,
    });
    own / transfer
}

pub(in crate::car) fn anti_front<T: Scalar>(state: &Balance<T>) -> T {
    anti(state, 0)
}

pub(in crate::car) fn anti_rear<T: Scalar>(state: &Balance<T>) -> T {
    anti(state, 1)
}

pub(in crate::car) fn roll_gradient<T: Scalar>(solved: &Solved<'_, T>) -> T {
    roll(&solved.by_ay)[1]
}

pub(in crate::car) fn pitch_gradient<T: Scalar>(solved: &Solved<'_, T>) -> T {
    pitch(&solved.by_ax)[1]
}

pub(in crate::car) fn local_distribution<T: Scalar>(solved: &Solved<'_, T>) -> T {
    let [front, rear] = [0, 1].each(|end| axle::load_transfer(&solved.by_ay, end)[1]);
    front.scaled(100.0) / (front + rear)
}

pub(in crate::car) fn roll_understeer<T: Scalar>(solved: &Solved<'_, T>) -> T {
    axle::roll_steer_gradient(solved, 1) - axle::roll_steer_gradient(solved, 0)
}

pub(in crate::car) fn roll_stiffness<T: Scalar>(solved: &Solved<'_, T>) -> T {
    let by_couple = roll(&solved.by_couple)[1];
    by_couple.one() / by_couple
}

pub(in crate::car) fn roll_stiffness_distribution<T: Scalar>(solved: &Solved<'_, T>) -> T {
    let state = &solved.by_couple;
    let [front, rear] =
        [0, 1].each(|end| (axle::track(state, end) * axle::load_transfer(state, end))[1]);
    front.scaled(100.0) / (front + rear)
}

pub(in crate::car) fn heave_rate<T: Scalar>(solved: &Solved<'_, T>) -> T {
    solved.by_heave.residuals[VERTICAL][1]
}

pub(in crate::car) fn heave_frequency<T: Scalar>(solved: &Solved<'_, T>) -> T {
    let per_metre = solved.car.per_metre();
    frequency(heave_rate(solved).scaled(per_metre) / solved.now.sprung.0)
}

/// Frequency of the sprung mass in heave and pitch on massless wheels, in hertz. The squares of both angular frequencies
/// are the roots w of det(K - w M) = 0, with the stiffness matrix K and the mass matrix M. The coordinates of these
/// matrices are the ground height gamma and the pitch angle.
fn body_frequency<T: Scalar>(solved: &Solved<'_, T>, sign: f64) -> T {
    // The residuals are the vertical force and the pitch moment about an axis -e (to the right). This axis is above or
    // below the origin, at the height of the mean contact point of the design position. The residuals depend on the
    // ground height gamma and on the pitch angle theta.
    let height = solved.now.road.up.dot(solved.now.design_contact);
    let along = |state: &Balance<Jet<T, 2>>| {
        let [forward, up, pitch] =
            [BODY, VERTICAL, PITCH_MOMENT].each(|row| state.residuals[row][1]);
        [up, height * forward - pitch]
    };
    let [by_heave, by_pitch] = [along(&solved.by_heave), along(&solved.by_pitch)];
    let k = [[by_heave[0], by_pitch[0]], [by_heave[1], by_pitch[1]]];
    let per_metre = solved.car.per_metre();
    let (mass, cg) = solved.now.sprung;
    let lever = solved.now.road.forward.dot(cg);
    let inertia = solved.car.pitch_inertia.unwrap_or(f64::NAN) * per_metre * per_metre;
    let m = [
        [mass, mass * lever],
        [
            mass * lever,
            mass * lever.squared() + mass.constant(inertia),
        ],
    ];
    let product = mass.scaled(inertia);
    let middle = k[0][0] * m[1][1] + k[1][1] * m[0][0] - (k[0][1] + k[1][0]) * m[0][1];
    let determinant = k[0][0] * k[1][1] - k[0][1] * k[1][0];
    let root = (middle.squared() - (product * determinant).scaled(4.0)).sqrt();
    let squared = (middle + root.scaled(sign)) / product.scaled(2.0);
    frequency(squared.scaled(per_metre))
}

pub(in crate::car) fn low_frequency<T: Scalar>(solved: &Solved<'_, T>) -> T {
    body_frequency(solved, -1.0)
}

pub(in crate::car) fn high_frequency<T: Scalar>(solved: &Solved<'_, T>) -> T {
    body_frequency(solved, 1.0)
}
