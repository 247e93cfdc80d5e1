//! Roll centre and swing arms, from the velocity of the contact point.
//!
//! C' is the velocity of the knuckle-fixed point at the contact point C, and w is the knuckle's angular velocity. In front
//! view, the velocity of the instantaneous centre has no y and z component. So its distance inboard of C follows from w_x
//! (y_C - y_ic) = C_z'. In side view, w_y (x_ic - x_C) = C_z'. All centres follow from the true velocities, which include
//! the effect of the tie rod. The graphical construction with arm planes ignores the tie rod, and its result can differ by
//! tens of millimetres.
//!
//! A wheel that does not rotate in a view has its centre at infinity. Its computed angular velocity is then only rounding error,
//! so a centre computed from it would be meaningless. [`turning`] separates the two cases.

use super::{Constants, Formula, Inputs, Need, Slot, Slots, Unit, WheelReading, formulas};
use crate::mechanism::Configuration;
use crate::model::Suspension;
use crate::number::{Jet, Real, Vector3};

/// Inputs of the velocity of the contact point.
pub(super) const CONTACT_VELOCITY: &[Slot] = &[Slot::SpinAxis, Slot::CentreRate, Slot::Turn];

/// Largest distance of an instantaneous centre, relative to the mechanism's size. A farther centre counts as infinite.
/// Because of rounding, a wheel that does not rotate has an angular velocity of about 1e-16 divided by the size. In badly
/// conditioned poses, the angular velocity is up to a million times larger.
const FARTHEST_CENTRE: f64 = 1e10;

/// Angular velocity in front view or side view, or zero if the instantaneous centre is farther than [`FARTHEST_CENTRE`]. `velocity`
/// has the contact point's two velocity components in this view.
#[inline(always)]
fn turning<T: Real>(turn: T, velocity: [T; 2], size: f64) -> T {
    let [first, second] = velocity;
    let speeds = first * first.sign() + second * second.sign();
    let is_near = ((turn * turn.sign()).scaled(FARTHEST_CENTRE * size) - speeds).sign();
    turn * (turn.one() + is_near).scaled(0.5)
}

impl<T: Real> Inputs<T> {
    /// Velocity of the contact point, and the knuckle's angular velocity about x. The angular velocity is zero if the front-view
    /// centre counts as infinite.
    #[inline(always)]
    fn in_front_view(&self) -> (Vector3<T>, T) {
        let velocity = self.contact_velocity();
        let turn = turning(self.turn.x, [velocity.y, velocity.z], self.constants.size);
        (velocity, turn)
    }

    /// Velocity of the contact point, and the knuckle's angular velocity about y. The angular velocity is zero if the side-view
    /// centre counts as infinite.
    #[inline(always)]
    fn in_side_view(&self) -> (Vector3<T>, T) {
        let velocity = self.contact_velocity();
        let turn = turning(self.turn.y, [velocity.x, velocity.z], self.constants.size);
        (velocity, turn)
    }
}

formulas! {
    /// Height of the kinematic roll centre above the ground.
    RollCentreHeight {
        name: "roll_centre_height",
        unit: Unit::Length,
        positive: "above the ground",
        formula: "C_y C_y'/C_z', in the centre plane y = 0",
        source: "the normal to the contact point's velocity meets the centre plane of the car",
        reads: &[Slot::SpinAxis, Slot::Centre, Slot::CentreRate, Slot::Turn],
        needs: &[Need::WheelRadius],
    } = |inputs| {
        let velocity = inputs.contact_velocity();
        inputs.contact_point().y * velocity.y / velocity.z
    };

    /// Length of the front-view swing arm: horizontal distance from the contact point to the instantaneous centre in front view.
    FrontViewSwingArm {
        name: "front_view_swing_arm",
        unit: Unit::Length,
        positive: "instantaneous centre inboard of the contact point",
        formula: "C_z'/w_x, horizontal distance from the contact point",
        source: "W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, SAE 1995, ch. 17",
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius],
    } = |inputs| {
        let (velocity, turn) = inputs.in_front_view();
        velocity.z / turn
    };

    /// Length of the side-view swing arm: horizontal distance from the contact point to the instantaneous centre in side view.
    SideViewSwingArm {
        name: "side_view_swing_arm",
        unit: Unit::Length,
        positive: "instantaneous centre behind the contact point",
        formula: "-C_z'/w_y, horizontal distance from the contact point",
        source: "W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, SAE 1995, ch. 17",
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius],
    } = |inputs| {
        let (velocity, turn) = inputs.in_side_view();
        -(velocity.z / turn)
    };

    /// Lateral position of the instantaneous centre in front view.
    FrontViewCentreLateral {
        name: "front_view_centre_lateral",
        unit: Unit::Length,
        positive: "instantaneous centre on the wheel's own side of the centre plane y = 0",
        formula: "C_y - C_z'/w_x",
        source: "the point at which the wheel carrier stands still, seen from the front",
        reads: &[Slot::SpinAxis, Slot::Centre, Slot::CentreRate, Slot::Turn],
        needs: &[Need::WheelRadius],
    } = |inputs| inputs.contact_point().y - FrontViewSwingArm::evaluate(inputs);

    /// Height of the instantaneous centre in front view above the ground.
    FrontViewCentreHeight {
        name: "front_view_centre_height",
        unit: Unit::Length,
        positive: "instantaneous centre in front view above the ground",
        formula: "C_y'/w_x",
        source: "the point at which the wheel carrier stands still, seen from the front",
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius],
    } = |inputs| {
        let (velocity, turn) = inputs.in_front_view();
        velocity.y / turn
    };

    /// Longitudinal position of the instantaneous centre in side view.
    SideViewCentreLongitudinal {
        name: "side_view_centre_longitudinal",
        unit: Unit::Length,
        positive: "instantaneous centre ahead of the study's x = 0",
        formula: "C_x + C_z'/w_y",
        source: "the point at which the wheel carrier stands still, seen from the side",
        reads: &[Slot::SpinAxis, Slot::Centre, Slot::CentreRate, Slot::Turn],
        needs: &[Need::WheelRadius],
    } = |inputs| inputs.contact_point().x - SideViewSwingArm::evaluate(inputs);

    /// Height of the instantaneous centre in side view above the ground.
    SideViewCentreHeight {
        name: "side_view_centre_height",
        unit: Unit::Length,
        positive: "instantaneous centre in side view above the ground",
        formula: "-C_x'/w_y",
        source: "the point at which the wheel carrier stands still, seen from the side",
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius],
    } = |inputs| {
        let (velocity, turn) = inputs.in_side_view();
        -(velocity.x / turn)
    };
}

/// Instantaneous centres as points in the kernel's frame (x forward, y left, z up, for a left wheel), for drawings. A centre is
/// `None` if it is at infinity, or if the wheel's radius is unknown.
///
/// The velocity of a point P of the knuckle is C' + w x (P - C). In front view, with P in the transverse plane of C, its y
/// and z components vanish for P - C = (0, -C_z'/w_x, C_y'/w_x). In side view, with P in the longitudinal plane of C, its x
/// and z components vanish for P - C = (C_z'/w_y, 0, -C_x'/w_y).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InstantCentres {
    /// Contact point of wheel and ground.
    pub contact: Option<Vector3<f64>>,
    /// Roll centre, in the centre plane y = 0.
    pub roll_centre: Option<Vector3<f64>>,
    /// Instantaneous centre in front view.
    pub front_view: Option<Vector3<f64>>,
    /// Instantaneous centre in side view.
    pub side_view: Option<Vector3<f64>>,
}

impl InstantCentres {
    /// Instantaneous centres of a suspension in a configuration with its first derivatives with respect to the drive
    /// coordinate.
    pub fn of(suspension: &Suspension, at: &Configuration<Jet<f64, 2>>) -> Self {
        if suspension.wheel_radius.is_none() {
            return InstantCentres::default();
        }
        let slots = Slots::default().with(RollCentreHeight::INFO.reads);
        let reading = WheelReading::reading(at, Constants::of(suspension), slots);
        reading.instant_centres()
    }
}

impl<const N: usize> WheelReading<N> {
    fn instant_centres(&self) -> InstantCentres {
        let inputs = self.inputs();
        let now = |v: Vector3<Jet<f64, N>>| v.map(|c| c[0]);
        let (contact, velocity) = (now(inputs.contact_point()), now(inputs.contact_velocity()));
        let turn = now(inputs.turn);
        let height = RollCentreHeight::evaluate(inputs)[0];
        let [front_view, side_view] =
            instant_centres_of(contact, velocity, turn, inputs.constants.size);
        InstantCentres {
            contact: Some(contact),
            roll_centre: finite(contact, Vector3::new(0.0, -contact.y, height)),
            front_view,
            side_view,
        }
    }
}

/// Instantaneous centres in front and side view, from the contact point, its velocity and the knuckle's angular velocity.
/// `None` for a centre at infinity. `size` is the size of the mechanism.
pub fn instant_centres_of(
    contact: Vector3<f64>,
    velocity: Vector3<f64>,
    turn: Vector3<f64>,
    size: f64,
) -> [Option<Vector3<f64>>; 2] {
    let about_x = turning(turn.x, [velocity.y, velocity.z], size);
    let about_y = turning(turn.y, [velocity.x, velocity.z], size);
    let front = Vector3::new(0.0, -velocity.z / about_x, velocity.y / about_x);
    let side = Vector3::new(velocity.z / about_y, 0.0, -velocity.x / about_y);
    [finite(contact, front), finite(contact, side)]
}

fn finite(from: Vector3<f64>, lever: Vector3<f64>) -> Option<Vector3<f64>> {
    let point = from + lever;
    let is_finite = point.to_array().iter().all(|x| x.is_finite());
    is_finite.then_some(point)
}
