//! Double wishbone: two arms, one above the other, and a tie or toe rod.

use super::rocker::{ANTI_ROLL_BAR, Carriers, ROCKER};
use super::topology::{
    CANNOT_STEER, Given, LOWER_ARM_AXIS, LOWER_ARM_FRONT, LOWER_ARM_REAR, NO_LOWER_ARM, NO_TIE_ROD,
    SPINDLE, SPINDLE_INNER, SPRING, SPRING_ON_LOWER_ARM, SPRING_UPPER, STEERING_AXIS, WHEEL_CENTRE,
    required,
};
use super::{ArmId, Body, ClosedForm, Mechanism, SteeringAxis, Topology};

const NO_UPPER_ARM: &str = "the upper arm would have no length";

/// The double wishbone.
pub(super) static DOUBLE_WISHBONE: Topology = Topology {
    name: "double_wishbone",
    summary: "Double wishbone: upper arm, lower arm, tie rod or toe rod",
    hardpoints: &[
        required(
            "upper_arm_front",
            "front pivot of the upper arm on the body",
        ),
        required("upper_arm_rear", "rear pivot of the upper arm on the body"),
        required("upper_ball_joint", "joint of upper arm and knuckle"),
        LOWER_ARM_FRONT,
        LOWER_ARM_REAR,
        required("lower_ball_joint", "joint of lower arm and knuckle"),
        required(
            "tie_rod_inner",
            "joint of tie rod and rack; if the axle is not steered, joint of toe rod and body",
        ),
        required("tie_rod_outer", "joint of tie rod and knuckle"),
        WHEEL_CENTRE,
        SPINDLE_INNER,
        SPRING_UPPER,
        SPRING_ON_LOWER_ARM,
    ],
    groups: &[&SPRING, &ROCKER, &ANTI_ROLL_BAR],
    distinct: &[
        (
            "upper_arm_front",
            "upper_arm_rear",
            "they define the axis of the upper arm",
        ),
        ("upper_ball_joint", "upper_arm_front", NO_UPPER_ARM),
        ("upper_ball_joint", "upper_arm_rear", NO_UPPER_ARM),
        ("lower_arm_front", "lower_arm_rear", LOWER_ARM_AXIS),
        ("lower_ball_joint", "lower_arm_front", NO_LOWER_ARM),
        ("lower_ball_joint", "lower_arm_rear", NO_LOWER_ARM),
        ("lower_ball_joint", "upper_ball_joint", STEERING_AXIS),
        ("tie_rod_inner", "tie_rod_outer", NO_TIE_ROD),
        ("tie_rod_outer", "lower_ball_joint", CANNOT_STEER),
        ("tie_rod_outer", "upper_ball_joint", CANNOT_STEER),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/double_wishbone.toml"),
};

const CARRIERS: Carriers = Carriers {
    pushrod: Body::Arm(ArmId(0)),
    pullrod: Body::Arm(ArmId(1)),
    drop_link: Body::Arm(ArmId(0)),
    spring: Body::Arm(ArmId(0)),
};

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let given = Given::of(topology, given, CARRIERS, |name| match name {
        "upper_arm_front" | "upper_arm_rear" | "lower_arm_front" | "lower_arm_rear" => {
            Body::Chassis
        }
        "tie_rod_inner" => Body::Rack,
        _ => Body::Knuckle,
    });
    let lower = given.arm("lower_arm", "lower_ball_joint");
    let upper = given.arm("upper_arm", "upper_ball_joint");
    let mut constraints = [lower.links(), upper.links()].concat();
    constraints.push(given.link("tie_rod_inner", "tie_rod_outer"));
    let bodies = [
        ("chassis", Body::Chassis),
        ("knuckle", Body::Knuckle),
        ("lower_arm", Body::Arm(ArmId(0))),
        ("upper_arm", Body::Arm(ArmId(1))),
    ];
    Mechanism {
        constraints,
        arms: vec![lower, upper],
        origin: lower.outer,
        steering_axis: Some(SteeringAxis::Through {
            lower: lower.outer,
            upper: upper.outer,
        }),
        closed_form: Some(ClosedForm::DoubleWishbone),
        ..given.mechanism(topology, &bodies)
    }
}
