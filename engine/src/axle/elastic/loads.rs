//! Loads on an axle with elastic parts: forces of all members in the equilibrium under each load.

use super::super::{Axle, AxlePlan};
use crate::ask::Unit;
use crate::compliance::{AxleEquilibrium, ElasticAxle, HeldQuantity, WheelLoads};
use crate::curves::{Column, MemberColumns};
use crate::model::{Axis, Side};
use crate::number::Each;
use crate::study::{AxleComplianceStudy, Load};

/// All loads with the same name. They act together.
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
        let wheels = Side::ALL.map(|side| {
            let suspension = axle.suspension(side);
            let members = model.members(side, &suspension.mechanism, &bushings);
            MemberColumns::of(members, axle.frame(side), axle.left.length_unit)
        });
        AxleLoads {
            cases,
            wheels,
            axle: model,
            along: axle.left.frame.sign(Axis::Y),
            has_rack: axle.left.mechanism.has_rack(),
            has_bar: elastic.parts.bar_rate.is_some(),
        }
    }

    pub(super) fn columns(&self) -> impl Iterator<Item = Column> {
        self.cases.iter().flat_map(|case| self.columns_of(case))
    }

    /// Returns the columns of both wheels, then the columns of the whole axle.
    fn columns_of(&self, case: &Case<'_>) -> Vec<Column> {
        let mut columns = Vec::new();
        for (wheel, prefix) in self.wheels.iter().zip(PREFIXES) {
            columns.extend(wheel.columns(case.name, prefix, case.held));
        }
        let [left, _] = &self.wheels;
        if self.has_rack {
            let name = format!("{}_rack_force", case.name);
            columns.push(left.column(name, Unit::Force, "on the rack along +y"));
        }
        if self.has_bar {
            let name = format!("{}_anti_roll_bar_torque", case.name);
            columns.push(left.column(name, Unit::Torque, "left lever turned further"));
        }
        columns
    }

    /// Returns the values of the columns at these travels and this rack displacement along the kernel's +y. If the axle
    /// has no equilibrium under a load, the columns of this load contain `None`.
    pub(super) fn values(&self, (travels, rack): ([f64; 2], f64)) -> Vec<Option<f64>> {
        if self.cases.is_empty() {
            return Vec::new();
        }
        let station = self.axle.at(travels, rack).ok();
        let mut values = Vec::new();
        for case in &self.cases {
            match station.and_then(|station| self.case(case, &station)) {
                Some(found) => values.extend(found),
                None => values.extend(self.columns_of(case).iter().map(|_| None)),
            }
        }
        values
    }

    fn case(&self, case: &Case<'_>, station: &AxleEquilibrium) -> Option<Vec<Option<f64>>> {
        let (axle, held) = (self.axle, case.held);
        let loads = Side::ALL.each(|side| match case.on[side as usize] {
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
        let [left, _] = &self.wheels;
        if self.has_rack {
            values.push(left.printed(self.along * axle.rack_force(&at), Unit::Force));
        }
        if self.has_bar {
            let torque = axle.bar_torque(&at);
            values.push(torque.and_then(|torque| left.printed(torque, Unit::Torque)));
        }
        Some(values)
    }
}
