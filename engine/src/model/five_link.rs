//! Five-link: five separate rods hold the knuckle.

use super::rocker::{ANTI_ROLL_BAR, Carriers, ROCKER};
use super::topology::{
    Given, NO_LINK, SPINDLE, SPINDLE_INNER, SPRING, SPRING_UPPER, WHEEL_CENTRE, optional, required,
};
use super::{Body, Mechanism, SteeringAxis, Topology};
use crate::number::Each;

const LINKS: [(&str, &str); 5] = [
    ("upper_front_link_inner", "upper_front_link_outer"),
    ("upper_rear_link_inner", "upper_rear_link_outer"),
    ("lower_front_link_inner", "lower_front_link_outer"),
    ("lower_rear_link_inner", "lower_rear_link_outer"),
    ("toe_link_inner", "toe_link_outer"),
];

/// The five-link suspension.
pub(super) static FIVE_LINK: Topology = Topology {
    name: "five_link",
    summary: "Five-link: knuckle on two upper links, two lower links and a toe link",
    hardpoints: &[
        required("upper_front_link_inner", "upper front link at the body"),
        required("upper_front_link_outer", "upper front link at the knuckle"),
        required("upper_rear_link_inner", "upper rear link at the body"),
        required("upper_rear_link_outer", "upper rear link at the knuckle"),
        required("lower_front_link_inner", "lower front link at the body"),
        required("lower_front_link_outer", "lower front link at the knuckle"),
        required("lower_rear_link_inner", "lower rear link at the body"),
        required("lower_rear_link_outer", "lower rear link at the knuckle"),
        required(
            "toe_link_inner",
            "toe link at the rack; at the body if the axle is not steered",
        ),
        required("toe_link_outer", "toe link at the knuckle"),
        WHEEL_CENTRE,
        SPINDLE_INNER,
        SPRING_UPPER,
        optional(
            "spring_lower",
            "lower end of spring and damper, on the knuckle or the rocker",
        ),
    ],
    groups: &[&SPRING, &ROCKER, &ANTI_ROLL_BAR],
    distinct: &[
        ("upper_front_link_inner", "upper_front_link_outer", NO_LINK),
        ("upper_rear_link_inner", "upper_rear_link_outer", NO_LINK),
        ("lower_front_link_inner", "lower_front_link_outer", NO_LINK),
        ("lower_rear_link_inner", "lower_rear_link_outer", NO_LINK),
        ("toe_link_inner", "toe_link_outer", NO_LINK),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/five_link.toml"),
};

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let given = Given::of(
        topology,
        given,
        Carriers::all(Body::Knuckle),
        |name| match name {
            "toe_link_inner" => Body::Rack,
            _ if name.ends_with("_link_inner") => Body::Chassis,
            _ => Body::Knuckle,
        },
    );
    let constraints = LINKS.each(|(inner, outer)| given.link(inner, outer));
    let bodies = [("chassis", Body::Chassis), ("knuckle", Body::Knuckle)];
    Mechanism {
        constraints: constraints.to_vec(),
        origin: given.id("lower_rear_link_outer"),
        steering_axis: Some(SteeringAxis::Instantaneous),
        ..given.mechanism(topology, &bodies)
    }
}
