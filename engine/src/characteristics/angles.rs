//! The four angles of the wheel and of the steering axis, and toe as a length.

use super::{Need, Slot, Unit, formulas};

formulas! {
    /// Camber: angle between the wheel plane and the vertical.
    Camber {
        name: "camber",
        unit: Unit::Angle,
        positive: "top of the wheel outboard",
        formula: "-asin(a_z)",
        source: "ISO 8855 (angle between the wheel plane and the vertical, not its projection)",
        reads: &[Slot::SpinAxis],
        needs: &[],
    } = |inputs| -inputs.now.spin_axis.z.asin();

    /// Toe: angle in the ground plane between the wheel's heading and the x axis.
    Toe {
        name: "toe",
        unit: Unit::Angle,
        positive: "toe-in (front of the wheel inboard)",
        formula: "atan2(a_x, a_y)",
        source: "ISO 8855 (static toe angle)",
        reads: &[Slot::SpinAxis],
        needs: &[],
    } = |inputs| {
        let a = inputs.now.spin_axis;
        a.x.atan2(a.y)
    };

    /// Toe as workshops measure it: a length at the rim.
    ToeAtRim {
        name: "toe_at_rim",
        unit: Unit::Length,
        positive: "toe-in (front edge of the rim inboard)",
        formula: "D sin(toe), where D is rim_diameter: lateral distance from the front edge to the rear edge of the rim at the height of W",
        source: "toe as a length on alignment racks; D is the diameter at which it is measured",
        reads: &[Slot::SpinAxis],
        needs: &[Need::RimDiameter],
    } = |inputs| {
        let (heading, _) = inputs.now.heading_and_outboard();
        -heading.y.scaled(inputs.constants.rim_diameter)
    };

    /// Caster: side-view inclination of the steering axis from the vertical.
    Caster {
        name: "caster",
        unit: Unit::Angle,
        positive: "top of the steering axis rearward",
        formula: "atan2(-k_x, k_z)",
        source: "ISO 8855 (castor angle)",
        reads: &[Slot::SteeringDirection],
        needs: &[Need::SteeringAxis],
    } = |inputs| {
        let k = inputs.now.steering_direction;
        (-k.x).atan2(k.z)
    };

    /// Kingpin inclination: front-view inclination of the steering axis from the vertical.
    KingpinInclination {
        name: "kingpin_inclination",
        unit: Unit::Angle,
        positive: "top of the steering axis inboard",
        formula: "atan2(-k_y, k_z)",
        source: "ISO 8855 (steering-axis inclination angle)",
        reads: &[Slot::SteeringDirection],
        needs: &[Need::SteeringAxis],
    } = |inputs| {
        let k = inputs.now.steering_direction;
        (-k.y).atan2(k.z)
    };
}
