//! Anti-dive, anti-lift and anti-squat: how much of the load transfer in braking and driving goes
//! through the arms instead of the springs.
//!
//! By virtual work: a braking force -F x at the contact point does the work -F C_x' and what the load transfer
//! N = F_total h/L adds to the wheel load does N C_z', so that the springs are left with N - F C_x'/C_z': the
//! slope of the way of C, which a side view's instantaneous centre gives too. C is a point of the carrier,
//! the wheel being locked. For drive torque that comes through shafts the force acts at the wheel centre W.
//! Primes are derivatives by wheel travel, W_z' = 1.

use super::instant_centre::CONTACT_VELOCITY;
use super::{Formula, Info, Inputs, Need, Slot, Unit};
use crate::number::Real;

const BRAKING: &[Need] = &[
    Need::WheelRadius,
    Need::Wheelbase,
    Need::CgHeight,
    Need::BrakeShareFront,
];
const SOURCE: &str =
    "W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, SAE 1995, ch. 17; by virtual work";

/// 100 share (L/h) C_x'/C_z'
#[inline(always)]
fn braking<T: Real>(inputs: &Inputs<T>, share: f64) -> T {
    let c = &inputs.constants;
    let velocity = inputs.contact_velocity();
    let forward = velocity.x / velocity.z;
    forward.scaled(100.0 * share * c.wheelbase / c.cg_height)
}

/// Front axle, outboard brakes.
pub(super) struct AntiDive;
impl Formula for AntiDive {
    const INFO: Info = Info {
        name: "anti_dive",
        unit: Unit::Percent,
        positive: "the front resists diving in braking",
        formula: "100 p_f (L/h) C_x'/C_z'",
        source: SOURCE,
        reads: CONTACT_VELOCITY,
        needs: BRAKING,
    };
    #[inline(always)]
    fn evaluate<T: Real>(inputs: &Inputs<T>) -> T {
        braking(inputs, inputs.constants.brake_share_front)
    }
}

/// Rear axle, outboard brakes.
pub(super) struct AntiLift;
impl Formula for AntiLift {
    const INFO: Info = Info {
        name: "anti_lift",
        unit: Unit::Percent,
        positive: "the rear resists lifting in braking",
        formula: "-100 (1 - p_f) (L/h) C_x'/C_z'",
        source: SOURCE,
        reads: CONTACT_VELOCITY,
        needs: BRAKING,
    };
    #[inline(always)]
    fn evaluate<T: Real>(inputs: &Inputs<T>) -> T {
        -braking(inputs, 1.0 - inputs.constants.brake_share_front)
    }
}

/// Driven rear axle, torque through shafts.
pub(super) struct AntiSquat;
impl Formula for AntiSquat {
    const INFO: Info = Info {
        name: "anti_squat",
        unit: Unit::Percent,
        positive: "the rear resists squatting under drive",
        formula: "-100 (L/h) W_x'",
        source: SOURCE,
        reads: &[Slot::CentreRate],
        needs: &[Need::Wheelbase, Need::CgHeight],
    };
    #[inline(always)]
    fn evaluate<T: Real>(inputs: &Inputs<T>) -> T {
        let c = &inputs.constants;
        (inputs.rate.centre.x / inputs.rate.centre.z).scaled(-100.0 * c.wheelbase / c.cg_height)
    }
}
