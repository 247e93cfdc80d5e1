//! Forces in links, joints and spring in every pose of a motion.

use super::Column;
use crate::analyse::{self, Balance, Carried, FAR, Member, Support, members};
use crate::model::{Frame, LengthUnit, Mechanism, RockerId};
use crate::number::Vector3;
use crate::study::Load;

/// Loads on a wheel, and the reaction forces to report.
pub(crate) struct Loads<'a> {
    loads: &'a [Load],
    mechanism: &'a Mechanism,
    frame: Frame,
    length: LengthUnit,
    /// Support that holds the suspension.
    pub(crate) support: Support,
    members: Vec<Member>,
}

/// Adds the side to the name of a member of a rigid axle. A load on one wheel loads both halves of the axle, so names need
/// the side. A member that the axle has only once keeps its name.
fn with_side(member: Member, mechanism: &Mechanism, frame: Frame) -> Member {
    if mechanism.rigid_axle.is_none() {
        return member;
    }
    let near = frame.meaning().1;
    let far = near.other();
    let is_single = match member.what {
        Carried::Tension(inner, outer) => {
            [inner, outer].into_iter().any(|id| mechanism.is_single(id))
        }
        Carried::WattRod(_) | Carried::DragLink | Carried::TieRod => true,
        Carried::Beam(force) => force.is_single(),
        _ => false,
    };
    let name = match member.name.strip_prefix(FAR) {
        Some(name) => format!("{}_{name}", far.name()),
        None if is_single => member.name,
        None => format!("{}_{}", near.name(), member.name),
    };
    Member { name, ..member }
}

impl<'a> Loads<'a> {
    /// Prepares loads on a mechanism. `frame` maps between the study's axes and the mechanism's own frame, `length` is the
    /// study's unit.
    pub(crate) fn of(
        mechanism: &'a Mechanism,
        (frame, length): (Frame, LengthUnit),
        loads: &'a [Load],
    ) -> Self {
        let support = Support::of(mechanism);
        Loads {
            loads,
            mechanism,
            frame,
            length,
            support,
            members: if loads.is_empty() {
                Vec::new()
            } else {
                let members = members(mechanism, support).into_iter();
                members.map(|m| with_side(m, mechanism, frame)).collect()
            },
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.loads.is_empty()
    }

    /// Rocker through which the spring supports the suspension. `None` without loads or without such a rocker.
    pub(crate) fn rocker(&self) -> Option<RockerId> {
        let rocker = self.support.rocker(self.mechanism);
        rocker.filter(|_| !self.is_empty())
    }

    /// Columns, load by load.
    pub(crate) fn columns(&self) -> impl Iterator<Item = Column> {
        self.loads.iter().flat_map(|load| {
            let name = |member: &Member| format!("{}_{}", load.name, member.name);
            let length = self.length;
            let column = move |m: &Member| {
                let unit = m.what.unit();
                let (symbol, factor) = (unit.suffix(length), unit.printed_factor(length));
                Column::of_value(name(m), symbol, m.what.positive(), factor)
            };
            self.members.iter().map(column)
        })
    }

    /// Values of the loads' columns in a pose, in printed units. Forces are along the study's axes. `contact` is the contact point
    /// in the kernel's frame (x forward, y left, z up, for a left wheel).
    pub(crate) fn forces(
        &self,
        balance: &Balance<'_>,
        contact: Vector3<f64>,
    ) -> impl Iterator<Item = Option<f64>> {
        self.loads.iter().flat_map(move |load| {
            let carried = balance.under(&analyse::Load {
                point: balance.place(load.at, contact),
                force: load.force,
                moment: load.moment,
            });
            self.members.iter().map(move |member| {
                let factor = member.what.unit().printed_factor(self.length);
                let value = balance.force(&carried, member.what)?;
                let value = value * member.what.sign(&self.frame) * factor;
                value.is_finite().then_some(value)
            })
        })
    }
}
