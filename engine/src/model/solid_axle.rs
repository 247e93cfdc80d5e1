//! Solid axle: one body carries both wheels, on four links, or on three links and a Panhard rod or a Watt linkage.
//!
//! The wheels may be steered (see `steered_axle.rs`). A study gives the left half, which is mirrored. Points of the Panhard
//! rod, of the Watt linkage, of the drag link, and of a single upper link are not mirrored: the study gives the actual y.

use super::rigid_axle::{AxleTravel, RigidAxle};
use super::rocker::{ANTI_ROLL_BAR, Carriers};
use super::steered_axle::{self, STEERING};
use super::topology::{
    Given, Group, NO_LINK, SPINDLE, SPINDLE_INNER, SPRING, SPRING_UPPER, WHEEL_CENTRE, optional,
    required,
};
use super::{Body, Constraint, Mechanism, RockerId, Topology};

/// Panhard rod. A study gives both ends or neither.
static PANHARD: Group = Group {
    what: "the Panhard rod",
    hardpoints: &[
        optional(
            "panhard_chassis",
            "Panhard rod at the body; actual y (not mirrored)",
        ),
        optional(
            "panhard_axle",
            "Panhard rod at the axle; actual y (not mirrored)",
        ),
    ],
    complete: &[&["panhard_chassis", "panhard_axle"]],
    beside: &[],
    distinct: &[("panhard_chassis", "panhard_axle", NO_LINK)],
};

/// Watt linkage: a rocker on the axle with two links to the body, or a rocker on the body with two links to the axle.
static WATT: Group = Group {
    what: "the Watt linkage",
    beside: &[],
    hardpoints: &[
        optional(
            "watt_pivot",
            "pivot of the Watt rocker; actual y (not mirrored)",
        ),
        optional(
            "watt_axis",
            "a second point of the rocker's axis; actual y (not mirrored)",
        ),
        optional(
            "watt_upper_chassis",
            "upper Watt link at the body; actual y (not mirrored)",
        ),
        optional(
            "watt_upper_axle",
            "upper Watt link at the axle; actual y (not mirrored)",
        ),
        optional(
            "watt_upper_rocker",
            "upper Watt link at the rocker; actual y (not mirrored)",
        ),
        optional(
            "watt_lower_chassis",
            "lower Watt link at the body; actual y (not mirrored)",
        ),
        optional(
            "watt_lower_axle",
            "lower Watt link at the axle; actual y (not mirrored)",
        ),
        optional(
            "watt_lower_rocker",
            "lower Watt link at the rocker; actual y (not mirrored)",
        ),
    ],
    complete: &[
        &[
            "watt_pivot",
            "watt_axis",
            "watt_upper_chassis",
            "watt_upper_rocker",
            "watt_lower_chassis",
            "watt_lower_rocker",
        ],
        &[
            "watt_pivot",
            "watt_axis",
            "watt_upper_axle",
            "watt_upper_rocker",
            "watt_lower_axle",
            "watt_lower_rocker",
        ],
    ],
    distinct: &[
        (
            "watt_pivot",
            "watt_axis",
            "they define the axis of the Watt rocker",
        ),
        ("watt_upper_chassis", "watt_upper_rocker", NO_LINK),
        ("watt_upper_axle", "watt_upper_rocker", NO_LINK),
        ("watt_lower_chassis", "watt_lower_rocker", NO_LINK),
        ("watt_lower_axle", "watt_lower_rocker", NO_LINK),
    ],
};

/// Topology of the solid axle.
pub(super) static SOLID_AXLE: Topology = Topology {
    name: "solid_axle",
    summary: "Solid axle: one body with both wheels on four links, or on three and a Panhard rod or Watt linkage",
    hardpoints: &[
        required("lower_link_chassis", "lower link at the body"),
        required("lower_link_axle", "lower link at the axle"),
        required(
            "upper_link_chassis",
            "upper link at the body; actual y (not mirrored) if it is single",
        ),
        required(
            "upper_link_axle",
            "upper link at the axle; actual y (not mirrored) if it is single",
        ),
        WHEEL_CENTRE,
        SPINDLE_INNER,
        SPRING_UPPER,
        optional(
            "spring_lower",
            "lower end of spring and damper, on the axle",
        ),
    ],
    groups: &[&SPRING, &PANHARD, &WATT, &ANTI_ROLL_BAR, &STEERING],
    distinct: &[
        ("lower_link_chassis", "lower_link_axle", NO_LINK),
        ("upper_link_chassis", "upper_link_axle", NO_LINK),
        SPINDLE,
    ],
    build,
    template: include_str!("../../templates/solid_axle.toml"),
};

/// Part that holds the axle laterally.
#[derive(Clone, Copy)]
enum Lateral {
    /// Two splayed upper links.
    UpperLinks,
    Panhard,
    WattOnAxle,
    WattOnChassis,
}

impl Lateral {
    fn of(given: &Given) -> Lateral {
        let has = |name| given.find(name).is_some();
        if has("panhard_axle") {
            Lateral::Panhard
        } else if has("watt_upper_axle") {
            Lateral::WattOnChassis
        } else if has("watt_upper_chassis") {
            Lateral::WattOnAxle
        } else {
            Lateral::UpperLinks
        }
    }
}

fn build(topology: &'static Topology, given: &[&'static str]) -> Mechanism {
    let has = |name: &str| given.contains(&name);
    let watt_rocker = RockerId(usize::from(has("drop_link_outer")));
    let is_steered = has("drag_link_body");
    let left_knuckle = RockerId(watt_rocker.0 + usize::from(has("watt_pivot")));
    let is_watt_on_chassis = given.contains(&"watt_upper_axle");
    let mut given = Given::of(
        topology,
        given,
        Carriers::all(Body::Knuckle),
        |name| match name {
            "watt_upper_rocker" | "watt_lower_rocker" => Body::Rocker(watt_rocker),
            "watt_pivot" | "watt_axis" if is_watt_on_chassis => Body::Chassis,
            _ if name.ends_with("_chassis") => Body::Chassis,
            _ if is_steered => steered_axle::body(name, left_knuckle).unwrap_or(Body::Knuckle),
            _ => Body::Knuckle,
        },
    );
    let lateral = Lateral::of(&given);
    let is_single = |name: &str| match lateral {
        _ if name.starts_with("drag_link_") => true,
        Lateral::UpperLinks => false,
        Lateral::Panhard | Lateral::WattOnAxle | Lateral::WattOnChassis => {
            ["panhard_", "watt_", "upper_link_"]
                .iter()
                .any(|of| name.starts_with(of))
        }
    };
    // Each wheel moves its own lever of the anti-roll bar. So a far point of a lever is not on the left wheel's rocker. It
    // counts as a point of the chassis.
    let far_body = |_, body| match body {
        Body::Rocker(id) if is_steered && id == left_knuckle => Body::Rocker(RockerId(id.0 + 1)),
        Body::Rocker(_) => Body::Chassis,
        body => body,
    };
    let (singles, pairs) = given.add_far_half(is_single, far_body);
    let steering = is_steered.then(|| steered_axle::add(&mut given, left_knuckle));
    let id = |name: &str| given.id(name);
    let link = |chassis: &str, axle: &str| given.link(chassis, axle);
    let mut constraints = vec![
        link("lower_link_chassis", "lower_link_axle"),
        link("right_lower_link_chassis", "right_lower_link_axle"),
        link("upper_link_chassis", "upper_link_axle"),
    ];
    constraints.push(match lateral {
        Lateral::UpperLinks => link("right_upper_link_chassis", "right_upper_link_axle"),
        Lateral::Panhard => link("panhard_chassis", "panhard_axle"),
        Lateral::WattOnAxle => link("watt_lower_chassis", "watt_lower_rocker"),
        Lateral::WattOnChassis => link("watt_lower_rocker", "watt_lower_axle"),
    });
    let (near_centre, far_centre) = (id("wheel_centre"), id("right_wheel_centre"));
    let held = AxleTravel::Mean;
    constraints.push(Constraint::AxleTravel {
        near: near_centre,
        far: far_centre,
        held,
    });
    let bodies = [("chassis", Body::Chassis), ("axle", Body::Knuckle)];
    let mut mechanism = Mechanism {
        constraints,
        rigid_axle: Some(RigidAxle {
            pairs,
            singles,
            extra_links: Vec::new(),
            far_centre,
            held,
            twist_beam: None,
            steering: None,
        }),
        ..given.mechanism(topology, &bodies)
    };
    if let Some(steering) = steering {
        steered_axle::steer(&mut mechanism, steering);
    }
    mechanism
}
