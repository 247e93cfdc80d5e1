//! H-arm: a lower arm with two joints at the body and two at the knuckle, and an upper link. The knuckle rotates about the
//! line through its two joints.

use super::rocker::{ANTI_ROLL_BAR, Carriers, ROCKER};
use super::topology::{
    Given, LOWER_ARM_AXIS, LOWER_ARM_FRONT, LOWER_ARM_REAR, NO_LINK, NO_LOWER_ARM, SPINDLE,
    SPINDLE_INNER, SPRING, SPRING_ON_LOWER_ARM, SPRING_UPPER, UPPER_LINK_INNER, UPPER_LINK_OUTER,
    WHEEL_CENTRE, required,
};
use super::{ArmId, Body, Constraint, Mechanism, Topology};

/// The H-arm suspension.
pub(super) static H_ARM: Topology = Topology {
    name: "h_arm",
    summary: "H-arm: lower arm hinged at body and knuckle, upper link; not steered",
    hardpoints: &[
        LOWER_ARM_FRONT,
        LOWER_ARM_REAR,
        required("lower_joint_front", "front joint of lower arm and knuckle"),
        required("lower_joint_rear", "rear joint of lower arm and knuckle"),
        UPPER_LINK_INNER,
        UPPER_LINK_OUTER,
        WHEEL_CENTRE,
        SPINDLE_INNER,
        SPRING_UPPER,
        SPRING_ON_LOWER_ARM,
    ],
    groups: &[&SPRING, &ROCKER, &ANTI_ROLL_BAR],
    distinct: &[
        ("lower_arm_front", "lower_arm_rear", LOWER_ARM_AXIS),
        ("lower_joint_front", "lower_arm_front", NO_LOWER_ARM),
        ("lower_joint_front", "lower_arm_rear", NO_LOWER_ARM),
        (
            "lower_joint_front",
            "lower_joint_rear",
            "they define the axis about which the knuckle turns on the arm",
        ),
        ("upper_link_inner", "upper_link_outer", NO_LINK),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/h_arm.toml"),
};

const LOWER: Body = Body::Arm(ArmId(0));

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let given = Given::of(topology, given, Carriers::all(LOWER), |name| match name {
        "lower_arm_front" | "lower_arm_rear" | "upper_link_inner" => Body::Chassis,
        _ => Body::Knuckle,
    });
    let arm = given.arm("lower_arm", "lower_joint_front");
    let [front, rear] = arm.links();
    let bodies = [
        ("chassis", Body::Chassis),
        ("knuckle", Body::Knuckle),
        ("lower_arm", LOWER),
    ];
    Mechanism {
        constraints: vec![
            front,
            rear,
            Constraint::ArmJoint {
                arm: ArmId(0),
                at: given.id("lower_joint_rear"),
            },
            given.link("upper_link_inner", "upper_link_outer"),
        ],
        arms: vec![arm],
        origin: arm.outer,
        ..given.mechanism(topology, &bodies)
    }
}
