//! Catalogue of topologies.

use super::rocker::{self, Carriers};
use super::{
    Arm, Body, Constraint, Mechanism, Point, PointId, SpinAxis, Spring, double_wishbone, five_link,
    h_arm, integral_link, macpherson, semi_trailing_arm, solid_axle, trailing_arm_two_links,
    twist_beam,
};
use crate::number::Vector3;

/// Hardpoint of a topology.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hardpoint {
    /// Name of the hardpoint in studies.
    pub name: &'static str,
    /// Description of the hardpoint, for messages and templates.
    pub about: &'static str,
    /// True if a study must give the hardpoint.
    pub required: bool,
}

/// A hardpoint that every study gives.
pub(super) const fn required(name: &'static str, about: &'static str) -> Hardpoint {
    Hardpoint {
        name,
        about,
        required: true,
    }
}

/// A hardpoint that a study may leave out.
pub(super) const fn optional(name: &'static str, about: &'static str) -> Hardpoint {
    Hardpoint {
        name,
        about,
        required: false,
    }
}

/// Centre of the wheel. Every topology has this hardpoint.
pub(super) const WHEEL_CENTRE: Hardpoint =
    required("wheel_centre", "centre of the wheel on its spin axis");

/// Second point of the spin axis. Every topology has this hardpoint.
pub(super) const SPINDLE_INNER: Hardpoint = optional(
    "spindle_inner",
    "a point of the spin axis inboard of the wheel; without it [wheel] gives static_camber and static_toe",
);

/// Upper end of spring and damper, for topologies in which it is optional.
pub(super) const SPRING_UPPER: Hardpoint = optional(
    "spring_upper",
    "upper end of spring and damper, on the body",
);

/// Lower end of spring and damper, for topologies whose lower arm carries it.
pub(super) const SPRING_ON_LOWER_ARM: Hardpoint = optional(
    "spring_lower",
    "lower end of spring and damper, on the lower arm or the rocker",
);

/// Front pivot of a lower arm.
pub(super) const LOWER_ARM_FRONT: Hardpoint = required(
    "lower_arm_front",
    "front pivot of the lower arm on the body",
);
pub(super) const LOWER_ARM_REAR: Hardpoint =
    required("lower_arm_rear", "rear pivot of the lower arm on the body");

/// Inner end of an upper link.
pub(super) const UPPER_LINK_INNER: Hardpoint =
    required("upper_link_inner", "upper link at the body");
pub(super) const UPPER_LINK_OUTER: Hardpoint =
    required("upper_link_outer", "upper link at the knuckle");

/// Spring and damper. A study gives both ends or none.
pub(super) static SPRING: Group = Group {
    what: "the spring",
    hardpoints: &[],
    complete: &[&["spring_upper", "spring_lower"]],
    beside: &[],
    distinct: &[(
        "spring_upper",
        "spring_lower",
        "the spring would have no length",
    )],
};

/// Two points of the spin axis that must be distinct, and the reason.
pub(super) const SPINDLE: (&str, &str, &str) = (
    "wheel_centre",
    "spindle_inner",
    "they define the spin axis of the wheel",
);

// Reasons why points of arms and tie rods must be distinct.
pub(super) const LOWER_ARM_AXIS: &str = "they define the axis of the lower arm";
pub(super) const NO_LOWER_ARM: &str = "the lower arm would have no length";
pub(super) const NO_LINK: &str = "the link would have no length";
pub(super) const STEERING_AXIS: &str = "they define the steering axis";
pub(super) const NO_TIE_ROD: &str = "the tie rod would have no length";
pub(super) const CANNOT_STEER: &str = "the tie rod could not steer the wheel";

/// Hardpoints that a study gives together.
pub struct Group {
    /// Name of the part that the hardpoints of the group form, such as "the rocker".
    pub what: &'static str,
    /// Hardpoints that a topology with this group has in addition to its own.
    pub hardpoints: &'static [Hardpoint],
    /// Alternative lists of names. A study gives every name of one list, or no name of any list.
    pub complete: &'static [&'static [&'static str]],
    /// Further names that a study may give, but only together with a complete list.
    pub beside: &'static [&'static str],
    /// Pairs of hardpoints that must not coincide, each with the reason.
    pub distinct: &'static [(&'static str, &'static str, &'static str)],
}

/// Hardpoints of a study, each with its body, from which a mechanism is built.
pub(super) struct Given(pub Vec<Point>);

impl Given {
    /// Given hardpoints of a topology, in the topology's order. Hardpoints of spring and rockers are on their `carriers`,
    /// the other hardpoints on the body that `body` returns.
    pub(super) fn of(
        topology: &Topology,
        given: &[&'static str],
        carriers: Carriers,
        body: impl Fn(&str) -> Body,
    ) -> Self {
        let named = topology
            .all_hardpoints()
            .filter(|h| given.contains(&h.name));
        Given(
            named
                .map(|h| Point {
                    name: h.name.to_owned(),
                    body: carriers.body(h.name, given).unwrap_or_else(|| body(h.name)),
                })
                .collect(),
        )
    }

    /// Point with this name, if it is given.
    pub(super) fn find(&self, name: &str) -> Option<PointId> {
        self.0.iter().position(|p| p.name == name).map(PointId)
    }

    /// Adds the points of the far half of an axle (the half of the other wheel). The name of a far point is the name of its
    /// near point with `right_` before it. `far_body` returns the body of a far point, given the near point and the body of the
    /// near point. Returns the points that both halves share, and the pairs.
    pub(super) fn add_far_half(
        &mut self,
        is_single: impl Fn(&str) -> bool,
        far_body: impl Fn(PointId, Body) -> Body,
    ) -> (Vec<PointId>, Vec<[PointId; 2]>) {
        let given = (0..self.0.len()).map(PointId);
        let (singles, near): (Vec<_>, Vec<_>) = given.partition(|id| is_single(&self.0[id.0].name));
        let mut pairs = Vec::with_capacity(near.len());
        for id in near {
            let Point { name, body } = &self.0[id.0];
            let far = Point {
                name: format!("right_{name}"),
                body: far_body(id, *body),
            };
            pairs.push([id, PointId(self.0.len())]);
            self.0.push(far);
        }
        (singles, pairs)
    }

    /// Returns the point with this name. Panics if the study lacks it, so `name` must be a required hardpoint.
    pub(super) fn id(&self, name: &str) -> PointId {
        self.find(name).expect("a required hardpoint is given")
    }

    /// Rod between two required points.
    pub(super) fn link(&self, inner: &str, outer: &str) -> Constraint {
        Constraint::Link {
            inner: self.id(inner),
            outer: self.id(outer),
        }
    }

    /// Arm with the pivots `NAME_front` and `NAME_rear`, where NAME is `arm`, and with the joint `outer` to the knuckle.
    pub(super) fn arm(&self, arm: &str, outer: &str) -> Arm {
        Arm {
            front: self.id(&format!("{arm}_front")),
            rear: self.id(&format!("{arm}_rear")),
            outer: self.id(outer),
        }
    }

    /// Returns a mechanism with the parts that all topologies share: wheel, spring and rockers. Its bodies are `bodies`
    /// and the rockers. No constraint holds the knuckle yet. The knuckle's origin is the wheel centre.
    pub(super) fn mechanism(
        self,
        topology: &'static Topology,
        bodies: &[(&'static str, Body)],
    ) -> Mechanism {
        let rockers = rocker::rockers(|name| self.find(name));
        let wheel_centre = self.id("wheel_centre");
        let ends = self.find("spring_upper").zip(self.find("spring_lower"));
        // Without `spindle_inner` the spin axis points straight outboard, until the study gives camber and toe.
        let outboard = SpinAxis::Along(Vector3::new(0.0, 1.0, 0.0));
        Mechanism {
            topology,
            bodies: bodies
                .iter()
                .copied()
                .chain(rocker::bodies(&rockers))
                .collect(),
            unsaid_seats: Vec::new(),
            constraints: Vec::new(),
            arms: Vec::new(),
            rockers,
            origin: wheel_centre,
            wheel_centre,
            spin_axis: self.find("spindle_inner").map_or(outboard, SpinAxis::From),
            parallel_axes: Vec::new(),
            steering_axis: None,
            spring: ends.map(|(upper, lower)| Spring { upper, lower }),
            closed_form: None,
            rigid_axle: None,
            points: self.0,
        }
    }
}

/// A kind of suspension.
pub struct Topology {
    /// Name of the topology in studies.
    pub name: &'static str,
    /// Description of the topology in one line.
    pub summary: &'static str,
    /// Hardpoints, in the order of printing.
    pub hardpoints: &'static [Hardpoint],
    /// Optional groups of hardpoints. A study gives the hardpoints of a group together.
    pub groups: &'static [&'static Group],
    /// Pairs of hardpoints that must not coincide, each with the reason.
    pub distinct: &'static [(&'static str, &'static str, &'static str)],
    /// Builds the mechanism from the hardpoints of a study, which include all required ones.
    pub build: fn(&'static Topology, &[&'static str]) -> Mechanism,
    /// A commented study that runs without changes.
    pub template: &'static str,
}

impl Topology {
    /// All topologies.
    pub const ALL: &'static [&'static Topology] = &[
        &macpherson::MACPHERSON,
        &double_wishbone::DOUBLE_WISHBONE,
        &five_link::FIVE_LINK,
        &semi_trailing_arm::SEMI_TRAILING_ARM,
        &trailing_arm_two_links::TRAILING_ARM_TWO_LINKS,
        &integral_link::INTEGRAL_LINK,
        &h_arm::H_ARM,
        &solid_axle::SOLID_AXLE,
        &twist_beam::TWIST_BEAM,
    ];

    /// Returns true for a solid axle or a twist beam, which carry both wheels.
    pub fn carries_both_wheels(&self) -> bool {
        self.name == solid_axle::SOLID_AXLE.name || self.is_twist_beam()
    }

    /// Returns true for the twist beam.
    pub fn is_twist_beam(&self) -> bool {
        self.name == twist_beam::TWIST_BEAM.name
    }

    /// The topology's own hardpoints, then the hardpoints of its groups.
    pub fn all_hardpoints(&self) -> impl Iterator<Item = &'static Hardpoint> {
        let further = self.groups.iter().flat_map(|group| group.hardpoints);
        self.hardpoints.iter().chain(further)
    }

    /// Hardpoint with this name.
    pub fn hardpoint(&self, name: &str) -> Option<&'static Hardpoint> {
        self.all_hardpoints().find(|h| h.name == name)
    }

    /// Pairs of hardpoints that must not coincide, each with the reason.
    pub fn all_distinct(
        &self,
    ) -> impl Iterator<Item = &'static (&'static str, &'static str, &'static str)> {
        let further = self.groups.iter().flat_map(|group| group.distinct);
        self.distinct.iter().chain(further)
    }

    /// Topology with this name.
    pub fn named(name: &str) -> Option<&'static Topology> {
        Self::ALL.iter().find(|t| t.name == name).copied()
    }
}

impl std::fmt::Debug for Topology {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Topology({})", self.name)
    }
}

impl PartialEq for Topology {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}
