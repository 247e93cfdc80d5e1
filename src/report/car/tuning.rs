//! Targets, constraints and variables of a tuned car, as tables and as JSON.

use super::record::{CarConstraintRecord, CarTargetRecord, CarVariableRecord};
use super::{CarResults, CarState};
use crate::ask::with_unit;
use crate::car::{CarQuantity, CarVariable, RigGoals, RigOutcome};
use crate::optimise::{Fit, Price};
use crate::report::table::{Cell, Table};
use crate::report::tuning_summary::{ConstraintStatus, bound_in_words, wanted as of_curve};
use crate::report::{brief, figure};
use crate::study::{CarOptimise, CarStudy, Constraint};
use serde_json::{Value, json};

/// Table cell with the target value, or with both limits of the target in words.
fn wanted_cell(wanted: [Option<f64>; 2], unit: &str) -> Cell {
    match wanted {
        [Some(low), Some(high)] if low == high => Cell::figure(low, unit),
        limits => limits_in_words(limits, unit).into(),
    }
}

/// Lower and upper limit of a target or constraint in words; empty without limits.
fn limits_in_words(limits: [Option<f64>; 2], unit: &str) -> String {
    match limits {
        [Some(low), Some(high)] => format!("{} to {}", figure(low, unit), figure(high, unit)),
        [Some(low), None] => format!("at least {}", figure(low, unit)),
        [None, Some(high)] => format!("at most {}", figure(high, unit)),
        [None, None] => String::new(),
    }
}

/// Target value (both limits are equal), or else the limits in words.
fn value_in_words(limits: [Option<f64>; 2], unit: &str) -> String {
    match limits {
        [Some(low), Some(high)] if low == high => figure(low, unit),
        limits => limits_in_words(limits, unit),
    }
}

/// Names of constraints with their limits in brackets. The name of a constraint of one axle alone already has the limits, so the
/// axle is in brackets instead. `numbers` are indices of `records`.
pub fn car_constraint_names(records: &[CarConstraintRecord], numbers: &[usize]) -> Vec<String> {
    let name = |number: &usize| {
        let own = &records[*number];
        let words = if own.is_of_axle {
            own.place.clone()
        } else {
            limits_in_words(own.limits, &own.unit)
        };
        format!("{} ({words})", own.name)
    };
    numbers.iter().map(name).collect()
}

impl CarTargetRecord {
    /// Table cell with the target value, or with the limits in words. For a target of an axle alone: a deviation of 0, with the
    /// curve or band of the target in words.
    pub(in crate::report) fn wanted_cell(&self) -> Cell {
        match self.curve {
            None => wanted_cell(self.wanted, self.unit()),
            Some(curve) => format!("0 (target {})", value_in_words(curve, self.unit())).into(),
        }
    }
}

/// Table of the targets with their values before and after the tuning.
pub fn car_targets_table(records: &[CarTargetRecord]) -> Table {
    let mut table = Table::new(["target", "case", "wanted", "before", "after", "tolerance"]);
    for target in records {
        let unit = target.unit();
        let cell = |value: Option<f64>| Cell::by(value, |value| figure(value, unit));
        let cells: [Cell; 6] = [
            target.output.as_str().into(),
            target.case.as_str().into(),
            target.wanted_cell(),
            cell(target.values[0]),
            cell(target.values[1]),
            cell(Some(target.tolerance)),
        ];
        table.push(cells);
    }
    table
}

/// Targets with their values, as JSON.
pub fn car_targets_json(records: &[CarTargetRecord]) -> Value {
    let targets = records.iter().map(|target| {
        json!({
            "name": target.output,
            "case": target.case,
            "wanted": match target.wanted {
                [Some(low), Some(high)] if low == high => json!(low),
                // A missing limit becomes null.
                limits => json!(limits),
            },
            "curve": target.curve,
            "tolerance": target.tolerance,
            "value": target.values[1],
        })
    });
    targets.collect()
}

/// Table of the constraints with their margins before and after the tuning. `None` without constraints.
pub fn car_constraints_table(records: &[CarConstraintRecord]) -> Option<Table> {
    if records.is_empty() {
        return None;
    }
    let mut table = Table::new([
        "constraint",
        "of",
        "limits",
        "margin before",
        "margin after",
        "unit",
        "kept",
        "price",
    ]);
    for own in records {
        let cell = |value: Option<f64>| Cell::by(value, |value| figure(value, &own.unit));
        let kept = own.status.and_then(ConstraintStatus::in_words);
        let cells: [Cell; 8] = [
            own.name.as_str().into(),
            own.place.as_str().into(),
            wanted_cell(own.limits, &own.unit),
            cell(own.margins[0]),
            cell(own.margins[1]),
            own.unit.as_str().into(),
            kept.map(str::to_owned).into(),
            if own.price_not_determined {
                Cell::from("not determined")
            } else {
                Cell::by(own.price, brief)
            },
        ];
        table.push(cells);
    }
    Some(table)
}

impl CarResults<'_> {
    /// Printed value of a result in a case. `None` if the case has no equilibrium, or if the result is undefined in it.
    pub(super) fn target_value(&self, case: usize, quantity: CarQuantity) -> Option<f64> {
        match &self.states[case] {
            CarState::Solved { solved, .. } => quantity.printed(solved, &self.study.cases[case]),
            CarState::Failed(_) => None,
        }
    }

    /// Targets of a tuning: of load cases, then of axles alone. `self` has the results of the tuned car, and `before` the results
    /// of the car before the tuning. `x` has the tuned values of the variables.
    pub fn target_records(
        &self,
        wanted: &CarOptimise,
        before: &CarResults<'_>,
        x: &[f64],
    ) -> Vec<CarTargetRecord> {
        let finite = |limit: f64| limit.is_finite().then_some(limit);
        let of_cases = wanted.targets.iter().map(|target| {
            let value = |of: &CarResults<'_>| of.target_value(target.case, target.quantity);
            let after = value(self);
            CarTargetRecord {
                output: target.quantity.column(self.study.car.length_unit),
                case: self.study.cases[target.case].name.clone(),
                wanted: target.wanted.map(finite),
                tolerance: target.tolerance,
                values: [value(before), after],
                deviation: after.map(|value| target.deviation(value) / target.tolerance),
                curve: None,
            }
        });
        let mut records: Vec<CarTargetRecord> = of_cases.collect();
        for (end, name, goals, outcomes) in rigs(before.study, wanted, x) {
            let length = before.study.axles[end].wheel().length_unit;
            for (number, target) in goals.optimise.targets.iter().enumerate() {
                let rms = outcomes.each_ref().map(|outcome| {
                    let outcome = outcome.as_ref()?;
                    Some(outcome.targets[number].rms)
                });
                let tolerance = (target.tolerance * target.of.factor()).abs();
                let output = format!("{}_rms_deviation", target.name(length));
                records.push(CarTargetRecord {
                    output: with_unit(output, &target.of.unit.suffix(length)),
                    case: format!("{name} axle alone"),
                    wanted: [Some(0.0); 2],
                    tolerance,
                    values: rms.map(|rms| Some(rms? * tolerance)),
                    // The largest deviation along the curve or band of the target is shown, as in reports of an axle.
                    deviation: outcomes[1]
                        .as_ref()
                        .map(|found| found.targets[number].worst),
                    curve: Some(of_curve(target)),
                });
            }
        }
        records
    }

    /// Constraints of a tuning. `prices` has the price of each constraint: the decrease of the misfit per unit of its limit. The
    /// other arguments are the same as in [`CarResults::target_records`].
    pub fn constraint_records(
        &self,
        wanted: &CarOptimise,
        before: &CarResults<'_>,
        x: &[f64],
        prices: &[Price],
    ) -> Vec<CarConstraintRecord> {
        let finite = |limit: f64| limit.is_finite().then_some(limit);
        let of_cases = wanted.constraints.iter().map(|own| {
            let [low, high] = own.between;
            let margin = |of: &CarResults<'_>| {
                let value = of.target_value(own.case, own.quantity)?;
                Some((value - low).min(high - value))
            };
            let margins = [margin(before), margin(self)];
            CarConstraintRecord {
                name: own.name.clone(),
                place: self.study.cases[own.case].name.clone(),
                limits: own.between.map(finite),
                unit: own.quantity.info().unit.suffix(self.study.car.length_unit),
                margins,
                is_of_axle: false,
                status: Some(status(margins[1], own.visible)),
                price: None,
                price_not_determined: false,
            }
        });
        let mut records: Vec<CarConstraintRecord> = of_cases.collect();
        for (_, name, goals, outcomes) in rigs(before.study, wanted, x) {
            for (number, own) in goals.optimise.constraints.iter().enumerate() {
                let margin = |outcome: &Option<RigOutcome>| {
                    let margin = outcome.as_ref()?.margins[number];
                    finite(margin)
                };
                let margins = outcomes.each_ref().map(margin);
                let part = own.parts.first();
                records.push(CarConstraintRecord {
                    name: own.name.clone(),
                    place: format!("{name} axle alone"),
                    limits: common_limits(own),
                    unit: part.map_or(String::new(), |part| part.unit.clone()),
                    margins,
                    is_of_axle: true,
                    status: Some(status(margins[1], part.map_or(1.0, |part| part.visible))),
                    price: None,
                    price_not_determined: false,
                });
            }
        }
        for (record, price) in records.iter_mut().zip(prices) {
            record.price = price.per_unit();
            record.price_not_determined = *price == Price::NotDetermined;
        }
        records
    }

    /// Variables of a tuning with their values before and after it: offsets of hardpoints, and values of all other variables.
    /// `before` is the study before the tuning.
    pub fn variable_records(&self, before: &CarStudy, fit: &Fit) -> Vec<CarVariableRecord> {
        let variables = before.optimise.iter().flat_map(|o| &o.variables);
        let record = |(number, variable): (usize, &CarVariable)| CarVariableRecord {
            name: variable.moves.label(&before.car),
            before: variable.moves.value(&before.car),
            after: fit.x[number],
            range: variable.range,
            at_bound: bound_in_words(fit.active_bounds[number]),
        };
        variables.enumerate().map(record).collect()
    }
}

/// Table of the variables of a tuning.
pub fn car_variables_table(records: &[CarVariableRecord]) -> Table {
    let names = ["variable", "lowest", "highest", "before", "after", "bound"];
    let mut table = Table::new(names);
    for own in records {
        let cell = |value: f64| Cell::shown(value, figure(value, ""));
        let bound = own.at_bound.as_ref();
        let cells: [Cell; 6] = [
            own.name.as_str().into(),
            cell(own.range[0]),
            cell(own.range[1]),
            Cell::by(own.before, |value| figure(value, "")),
            cell(own.after),
            bound.map(|side| format!("at {side} bound")).into(),
        ];
        table.push(cells);
    }
    table
}

/// Status of a constraint with this margin, or without a known margin. `visible` is the violation that counts as 1, in the unit of
/// the margin.
fn status(margin: Option<f64>, visible: f64) -> ConstraintStatus {
    ConstraintStatus::of(margin.unwrap_or(f64::NAN) / visible)
}

/// Limits of a constraint of an axle. Both limits are `None` if the parts of the constraint have different limits.
fn common_limits(constraint: &Constraint) -> [Option<f64>; 2] {
    let mut limits = constraint.parts.iter().map(|part| part.limits());
    let first = limits.next().unwrap_or_default();
    if limits.all(|other| other == first) {
        first
    } else {
        [None; 2]
    }
}

/// Targets and constraints of one axle alone: index and name of the axle, these goals, and their outcome before and after a tuning.
type Rig<'s> = (usize, &'static str, &'s RigGoals, [Option<RigOutcome>; 2]);

/// Axles with targets or constraints of their own, each with two outcomes: in the design of the study, and with the variables at
/// `x`.
fn rigs<'s>(study: &CarStudy, wanted: &'s CarOptimise, x: &[f64]) -> Vec<Rig<'s>> {
    let mut found = Vec::new();
    let start = vec![0.0; x.len()];
    for (end, name) in crate::car::AXLE_NAMES.into_iter().enumerate() {
        let Some(goals) = &wanted.rigs[end] else {
            continue;
        };
        // In the design of the study, the offsets of hardpoints are 0.
        let outcomes = [start.as_slice(), x].map(|x| {
            let outcome = goals.outcome(&study.axles[end].vehicle, x);
            outcome.ok()
        });
        found.push((end, name, goals, outcomes));
    }
    found
}
