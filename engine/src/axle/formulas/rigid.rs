//! Quantities of a rigid axle.
//!
//! The axle has two travels, h and d. h is the mean travel. d is half the difference: the left wheel centre rises by d while
//! the right wheel centre falls by d. C_b,h and C_b,d are the velocities of the axle's point at contact point b. Other forces
//! do the work q_h per unit of h and q_d per unit of d. n is the normal of the ground, e points to the left along the ground,
//! and i forward. Normal forces f_b at both contact points balance the other forces if
//!
//! ```text
//! f_l n.C_l,h + f_r n.C_r,h = -q_h        f_l n.C_l,d + f_r n.C_r,d = -q_d                     (1)
//! ```
//!
//! | forces | work |
//! |---|---|
//! | a unit side force to the left, half at each wheel | q = (e.C_l + e.C_r)/2 |
//! | a unit force forward, half at each wheel | q = (i.D_l + i.D_r)/2, D = C if the axle carries the torque, W if shafts do |
//! | springs and anti-roll bar of the energy U | q = -U |
//!
//! W is the velocity of a wheel centre. In each line of this table, q, C, D, W and U have a further index h or d. U_h and U_d
//! are the derivatives of U.
//!
//! The roll centre is the instant centre of the axle's motion along d in front view. With v the velocity at the
//! midpoint of both contact points and w the angular velocity, its position from that midpoint is
//!
//! ```text
//! height v.e/(w.i)        to the left -v.n/(w.i)                                               (2)
//! ```
//!
//! When a steered axle moves, its wheels turn about the kingpins. This changes the forces of equation (1): C_b,h and C_b,d
//! are then the velocities of points of the knuckles. The roll centre of equation (2), pinion angle and direction describe
//! the axle itself.
//!
//! The height of a pad changes with both travels of the wheel centres:
//!
//! ```text
//! dp_l = (n.C_l,h + n.C_l,d)/2 dz_l + (n.C_l,h - n.C_l,d)/2 dz_r, and the same for p_r with l and r exchanged   (3)
//! ```
//!
//! Each wheel has its own frame. The right wheel's frame is the mirror image, in which the difference is -d. So n.C_r,d
//! is the negative of its value in that frame, and e.C_r,d is the outboard component in that frame.

use super::loads::{bar_torque, spring_force};
use super::roll::FARTHEST_MEETING;
use crate::axle::reading::WheelParts;
use crate::axle::state::{AxleState, Motion, WheelState};
use crate::axle::{AxleQuantity, Carriers};
use crate::characteristics::NumberPart;
use crate::model::Side;
use crate::number::{Each, Matrix3, Real, Scalar, SimdReal, Vector3};

/// Work of forces per unit of d (half the difference of travels), and per unit of the mean travel h.
struct Work<T> {
    difference: T,
    mean: T,
}

/// Velocities of a point of each wheel, in the frame of this wheel. The first velocity is per unit of d (half the difference of
/// travels) in this frame, the second per unit of the mean travel.
type Velocities<T> = [[Vector3<T>; 2]; 2];

#[inline(always)]
fn contact_velocities<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> Velocities<T> {
    state
        .wheels()
        .each(|wheel| [wheel.contact_by_difference(), wheel.contact_by_mean()])
}

/// Wheel loads that balance forces which do this work, by equation (1).
#[inline(always)]
fn balancing<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>, work: &Work<T>) -> [T; 2] {
    let [left, right] = state.wheels();
    let (left_d, right_d) = (left.rise_by_difference(), right.rise_by_difference());
    let (left_h, right_h) = (left.rise_by_mean(), right.rise_by_mean());
    let determinant = left_d * right_h + right_d * left_h;
    [
        -(work.difference * right_h + work.mean * right_d) / determinant,
        -(work.mean * left_d - work.difference * left_h) / determinant,
    ]
}

/// Wheel loads that balance a unit side force to the left, half at each wheel.
#[inline(always)]
pub(crate) fn side_force_loads<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> [T; 2] {
    let [left, right] = state.wheels().each(|wheel| wheel.ground.outboard());
    let [[left_d, left_h], [right_d, right_h]] = contact_velocities(state);
    let work = Work {
        difference: (left.dot(left_d) + right.dot(right_d)).scaled(0.5),
        mean: (left.dot(left_h) - right.dot(right_h)).scaled(0.5),
    };
    balancing(state, &work)
}

/// Height of the roll centre, and its distance to the left of the midpoint between the contact points, by equation (2).
#[inline(always)]
pub(crate) fn roll_centre<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> [T; 2] {
    if let Carriers::Steered(_) = state.carriers {
        return steered_roll_centre(state);
    }
    let [left, right] = state.wheels();
    let [[left_d, _], [right_d, _]] = contact_velocities(state);
    let across = left.ground.outboard().dot(left_d) + right.ground.outboard().dot(right_d);
    let up = left.ground.normal().dot(left_d) - right.ground.normal().dot(right_d);
    let rolling = rolling(state);
    let twice = rolling + rolling;
    [across / twice, -(up / twice)]
}

/// Height of the roll centre of a steered axle and its lateral distance, in the frame of the left wheel.
#[inline(always)]
fn steered_roll_centre<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> [T; 2] {
    let [left, right] = state.wheels();
    let (own, other) = (left.contact_point(), right.contact_point());
    let middle = Vector3::new(own.x + other.x, own.y - other.y, own.z + other.z);
    let (of_axle, _) = left.reading.steering_axis();
    let [velocity, turn] = left.reading.axle_twist(state.carriers.by_difference());
    let here = velocity + turn.cross(middle.scaled(0.5) - of_axle);
    let ground = left.ground;
    [
        ground.outboard().dot(here) / turn.x,
        -(ground.normal().dot(here) / turn.x),
    ]
}

/// Column of the axle's rotation matrix along x (0) or y (1).
#[inline(always)]
fn axle_column<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>, i: usize) -> Vector3<T> {
    match state.carriers {
        Carriers::Steered(_) => state.readings[0].axle_column(i, [0, 0]),
        _ => state.readings[0].column(i, [0, 0]),
    }
}

/// Derivative of the axle's rotation about the vehicle's x with respect to d (half the difference of travels).
#[inline(always)]
fn rolling<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let [_, turn] = state.readings[0].twist(state.carriers.by_difference());
    turn.x
}

/// Lanes in which the roll centre is less than a hundred tracks away, both in height and to the side. Farther away, its
/// position is meaningless. A roll centre with NaN coordinates counts as far away.
#[inline(always)]
pub(crate) fn rolls_nearby<B: SimdReal, W: WheelParts<B>>(state: &AxleState<B, W>) -> B::Mask {
    let [height, lateral] = roll_centre(state);
    let far = state.track().scaled(0.5 * FARTHEST_MEETING);
    height.abs().less(far) & lateral.abs().less(far)
}

/// Loads of both wheels due to springs and anti-roll bar.
pub(crate) fn wheel_loads<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> [T; 2] {
    loads_of(state, state.setup.bar_rate.is_some())
}

/// Derivative of the wheel load with respect to the height of the wheel's level pad, from the springs alone. The other pad
/// does not move. So the changes of both travels are computed with the inverse of the matrix of equation (3).
pub(crate) fn wheel_rate<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    let pads = state.on_pads();
    let by_travel = |motion: Motion| loads_of(&pads.moving(motion), false)[side as usize][1];
    let (by_left, by_right) = (
        by_travel(Motion::TravelLeft),
        by_travel(Motion::TravelRight),
    );
    let rises = |wheel: WheelState<'_, T, W>| {
        let (difference, mean) = (wheel.rise_by_difference(), wheel.rise_by_mean());
        // Derivatives of the contact point's rise with respect to the travel of this wheel and the travel of the other wheel.
        [mean + difference, mean - difference].each(|c| c.scaled(0.5))
    };
    let [left, right] = pads.wheels();
    let ([left_own, left_other], [right_own, right_other]) = (rises(left), rises(right));
    let determinant = left_own * right_own - left_other * right_other;
    let sum = match side {
        Side::Left => by_left * right_own - by_right * right_other,
        Side::Right => by_right * left_own - by_left * left_other,
    };
    sum / determinant
}

fn loads_of<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>, has_bar: bool) -> [T; 2] {
    let rates = |side: Side, part: NumberPart| {
        let reading = &state.readings[side as usize];
        let by_difference = reading.number(part, state.carriers.by_difference());
        [
            by_difference,
            reading.number(part, state.carriers.by_mean()),
        ]
    };
    let [left, right] = [Side::Left, Side::Right].each(|side| {
        let force = spring_force(state, side);
        rates(side, NumberPart::SpringLength).each(|rate| force * rate)
    });
    // In the right wheel's frame, the difference of travels has the opposite sign.
    let mut work = Work {
        difference: left[0] - right[0],
        mean: left[1] + right[1],
    };
    if has_bar {
        let torque = bar_torque(state);
        let [left, right] =
            [Side::Left, Side::Right].each(|side| rates(side, NumberPart::BarAngle));
        work.difference = work.difference - torque * (left[0] + right[0]);
        work.mean = work.mean - torque * (left[1] - right[1]);
    }
    balancing(state, &work)
}

/// Wheel loads that balance a unit force forward, half at each wheel. `by_carrier` is 1 if the axle carries the drive
/// or brake torque, 0 if shafts from the body carry it.
#[inline(always)]
fn forward_force_loads<T: Real, W: WheelParts<T>>(
    state: &AxleState<T, W>,
    by_carrier: f64,
) -> [T; 2] {
    let [left, right] = state.wheels().each(|wheel| {
        let lever = wheel.contact_lever().scaled(by_carrier);
        let forward = |powers: [usize; 2]| {
            let [centre, turn] = wheel.reading.twist(powers);
            (centre + turn.cross(lever)).x
        };
        let carriers = wheel.carriers;
        [
            forward(carriers.by_difference()),
            forward(carriers.by_mean()),
        ]
    });
    let work = Work {
        difference: (left[0] - right[0]).scaled(0.5),
        mean: (left[1] + right[1]).scaled(0.5),
    };
    balancing(state, &work)
}

/// Returns 100 share (L/h) (f_l + f_r) for a unit force forward, in percent. `share` is this axle's share of the drive or
/// brake force. L is the wheelbase. h is here the height of the centre of gravity. f_l and f_r are the wheel loads of
/// [`forward_force_loads`].
#[inline(always)]
fn supported<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>, share: f64, by_carrier: f64) -> T {
    let c = &state.setup.constants;
    let [left, right] = forward_force_loads(state, by_carrier);
    (left + right).scaled(100.0 * share * c.wheelbase / c.cg_height)
}

#[inline(always)]
fn driving<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let c = &state.setup.constants;
    supported(state, c.drive_share, c.drive_torque_by_carrier)
}

#[inline(always)]
fn braking<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let c = &state.setup.constants;
    supported(state, c.brake_share, c.brake_torque_by_carrier)
}

/// Share of the load transfer under drive that the links of a rear axle carry.
#[inline(always)]
pub(crate) fn anti_squat<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    driving(state)
}

/// Share of the load transfer that the links carry. It applies to a rear axle in braking, and to a driven front axle
/// under drive.
#[inline(always)]
pub(crate) fn anti_lift<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    if state.setup.constants.is_front {
        -driving(state)
    } else {
        braking(state)
    }
}

/// Share of the load transfer in braking that the links of a front axle carry.
#[inline(always)]
pub(crate) fn anti_dive<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    -braking(state)
}

/// Load that a unit drive force moves from the left to the right wheel.
#[inline(always)]
pub(crate) fn drive_load_transfer<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let by_carrier = state.setup.constants.drive_torque_by_carrier;
    let [left, right] = forward_force_loads(state, by_carrier);
    (right - left).scaled(0.5)
}

/// Twist angle of a twist beam: half the difference of the angles at both wheels. The angle at a wheel is the rotation
/// of the other half relative to this half. It is positive if the other wheel falls. The angles at both wheels have
/// opposite signs.
#[inline(always)]
pub(crate) fn beam_twist<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let [left, right] = state
        .readings
        .each_ref()
        .each(|reading| reading.bar_angle().0);
    (right - left).scaled(0.5)
}

/// Torque in a twist beam. In other formulas, the beam acts like an anti-roll bar whose rate is a quarter of the beam's
/// rate, and whose angle is twice the beam's angle.
#[inline(always)]
pub(crate) fn beam_torque<T: Scalar, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    -bar_torque(state).scaled(2.0)
}

/// Direction of the axle's line, seen from above.
#[inline(always)]
pub(crate) fn axle_steer<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    steer_of(axle_column(state, 1))
}

/// Angle of an axle's line to the left, seen from above.
#[inline(always)]
pub(crate) fn steer_of<T: Real>(line: Vector3<T>) -> T {
    (-line.x).atan2(line.y)
}

/// Pitch of the axle from the design position.
#[inline(always)]
pub(crate) fn pinion_angle<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    pitch_of(axle_column(state, 0))
}

/// Nose-up angle of a direction that is forward in the design position.
#[inline(always)]
pub(crate) fn pitch_of<T: Real>(forward: Vector3<T>) -> T {
    forward.z.atan2(forward.x)
}

/// Quantities that are measured from the design position. [`place_of`] returns the values in this order.
pub(crate) const FROM_DESIGN: [AxleQuantity; 4] = [
    AxleQuantity::AxleSteer,
    AxleQuantity::AxleLateral,
    AxleQuantity::AxleLongitudinal,
    AxleQuantity::PinionAngle,
];

/// Returns the values of [`FROM_DESIGN`] for an axle, in the left wheel's frame. `rotation` is the axle's rotation from
/// the design position. `displacement` is the displacement of the midpoint between the wheel centres.
pub(crate) fn place_of<T: Scalar>(rotation: &Matrix3<T>, displacement: Vector3<T>) -> [T; 4] {
    let [forward, line, _] = rotation.columns;
    [
        steer_of(line),
        displacement.y,
        displacement.x,
        pitch_of(forward),
    ]
}

/// Displacement of the midpoint of both wheel centres, in the left wheel's frame.
#[inline(always)]
fn displacement<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> Vector3<T> {
    let [left, right] = state
        .wheels()
        .each(|wheel| wheel.reading.centre() - wheel.reading.design().centre);
    let sum = Vector3::new(left.x + right.x, left.y - right.y, left.z + right.z);
    sum.scaled(0.5)
}

/// Displacement of the midpoint of both wheel centres to the left.
#[inline(always)]
pub(crate) fn axle_lateral<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    displacement(state).y
}

/// Forward displacement of the midpoint of both wheel centres.
#[inline(always)]
pub(crate) fn axle_longitudinal<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    displacement(state).x
}
