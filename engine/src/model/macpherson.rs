//! MacPherson strut: one lower arm, a strut fixed to the knuckle, a tie rod.

use super::rocker::{ANTI_ROLL_BAR, Carriers};
use super::topology::{
    CANNOT_STEER, Given, LOWER_ARM_AXIS, LOWER_ARM_FRONT, LOWER_ARM_REAR, NO_LOWER_ARM, NO_TIE_ROD,
    SPINDLE, SPINDLE_INNER, STEERING_AXIS, WHEEL_CENTRE, optional, required,
};
use super::{ArmId, Body, ClosedForm, Constraint, Mechanism, Spring, SteeringAxis, Topology};

/// The MacPherson strut.
pub(super) static MACPHERSON: Topology = Topology {
    name: "macpherson",
    summary: "MacPherson strut: lower arm, strut clamped in the knuckle, tie rod",
    hardpoints: &[
        LOWER_ARM_FRONT,
        LOWER_ARM_REAR,
        required("lower_ball_joint", "joint of lower arm and knuckle"),
        required("strut_top", "upper strut mount on the body"),
        required("strut_lower", "a point of the strut axis on the knuckle"),
        optional(
            "strut_upper",
            "a second point of the strut axis on the knuckle; without it the axis runs from strut_lower to strut_top",
        ),
        required("tie_rod_inner", "joint of tie rod and rack"),
        required("tie_rod_outer", "joint of tie rod and knuckle"),
        WHEEL_CENTRE,
        SPINDLE_INNER,
    ],
    groups: &[&ANTI_ROLL_BAR],
    distinct: &[
        ("lower_arm_front", "lower_arm_rear", LOWER_ARM_AXIS),
        ("lower_ball_joint", "lower_arm_front", NO_LOWER_ARM),
        ("lower_ball_joint", "lower_arm_rear", NO_LOWER_ARM),
        ("lower_ball_joint", "strut_top", STEERING_AXIS),
        ("strut_lower", "strut_upper", "they define the strut axis"),
        ("strut_lower", "strut_top", "the strut would have no length"),
        ("tie_rod_inner", "tie_rod_outer", NO_TIE_ROD),
        ("tie_rod_outer", "lower_ball_joint", CANNOT_STEER),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/macpherson.toml"),
};

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let given = Given::of(
        topology,
        given,
        Carriers::all(Body::Knuckle),
        |name| match name {
            "lower_arm_front" | "lower_arm_rear" | "strut_top" => Body::Chassis,
            "tie_rod_inner" => Body::Rack,
            _ => Body::Knuckle,
        },
    );
    let id = |name: &str| given.id(name);
    let arm = given.arm("lower_arm", "lower_ball_joint");
    let [front, rear] = arm.links();
    let bodies = [
        ("chassis", Body::Chassis),
        ("knuckle", Body::Knuckle),
        ("lower_arm", Body::Arm(ArmId(0))),
        ("strut_rod", Body::StrutRod(id("strut_top"))),
    ];
    Mechanism {
        constraints: vec![
            front,
            rear,
            Constraint::StrutLine {
                top: id("strut_top"),
                lower: id("strut_lower"),
                upper: given.find("strut_upper"),
            },
            given.link("tie_rod_inner", "tie_rod_outer"),
        ],
        arms: vec![arm],
        origin: arm.outer,
        steering_axis: Some(SteeringAxis::Through {
            lower: arm.outer,
            upper: id("strut_top"),
        }),
        spring: Some(Spring {
            upper: id("strut_top"),
            lower: id("strut_lower"),
        }),
        closed_form: Some(ClosedForm::Strut),
        ..given.mechanism(topology, &bodies)
    }
}
