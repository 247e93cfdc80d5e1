//! Position of the steering axis relative to the wheel.
//!
//! W is the wheel centre, C the contact point, and G the point where the steering axis meets the ground plane through C. T
//! is the heading of the wheel in the ground plane, and O the outboard direction in the ground plane, normal to T.

use super::{Inputs, Need, Slot, Unit, formulas};
use crate::number::{Real, Vector3};

const GROUND: &[Slot] = &[
    Slot::SpinAxis,
    Slot::Centre,
    Slot::SteeringPoint,
    Slot::SteeringDirection,
];

/// Vector G - C, from the contact point to the steering axis at the ground.
#[inline(always)]
fn contact_to_axis<T: Real>(inputs: &Inputs<T>) -> Vector3<T> {
    let contact = inputs.contact_point();
    inputs.now.steering_axis_at(contact.z) - contact
}

formulas! {
    /// Lateral offset of the steering axis from the contact point, at the ground.
    ScrubRadius {
        name: "scrub_radius",
        unit: Unit::Length,
        positive: "steering axis meets the ground inboard of the contact point (signed, as Adams and Lotus have it; ISO 8855 has the distance from G to C)",
        formula: "-(G - C).O",
        source: "steering-axis offset at ground of ISO 8855 (whose \"scrub radius\" is the distance |G - C|)",
        reads: GROUND,
        needs: &[Need::WheelRadius, Need::SteeringAxis],
    } = |inputs| {
        let (_, outboard) = inputs.now.heading_and_outboard();
        -contact_to_axis(inputs).dot(outboard)
    };

    /// Longitudinal offset of the steering axis from the contact point, at the ground.
    CasterTrail {
        name: "caster_trail",
        unit: Unit::Length,
        positive: "steering axis meets the ground ahead of the contact point",
        formula: "(G - C).T",
        source: "castor offset at ground of ISO 8855",
        reads: GROUND,
        needs: &[Need::WheelRadius, Need::SteeringAxis],
    } = |inputs| {
        let (heading, _) = inputs.now.heading_and_outboard();
        contact_to_axis(inputs).dot(heading)
    };

    /// Longitudinal position of the point where the steering axis meets the ground.
    SteeringAxisAtGroundLongitudinal {
        name: "steering_axis_at_ground_longitudinal",
        unit: Unit::Length,
        positive: "ahead of the study's x = 0",
        formula: "G_x",
        source: "the point to which castor offset and steering-axis offset at ground of ISO 8855 are measured",
        reads: GROUND,
        needs: &[Need::WheelRadius, Need::SteeringAxis],
    } = |inputs| inputs.now.steering_axis_at(inputs.contact_point().z).x;

    /// Lateral position of the point where the steering axis meets the ground.
    SteeringAxisAtGroundLateral {
        name: "steering_axis_at_ground_lateral",
        unit: Unit::Length,
        positive: "on the wheel's own side of the centre plane y = 0",
        formula: "G_y",
        source: "the point to which castor offset and steering-axis offset at ground of ISO 8855 are measured",
        reads: GROUND,
        needs: &[Need::WheelRadius, Need::SteeringAxis],
    } = |inputs| inputs.now.steering_axis_at(inputs.contact_point().z).y;
}

const AT_CENTRE: &[Slot] = &[Slot::Centre, Slot::SteeringPoint, Slot::SteeringDirection];

formulas! {
    /// Lateral offset of the steering axis from the wheel centre, at wheel-centre height.
    KingpinOffset {
        name: "kingpin_offset",
        unit: Unit::Length,
        positive: "steering axis inboard of the wheel centre",
        formula: "W_y - y_a, where y_a is the y coordinate of the steering axis at the height W_z",
        source: "steering-axis offset at wheel centre of ISO 8855, measured horizontally",
        reads: AT_CENTRE,
        needs: &[Need::SteeringAxis],
    } = |inputs| {
        let centre = inputs.now.centre;
        centre.y - inputs.now.steering_axis_at(centre.z).y
    };

    /// Longitudinal offset of the steering axis from the wheel centre, at wheel-centre height.
    SpindleTrail {
        name: "spindle_trail",
        unit: Unit::Length,
        positive: "steering axis ahead of the wheel centre (Lotus' hub trail has the opposite sign)",
        formula: "x_a - W_x, where x_a is the x coordinate of the steering axis at the height W_z",
        source: "castor offset at wheel centre of ISO 8855",
        reads: AT_CENTRE,
        needs: &[Need::SteeringAxis],
    } = |inputs| {
        let centre = inputs.now.centre;
        inputs.now.steering_axis_at(centre.z).x - centre.x
    };
}
