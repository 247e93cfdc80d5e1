//! Integral link: a lower arm, an upper link and a toe link. A short link between arm and knuckle prevents the knuckle from
//! rotating about the spin axis.

use super::rocker::{ANTI_ROLL_BAR, Carriers, ROCKER};
use super::topology::{
    Given, LOWER_ARM_AXIS, LOWER_ARM_FRONT, LOWER_ARM_REAR, NO_LINK, NO_LOWER_ARM, SPINDLE,
    SPINDLE_INNER, SPRING, SPRING_ON_LOWER_ARM, SPRING_UPPER, UPPER_LINK_INNER, UPPER_LINK_OUTER,
    WHEEL_CENTRE, required,
};
use super::{ArmId, Body, Mechanism, SteeringAxis, Topology};

/// The integral-link suspension.
pub(super) static INTEGRAL_LINK: Topology = Topology {
    name: "integral_link",
    summary: "Integral link: lower arm with a link to the knuckle, upper link, toe link",
    hardpoints: &[
        LOWER_ARM_FRONT,
        LOWER_ARM_REAR,
        required("lower_ball_joint", "joint of lower arm and knuckle"),
        required("integral_link_inner", "integral link at the lower arm"),
        required("integral_link_outer", "integral link at the knuckle"),
        UPPER_LINK_INNER,
        UPPER_LINK_OUTER,
        required(
            "toe_link_inner",
            "toe link at the rack; at the body if the axle is not steered",
        ),
        required("toe_link_outer", "toe link at the knuckle"),
        WHEEL_CENTRE,
        SPINDLE_INNER,
        SPRING_UPPER,
        SPRING_ON_LOWER_ARM,
    ],
    groups: &[&SPRING, &ROCKER, &ANTI_ROLL_BAR],
    distinct: &[
        ("lower_arm_front", "lower_arm_rear", LOWER_ARM_AXIS),
        ("lower_ball_joint", "lower_arm_front", NO_LOWER_ARM),
        ("lower_ball_joint", "lower_arm_rear", NO_LOWER_ARM),
        ("integral_link_inner", "integral_link_outer", NO_LINK),
        ("upper_link_inner", "upper_link_outer", NO_LINK),
        ("toe_link_inner", "toe_link_outer", NO_LINK),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/integral_link.toml"),
};

const LOWER: Body = Body::Arm(ArmId(0));

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let given = Given::of(topology, given, Carriers::all(LOWER), |name| match name {
        "lower_arm_front" | "lower_arm_rear" | "upper_link_inner" => Body::Chassis,
        "toe_link_inner" => Body::Rack,
        "integral_link_inner" => LOWER,
        _ => Body::Knuckle,
    });
    let arm = given.arm("lower_arm", "lower_ball_joint");
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
            given.link("integral_link_inner", "integral_link_outer"),
            given.link("upper_link_inner", "upper_link_outer"),
            given.link("toe_link_inner", "toe_link_outer"),
        ],
        arms: vec![arm],
        origin: arm.outer,
        steering_axis: Some(SteeringAxis::Instantaneous),
        ..given.mechanism(topology, &bodies)
    }
}
