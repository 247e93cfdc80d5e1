//! Loads along a motion: what each link, joint and the spring carries in every pose.

use super::Column;
use crate::analyse;
use crate::analyse::{Balance, Reaction, Reactions, Support};
use crate::characteristics::{Constants, Slot, Slots, WheelReading};
use crate::mechanism::Configuration;
use crate::model::{Arm, Axis, Body, Constraint, Mechanism, PointId, RockerId, Suspension};
use crate::number::{Jet, Vector3};
use crate::plan::Plan;
use crate::study::{Load, LoadPoint};

/// The loads of a plan and what is reported of how they are carried.
pub(super) struct Loads<'a> {
    loads: &'a [Load],
    suspension: &'a Suspension,
    constants: Constants,
    /// What keeps the suspension from moving.
    pub(super) support: Support,
    members: Vec<Member>,
}

/// A force that is reported, for every load.
struct Member {
    /// What its column's name goes on with after the load's.
    name: String,
    what: Carried,
}

/// The force in the kernel's frame.
enum Carried {
    /// Tension of the rod with these ends, or of a leg of an arm that bears no spring.
    Tension(PointId, PointId),
    /// Force at a point on the wheel carrier.
    Force(PointId, Axis),
    /// Of the support.
    Support(Support),
    /// Tension of the rod of the spring's rocker.
    Rod,
}

impl Carried {
    /// When it is positive.
    fn positive(&self) -> &'static str {
        match self {
            Carried::Tension(..) | Carried::Rod => "tension",
            Carried::Force(_, Axis::X) => "on the wheel carrier along +x",
            Carried::Force(_, Axis::Y) => "on the wheel carrier along +y",
            Carried::Force(_, Axis::Z) => "on the wheel carrier along +z",
            Carried::Support(Support::Spring(_)) => "compression",
            Carried::Support(Support::WheelCentre) => "upward on the wheel carrier",
        }
    }
}

impl<'a> Loads<'a> {
    pub(super) fn of(suspension: &'a Suspension, plan: &'a Plan) -> Self {
        let mechanism = &suspension.mechanism;
        let support = mechanism
            .spring
            .map_or(Support::WheelCentre, Support::Spring);
        Loads {
            loads: &plan.loads,
            suspension,
            constants: plan.constants,
            support,
            members: match plan.loads.is_empty() {
                true => Vec::new(),
                false => members(mechanism, support),
            },
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.loads.is_empty()
    }

    /// The rocker through which the spring holds the suspension, where loads are followed.
    pub(super) fn rocker(&self) -> Option<RockerId> {
        match self.support {
            Support::Spring(spring) if !self.is_empty() => {
                let mechanism = &self.suspension.mechanism;
                mechanism.rockers_moving(spring.lower).next()
            }
            _ => None,
        }
    }

    /// The columns, load by load.
    pub(super) fn columns(&self) -> impl Iterator<Item = Column> {
        self.loads.iter().flat_map(|load| {
            let name = |member: &Member| format!("{}_{}", load.name, member.name);
            let column = move |m: &Member| Column::force(name(m), m.what.positive());
            self.members.iter().map(column)
        })
    }

    /// The values of the columns in a pose.
    pub(super) fn forces<const N: usize>(
        &self,
        balance: &Balance<'_>,
        at: &Configuration<Jet<f64, N>>,
    ) -> impl Iterator<Item = Option<f64>> {
        let slots = Slots::default().with(&[Slot::SpinAxis, Slot::Centre]);
        let view = WheelReading::reading(at, self.constants, slots);
        let place = |id: PointId| at.point(id).map(|c| c[0]);
        self.loads.iter().flat_map(move |load| {
            let carried = balance.under(&analyse::Load {
                point: match load.at {
                    LoadPoint::ContactPoint => view.contact_point(),
                    LoadPoint::WheelCentre => place(at.mechanism.wheel_centre),
                },
                force: load.force,
                moment: load.moment,
            });
            self.members.iter().map(move |member| {
                let value = match member.what {
                    Carried::Tension(inner, outer) => tension(inner, outer, &carried)?,
                    Carried::Support(_) => carried.support,
                    Carried::Rod => carried.rod?,
                    Carried::Force(point, axis) => {
                        let force = force_at(point, &carried, at.mechanism, place);
                        force[axis] * self.suspension.frame.sign(axis)
                    }
                };
                value.is_finite().then_some(value)
            })
        })
    }
}

/// Everything that carries: rods, then what is held at points, then joints of arms, then the support.
fn members(mechanism: &Mechanism, support: Support) -> Vec<Member> {
    let mut members = Vec::new();
    let force = |name: &str, point| {
        let component = |axis: Axis| Member {
            name: format!("{name}_{}", axis.name()),
            what: Carried::Force(point, axis),
        };
        Axis::ALL.map(component)
    };
    for constraint in &mechanism.constraints {
        match *constraint {
            // The legs of an arm with a spring on it are bent, and no force along them is the whole.
            Constraint::Link { outer, .. } if sprung_joint(mechanism) == Some(outer) => {}
            Constraint::Link { inner, outer } => {
                let name = mechanism.name(inner);
                members.push(Member {
                    name: name.strip_suffix("_inner").unwrap_or(name).to_owned(),
                    what: Carried::Tension(inner, outer),
                });
            }
            Constraint::StrutLine { top, .. } => members.extend(force("strut_side", top)),
            Constraint::Revolute { first, second } => {
                members.extend(force(mechanism.name(first), first));
                members.extend(force(mechanism.name(second), second));
            }
        }
    }
    let ends_a_link = |arm: &&Arm| {
        let at_joint =
            |c: &Constraint| matches!(c, Constraint::Link { outer, .. } if *outer == arm.outer);
        mechanism.constraints.iter().any(at_joint)
    };
    for arm in mechanism.arms.iter().filter(ends_a_link) {
        members.extend(force(mechanism.name(arm.outer), arm.outer));
    }
    if let Support::Spring(spring) = support
        && let Some(rocker) = mechanism.rockers_moving(spring.lower).next()
    {
        members.push(Member {
            name: mechanism.rocker(rocker).rod.to_string().replace(' ', "_"),
            what: Carried::Rod,
        });
    }
    members.push(Member {
        name: match support {
            Support::Spring(_) => "spring".to_owned(),
            Support::WheelCentre => "support".to_owned(),
        },
        what: Carried::Support(support),
    });
    members
}

/// The joint of the arm the spring stands on, if it or the rod of its rocker stands on an arm.
fn sprung_joint(mechanism: &Mechanism) -> Option<PointId> {
    match mechanism.body(mechanism.spring_seat()?) {
        Body::Arm(arm) => Some(mechanism.arms[arm.0].outer),
        _ => None,
    }
}

/// The tension of the rod between two points.
fn tension(inner: PointId, outer: PointId, carried: &Reactions) -> Option<f64> {
    carried
        .constraints
        .iter()
        .find_map(|reaction| match *reaction {
            Reaction::Rod {
                inner: from,
                outer: to,
                tension,
            } => ((from, to) == (inner, outer)).then_some(tension),
            Reaction::Force { .. } => None,
        })
}

/// Everything that acts on the wheel carrier at a point.
fn force_at(
    point: PointId,
    carried: &Reactions,
    mechanism: &Mechanism,
    place: impl Fn(PointId) -> Vector3<f64>,
) -> Vector3<f64> {
    let forces = carried
        .constraints
        .iter()
        .filter_map(|reaction| match *reaction {
            Reaction::Rod {
                inner,
                outer,
                tension,
            } => {
                let pull = (outer == point).then(|| (place(inner) - place(outer)).normalised());
                pull.map(|pull| pull * tension)
            }
            Reaction::Force { point: at, force } => (at == point).then_some(force),
        });
    let constraints = forces.fold(Vector3::default(), |sum, force| sum + force);
    match sprung_joint(mechanism) == Some(point) {
        true => constraints + carried.support_force,
        false => constraints,
    }
}
