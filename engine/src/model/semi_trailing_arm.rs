//! Semi-trailing arm: the wheel carrier is one arm on a hinge. With the hinge axis along y it is a trailing arm, with the
//! axis along x it is a swing axle.

use super::rocker::{ANTI_ROLL_BAR, Carriers, ROCKER};
use super::topology::{
    Given, SPINDLE, SPINDLE_INNER, SPRING, SPRING_UPPER, WHEEL_CENTRE, optional, required,
};
use super::{Arm, Body, Constraint, Mechanism, Topology};

/// The semi-trailing arm.
pub(super) static SEMI_TRAILING_ARM: Topology = Topology {
    name: "semi_trailing_arm",
    summary: "Semi-trailing arm: wheel carrier on one hinge; a trailing arm if the hinge axis is transverse",
    hardpoints: &[
        required("arm_pivot_inner", "inboard pivot of the arm on the body"),
        required("arm_pivot_outer", "outboard pivot of the arm on the body"),
        WHEEL_CENTRE,
        SPINDLE_INNER,
        SPRING_UPPER,
        optional(
            "spring_lower",
            "lower end of spring and damper, on the arm or the rocker",
        ),
    ],
    groups: &[&SPRING, &ROCKER, &ANTI_ROLL_BAR],
    distinct: &[
        (
            "arm_pivot_inner",
            "arm_pivot_outer",
            "they define the axis of the arm",
        ),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/semi_trailing_arm.toml"),
};

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let given = Given::of(
        topology,
        given,
        Carriers::all(Body::Knuckle),
        |name| match name {
            "arm_pivot_inner" | "arm_pivot_outer" => Body::Chassis,
            _ => Body::Knuckle,
        },
    );
    let (first, second) = (given.id("arm_pivot_inner"), given.id("arm_pivot_outer"));
    let bodies = [("chassis", Body::Chassis), ("arm", Body::Knuckle)];
    Mechanism {
        constraints: vec![Constraint::Revolute { first, second }],
        arms: vec![Arm {
            front: second,
            rear: first,
            outer: given.id("wheel_centre"),
        }],
        ..given.mechanism(topology, &bodies)
    }
}
