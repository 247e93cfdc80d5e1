//! Track, roll centre, jacking, and the effects of roll on a wheel.
//!
//! C is the contact point, and C' its velocity with the wheel locked to its carrier, with respect to the wheel's travel. In
//! front view, the reaction of a side force on the locked wheel acts along the normal to C' through C. A unit side force
//! inboard along the ground adds j units of wheel load, j = (C'.o)/(C'.n). Here o points outboard along the ground, and n
//! is the normal of the ground. The normals to C' of both wheels meet in the roll centre. Its coordinates are eta along the
//! ground from midway between the contact points, positive to the left, and zeta above the ground:
//!
//! ```text
//! d/2 + (track/2 - eta) j_l = zeta = -d/2 + (track/2 + eta) j_r
//! zeta = (track j_l j_r + (d/2) (j_r - j_l))/(j_l + j_r)
//! eta  = ((track/2) (j_l - j_r) + d)/(j_l + j_r)
//! ```
//!
//! where d is the height of the left contact point above the right contact point. On a plane d is 0; else zeta is measured from
//! the mean height of both contact points.
//!
//! Both wheels can carry equal side forces. Then their resultant has the same roll moment at the height track (j_l + j_r)/4,
//! which stays finite.

use super::rigid;
use crate::axle::reading::WheelParts;
use crate::axle::state::{AxleState, Motion, WheelState};
use crate::mechanism::Ground;
use crate::model::Side;
use crate::number::{Real, SimdReal, outlined};

/// Wheel load per unit of side force. The side force acts inboard, across the vehicle.
#[inline(always)]
pub(crate) fn jacking_coefficient<T: Real, W: WheelParts<T>>(
    state: &AxleState<T, W>,
    side: Side,
) -> T {
    outlined!(
        [T: Real, W: WheelParts<T>] state.like(); wheel: WheelState<'p, T, W> = state.wheel(side) => T {
            let velocity = wheel.contact_velocity();
            velocity.dot(wheel.ground.outboard()) / velocity.dot(wheel.ground.normal())
        }
    )
}

/// Wheel load per unit of side force. The side force acts along the projection of the wheel's spin axis on the ground,
/// instead of across the vehicle.
#[inline(always)]
pub(crate) fn side_force_jacking<T: Real, W: WheelParts<T>>(
    state: &AxleState<T, W>,
    side: Side,
) -> T {
    let wheel = state.wheel(side);
    let (velocity, normal) = (wheel.contact_velocity(), wheel.ground.normal());
    let a = wheel.reading.spin_axis();
    let across = (a - normal * a.dot(normal)).normalised();
    velocity.dot(across) / velocity.dot(normal)
}

#[inline(always)]
pub(crate) fn jacking<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> [T; 2] {
    [
        jacking_coefficient(state, Side::Left),
        jacking_coefficient(state, Side::Right),
    ]
}

/// Track: distance of the contact points across the vehicle.
#[inline(always)]
pub(crate) fn track<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    state.track()
}

/// Track minus the track of the design position.
#[inline(always)]
pub(crate) fn track_change<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    let designed = designed_half_track(state, Side::Left) + designed_half_track(state, Side::Right);
    state.track() - designed
}

/// Lateral distance of a contact point from the vehicle's centre plane in the design position.
#[inline(always)]
fn designed_half_track<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    let wheel = state.wheel(side);
    let level = Ground::level(state.like());
    let lever = level.contact_lever(wheel.reading.design().spin_axis, wheel.radius);
    wheel.reading.design().centre.y + lever.y
}

/// Roll angle of the body.
#[inline(always)]
pub(crate) fn roll_angle<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    state.roll
}

/// Height of the kinematic roll centre above the ground. On pads, height above the mean height of both contact points.
#[inline(always)]
pub(crate) fn roll_centre_height<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    if state.carriers.is_rigid() {
        return rigid::roll_centre(state)[0];
    }
    let [left, right] = jacking(state);
    let higher = state.mismatch().scaled(0.5);
    (state.track() * (left * right) + higher * (right - left)) / (left + right)
}

/// Lateral position of the kinematic roll centre along the ground, measured from midway between the contact points.
#[inline(always)]
pub(crate) fn roll_centre_lateral<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    if state.carriers.is_rigid() {
        return rigid::roll_centre(state)[1];
    }
    let [left, right] = jacking(state);
    (state.track().scaled(0.5) * (left - right) + state.mismatch()) / (left + right)
}

/// Height of the force-based roll centre. If the side forces of both wheels are equal, a single side force at this
/// height has the same roll moment.
#[inline(always)]
pub(crate) fn force_roll_centre_height<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    if state.carriers.is_rigid() {
        let [left, right] = rigid::side_force_loads(state);
        return (state.track() * (right - left)).scaled(0.5);
    }
    let [left, right] = jacking(state);
    (state.track() * (left + right)).scaled(0.25)
}

/// Upward force on the body per side force to the left, if both wheels carry equal side forces.
#[inline(always)]
pub(crate) fn jacking_force_ratio<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    if state.carriers.is_rigid() {
        let [left, right] = rigid::side_force_loads(state);
        return left + right;
    }
    let [left, right] = jacking(state);
    (right - left).scaled(0.5)
}

/// Derivative of the kinematic roll centre's height with respect to the roll angle.
#[inline(always)]
pub(crate) fn roll_centre_migration_vertical<T: Real, W: WheelParts<T>>(
    state: &AxleState<T, W>,
) -> T {
    roll_centre_height(&state.moving(Motion::Roll))[1]
}

/// Derivative of the kinematic roll centre's lateral position with respect to the roll angle.
#[inline(always)]
pub(crate) fn roll_centre_migration_lateral<T: Real, W: WheelParts<T>>(
    state: &AxleState<T, W>,
) -> T {
    roll_centre_lateral(&state.moving(Motion::Roll))[1]
}

/// Derivative of the height of the force-based roll centre with respect to the roll angle.
#[inline(always)]
pub(crate) fn force_roll_centre_migration<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>) -> T {
    force_roll_centre_height(&state.moving(Motion::Roll))[1]
}

/// Largest accepted lateral distance of the point where the normals to C' through both contact points meet, in half
/// tracks. Beyond a hundred tracks, the normals are nearly parallel, and this point is meaningless.
pub(crate) const FARTHEST_MEETING: f64 = 200.0;

/// Sum of the jacking coefficients below which the normals to C' count as vertical or parallel. Near zero, rounding errors of
/// about 1e-15 alone would decide where they meet.
pub(crate) const UPRIGHT: f64 = 1e-8;

/// Lanes in which the roll centre exists: the normals to C' meet within the largest distance. Normals with NaN jacking
/// coefficients count as parallel.
#[inline(always)]
pub(crate) fn normals_meet<B: SimdReal, W: WheelParts<B>>(state: &AxleState<B, W>) -> B::Mask {
    if state.carriers.is_rigid() {
        rigid::rolls_nearby(state)
    } else {
        meet_near(jacking(state))
    }
}

/// Lanes in which the normals to C' with these jacking coefficients meet within the largest distance.
#[inline(always)]
fn meet_near<B: SimdReal>([left, right]: [B; 2]) -> B::Mask {
    let sum = (left + right).abs();
    let across = (left - right).abs();
    sum.constant(UPRIGHT).less(sum) & across.less(sum.scaled(FARTHEST_MEETING))
}

/// Camber relative to the normal of the ground.
#[inline(always)]
pub(crate) fn camber_to_road<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    let wheel = state.wheel(side);
    -wheel.reading.spin_axis().dot(wheel.ground.normal()).asin()
}

/// Derivative of camber with respect to the roll angle.
#[inline(always)]
pub(crate) fn roll_camber<T: Real, W: WheelParts<T>>(state: &AxleState<T, W>, side: Side) -> T {
    let rolling = state.moving(Motion::Roll);
    let a = rolling.wheel(side).reading.spin_axis();
    (-a.z.asin())[1]
}

/// Derivative of camber to the road with respect to the roll angle.
#[inline(always)]
pub(crate) fn roll_camber_to_road<T: Real, W: WheelParts<T>>(
    state: &AxleState<T, W>,
    side: Side,
) -> T {
    camber_to_road(&state.moving(Motion::Roll), side)[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The normals for the jacking coefficients a and b meet (a - b)/(a + b) half tracks beside the middle. The point
    /// where they meet is accepted up to a hundred tracks, unless the normals are vertical.
    #[test]
    fn normals_meet_within_a_hundred_tracks() {
        for sign in [1.0, -1.0] {
            let at = |place: f64, sum: f64| {
                let difference = place * sum;
                meet_near([0.5 * (sum + difference), 0.5 * (sum - difference)].map(|a| sign * a))
            };
            for place in [-199.0, -1.0, 0.0, 3.0, 199.0] {
                assert!(at(place, 0.01) && at(place, 2e-8), "{place}");
                assert!(!at(place, 5e-9), "{place}");
            }
            for place in [-201.0, 201.0] {
                assert!(!at(place, 0.01), "{place}");
            }
        }
        assert!(!meet_near([f64::NAN, 0.1]) && !meet_near([0.0_f64, 0.0]));
    }
}
