//! The result of a set-up: the effect of a length unit or a turn of each adjustment, and the steps to the wanted
//! values.

use super::table::{Cell, Table};
use crate::assembly::{SetUp, Static};
use crate::model::LengthUnit;
use crate::study::{Setup, Study};
use serde::Serialize;

/// A set-up in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SetUpSummary {
    /// Name of the study.
    pub study: String,
    /// Whether every wanted value is met, but for whole steps of shims.
    pub met: bool,
    /// Static values.
    pub statics: Vec<StaticRecord>,
    /// Adjustments in the order a mechanic does them.
    pub adjustments: Vec<AdjustmentRecord>,
    unit: String,
}

/// A static value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StaticRecord {
    /// Name with unit.
    pub column: String,
    /// The value with the parts as drawn.
    pub drawn: Option<f64>,
    /// The value with the parts adjusted.
    pub set: Option<f64>,
    /// The wanted value, if there is one.
    pub wanted: Option<f64>,
    /// The value set minus the wanted one.
    pub miss: Option<f64>,
}

/// An adjustment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AdjustmentRecord {
    /// Name.
    pub adjustment: String,
    /// Amount of the adjustment, in length units.
    pub amount: f64,
    /// The same amount in turns, if it is made by a thread.
    pub turns: Option<f64>,
    /// In shims.
    pub shims: Option<f64>,
    /// Change of each static value by a length unit of it, about the parts as drawn.
    pub by_length: Vec<Option<f64>>,
    /// Change of each static value by a turn of it.
    pub by_turn: Option<Vec<Option<f64>>>,
    /// The static values once this has been done.
    pub after: Vec<Option<f64>>,
}

impl SetUpSummary {
    /// Summary of the set-up that was found for a study.
    pub fn of(study: &Study, setup: &Setup, found: &SetUp) -> Self {
        let length = study.suspension.length_unit;
        let finite = |v: f64| v.is_finite().then_some(v + 0.0);
        let columns = found.statics.iter().map(|s| static_column(*s, length));
        let misses = found.misses();
        let statics = columns.enumerate().map(|(i, column)| StaticRecord {
            column,
            drawn: finite(found.drawn.values[i]),
            set: finite(found.last().values[i]),
            wanted: found.wanted[i],
            miss: misses[i],
        });
        let adjustments = setup.adjust.iter().enumerate();
        let adjustments = adjustments.map(|(k, adjustment)| {
            let after = found.steps.get(k).unwrap_or(&found.drawn);
            let amount = found.last().amounts[k] + 0.0;
            let by = &found.drawn.by[k];
            AdjustmentRecord {
                adjustment: adjustment.name.clone(),
                amount,
                turns: adjustment.per_turn.map(|per| amount / per),
                shims: adjustment.step.map(|step| (amount / step).round()),
                by_length: by.iter().map(|v| finite(*v)).collect(),
                by_turn: adjustment
                    .per_turn
                    .map(|per| by.iter().map(|v| finite(v * per)).collect()),
                after: after.values.iter().map(|v| finite(*v)).collect(),
            }
        });
        SetUpSummary {
            study: study.name.clone(),
            met: found.is_met(),
            statics: statics.collect(),
            adjustments: adjustments.collect(),
            unit: length.symbol().to_owned(),
        }
    }

    /// A table of the effects of a length unit, or a turn, of each adjustment.
    pub fn effects_table(&self) -> Table {
        let columns = ["adjustment", "per"].map(str::to_owned);
        let statics = self.statics.iter().map(|s| s.column.clone());
        let mut table = Table::with_columns(columns.into_iter().chain(statics));
        for adjustment in &self.adjustments {
            let mut push = |per: &str, by: &[Option<f64>]| {
                let head = [Cell::from(adjustment.adjustment.as_str()), Cell::from(per)];
                let cells = by.iter().map(|v| figure(*v));
                table.push_row(head.into_iter().chain(cells));
            };
            push(&self.unit, &adjustment.by_length);
            if let Some(by) = &adjustment.by_turn {
                push("turn", by);
            }
        }
        table.keyed(2)
    }

    /// A table of the adjustments to make, step by step, with the static values after each.
    pub fn steps_table(&self) -> Table {
        let amount = format!("amount {}", self.unit);
        let columns = ["step".to_owned(), amount, "turns".into(), "shims".into()];
        let statics = self.statics.iter().map(|s| s.column.clone());
        let mut table = Table::with_columns(columns.into_iter().chain(statics));
        let row = |name: &str, amounts: [Option<f64>; 3], values: Vec<Option<f64>>| {
            let head = [Cell::from(name)];
            let numbers = amounts.into_iter().chain(values).map(figure);
            head.into_iter().chain(numbers).collect::<Vec<_>>()
        };
        let drawn = self.statics.iter().map(|s| s.drawn).collect();
        table.push_row(row("as drawn", [None; 3], drawn));
        for a in &self.adjustments {
            let amounts = [Some(a.amount), a.turns, a.shims];
            table.push_row(row(&a.adjustment, amounts, a.after.clone()));
        }
        let wanted: Vec<_> = self.statics.iter().map(|s| s.wanted).collect();
        if wanted.iter().any(Option::is_some) {
            table.push_row(row("wanted", [None; 3], wanted));
        }
        table
    }

    /// Wanted values that are missed by more than rounding, each with by how much.
    pub fn missed(&self) -> impl Iterator<Item = (&str, f64)> {
        let missed = self
            .statics
            .iter()
            .filter_map(|s| Some((&*s.column, s.miss?)));
        missed.filter(|(_, miss)| miss.abs() > 1e-6)
    }
}

/// The name of a static value, with its unit.
pub fn static_column(value: Static, length: LengthUnit) -> String {
    match value {
        Static::Characteristic(c) => c.column(length),
        Static::RideHeight => format!("ride_height_{}", length.symbol()),
    }
}

/// A number with a few digits to a reader; what is rounding is 0.
fn figure(value: Option<f64>) -> Cell {
    Cell::by(value, |value| match value.abs() < 1e-9 {
        true => "0".to_owned(),
        false => super::brief(value),
    })
}
