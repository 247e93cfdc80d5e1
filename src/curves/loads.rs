//! Loads along a motion: what each link, joint and the spring carries in every pose.

use super::Column;
use crate::analyse::{self, Balance, Member, Support, members};
use crate::characteristics::{Constants, Slot, Slots, WheelReading};
use crate::mechanism::Configuration;
use crate::model::{RockerId, Suspension};
use crate::number::Jet;
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

impl<'a> Loads<'a> {
    pub(super) fn of(suspension: &'a Suspension, plan: &'a Plan) -> Self {
        let mechanism = &suspension.mechanism;
        let support = Support::of(mechanism);
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
        let rocker = self.support.rocker(&self.suspension.mechanism);
        rocker.filter(|_| !self.is_empty())
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
        self.loads.iter().flat_map(move |load| {
            let point = match load.at {
                LoadPoint::ContactPoint => view.contact_point(),
                LoadPoint::WheelCentre => at.point(at.mechanism.wheel_centre),
            };
            let carried = balance.under(&analyse::Load {
                point: point.map(|c| c[0]),
                force: load.force,
                moment: load.moment,
            });
            self.members.iter().map(move |member| {
                let sign = |axis| self.suspension.frame.sign(axis);
                let value = balance.force(&carried, member.what)?;
                let value = member.what.axis().map_or(value, |axis| value * sign(axis));
                value.is_finite().then_some(value)
            })
        })
    }
}
