//! Checks that hardpoints form a suspension: the set is complete, points are distinct, arms and rockers can rotate,
//! the size is plausible, and the side is correct.
//!
//! The [builder](super::SuspensionBuilder) and the code that reads studies share these checks. The code that reads studies
//! adds the position in the file and the remedy to an error.

use super::rocker::has_leverage;
use crate::model::{Body, Group, LengthUnit, PointId, Rod, Suspension, Topology};
use thiserror::Error;

/// Distance, as a share of the mechanism's size, below which points coincide.
const COINCIDENT: f64 = 1e-9;

/// Range of plausible sizes of a suspension, in metres: from a small model car to a haul truck. Confusing mm with m
/// changes the size by a factor of a thousand.
const PLAUSIBLE_SIZE: [f64; 2] = [0.005, 50.0];

/// Reason why the given hardpoints do not fit a topology.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum HardpointFault {
    /// The topology has no hardpoint of this name.
    #[error("{topology} has no hardpoint {name:?}")]
    Unknown {
        /// Name of the topology.
        topology: &'static str,
        /// Unknown name.
        name: String,
    },
    /// Required hardpoints of the topology are missing.
    #[error("missing for {topology}: {}", .missing.join(", "))]
    Missing {
        /// Name of the topology.
        topology: &'static str,
        /// Missing hardpoints, each with its description.
        missing: Vec<String>,
    },
    /// The study mixes hardpoints of two alternative lists of a group. A study may use only one of these lists.
    #[error("{first} and {second} are both given: expected only one of them for {group}")]
    Both {
        /// A hardpoint of one alternative.
        first: &'static str,
        /// A hardpoint of the other alternative that the first alternative does not have.
        second: &'static str,
        /// Name of the group.
        group: &'static str,
    },
    /// A study gives only some of the hardpoints of a group.
    #[error("missing for {group}: {}", .missing.join(", "))]
    Incomplete {
        /// Name of the group.
        group: &'static str,
        /// Missing hardpoints, each with its description.
        missing: Vec<String>,
    },
}

impl HardpointFault {
    /// Returns a fault that lists the required hardpoints of a topology that are missing. `None` if no hardpoint is
    /// missing.
    pub fn missing(
        topology: &'static Topology,
        is_given: impl Fn(&str) -> bool,
    ) -> Option<HardpointFault> {
        let missing: Vec<String> = topology
            .hardpoints
            .iter()
            .filter(|h| h.required && !is_given(h.name))
            .map(|h| format!("{} ({})", h.name, h.about))
            .collect();
        (!missing.is_empty()).then_some(HardpointFault::Missing {
            topology: topology.name,
            missing,
        })
    }

    /// Returns a fault if the study gives only some of the hardpoints of a group, or mixes two of its alternatives. `None` for
    /// a complete group and for a group without hardpoints.
    pub fn of_group(
        topology: &'static Topology,
        group: &'static Group,
        given: &[&'static str],
    ) -> Option<HardpointFault> {
        let is_given = |name: &&str| given.contains(name);
        let count = |list: &[&'static str]| list.iter().filter(|name| is_given(name)).count();
        // Each list in `complete` is a complete set of hardpoints. Selects the list with the most hardpoints in the study. If
        // several lists are equal, selects the first of them.
        let nearest = group.complete.iter().rev().max_by_key(|list| count(list));
        let is_beside = group.beside.iter().any(is_given);
        let list = nearest.filter(|list| count(list) > 0 || is_beside)?;
        let belongs = |name: &&str| group.complete.iter().any(|list| list.contains(name));
        let mut written = given.iter().filter(|name| belongs(name));
        // The study gives at least as many hardpoints of `list` as of the other alternative. So one of them is not in the
        // other alternative.
        if let Some(first) = written.find(|name| !list.contains(name))
            && let Some(other) = group.complete.iter().find(|list| list.contains(first))
            && let Some(second) = list.iter().find(|n| is_given(n) && !other.contains(n))
        {
            return Some(HardpointFault::Both {
                first,
                second,
                group: group.what,
            });
        }
        let about = |name: &&str| match topology.hardpoint(name) {
            Some(hardpoint) => format!("{name} ({})", hardpoint.about),
            None => (*name).to_owned(),
        };
        let missing: Vec<String> = list
            .iter()
            .filter(|name| !is_given(name))
            .map(about)
            .collect();
        (!missing.is_empty()).then_some(HardpointFault::Incomplete {
            group: group.what,
            missing,
        })
    }
}

/// Reason why a complete set of hardpoints is not a valid suspension.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GeometryFault {
    /// Two points that must be distinct coincide.
    #[error("{second} coincides with {first}: {reason}")]
    Coincident {
        /// First point.
        first: String,
        /// Second point.
        second: String,
        /// Reason why the two points must be distinct.
        reason: &'static str,
    },
    /// An arm's outer joint is on the arm's axis.
    #[error("{outer} lies on the line through {front} and {rear}, so the arm cannot move it")]
    ArmInLine {
        /// Outer joint of the arm.
        outer: String,
        /// A point of the axis.
        front: String,
        /// Second point of the axis.
        rear: String,
    },
    /// The end of a rod lies on the axis of the body that the rod rotates.
    #[error(
        "{inner} lies on the line through {first} and {second}, so it has no lever arm to turn {turned}"
    )]
    LeverInLine {
        /// End of the rod on this body.
        inner: String,
        /// A point of the axis.
        first: String,
        /// Second point of the axis.
        second: String,
        /// Body that cannot rotate.
        turned: &'static str,
    },
    /// A rod is at a toggle in the design position.
    #[error(
        "the {rod} is at toggle in the design position: {outer}, {inner} and the axis from {first} to \
         {second} lie in one plane, so it cannot turn {turned}"
    )]
    LeverAtToggle {
        /// Kind of rod.
        rod: String,
        /// End of the rod on the body that it rotates.
        inner: String,
        /// Other end of the rod.
        outer: String,
        /// A point of the axis.
        first: String,
        /// Second point of the axis.
        second: String,
        /// Body that cannot rotate.
        turned: &'static str,
    },
    /// The suspension is too large or too small, probably because of a wrong unit of length.
    #[error("the hardpoints are {size:.3} {} apart, which is impossible for a suspension", unit.symbol())]
    ImplausibleSize {
        /// Largest distance of a hardpoint from the wheel carrier's origin.
        size: f64,
        /// Unit of the size.
        unit: LengthUnit,
    },
    /// The wheel is not outboard of the body, so the side or the axes must be wrong.
    #[error("{wheel_centre} is inboard of the points on the body")]
    WrongSide {
        /// Wheel centre.
        wheel_centre: String,
    },
}

impl GeometryFault {
    /// Returns the first fault of a suspension. `None` if there is no fault.
    pub fn first_of(suspension: &Suspension) -> Option<GeometryFault> {
        GeometryFault::all_of(suspension).into_iter().next()
    }

    /// Finds the faults of a suspension. Returns only faults of the first kind found, because this kind can cause the other
    /// kinds.
    pub fn all_of(suspension: &Suspension) -> Vec<GeometryFault> {
        let checks = [
            distinct_points,
            arms_turn,
            levers_turn,
            plausible_size,
            right_side,
        ];
        let mut faults = checks.into_iter().map(|check| check(suspension));
        faults.find(|found| !found.is_empty()).unwrap_or_default()
    }
}

fn name(suspension: &Suspension, id: PointId) -> String {
    suspension.mechanism.name(id).to_owned()
}

fn distinct_points(suspension: &Suspension) -> Vec<GeometryFault> {
    let (mechanism, design) = (&suspension.mechanism, &suspension.design);
    let least = COINCIDENT * suspension.size();
    let pairs = mechanism.topology.all_distinct();
    let coincident = pairs.filter_map(|(first, second, reason)| {
        let (a, b) = (mechanism.point(first)?, mechanism.point(second)?);
        ((design[a.0] - design[b.0]).norm() <= least).then(|| GeometryFault::Coincident {
            first: (*first).to_owned(),
            second: (*second).to_owned(),
            reason,
        })
    });
    coincident.collect()
}

fn arms_turn(suspension: &Suspension) -> Vec<GeometryFault> {
    let design = &suspension.design;
    let in_line = suspension.mechanism.arms.iter().filter(|arm| {
        let axis = (design[arm.front.0] - design[arm.rear.0]).normalised();
        let leg = design[arm.outer.0] - design[arm.rear.0];
        axis.cross(leg).norm() <= COINCIDENT * suspension.size()
    });
    let fault = |arm: &crate::model::Arm| GeometryFault::ArmInLine {
        outer: name(suspension, arm.outer),
        front: name(suspension, arm.front),
        rear: name(suspension, arm.rear),
    };
    in_line.map(fault).collect()
}

fn levers_turn(suspension: &Suspension) -> Vec<GeometryFault> {
    let design = &suspension.design;
    let mut faults = Vec::new();
    // A twist beam has no real rod. The study checks the positions of its points.
    let rockers = suspension.mechanism.rockers.iter();
    for rocker in rockers.filter(|rocker| rocker.rod != Rod::TwistBeam) {
        let [inner, outer, first, second] =
            [rocker.inner, rocker.outer, rocker.first, rocker.second].map(|p| name(suspension, p));
        let axis = (design[rocker.second.0] - design[rocker.first.0]).normalised();
        let lever = axis.cross(design[rocker.inner.0] - design[rocker.first.0]);
        let turned = rocker.rod.turns();
        if lever.norm() <= COINCIDENT * suspension.size() {
            faults.push(GeometryFault::LeverInLine {
                inner,
                first,
                second,
                turned,
            });
        } else if !has_leverage(rocker, design) {
            faults.push(GeometryFault::LeverAtToggle {
                rod: rocker.rod.to_string(),
                inner,
                outer,
                first,
                second,
                turned,
            });
        }
    }
    faults
}

fn plausible_size(suspension: &Suspension) -> Vec<GeometryFault> {
    let (size, unit) = (suspension.size(), suspension.length_unit);
    let [smallest, largest] = PLAUSIBLE_SIZE;
    if (smallest..=largest).contains(&(size / unit.per_metre())) {
        Vec::new()
    } else {
        vec![GeometryFault::ImplausibleSize { size, unit }]
    }
}

/// Checks that the wheel is outboard of the mean of the points on body and rack. The position of the coordinate origin has no
/// effect.
fn right_side(suspension: &Suspension) -> Vec<GeometryFault> {
    let (mechanism, design) = (&suspension.mechanism, &suspension.design);
    let points = mechanism.points.iter().zip(design);
    let inboard: Vec<f64> = points
        .filter(|(point, _)| matches!(point.body, Body::Chassis | Body::Rack))
        .map(|(_, position)| position.y)
        .collect();
    let mean = inboard.iter().sum::<f64>() / inboard.len() as f64;
    let centre = mechanism.wheel_centre;
    // A twist beam without springs has no point on the body, so the mean of these points does not exist.
    if design[centre.0].y < mean {
        vec![GeometryFault::WrongSide {
            wheel_centre: name(suspension, centre),
        }]
    } else {
        Vec::new()
    }
}
