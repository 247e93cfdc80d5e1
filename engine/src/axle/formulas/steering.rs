//! Steer angles, Ackermann and turning circle.
//!
//! Seen from above, in the body's axes, each spin axis meets the line of the other axle. Let i and o be the steer angles of
//! the inner and outer wheel, positive to the inside of the turn. L_i and L_o are the distances of their centres ahead of
//! that line, and T is the distance of the centres across the vehicle. The inner spin axis meets the line at L_i cot i from
//! the inner wheel. The ideal outer spin axis passes through the same point:
//!
//! ```text
//! ideal = atan2(L_o sin i, L_i cos i + T sin i)
//! ```
//!
//! A steered rear axle is treated as the front axle of the vehicle driven backwards: the forward direction and the sign of
//! steer change.

use crate::axle::reading::WheelParts;
use crate::axle::state::{AxleState, Motion};
use crate::characteristics::Wheel;
use crate::model::Side;
use crate::number::{Each, Real, Vector3, outlined};
use std::f64::consts::PI;

/// Absolute mean steer, in rad, below which the percentages and the turning circle have no value. Straight ahead, the angles
/// in their denominators are zero.
pub(crate) const STRAIGHT_AHEAD: f64 = 0.02;

/// Steer angle of a wheel, positive to the left.
#[inline(always)]
pub(crate) fn steer<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    let a = state.wheel(side).reading.spin_axis();
    match side {
        Side::Left => -a.x.atan2(a.y),
        Side::Right => a.x.atan2(a.y),
    }
}

/// Mean steer angle of both wheels.
#[inline(always)]
pub(crate) fn mean_steer<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    (steer(state, Side::Left) + steer(state, Side::Right)).scaled(0.5)
}

/// Sum of both toe angles.
#[inline(always)]
pub(crate) fn total_toe<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    steer(state, Side::Right) - steer(state, Side::Left)
}

/// Sum of the toe of both wheels, expressed as lengths at the rim.
#[inline(always)]
pub(crate) fn total_toe_at_rim<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let at_rim = |side| {
        let axis = state.wheel(side).reading.spin_axis();
        let (heading, _) = Wheel::heading_and_outboard_of(axis);
        -heading.y
    };
    let sum: T = at_rim(Side::Left) + at_rim(Side::Right);
    sum.scaled(state.setup.constants.rim_diameter)
}

/// Derivative of steer with respect to the roll angle.
#[inline(always)]
pub(crate) fn roll_steer<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    steer(&state.moving(Motion::Roll), side)[1]
}

/// Derivative of mean steer with respect to the roll angle.
#[inline(always)]
pub(crate) fn axle_roll_steer<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    mean_steer(&state.moving(Motion::Roll))[1]
}

/// Angle of the steering wheel per mean steer. On a plane ground, roll angle and mean travel are constant. On pads, both
/// travels are constant.
#[inline(always)]
pub(crate) fn steering_ratio<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let per_angle = state.setup.c_factor.unwrap_or(f64::NAN) / (2.0 * PI);
    let by_rack = mean_steer(&state.moving(Motion::Steering))[1];
    by_rack.one() / by_rack.scaled(per_angle)
}

/// Geometry of a turn, seen from above. Angles are positive towards the inside of the turn.
struct Turn<T> {
    /// Sine and cosine of the inner wheel's steer, both multiplied by the same positive factor.
    inner: [T; 2],
    /// Sine and cosine of the outer wheel's steer, both multiplied by the same positive factor.
    outer: [T; 2],
    /// Distance of each wheel centre ahead of the other axle's line: [inner, outer].
    ahead: [T; 2],
    /// Distance of the wheel centres across the vehicle.
    across: T,
    /// Distance of the wheel centres across the vehicle in the design position.
    design_across: T,
    /// Contact point of the outer wheel relative to its centre: [ahead, outboard].
    outer_contact: [T; 2],
}

/// Orders the numbers of the left and the right wheel as [inner, outer]. `side` is 1 if the left wheel is the inner
/// wheel, else -1.
#[inline(always)]
fn inner_and_outer<T: Real>(side: T, left: T, right: T) -> [T; 2] {
    let is_left = (side.one() + side).scaled(0.5);
    let is_right = side.one() - is_left;
    [
        left * is_left + right * is_right,
        left * is_right + right * is_left,
    ]
}

impl<T: Real> Turn<T> {
    /// Computes the geometry of the turn. The macro `outlined!` makes a separate function of the computation, because several
    /// formulas use it.
    #[inline(always)]
    fn of<W: WheelParts<T>>(state: &AxleState<T, W>) -> Self {
        outlined!(
            [T: Real, W: WheelParts<T>] state.like(); state: &'p AxleState<'p, T, W> = state => Turn<T> {
                Turn::seen_from_above(state)
            }
        )
    }

    #[inline(always)]
    fn seen_from_above<W: WheelParts<T>>(state: &AxleState<T, W>) -> Self {
        let like = state.like();
        let wheelbase = state.setup.wheelbase.unwrap_or(f64::NAN);
        let forward = state.setup.forward();
        let side = mean_steer(state).scaled(forward).sign();
        let [left, right] = state.wheels();
        let [left_design, right_design] =
            [left.reading.design().centre, right.reading.design().centre];
        // The other axle's line is a wheelbase away from the design position of these wheels.
        let middle = (left_design.x + right_design.x).scaled(0.5);
        let (left_centre, right_centre) = (left.reading.centre(), right.reading.centre());
        let [inner_x, outer_x] = inner_and_outer(side, left_centre.x, right_centre.x);
        let (left_axis, right_axis) = (left.reading.spin_axis(), right.reading.spin_axis());
        let [inner_axis_x, outer_axis_x] = inner_and_outer(side, left_axis.x, right_axis.x);
        let [inner_axis_y, outer_axis_y] = inner_and_outer(side, left_axis.y, right_axis.y);
        let (left_lever, right_lever) = (left.contact_lever(), right.contact_lever());
        let [_, lever_x] = inner_and_outer(side, left_lever.x, right_lever.x);
        let [_, lever_y] = inner_and_outer(side, left_lever.y, right_lever.y);
        Turn {
            // The outboard direction points to the inside of the turn at the inner wheel, and to the outside at the
            // outer wheel.
            inner: [inner_axis_x.scaled(-forward), inner_axis_y],
            outer: [outer_axis_x.scaled(forward), outer_axis_y],
            ahead: [
                (inner_x - middle).scaled(forward) + like.constant(wheelbase),
                (outer_x - middle).scaled(forward) + like.constant(wheelbase),
            ],
            across: left_centre.y + right_centre.y,
            design_across: left_design.y + right_design.y,
            outer_contact: [lever_x.scaled(forward), lever_y],
        }
    }

    #[inline(always)]
    fn angles(&self) -> [T; 2] {
        let ([inner, inner_cosine], [outer, outer_cosine]) = (self.inner, self.outer);
        [inner.atan2(inner_cosine), outer.atan2(outer_cosine)]
    }

    #[inline(always)]
    fn ideal_outer(&self) -> T {
        let [sine, cosine] = self.inner;
        let [inner, outer] = self.ahead;
        (outer * sine).atan2(inner * cosine + self.across * sine)
    }

    #[inline(always)]
    fn cotangents(&self) -> [T; 2] {
        let ([inner, inner_cosine], [outer, outer_cosine]) = (self.inner, self.outer);
        [inner_cosine / inner, outer_cosine / outer]
    }
}

/// Steer of the outer wheel minus its ideal steer.
#[inline(always)]
pub(crate) fn ackermann_error<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let turn = Turn::of(state);
    let [_, outer] = turn.angles();
    outer - turn.ideal_outer()
}

/// Difference of the steer angles, in percent of the ideal difference. The ideal outer angle is computed from the inner
/// angle.
#[inline(always)]
pub(crate) fn ackermann<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let turn = Turn::of(state);
    let [inner, outer] = turn.angles();
    ((inner - outer) / (inner - turn.ideal_outer())).scaled(100.0)
}

/// Difference of the steer angles, in percent of the ideal difference. The ideal difference is computed from the outer
/// wheel's angle, as in Simscape.
#[inline(always)]
pub(crate) fn ackermann_by_inner<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let turn = Turn::of(state);
    let [inner, outer] = turn.angles();
    let [sine, cosine] = turn.outer;
    let length = sine.constant(state.setup.wheelbase.unwrap_or(f64::NAN));
    let ideal = (length * sine).atan2(length * cosine - turn.design_across * sine);
    ((inner - outer) / (ideal - outer)).scaled(100.0)
}

/// Difference of the cotangents of the steer angles, in percent of the ideal difference. The ideal difference is the track
/// of the wheel centres in the design position, divided by the wheelbase.
#[inline(always)]
pub(crate) fn ackermann_by_cotangents<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let turn = Turn::of(state);
    let [inner, outer] = turn.cotangents();
    let length = inner.constant(state.setup.wheelbase.unwrap_or(f64::NAN));
    ((outer - inner) * length / turn.design_across).scaled(100.0)
}

/// Diameter of the circle on which the outer wheel's contact point moves. The centre of the circle is midway between
/// the points where the spin axes meet the line of the other axle.
#[inline(always)]
pub(crate) fn turning_circle<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let turn = Turn::of(state);
    let [inner, outer] = turn.cotangents();
    let lateral = (turn.ahead[0] * inner + turn.across + turn.ahead[1] * outer).scaled(0.5);
    let [ahead, outboard] = turn.outer_contact;
    let (x, y) = (turn.ahead[1] + ahead, lateral + outboard);
    (x * x + y * y).sqrt().scaled(2.0)
}

/// A turn, seen from above, in the body's axes (x forward, y left).
pub(crate) struct FromAbove {
    /// Rear and front end of the left and the right wheel.
    pub wheels: [[[f64; 2]; 2]; 2],
    /// Points where the spin axis of each wheel meets the other axle's line. `None` straight ahead.
    pub meets: Option<[[f64; 2]; 2]>,
    /// Midpoint of the two points in `meets`.
    pub centre: Option<[f64; 2]>,
    /// Position of the other axle, along x.
    pub other_axle: f64,
}

/// Geometry of the turn. `None` unless the study gives a wheelbase and the wheels' radius.
pub(crate) fn turn(state: &AxleState<f64>) -> Option<FromAbove> {
    let wheelbase = state.setup.wheelbase?;
    let radius = state.setup.wheel_radius?;
    let forward = state.setup.forward();
    // The right wheel's frame is the mirror image.
    let readings = state.wheels().each(|wheel| wheel.reading);
    let plan = |v: Vector3<f64>, side: usize| [v.x, if side == 0 { v.y } else { -v.y }];
    let centres = [0, 1].each(|side| plan(readings[side].centre(), side));
    let wheels = [0, 1].each(|side| {
        let [x, y] = plan(readings[side].spin_axis(), side);
        let [dx, dy] = [y, -x].each(|c| c * radius / x.hypot(y) * (1.0 - 2.0 * side as f64));
        let [cx, cy] = centres[side];
        [[cx - dx, cy - dy], [cx + dx, cy + dy]]
    });
    let [left, right] = readings.each(|reading| reading.design().centre.x);
    let other_axle = 0.5 * (left + right) - forward * wheelbase;
    let meets = (!is_straight_ahead(state)).then(|| {
        let turn = Turn::of(state);
        let left_is_inner = mean_steer(state) * forward >= 0.0;
        let (inner, outer, inside) = if left_is_inner {
            (0, 1, 1.0)
        } else {
            (1, 0, -1.0)
        };
        let away = turn.cotangents();
        let mut meets = [[other_axle, 0.0]; 2];
        meets[inner][1] = centres[inner][1] + inside * turn.ahead[0] * away[0];
        meets[outer][1] = centres[outer][1] + inside * turn.ahead[1] * away[1];
        meets
    });
    Some(FromAbove {
        wheels,
        meets,
        centre: meets.map(|[left, right]| [other_axle, 0.5 * (left[1] + right[1])]),
        other_axle,
    })
}

/// Returns true if the wheels are so close to straight ahead that the percentages are meaningless.
pub(crate) fn is_straight_ahead(state: &AxleState<f64>) -> bool {
    let steer = mean_steer(state);
    steer.is_nan() || steer.abs() < STRAIGHT_AHEAD
}
