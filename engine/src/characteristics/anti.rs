//! Anti-dive, anti-lift and anti-squat: the share of the load transfer that the arms carry instead of the springs.
//!
//! The formulas follow from virtual work. A longitudinal force F acts on the tyre at the contact point C, and the wheel load
//! changes by the load transfer N = F_total h/L. F_total is the longitudinal force on the whole car, h the height of the
//! centre of gravity, and L the wheelbase. The torque of F about the spin axis a has one of two paths:
//!
//! - The carrier takes it (outboard brakes, hub motors, live axles). The wheel moves as if locked to the carrier.
//! - A shaft from the body takes it (inboard brakes, drive shafts). The wheel rotates about a in its carrier, so that it
//!   does not rotate about a in the car.
//!
//! The point of the wheel at C then moves with
//!
//! ```text
//! by the carrier:  C' = W' + w x (C - W)
//! by a shaft:      S' = W' + (w - (w.a) a) x (C - W)                                    (1)
//! ```
//!
//! W' and w are the velocity of the wheel centre and the angular velocity of the carrier, with respect to the drive. (The
//! shaft is assumed to lie along a. The effect of angles in its joints is neglected.) With V = C' or S', the springs carry
//! the following upward force on the wheel:
//!
//! ```text
//! front, braking:  N - p F_total V_x/V_z      rear, braking:  -N - p F_total V_x/V_z
//! front, drive:   -N + d F_total V_x/V_z      rear, drive:     N + d F_total V_x/V_z     (2)
//! ```
//!
//! p and d are the axle's shares of the braking force and of the drive force. For V = C', V_x/V_z is also the slope of
//! the line to the instantaneous centre in side view: its rise per length towards the rear. The percentage is the part
//! of the load transfer N that, by equation (2), the springs do not carry.

use super::instant_centre::CONTACT_VELOCITY;
use super::{Inputs, Need, Unit, formulas};
use crate::number::Real;

const SOURCE: &str =
    "W. F. Milliken, D. L. Milliken, Race Car Vehicle Dynamics, SAE 1995, ch. 17; by virtual work";

/// Returns 100 `share` (L/h) V_x/V_z, in percent, with the symbols of this module. `share` is the axle's share p or d of the force.
/// `by_carrier` is the fraction of the torque that the carrier takes.
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
    /// Anti-dive of a front axle in braking.
    AntiDive {
        name: "anti_dive",
        unit: Unit::Percent,
        positive: "the front resists diving in braking",
        formula: "100 p (L/h) B_x'/B_z'",
        source: SOURCE,
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius, Need::Wheelbase, Need::CgHeight, Need::FrontBraking],
    } = |inputs| braking(inputs);

    /// Anti-lift of a rear axle in braking, or of a driven front axle under drive.
    AntiLift {
        name: "anti_lift",
        unit: Unit::Percent,
        positive: "the rear resists lifting in braking, or a driven front axle resists lifting under drive",
        formula: "-100 p (L/h) B_x'/B_z' at the rear, 100 d (L/h) D_x'/D_z' in front",
        source: SOURCE,
        reads: CONTACT_VELOCITY,
        needs: &[Need::WheelRadius, Need::Wheelbase, Need::CgHeight, Need::RearBrakingOrFrontDrive],
    } = |inputs| {
        if inputs.constants.is_front { driving(inputs) } else { -braking(inputs) }
    };

    /// Anti-squat of a driven rear axle under drive.
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
