//! Roll centre and swing arms, from the velocity of the contact point.
//!
//! C' is the velocity of the knuckle-fixed point at the contact point C and w the knuckle's angular
//! velocity. In front view the instantaneous centre is the point whose velocity has no y and z
//! component, so it lies w_x (y_C - y_ic) = C_z' inboard of C; in side view w_y (x_ic - x_C) = C_z'.
//! All are taken from the true velocities, tie rod included; the construction with arm planes leaves
//! the tie rod out and can differ by tens of millimetres.

use super::{Formula, Info, Inputs, Need, Slot, Unit};
use crate::number::Real;

/// What the velocity of the contact point depends on.
pub(super) const CONTACT_VELOCITY: &[Slot] = &[Slot::SpinAxis, Slot::CentreRate, Slot::Turn];

/// Kinematic roll centre.
pub(super) struct RollCentreHeight;
impl Formula for RollCentreHeight {
    const INFO: Info = Info {
        name: "roll_centre_height",
        unit: Unit::Length,
        positive: "above the ground",
        formula: "C_y C_y'/C_z' about the centre plane y = 0",
        source: "the normal to the contact point's velocity meets the centre plane of the car",
        reads: &[Slot::SpinAxis, Slot::Centre, Slot::CentreRate, Slot::Turn],
        needs: &[Need::WheelRadius],
    };
    #[inline(always)]
    fn evaluate<T: Real>(inputs: &Inputs<T>) -> T {
        let velocity = inputs.contact_velocity();
        inputs.contact_point().y * velocity.y / velocity.z
    }
}

/// Front-view swing arm.
pub(super) struct FrontViewSwingArm;
impl Formula for FrontViewSwingArm {
    const INFO: Info = Info {
        name: "front_view_swing_arm",
        unit: Unit::Length,
        positive: "instantaneous centre inboard of the contact point",
        formula: "C_z'/w_x, horizontal distance from the contact point",
        source: "W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, SAE 1995, ch. 17",
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius],
    };
    #[inline(always)]
    fn evaluate<T: Real>(inputs: &Inputs<T>) -> T {
        inputs.contact_velocity().z / inputs.turn.x
    }
}

/// Side-view swing arm.
pub(super) struct SideViewSwingArm;
impl Formula for SideViewSwingArm {
    const INFO: Info = Info {
        name: "side_view_swing_arm",
        unit: Unit::Length,
        positive: "instantaneous centre behind the contact point",
        formula: "-C_z'/w_y, horizontal distance from the contact point",
        source: "W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, SAE 1995, ch. 17",
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius],
    };
    #[inline(always)]
    fn evaluate<T: Real>(inputs: &Inputs<T>) -> T {
        -(inputs.contact_velocity().z / inputs.turn.y)
    }
}
