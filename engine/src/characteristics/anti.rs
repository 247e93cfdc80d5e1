//! Anti-dive, anti-lift and anti-squat: how much of the load transfer in braking and driving goes
//! through the arms instead of the springs.
//!
//! By virtual work. A longitudinal force F acts on the tyre at the contact point C, and the wheel load changes by
//! the load transfer N = F_total h/L. The torque of F about the spin axis a is taken either by the carrier
//! (outboard brakes, hub motors, live axles), and the wheel moves as if locked to it; or by a shaft from the body
//! (inboard brakes, drive shafts), and the wheel turns about a in its carrier so that it does not turn about a in
//! the car. The point of the wheel at C then moves with
//!
//! ```text
//! by the carrier:  C' = W' + w x (C - W)
//! by a shaft:      S' = W' + (w - (w.a) a) x (C - W)                                    (1)
//! ```
//!
//! where W' and w are the velocity of the wheel centre and the angular velocity of the carrier by wheel travel.
//! (The shaft is taken to lead along a: what its joints add where it does not is left out.) With V either of
//! them, the springs are left with
//!
//! ```text
//! front, braking:  N - p F_total V_x/V_z      rear, braking:  -N - p F_total V_x/V_z
//! front, drive:   -N + d F_total V_x/V_z      rear, drive:     N + d F_total V_x/V_z     (2)
//! ```
//!
//! upward on the wheel, p and d being the axle's shares of the braking and of the drive force; V_x/V_z is the slope
//! that a side view's instantaneous centre gives too. The percentages are what (2) is short of its load transfer.

use super::instant_centre::CONTACT_VELOCITY;
use super::{Inputs, Need, Unit, formulas};
use crate::number::Real;

const SOURCE: &str =
    "W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, SAE 1995, ch. 17; by virtual work";

/// 100 share (L/h) V_x/V_z, the torque taken by the carrier to this part.
#[inline(always)]
fn slope<T: Real>(inputs: &Inputs<T>, share: f64, by_carrier: f64) -> T {
    let c = &inputs.constants;
    let velocity = inputs.tyre_velocity(by_carrier);
    let forward = velocity.x / velocity.z;
    forward.scaled(100.0 * share * c.wheelbase / c.cg_height)
}

#[inline(always)]
fn braking<T: Real>(inputs: &Inputs<T>) -> T {
    let c = &inputs.constants;
    slope(inputs, c.brake_share, c.brake_torque_by_carrier)
}

#[inline(always)]
fn driving<T: Real>(inputs: &Inputs<T>) -> T {
    let c = &inputs.constants;
    slope(inputs, c.drive_share, c.drive_torque_by_carrier)
}

formulas! {
    /// Front axle in braking.
    AntiDive {
        name: "anti_dive",
        unit: Unit::Percent,
        positive: "the front resists diving in braking",
        formula: "100 p (L/h) B_x'/B_z'",
        source: SOURCE,
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius, Need::Wheelbase, Need::CgHeight, Need::FrontBraking],
    } = |inputs| braking(inputs);

    /// Rear axle in braking, or driven front axle under drive.
    AntiLift {
        name: "anti_lift",
        unit: Unit::Percent,
        positive: "the rear resists lifting in braking, or a driven front under drive",
        formula: "-100 p (L/h) B_x'/B_z' at the rear, 100 d (L/h) D_x'/D_z' in front",
        source: SOURCE,
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius, Need::Wheelbase, Need::CgHeight, Need::RearBrakingOrFrontDrive],
    } = |inputs| {
        match inputs.constants.is_front {
            true => driving(inputs),
            false => -braking(inputs),
        }
    };

    /// Driven rear axle under drive.
    AntiSquat {
        name: "anti_squat",
        unit: Unit::Percent,
        positive: "the rear resists squatting under drive",
        formula: "-100 d (L/h) D_x'/D_z'",
        source: SOURCE,
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius, Need::Wheelbase, Need::CgHeight, Need::RearDrive],
    } = |inputs| -driving(inputs);
}
