//! Members of the suspension: named forces in the results.

use super::super::beam_loads::BeamForce;
use super::{FAR, Support};
use crate::ask::Unit;
use crate::model::{Arm, Axis, Body, Constraint, Frame, Mechanism, PointId, RockerId, Rod};

/// One of the reactions to a load, in the kernel's frame (x forward, y left, z up, for a left wheel).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carried {
    /// Tension of the rod with these ends, or of a leg of an arm that carries no other part.
    Tension(PointId, PointId),
    /// Force at a point on the wheel carrier.
    Force(PointId, Axis),
    /// Force with which the support holds the suspension: spring force or vertical force.
    Support(Support),
    /// Force of the support at the opposite wheel of a rigid axle.
    FarSupport(Support),
    /// Tension of the rod of the spring's rocker.
    Rod,
    /// Tension of the rod that rotates the rocker of a Watt linkage.
    WattRod(RockerId),
    /// Tension of the drag link of a steered axle.
    DragLink,
    /// Tension of the tie rod of a steered axle.
    TieRod,
    /// Force or moment of a twist beam.
    Beam(BeamForce),
}

impl Carried {
    /// Direction of a positive value in words, such as `tension` or `compression`.
    pub fn positive(&self) -> &'static str {
        match self {
            Carried::Tension(..)
            | Carried::Rod
            | Carried::WattRod(_)
            | Carried::DragLink
            | Carried::TieRod => "tension",
            Carried::Beam(force) => force.positive(),
            Carried::Force(_, axis) => axis.force_on_carrier(),
            Carried::Support(Support::Spring(_)) | Carried::FarSupport(Support::Spring(_)) => {
                "compression"
            }
            Carried::Support(Support::WheelCentre) | Carried::FarSupport(Support::WheelCentre) => {
                "upward on the wheel carrier"
            }
        }
    }

    /// Sign that converts the reaction from the kernel's frame of the loaded wheel to the study's axes.
    pub(crate) fn sign(&self, frame: &Frame) -> f64 {
        match self {
            Carried::Force(_, axis) => frame.sign(*axis),
            Carried::Beam(force) => {
                let sign = match force {
                    BeamForce::Moment(axis) => frame.turn_sign(*axis),
                    _ => frame.sign(force.axis()),
                };
                sign * force.sign_of(frame.meaning().1)
            }
            _ => 1.0,
        }
    }

    /// Unit of the reaction.
    pub fn unit(&self) -> Unit {
        match self {
            Carried::Beam(BeamForce::Moment(_)) => Unit::Torque,
            _ => Unit::Force,
        }
    }
}

/// A force that is in the results of every load.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Name of the member. The name of its column is the load's name followed by this name.
    pub name: String,
    /// Reaction from which the force is taken.
    pub what: Carried,
}

/// Returns all members with a reaction, in this order: members of the constraints, joints of arms, rods on rockers,
/// forces of a twist beam, supports.
pub fn members(mechanism: &Mechanism, support: Support) -> Vec<Member> {
    let mut members =
        members_of_constraints(mechanism, |joint| is_joint_of_bent_arm(mechanism, joint));
    members.extend(joints_of_arms_with_links(mechanism));
    members.extend(rods_on_rockers(mechanism));
    if mechanism.topology.is_twist_beam() {
        let forces = BeamForce::all(FAR).map(|(name, force)| Member {
            name,
            what: Carried::Beam(force),
        });
        members.extend(forces);
    }
    members.extend(supports(mechanism, support));
    members
}

/// Returns the members for the three components of the force at a point.
fn components(name: &str, point: PointId) -> [Member; 3] {
    Axis::ALL.map(|axis| Member {
        name: format!("{name}_{}", axis.name()),
        what: Carried::Force(point, axis),
    })
}

/// Returns the members of the constraints, in the order of the constraints. The legs of an arm are left out if `is_bent` is true
/// for its outer joint.
pub(crate) fn members_of_constraints(
    mechanism: &Mechanism,
    is_bent: impl Fn(PointId) -> bool,
) -> Vec<Member> {
    let mut members = Vec::new();
    for constraint in &mechanism.constraints {
        match *constraint {
            // In a twist beam's mechanism, rods only represent the half of the opposite wheel. They are not real parts.
            Constraint::Link { .. } if mechanism.topology.is_twist_beam() => {}
            // If an arm carries a spring or a link, its legs are bent. So the axial force of a leg is not the whole
            // load on it.
            Constraint::Link { outer, .. } if is_bent(outer) => {}
            Constraint::Link { inner, outer } => {
                members.push(Member {
                    name: mechanism.link_name(inner).to_owned(),
                    what: Carried::Tension(inner, outer),
                });
            }
            Constraint::StrutLine { top, .. } => members.extend(components("strut_side", top)),
            Constraint::Revolute { first, second } => {
                members.extend(components(mechanism.name(first), first));
                members.extend(components(mechanism.name(second), second));
            }
            Constraint::BallJoint { at } | Constraint::ArmJoint { at, .. } => {
                members.extend(components(mechanism.name(at), at));
            }
            // The function `members` lists the forces of a twist beam separately.
            Constraint::Mount { .. } | Constraint::AxleTravel { .. } => {}
        }
    }
    members
}

/// Returns the forces in the outer joints of those arms at whose outer joint a link ends, such as a leg of the arm.
fn joints_of_arms_with_links(mechanism: &Mechanism) -> impl Iterator<Item = Member> + use<'_> {
    let ends_a_link = |arm: &&Arm| {
        let at_joint =
            |c: &Constraint| matches!(c, Constraint::Link { outer, .. } if *outer == arm.outer);
        mechanism.constraints.iter().any(at_joint)
    };
    let arms = mechanism.arms.iter().filter(ends_a_link);
    arms.flat_map(|arm| components(mechanism.name(arm.outer), arm.outer))
}

/// Returns the rods of Watt linkages. For a steered axle, also returns drag link and tie rod.
fn rods_on_rockers(mechanism: &Mechanism) -> Vec<Member> {
    let rockers = mechanism.rockers.iter().enumerate();
    let watt_links = rockers.filter(|(_, rocker)| rocker.rod == Rod::WattLink);
    let mut members: Vec<Member> = watt_links
        .map(|(number, rocker)| Member {
            name: rocker.rod.key().to_owned(),
            what: Carried::WattRod(RockerId(number)),
        })
        .collect();
    if mechanism.axle_steering().is_some() {
        let rods = [
            (Rod::DragLink, Carried::DragLink),
            (Rod::TieRod, Carried::TieRod),
        ];
        members.extend(rods.map(|(rod, what)| Member {
            name: rod.key().to_owned(),
            what,
        }));
    }
    members
}

/// Returns the rod of the spring's rocker, if the spring is the support, and the supports.
fn supports(mechanism: &Mechanism, support: Support) -> Vec<Member> {
    let mut members = Vec::new();
    if let Some(rocker) = support.rocker(mechanism) {
        members.push(Member {
            name: mechanism.rocker(rocker).rod.key().to_owned(),
            what: Carried::Rod,
        });
    }
    let name = match support {
        Support::Spring(_) => "spring",
        Support::WheelCentre => "support",
    };
    members.push(Member {
        name: name.to_owned(),
        what: Carried::Support(support),
    });
    if mechanism.rigid_axle.is_some() {
        members.push(Member {
            name: format!("{FAR}{name}"),
            what: Carried::FarSupport(support),
        });
    }
    members
}

/// Returns true for the outer joint of an arm that carries another part. Such parts are the spring, the rod of its rocker, a
/// link to the knuckle, and a second joint to the knuckle.
fn is_joint_of_bent_arm(mechanism: &Mechanism, joint: PointId) -> bool {
    let arms = mechanism.constraints.iter();
    let mut arms = arms.filter_map(|constraint| mechanism.arm_under(constraint));
    sprung_joint(mechanism) == Some(joint) || arms.any(|arm| mechanism.arms[arm.0].outer == joint)
}

/// Outer joint of the arm that carries the spring or the rod of its rocker. `None` if no arm carries them.
pub(super) fn sprung_joint(mechanism: &Mechanism) -> Option<PointId> {
    match mechanism.body(mechanism.spring_seat()?) {
        Body::Arm(arm) => Some(mechanism.arms[arm.0].outer),
        _ => None,
    }
}
