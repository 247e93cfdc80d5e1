//! Rockers: parts on an axis fixed in the body or in a solid axle, which a rod rotates. Examples are the bell crank of a
//! pushrod or pullrod, an anti-roll bar with its drop link, and the rocker of a Watt linkage.
//!
//! The hardpoints of rockers form groups that a topology offers in addition to its own hardpoints. A study gives all
//! hardpoints of one of the lists in [`Group::complete`], or no hardpoint of the group.

use super::topology::{Group, optional};
use super::{Body, Mechanism, PointId};
use std::fmt;

/// Index of a rocker in [`Mechanism::rockers`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RockerId(pub usize);

/// Part that rotates about a line fixed in its base. The base is the vehicle or a solid axle. A rod of fixed length rotates the
/// part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rocker {
    /// Rod that rotates the rocker.
    pub rod: Rod,
    /// A point of the axis, on the chassis or on a solid axle.
    pub first: PointId,
    /// Another point of the axis.
    pub second: PointId,
    /// End of the rod on the rocker.
    pub inner: PointId,
    /// Other end of the rod: on an arm, the knuckle or an earlier rocker. For a rocker on a solid axle, it can also be on the
    /// chassis or the steering gear. For a twist beam, it is the far mount.
    pub outer: PointId,
}

/// Kind of the rod that rotates a rocker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rod {
    /// Pushes the rocker of the spring in jounce.
    Pushrod,
    /// Pulls the rocker of the spring in jounce.
    Pullrod,
    /// Rotates the lever of an anti-roll bar.
    DropLink,
    /// Upper link of a Watt linkage. The link rotates the linkage's rocker.
    WattLink,
    /// Turns the left knuckle of a steered solid axle.
    DragLink,
    /// Connects the knuckles of a steered solid axle, so that the left one turns the right one.
    TieRod,
    /// No real rod: a mount of a twist beam, which turns its half of the beam against the other half.
    TwistBeam,
}

impl Rod {
    /// Name of the part that the rod rotates.
    pub fn turns(self) -> &'static str {
        match self {
            Rod::Pushrod | Rod::Pullrod => "the rocker",
            Rod::DropLink => "the anti-roll bar",
            Rod::WattLink => "the Watt rocker",
            Rod::DragLink => "the left knuckle",
            Rod::TieRod => "the right knuckle",
            Rod::TwistBeam => "the twist beam",
        }
    }

    /// Returns true for rods of the spring's rocker.
    pub fn is_of_spring(self) -> bool {
        matches!(self, Rod::Pushrod | Rod::Pullrod)
    }

    /// Name of the rod in keys and columns.
    pub fn key(self) -> &'static str {
        match self {
            Rod::Pushrod => "pushrod",
            Rod::Pullrod => "pullrod",
            Rod::DropLink => "drop_link",
            Rod::WattLink => "watt_upper",
            Rod::DragLink => "drag_link",
            Rod::TieRod => "tie_rod",
            Rod::TwistBeam => "twist_beam",
        }
    }
}

impl fmt::Display for Rod {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Rod::Pushrod => "pushrod",
            Rod::Pullrod => "pullrod",
            Rod::DropLink => "drop link",
            Rod::WattLink => "upper Watt link",
            Rod::DragLink => "drag link",
            Rod::TieRod => "tie rod",
            Rod::TwistBeam => "twist beam",
        })
    }
}

const NO_PUSHROD: &str = "the pushrod would have no length";
const NO_PULLROD: &str = "the pullrod would have no length";
const NO_DROP_LINK: &str = "the drop link would have no length";
const PUSHROD: [&str; 4] = [
    "pushrod_outer",
    "pushrod_inner",
    "rocker_pivot_front",
    "rocker_pivot_rear",
];
const PULLROD: [&str; 4] = [
    "pullrod_outer",
    "pullrod_inner",
    "rocker_pivot_front",
    "rocker_pivot_rear",
];
const DROP_LINK: [&str; 4] = [
    "drop_link_outer",
    "drop_link_inner",
    "anti_roll_bar_inner",
    "anti_roll_bar_outer",
];

/// A rocker with its pushrod or pullrod. The spring then acts on the rocker.
pub(super) static ROCKER: Group = Group {
    what: "the rocker",
    hardpoints: &[
        optional("pushrod_outer", "pushrod at the suspension"),
        optional("pushrod_inner", "pushrod at the rocker"),
        optional("pullrod_outer", "pullrod at the suspension"),
        optional("pullrod_inner", "pullrod at the rocker"),
        optional(
            "rocker_pivot_front",
            "front point of the rocker's axis on the body",
        ),
        optional(
            "rocker_pivot_rear",
            "rear point of the rocker's axis on the body",
        ),
        optional(
            "heave_spring",
            "end of the heave spring on the rocker; its other end is on the other wheel's rocker",
        ),
    ],
    complete: &[&PUSHROD, &PULLROD],
    beside: &["heave_spring"],
    distinct: &[
        (
            "rocker_pivot_front",
            "rocker_pivot_rear",
            "they define the axis of the rocker",
        ),
        ("pushrod_outer", "pushrod_inner", NO_PUSHROD),
        ("pullrod_outer", "pullrod_inner", NO_PULLROD),
    ],
};

/// An anti-roll bar with its drop link.
pub(super) static ANTI_ROLL_BAR: Group = Group {
    what: "the anti-roll bar",
    hardpoints: &[
        optional("drop_link_outer", "drop link at the suspension"),
        optional("drop_link_inner", "drop link at the anti-roll bar's lever"),
        optional(
            "anti_roll_bar_inner",
            "inboard point of the anti-roll bar's axis",
        ),
        optional(
            "anti_roll_bar_outer",
            "outboard point of the anti-roll bar's axis",
        ),
    ],
    complete: &[&DROP_LINK],
    beside: &[],
    distinct: &[
        (
            "anti_roll_bar_inner",
            "anti_roll_bar_outer",
            "they define the axis of the anti-roll bar",
        ),
        ("drop_link_outer", "drop_link_inner", NO_DROP_LINK),
    ],
};

/// Watt linkage with its rocker on a solid axle: ends of the upper link on the body and on the rocker, pivot, and axis.
const WATT_ON_AXLE: [&str; 4] = [
    "watt_upper_chassis",
    "watt_upper_rocker",
    "watt_pivot",
    "watt_axis",
];
/// Watt linkage with its rocker on the body.
const WATT_ON_CHASSIS: [&str; 4] = [
    "watt_upper_axle",
    "watt_upper_rocker",
    "watt_pivot",
    "watt_axis",
];

/// Bodies that carry the outer ends of rods and springs, unless a study names other bodies.
#[derive(Clone, Copy)]
pub(super) struct Carriers {
    pub pushrod: Body,
    pub pullrod: Body,
    pub drop_link: Body,
    /// Body that carries the lower end of the spring if there is no rocker.
    pub spring: Body,
}

impl Carriers {
    /// Assigns all ends to one body.
    pub(super) const fn all(body: Body) -> Self {
        Carriers {
            pushrod: body,
            pullrod: body,
            drop_link: body,
            spring: body,
        }
    }

    /// Body of a hardpoint of spring, rocker or anti-roll bar. `None` for other hardpoints.
    pub(super) fn body(self, name: &str, given: &[&str]) -> Option<Body> {
        let has_rocker = given.contains(&"rocker_pivot_front");
        Some(match name {
            "pushrod_outer" => self.pushrod,
            "pullrod_outer" => self.pullrod,
            "drop_link_outer" => self.drop_link,
            "pushrod_inner" | "pullrod_inner" | "heave_spring" => Body::Rocker(RockerId(0)),
            "drop_link_inner" => Body::Rocker(RockerId(usize::from(has_rocker))),
            "spring_lower" if has_rocker => Body::Rocker(RockerId(0)),
            "spring_lower" => self.spring,
            "rocker_pivot_front"
            | "rocker_pivot_rear"
            | "anti_roll_bar_inner"
            | "anti_roll_bar_outer"
            | "spring_upper" => Body::Chassis,
            _ => return None,
        })
    }
}

/// Rockers whose hardpoints are given. The rocker of the spring comes first.
pub(super) fn rockers(find: impl Fn(&str) -> Option<PointId>) -> Vec<Rocker> {
    let rods = [
        (Rod::Pushrod, PUSHROD),
        (Rod::Pullrod, PULLROD),
        (Rod::DropLink, DROP_LINK),
        (Rod::WattLink, WATT_ON_AXLE),
        (Rod::WattLink, WATT_ON_CHASSIS),
    ];
    let given = rods
        .into_iter()
        .filter_map(|(rod, [outer, inner, first, second])| {
            Some(Rocker {
                rod,
                first: find(first)?,
                second: find(second)?,
                inner: find(inner)?,
                outer: find(outer)?,
            })
        });
    given.collect()
}

/// Rockers as bodies that a study may assign to points.
pub(super) fn bodies(rockers: &[Rocker]) -> impl Iterator<Item = (&'static str, Body)> {
    rockers.iter().enumerate().map(|(number, rocker)| {
        let name = match rocker.rod {
            Rod::Pushrod | Rod::Pullrod => "rocker",
            Rod::DropLink => "anti_roll_bar",
            Rod::WattLink => "watt_rocker",
            Rod::DragLink => "knuckle",
            Rod::TieRod => "right_knuckle",
            Rod::TwistBeam => "twist_beam",
        };
        (name, Body::Rocker(RockerId(number)))
    })
}

impl Mechanism {
    /// Rocker with this index.
    #[inline]
    pub fn rocker(&self, id: RockerId) -> Rocker {
        self.rockers[id.0]
    }

    /// Index of the rocker with a pushrod or pullrod.
    #[inline]
    pub fn spring_rocker(&self) -> Option<RockerId> {
        let mut rods = self.rockers.iter().map(|rocker| rocker.rod);
        rods.position(Rod::is_of_spring).map(RockerId)
    }

    /// Index of the anti-roll bar, which a drop link rotates. For a twist beam it is the far half of the beam, whose rotation
    /// twists the cross member.
    #[inline]
    pub fn anti_roll_bar(&self) -> Option<RockerId> {
        let mut rods = self.rockers.iter().map(|rocker| rocker.rod);
        rods.position(|rod| matches!(rod, Rod::DropLink | Rod::TwistBeam))
            .map(RockerId)
    }

    /// End of the heave spring on the rocker.
    #[inline]
    pub fn heave_spring(&self) -> Option<PointId> {
        let is_end = |point: &super::Point| point.name == "heave_spring";
        self.spring_rocker()?;
        self.points.iter().position(is_end).map(PointId)
    }

    /// Rockers that move a point: the rocker that carries the point, and the rocker that moves this rocker.
    pub fn rockers_moving(&self, id: PointId) -> impl Iterator<Item = RockerId> + '_ {
        let under = |id: PointId| match self.body(id) {
            Body::Rocker(rocker) => Some(rocker),
            _ => None,
        };
        std::iter::successors(under(id), move |rocker| under(self.rocker(*rocker).outer))
    }

    /// Point at which the spring acts on the arm or knuckle: the lower end of the spring, or the outer end of the rod of the
    /// spring's rocker.
    pub fn spring_seat(&self) -> Option<PointId> {
        let lower = self.spring?.lower;
        let last = self.rockers_moving(lower).last();
        Some(last.map_or(lower, |rocker| self.rocker(rocker).outer))
    }

    /// Name of the body that carries the outer end of a rocker's rod.
    pub fn seat(&self, rocker: &Rocker) -> String {
        let body = self.body(rocker.outer);
        let found = self.bodies.iter().find(|(_, known)| *known == body);
        found.map_or_else(String::new, |(name, _)| name.replace('_', " "))
    }

    /// Returns the mechanism with each hardpoint on the body that the topology assigns to it, whatever the study names.
    fn usual(&self) -> Mechanism {
        let known = self.points.iter();
        let known = known.filter_map(|point| self.topology.hardpoint(&point.name));
        let given: Vec<&'static str> = known.map(|hardpoint| hardpoint.name).collect();
        (self.topology.build)(self.topology, &given)
    }

    /// Body that the topology assigns to a hardpoint.
    pub(super) fn usual_body(&self, id: PointId) -> Body {
        let usual = self.usual();
        usual.body(usual.point(self.name(id)).unwrap_or(id))
    }

    /// Hardpoints that the study assigns to another body than the topology does.
    pub fn points_on_other_bodies(&self) -> Vec<&str> {
        let usual = self.usual();
        let differs = |point: &&super::Point| {
            let id = usual.point(&point.name);
            id.is_some_and(|id| usual.body(id) != point.body)
        };
        let moved = self.points.iter().filter(differs);
        moved.map(|point| point.name.as_str()).collect()
    }

    /// Bodies that a study may assign to a hardpoint. Only the ends of springs and rods on the suspension have such a
    /// choice. Empty for every other hardpoint.
    pub fn possible_bodies(&self, id: PointId) -> Vec<(&'static str, Body)> {
        let is_turned = |rocker: &Rocker| {
            let is_of_axle = matches!(
                rocker.rod,
                Rod::WattLink | Rod::DragLink | Rod::TieRod | Rod::TwistBeam
            );
            rocker.outer == id && !is_of_axle
        };
        let turns = self.rockers.iter().position(is_turned);
        let is_spring =
            self.spring.is_some_and(|s| s.lower == id) && self.name(id) == "spring_lower";
        let allowed = |body: Body| match (body, turns) {
            (Body::Chassis | Body::Rack, _) => false,
            (Body::Rocker(rocker), Some(turned)) => rocker.0 < turned,
            (Body::Rocker(rocker), None) => Some(rocker) == self.spring_rocker(),
            _ => true,
        };
        let bodies = self.bodies.iter().filter(|_| turns.is_some() || is_spring);
        bodies.copied().filter(|(_, body)| allowed(*body)).collect()
    }
}
