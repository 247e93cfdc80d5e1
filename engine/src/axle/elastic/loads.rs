//! Loads on an axle with elastic parts: forces of all members in the equilibrium under each load.

use super::super::{Axle, AxlePlan};
use crate::ask::Unit;
use crate::compliance::{AxleEquilibrium, ElasticAxle, HeldQuantity, WheelLoads};
use crate::curves::{Column, MemberColumns};
use crate::model::{Axis, LengthUnit, Side};
use crate::study::{AxleComplianceStudy, Load};

/// Loads with one name: they act together.
struct Case<'a> {
    name: &'a str,
    held: HeldQuantity,
    on: [Option<&'a Load>; 2],
}

/// Loads on an axle with elastic parts.
pub(super) struct AxleLoads<'a> {
    cases: Vec<Case<'a>>,
    wheels: [MemberColumns; 2],
    axle: &'a ElasticAxle,
    length: LengthUnit,
    /// Sign of the study's rack axis in the left wheel's frame.
    along: f64,
    has_rack: bool,
    has_bar: bool,
}

const PREFIXES: [&str; 2] = ["left_", "right_"];

impl<'a> AxleLoads<'a> {
    pub(super) fn of(
        axle: &'a Axle,
        elastic: &AxleComplianceStudy,
        model: &'a ElasticAxle,
        plan: &'a AxlePlan,
    ) -> Self {
        let mut cases: Vec<Case<'a>> = Vec::new();
        for (side, loads) in plan.loads.iter().enumerate() {
            for load in loads {
                let known = cases.iter().position(|case| case.name == load.name);
                let number = known.unwrap_or_else(|| {
                    cases.push(Case {
                        name: &load.name,
                        held: load.held.unwrap_or(HeldQuantity::WheelLoad),
                        on: [None; 2],
                    });
                    cases.len() - 1
                });
                cases[number].on[side] = Some(load);
            }
        }
        let bushings = elastic.bushing_names(&axle.left);
        let length = axle.left.length_unit;
        let wheels = Side::ALL.map(|side| {
            let suspension = axle.suspension(side);
            let members = model.members(side, &suspension.mechanism, &bushings);
            MemberColumns::of(members, axle.frame(side), length)
        });
        AxleLoads {
            cases,
            wheels,
            axle: model,
            length,
            along: axle.left.frame.sign(Axis::Y),
            has_rack: axle.left.mechanism.has_rack(),
            has_bar: elastic.parts.bar_rate.is_some(),
        }
    }

    pub(super) fn columns(&self) -> Vec<Column> {
        let mut columns = Vec::new();
        for case in &self.cases {
            for (wheel, prefix) in self.wheels.iter().zip(PREFIXES) {
                columns.extend(wheel.columns(case.name, prefix, case.held));
            }
            let of = |name: &str, unit: Unit, positive| {
                let (suffix, factor) = (unit.suffix(self.length), unit.printed_factor(self.length));
                Column::of_value(format!("{}_{name}", case.name), suffix, positive, factor)
            };
            let rack = of("rack_force", Unit::Force, "on the rack along +y");
            columns.extend(self.has_rack.then_some(rack));
            let bar = of(
                "anti_roll_bar_torque",
                Unit::Torque,
                "left lever turned further",
            );
            columns.extend(self.has_bar.then_some(bar));
        }
        columns
    }

    /// Values of the columns at these travels and this rack displacement along the study's +y. A load without equilibrium has
    /// none.
    pub(super) fn values(&self, (travels, rack): ([f64; 2], f64)) -> Vec<Option<f64>> {
        let station = self.axle.at(travels, self.along * rack).ok();
        let mut values = Vec::new();
        for case in &self.cases {
            let found = station.and_then(|station| self.case(case, &station));
            match found {
                Some(found) => values.extend(found),
                None => {
                    let wheels = self.wheels.iter().zip(PREFIXES);
                    let count: usize = wheels
                        .map(|(wheel, prefix)| wheel.columns(case.name, prefix, case.held).count())
                        .sum();
                    let more = usize::from(self.has_rack) + usize::from(self.has_bar);
                    values.resize(values.len() + count + more, None);
                }
            }
        }
        values
    }

    fn case(&self, case: &Case<'_>, station: &AxleEquilibrium) -> Option<Vec<Option<f64>>> {
        let (axle, held) = (self.axle, case.held);
        let loads = Side::ALL.map(|side| match case.on[side as usize] {
            Some(load) => load.in_equilibrium(held, axle.wheel_load(station, side)),
            None => WheelLoads::none(0.0),
        });
        let at = axle.loaded_about(station, station, &loads, held).ok()?;
        let mut values = Vec::new();
        for (side, wheel) in Side::ALL.into_iter().zip(&self.wheels) {
            let left = match held {
                HeldQuantity::WheelHeight => axle.wheel_load(&at, side),
                HeldQuantity::WheelLoad => axle.travel(&at, side),
            };
            values.extend(wheel.values(&axle.member_forces(&at, side)?, left, held));
        }
        let printed = |value: f64, unit: Unit| {
            let value = value * unit.printed_factor(self.length);
            value.is_finite().then_some(value)
        };
        if self.has_rack {
            values.push(printed(self.along * axle.rack_force(&at), Unit::Force));
        }
        if self.has_bar {
            values.push(
                axle.bar_torque(&at)
                    .and_then(|torque| printed(torque, Unit::Torque)),
            );
        }
        Some(values)
    }
}
