//! Trailing arm with two lateral links: the arm is the wheel carrier. A ball joint at the body and two links hold it.

use super::rocker::{ANTI_ROLL_BAR, Carriers, ROCKER};
use super::topology::{
    Given, NO_LINK, SPINDLE, SPINDLE_INNER, SPRING, SPRING_UPPER, WHEEL_CENTRE, optional, required,
};
use super::{Body, Constraint, Mechanism, Topology};

const ON_THE_PIVOT: &str = "the link would not hold the arm";

/// The trailing arm with two lateral links.
pub(super) static TRAILING_ARM_TWO_LINKS: Topology = Topology {
    name: "trailing_arm_two_links",
    summary: "Trailing arm with two lateral links: wheel carrier on a ball joint at the body and two links",
    hardpoints: &[
        required("arm_pivot", "ball joint of the trailing arm at the body"),
        required("upper_link_inner", "upper lateral link at the body"),
        required("upper_link_outer", "upper lateral link at the arm"),
        required("lower_link_inner", "lower lateral link at the body"),
        required("lower_link_outer", "lower lateral link at the arm"),
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
        ("upper_link_inner", "upper_link_outer", NO_LINK),
        ("lower_link_inner", "lower_link_outer", NO_LINK),
        ("upper_link_outer", "arm_pivot", ON_THE_PIVOT),
        ("lower_link_outer", "arm_pivot", ON_THE_PIVOT),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/trailing_arm_two_links.toml"),
};

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let given = Given::of(
        topology,
        given,
        Carriers::all(Body::Knuckle),
        |name| match name {
            "arm_pivot" | "upper_link_inner" | "lower_link_inner" => Body::Chassis,
            _ => Body::Knuckle,
        },
    );
    let bodies = [("chassis", Body::Chassis), ("arm", Body::Knuckle)];
    Mechanism {
        constraints: vec![
            Constraint::BallJoint {
                at: given.id("arm_pivot"),
            },
            given.link("upper_link_inner", "upper_link_outer"),
            given.link("lower_link_inner", "lower_link_outer"),
        ],
        ..given.mechanism(topology, &bodies)
    }
}
