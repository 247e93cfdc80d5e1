//! Loads on elastic suspensions: forces of all members in the equilibrium under each load.

use super::{Column, Status};
use crate::analyse::LoadPoint;
use crate::ask::{NoValue, Unit};
use crate::compliance::{
    CarriedForces, Compliance, ElasticMember, ElasticWheel, Equilibrium, HeldQuantity, WheelLoads,
};
use crate::model::{Axis, Frame, LengthUnit, Suspension};
use crate::study::Load;

/// Members of a wheel, and their columns.
#[derive(Clone, Debug)]
pub(crate) struct MemberColumns {
    members: Vec<ElasticMember>,
    frame: Frame,
    length: LengthUnit,
}

impl MemberColumns {
    /// Makes the columns of these members. `frame` maps between the study's axes and the wheel's own frame.
    pub(crate) fn of(members: Vec<ElasticMember>, frame: Frame, length: LengthUnit) -> Self {
        MemberColumns {
            members,
            frame,
            length,
        }
    }

    /// Columns of a load: first the forces of the members, then the quantity that the load does not prescribe (vertical force
    /// or travel). `prefix` names the wheel.
    pub(crate) fn columns<'s>(
        &'s self,
        load: &'s str,
        prefix: &'s str,
        held: HeldQuantity,
    ) -> impl Iterator<Item = Column> + 's {
        let members = self.members.iter().map(move |member| {
            let prefix = if member.is_single { "" } else { prefix };
            let name = format!("{prefix}{load}_{}", member.name);
            self.column(name, member.unit(), member.positive())
        });
        let (name, unit, positive) = match held {
            HeldQuantity::WheelHeight => {
                ("vertical_force", Unit::Force, "upward at the contact point")
            }
            HeldQuantity::WheelLoad => ("travel", Unit::Length, "wheel up"),
        };
        let left = self.column(format!("{prefix}{load}_{name}"), unit, positive);
        members.chain([left])
    }

    /// Column of a value with this unit.
    pub(crate) fn column(&self, name: String, unit: Unit, positive: &'static str) -> Column {
        let (suffix, factor) = (unit.suffix(self.length), unit.printed_factor(self.length));
        Column::of_value(name, suffix, positive, factor)
    }

    /// Value in the unit of its column. `None` if it is not finite.
    pub(crate) fn printed(&self, value: f64, unit: Unit) -> Option<f64> {
        let value = value * unit.printed_factor(self.length);
        value.is_finite().then_some(value)
    }

    /// Values of the columns, in their units. Forces at joints are along the study's axes. `left` is the quantity that the
    /// load does not prescribe: vertical force or travel.
    pub(crate) fn values<'s>(
        &'s self,
        carried: &'s CarriedForces,
        left: f64,
        held: HeldQuantity,
    ) -> impl Iterator<Item = Option<f64>> + 's {
        let members = self.members.iter().map(move |member| {
            let value = carried.of(&member.part)?;
            let sign = member.axis().map_or(1.0, |axis| self.frame.sign(axis));
            self.printed(value * sign, member.unit())
        });
        let unit = match held {
            HeldQuantity::WheelHeight => Unit::Force,
            HeldQuantity::WheelLoad => Unit::Length,
        };
        members.chain([self.printed(left, unit)])
    }
}

impl Load {
    /// Loads to add to an equilibrium whose only load is `wheel_load`. With [`HeldQuantity::WheelLoad`], `self` already contains
    /// the whole vertical force, so `wheel_load` is subtracted.
    pub(crate) fn in_equilibrium(&self, held: HeldQuantity, wheel_load: f64) -> WheelLoads {
        let mut loads = WheelLoads::none(0.0);
        match self.at {
            LoadPoint::ContactPoint => loads.contact = self.force,
            LoadPoint::WheelCentre => loads.centre = self.force,
        }
        loads.moment = self.moment;
        if held == HeldQuantity::WheelLoad {
            loads.contact.z -= wheel_load;
        }
        loads
    }
}

/// Loads on a wheel with elastic parts.
pub(super) struct ElasticLoads<'a> {
    loads: &'a [Load],
    members: MemberColumns,
    wheel: &'a ElasticWheel,
    /// Sign of the study's rack axis in the wheel's own frame.
    along: f64,
}

impl<'a> ElasticLoads<'a> {
    pub(super) fn of(
        suspension: &Suspension,
        parts: &Compliance,
        wheel: &'a ElasticWheel,
        loads: &'a [Load],
    ) -> Self {
        let mechanism = &suspension.mechanism;
        let bushings = parts.bushings.iter();
        let bushings: Vec<String> = bushings
            .map(|part| mechanism.name(part.point).to_owned())
            .collect();
        let members = wheel.members(mechanism, &bushings);
        ElasticLoads {
            loads,
            members: MemberColumns::of(members, suspension.frame, suspension.length_unit),
            wheel,
            along: suspension.frame.sign(Axis::Y),
        }
    }

    pub(super) fn columns(&self) -> impl Iterator<Item = Column> {
        let of = |load: &'_ Load| {
            let held = load.held.unwrap_or(HeldQuantity::WheelLoad);
            self.members
                .columns(&load.name, "", held)
                .collect::<Vec<_>>()
        };
        self.loads.iter().flat_map(of)
    }

    /// Appends the values of the loads' columns to the values of a station, which is at a travel and a rack displacement. Returns
    /// the status of the station.
    pub(super) fn add_values(
        &self,
        [travel, rack]: [f64; 2],
        status: Status,
        values: &mut Vec<Result<f64, NoValue>>,
    ) -> Status {
        if self.loads.is_empty() {
            return status;
        }
        let station = self.wheel.at(travel, self.along * rack);
        let (Status::Ok, Ok(station)) = (status, station) else {
            values.extend(self.columns().map(|_| Err(NoValue::NoPose)));
            return status;
        };
        let forces = self.values(&station).into_iter();
        values.extend(forces.map(|force| force.ok_or(NoValue::NotHeld)));
        if values.contains(&Err(NoValue::NotHeld)) {
            Status::Unsupported
        } else {
            Status::Ok
        }
    }

    /// Values of the loads' columns at a station. A load without an equilibrium has no values.
    fn values(&self, station: &Equilibrium) -> Vec<Option<f64>> {
        let mut values = Vec::new();
        for load in self.loads {
            let held = load.held.unwrap_or(HeldQuantity::WheelLoad);
            let loads = load.in_equilibrium(held, self.wheel.wheel_load(station));
            let at = self.wheel.loaded_about(station, station, &loads, held).ok();
            let found = at.and_then(|at| Some((at, self.wheel.member_forces(&at)?)));
            match &found {
                Some((at, carried)) => {
                    let left = match held {
                        HeldQuantity::WheelHeight => self.wheel.wheel_load(at),
                        HeldQuantity::WheelLoad => self.wheel.travel(at),
                    };
                    values.extend(self.members.values(carried, left, held));
                }
                None => values.extend(self.members.columns(&load.name, "", held).map(|_| None)),
            }
        }
        values
    }
}
