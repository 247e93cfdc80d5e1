//! Targets and variables of a tuned car, for the terminal and for programs.

use super::{CarResults, CarState};
use crate::car::{CarQuantity, CarTarget};
use crate::report::figure;
use crate::report::table::{Cell, Table};
use crate::study::{CarOptimise, CarStudy};
use serde_json::{Value, json};

/// The wanted value or band, for the terminal.
fn wanted_cell(target: &CarTarget, unit: &str) -> Cell {
    let [low, high] = target.wanted;
    match (low.is_finite(), high.is_finite()) {
        _ if low == high => Cell::figure(low, unit),
        (true, true) => format!("{} to {}", figure(low, unit), figure(high, unit)).into(),
        (true, false) => format!("at least {}", figure(low, unit)).into(),
        _ => format!("at most {}", figure(high, unit)).into(),
    }
}

impl CarResults<'_> {
    pub(super) fn target_value(&self, case: usize, quantity: CarQuantity) -> Option<f64> {
        match &self.states[case] {
            CarState::Solved { solved, .. } => quantity.printed(solved, &self.study.cases[case]),
            CarState::Failed(_) => None,
        }
    }

    /// Targets with their values for the terminal.
    pub fn targets_table(&self, wanted: &CarOptimise, before: &CarResults<'_>) -> Table {
        let mut table = Table::new(["target", "case", "wanted", "before", "after", "tolerance"]);
        for target in &wanted.targets {
            let unit = target
                .quantity
                .info()
                .unit
                .suffix(self.study.car.length_unit);
            let cell = |value: Option<f64>| Cell::by(value, |value| figure(value, &unit));
            let cells: [Cell; 6] = [
                target
                    .quantity
                    .column(self.study.car.length_unit)
                    .as_str()
                    .into(),
                self.study.cases[target.case].name.as_str().into(),
                wanted_cell(target, &unit),
                cell(before.target_value(target.case, target.quantity)),
                cell(self.target_value(target.case, target.quantity)),
                cell(Some(target.tolerance)),
            ];
            table.push(cells);
        }
        table
    }

    /// Targets with their values for programs.
    pub fn targets_json(&self, wanted: &CarOptimise) -> Value {
        let targets = wanted.targets.iter().map(|target| {
            json!({
                "name": target.quantity.column(self.study.car.length_unit),
                "case": self.study.cases[target.case].name,
                "wanted": match target.wanted {
                    [low, high] if low == high => json!(low),
                    // A side without a limit is null.
                    limits => json!(limits),
                },
                "tolerance": target.tolerance,
                "value": self.target_value(target.case, target.quantity),
            })
        });
        targets.collect()
    }

    /// Variables for the terminal; offsets of hardpoints, values of the rest.
    pub fn variables_table(&self, before: &CarStudy, x: &[f64]) -> Table {
        let mut table = Table::new(["variable", "lowest", "highest", "before", "after"]);
        for (variable, value) in before.optimise.iter().flat_map(|o| &o.variables).zip(x) {
            let cell = |value: f64| Cell::shown(value, figure(value, ""));
            let cells: [Cell; 5] = [
                variable.moves.label(&before.car).as_str().into(),
                cell(variable.range[0]),
                cell(variable.range[1]),
                cell(variable.moves.value(&before.car).unwrap_or(f64::NAN)),
                cell(*value),
            ];
            table.push(cells);
        }
        table
    }

    /// Variables for programs.
    pub fn variables_json(&self, before: &CarStudy, x: &[f64]) -> Value {
        let variables = before.optimise.iter().flat_map(|o| &o.variables).zip(x);
        variables
            .map(|(variable, value)| {
                json!({
                    "name": variable.moves.label(&before.car),
                    "before": variable.moves.value(&before.car),
                    "after": value,
                    "range": variable.range,
                })
            })
            .collect()
    }
}
