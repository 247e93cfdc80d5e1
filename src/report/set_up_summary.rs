//! Result of a set-up: effects of the adjustments, instructions for a mechanic, and errors before and after rounding.

mod effect;
mod instruction;

use super::figure::finite;
use super::table::{Cell, Column, Table};
use super::{brief, ends_at};
use crate::ask::with_unit;
use crate::assembly::{
    Aim, AssemblyError, BuildParameter, MissedTarget, SetUp, SetUpError, Static,
};
use crate::model::LengthUnit;
use crate::study::{Adjustment, Increment, Setup, Study};
use effect::{effect_in_words, effect_of_step};
use instruction::instruction;
use serde::Serialize;

/// Wheels of an axle to which a set-up applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SetUpSide {
    /// Both wheels, one as the mirror image of the other.
    Both,
    /// The left wheel.
    Left,
    /// Right wheel. Amounts along y are those of its mirror image, which is a left wheel.
    Right,
}

impl SetUpSide {
    /// Name of the side in tables.
    pub fn name(self) -> &'static str {
        match self {
            SetUpSide::Both => "both",
            SetUpSide::Left => "left",
            SetUpSide::Right => "right",
        }
    }

    /// Wheels in words.
    pub fn wheels(self) -> &'static str {
        match self {
            SetUpSide::Both => "both wheels",
            SetUpSide::Left => "left wheel",
            SetUpSide::Right => "right wheel",
        }
    }
}

/// Results of a set-up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SetUpSummary {
    /// Name of the study.
    pub study: String,
    /// Wheels that are set up, if the study describes an axle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side: Option<SetUpSide>,
    /// True if every target is met, both with the computed and with the rounded amounts. Errors up to `allowed` and
    /// `allowed_rounded` count as met.
    pub met: bool,
    /// Static values, with their targets and results.
    pub statics: Vec<StaticRecord>,
    /// Adjustments in the order of the mechanic's work.
    pub adjustments: Vec<AdjustmentRecord>,
    /// Symbol of the length unit.
    unit: String,
    /// True if an adjustment moves a point.
    #[serde(skip)]
    moves_points: bool,
}

/// A static value with its target and results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StaticRecord {
    /// Name of the static value, with its unit.
    pub column: String,
    /// Static value of the nominal design.
    pub nominal: Option<f64>,
    /// Static value with the computed amounts of all adjustments. For a shim, the computed amount is a whole number of shims.
    pub set: Option<f64>,
    /// Target value, or the nominal value that the set-up keeps (see `kept`). `None` without a target.
    pub wanted: Option<f64>,
    /// True if the study has no target for this value, but the set-up keeps it at its nominal value.
    pub kept: bool,
    /// Static value with the computed amounts minus target value.
    pub miss: Option<f64>,
    /// Allowed size of `miss`: effect of half a step of each shim adjustment. 0 for a value that a thread sets.
    pub allowed: f64,
    /// Static value with the rounded amounts of all adjustments, which a mechanic can set.
    pub set_rounded: Option<f64>,
    /// Static value with the rounded amounts minus target value.
    pub miss_rounded: Option<f64>,
    /// Allowed size of `miss_rounded`: `allowed`, plus the effect of half a sixteenth of a turn of each threaded adjuster. For
    /// lengths without a thread or shims, half the smallest change counts.
    pub allowed_rounded: f64,
    /// True if the target counts as met with the computed amounts.
    pub met: bool,
    /// True if the target counts as met with the rounded amounts.
    pub met_rounded: bool,
}

/// An adjustment with its amounts and effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AdjustmentRecord {
    /// Name of the adjustment.
    pub adjustment: String,
    /// Instruction for a mechanic with the rounded amount, such as "shorten by 1/16 turn".
    pub instruction: String,
    /// Computed amount, in the length unit. Positive: the part becomes longer, or the point moves along the positive axis of the
    /// study (for a right wheel: of its mirror image).
    pub amount: f64,
    /// Computed amount in turns, for a threaded adjuster.
    pub turns: Option<f64>,
    /// Number of shims of the computed amount, with the sign of `amount`. `None` without shims.
    pub shims: Option<f64>,
    /// Rounded amount of the adjustment, which a mechanic can set, in the length unit.
    pub amount_rounded: f64,
    /// Rounded amount of the adjustment, which a mechanic can set, in turns, for a threaded adjuster.
    pub turns_rounded: Option<f64>,
    /// Change of each static value per length unit of this adjustment, at the nominal design.
    pub by_length: Vec<Option<f64>>,
    /// Change of each static value per turn of this adjustment, for a threaded adjuster.
    pub by_turn: Option<Vec<Option<f64>>>,
    /// Static values after this step (adjustment), with the computed amounts.
    pub after: Vec<Option<f64>>,
    /// Change of each static value in this step (adjustment), with the rounded amount.
    pub effect: Vec<Option<f64>>,
    /// These changes of static values in words, such as "camber -0.42 deg, toe +0.03 deg". Changes that a mechanic cannot measure
    /// are left out.
    pub effect_in_words: String,
}

impl SetUpSummary {
    /// Summarises a set-up of a study. `found` may also be a nominal design without a set-up; then all amounts are 0.
    pub fn of(study: &Study, setup: &Setup, side: Option<SetUpSide>, found: &SetUp) -> Self {
        let length = study.wheel().length_unit;
        let (misses, rounded) = (found.misses(), found.misses_rounded());
        let (met, met_rounded) = (found.met(), found.met_rounded());
        let statics = found.statics.iter().enumerate();
        let statics = statics.map(|(i, value)| StaticRecord {
            column: static_column(*value, length),
            nominal: finite(found.drawn.values[i]),
            set: finite(found.last().values[i]),
            wanted: found.aims[i].value().map(|v| v + 0.0),
            kept: matches!(found.aims[i], Aim::Kept(_)),
            miss: misses[i],
            allowed: found.allowed[i],
            set_rounded: finite(found.rounded.values[i]),
            miss_rounded: rounded[i],
            allowed_rounded: found.allowed_rounded[i],
            met: met[i],
            met_rounded: met_rounded[i],
        });
        let adjustments = found.order.iter().enumerate();
        let adjustments = adjustments.map(|(place, k)| {
            let after = found.steps.get(place).unwrap_or(&found.drawn);
            let adjustment = &setup.adjust[*k];
            let instruction =
                instruction(adjustment, study.wheel(), found.rounded.amounts[*k] + 0.0);
            let effect = effect_of_step(found, place);
            AdjustmentRecord {
                effect_in_words: effect_in_words(&found.statics, &effect, length),
                effect,
                ..adjustment_record(adjustment, *k, found, &after.values, instruction)
            }
        });
        SetUpSummary {
            study: study.name.clone(),
            side,
            met: found.is_met(),
            statics: statics.collect(),
            adjustments: adjustments.collect(),
            unit: length.symbol().to_owned(),
            moves_points: setup
                .adjust
                .iter()
                .any(|own| matches!(own.change.0, BuildParameter::Coordinate(..))),
        }
    }

    /// Machine-readable table of the effects of the adjustments. Each adjustment has a row with effects per length unit, and a row
    /// with effects per turn if its `per_turn` is known.
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

    /// Table of the effects for the text output and the page: one row per static value of each adjustment, so that no name needs a
    /// line break.
    pub fn effects_for_readers(&self) -> Table {
        let has_turns = self.adjustments.iter().any(|a| a.by_turn.is_some());
        let mut header = vec!["adjustment".to_owned(), "static value".to_owned()];
        header.push(format!("per {}", self.unit));
        if has_turns {
            header.push("per turn".to_owned());
        }
        let mut table = Table::with_columns(header);
        for adjustment in &self.adjustments {
            for (i, value) in self.statics.iter().enumerate() {
                let name = adjustment.adjustment.as_str();
                let mut row = vec![if i == 0 {
                    name.into()
                } else {
                    Cell::repeated(name)
                }];
                row.push(value.column.as_str().into());
                row.push(figure(adjustment.by_length[i]));
                if has_turns {
                    row.push(figure(adjustment.by_turn.as_ref().and_then(|by| by[i])));
                }
                table.push_row(row);
            }
        }
        table.keyed(2)
    }

    /// Explains the signs and the meaning of shims in the tables of effects. `None` if the set-up moves no points.
    pub fn effects_note(&self) -> Option<&'static str> {
        self.moves_points.then_some(match self.side {
            Some(SetUpSide::Both | SetUpSide::Right) => {
                "A positive amount of a shim moves the point along the positive axis of the study, relative to the part that \
                 carries the point. At the right wheel, the direction along y is reversed, because this wheel is treated as \
                 its mirror image."
            }
            None | Some(SetUpSide::Left) => {
                "A positive amount of a shim moves the point along the positive axis of the study, relative to the part that \
                 carries the point."
            }
        })
    }

    /// Machine-readable table of the steps: the adjustments in order, with the static values after each of them. Further rows have
    /// the static values of the nominal design, their targets, and their values with the rounded amounts.
    pub fn steps_table(&self) -> Table {
        let amount = format!("amount {}", self.unit);
        let columns = ["step".to_owned(), amount, "turns".into(), "shims".into()];
        let statics = self.statics.iter().map(|s| s.column.clone());
        let rounded = [
            format!("amount rounded {}", self.unit),
            "turns rounded".into(),
            "instruction".into(),
        ];
        let columns = columns.into_iter().chain(statics).chain(rounded);
        let mut table = Table::with_columns(columns);
        let row = |name: &str, a: Option<&AdjustmentRecord>, values: Vec<Option<f64>>| {
            let amounts = [a.map(|a| a.amount), a.and_then(|a| a.turns)];
            let amounts = amounts.into_iter().chain([a.and_then(|a| a.shims)]);
            let rounded = [a.map(|a| a.amount_rounded), a.and_then(|a| a.turns_rounded)];
            let numbers = amounts.chain(values).chain(rounded).map(figure);
            let instruction = a.map(|a| a.instruction.as_str());
            let cells = [Cell::from(name)].into_iter().chain(numbers);
            cells.chain([instruction.into()]).collect::<Vec<_>>()
        };
        let of = |f: fn(&StaticRecord) -> Option<f64>| self.statics.iter().map(f).collect();
        table.push_row(row("nominal", None, of(|s| s.nominal)));
        for a in &self.adjustments {
            table.push_row(row(&a.adjustment, Some(a), a.after.clone()));
        }
        if self.statics.iter().any(|s| s.wanted.is_some()) {
            table.push_row(row("wanted", None, of(|s| s.wanted)));
        }
        table.push_row(row("rounded", None, of(|s| s.set_rounded)));
        table
    }

    /// Table of instructions for a mechanic, one row per adjustment.
    pub fn instructions(&self) -> Table {
        let amount = format!("computed {}", self.unit);
        let has_turns = self.adjustments.iter().any(|a| a.turns.is_some());
        let mut header = vec!["step".to_owned(), "adjustment".into(), "do".into(), amount];
        if has_turns {
            header.push("computed turns".to_owned());
        }
        let mut table = Table::with_columns(header);
        for (number, a) in self.adjustments.iter().enumerate() {
            let mut row: Vec<Cell> = vec![(number + 1).into(), a.adjustment.as_str().into()];
            row.push(a.instruction.as_str().into());
            row.push(figure(Some(a.amount)));
            if has_turns {
                row.push(figure(a.turns));
            }
            table.push_row(row);
        }
        table
    }

    /// Table of the effects of the instructions in words, one row per step.
    pub fn effects_of_steps(&self) -> Table {
        let mut table = Table::new(["step", "effect"]);
        for (number, a) in self.adjustments.iter().enumerate() {
            let effect = Cell::from(a.effect_in_words.as_str());
            table.push_row([Cell::from(number + 1), effect]);
        }
        table
    }

    /// Tables of the static values: at the nominal design, and after each step with the computed amounts. Each table has only a
    /// few steps, so that no name needs a line break.
    pub fn values_after_steps(&self) -> Vec<Table> {
        const MOST: usize = 5;
        let nominal = self.statics.iter().map(|s| s.nominal).collect();
        let mut columns: Vec<(String, Vec<Option<f64>>)> = vec![("nominal".to_owned(), nominal)];
        for (number, a) in self.adjustments.iter().enumerate() {
            columns.push((format!("step {}", number + 1), a.after.clone()));
        }
        let tables = columns.chunks(MOST).map(|columns| {
            let header = columns.iter().map(|(name, _)| name.clone());
            let header = ["static value".to_owned()].into_iter().chain(header);
            let mut table = Table::with_columns(header.map(Column::from));
            for (i, value) in self.statics.iter().enumerate() {
                let cells = columns.iter().map(|(_, values)| figure(values[i]));
                table.push_row([value.column.as_str().into()].into_iter().chain(cells));
            }
            table
        });
        tables.collect()
    }

    /// Table of the target values and the resulting static values. Each static value has a row with the computed and a row with the
    /// rounded amounts.
    pub fn results(&self) -> Table {
        let header = [
            "static value",
            "amounts",
            "wanted",
            "value",
            "error",
            "allowed",
            "met",
        ];
        let mut table = Table::new(header);
        for s in self.statics.iter().filter(|s| s.wanted.is_some()) {
            let name = if s.kept {
                format!("{} (kept)", s.column)
            } else {
                s.column.clone()
            };
            let mut push = |head: [Cell; 2], value, miss, allowed, met: bool| {
                let numbers = [s.wanted, value, miss, Some(allowed)].map(figure);
                table.push_row(head.into_iter().chain(numbers).chain([met.into()]));
            };
            let head = [Cell::from(name.as_str()), "computed".into()];
            push(head, s.set, s.miss, s.allowed, s.met);
            let head = [Cell::repeated(&name), "rounded".into()];
            push(
                head,
                s.set_rounded,
                s.miss_rounded,
                s.allowed_rounded,
                s.met_rounded,
            );
        }
        table.keyed(2)
    }

    /// Static values whose error exceeds the allowed error, with the computed or with the rounded amounts.
    pub fn not_met(&self) -> impl Iterator<Item = &StaticRecord> {
        self.statics.iter().filter(|s| !(s.met && s.met_rounded))
    }
}

/// Record of the `k`-th adjustment of a study without its effect. `after` has the static values after the adjustment.
fn adjustment_record(
    adjustment: &Adjustment,
    k: usize,
    found: &SetUp,
    after: &[f64],
    instruction: String,
) -> AdjustmentRecord {
    let amount = found.last().amounts[k] + 0.0;
    let amount_rounded = found.rounded.amounts[k] + 0.0;
    let by = &found.drawn.by[k];
    let turn = match adjustment.increment {
        Increment::Thread { per_turn } => Some(per_turn),
        Increment::Shims { .. } | Increment::Free => None,
    };
    AdjustmentRecord {
        adjustment: adjustment.name.clone(),
        instruction,
        amount,
        turns: turn.map(|turn| amount / turn),
        shims: match adjustment.increment {
            Increment::Shims { step } => Some((amount / step).round() + 0.0),
            Increment::Thread { .. } | Increment::Free => None,
        },
        amount_rounded,
        turns_rounded: turn.map(|turn| amount_rounded / turn),
        by_length: by.iter().map(|v| finite(*v)).collect(),
        by_turn: turn.map(|turn| by.iter().map(|v| finite(v * turn)).collect()),
        after: after.iter().map(|v| finite(*v)).collect(),
        effect: Vec::new(),
        effect_in_words: String::new(),
    }
}

/// Name of a static value with its unit.
pub fn static_column(value: Static, length: LengthUnit) -> String {
    with_unit(static_name(value), &value.unit().suffix(length))
}

/// Name of a static value without its unit.
fn static_name(value: Static) -> String {
    match value {
        Static::Characteristic(c) => c.info().name.to_owned(),
        Static::Axle(quantity) => quantity.name(),
        Static::RideHeightChange => "ride_height_change".to_owned(),
    }
}

/// Table cell with a number for people: six digits. A value below 1e-9 becomes 0.
fn figure(value: Option<f64>) -> Cell {
    Cell::by(value, |value| {
        if value.abs() < 1e-9 {
            "0".to_owned()
        } else {
            brief(value)
        }
    })
}

/// Reason in words why there is no set-up.
pub fn set_up_refusal(study: &Study, setup: &Setup, none: &SetUpError) -> String {
    let length = study.wheel().length_unit;
    match none {
        SetUpError::Fault(reason) => reason.describe(&study.wheel().mechanism),
        SetUpError::NoEquilibrium(reason) => reason.describe(length, study.wheel().frame),
        SetUpError::AssemblyError(AssemblyError::OutOfReach { share }) => format!(
            "the links are too short or too long for the target height and the adjusted parts: the mechanism \
             can be assembled for only {:.0} % of the change from the design",
            100.0 * share
        ),
        SetUpError::AssemblyError(reject) => reject.to_string(),
        SetUpError::Absurd { adjustment, amount } => format!(
            "the target values need an adjustment of {} {} at {}, more than a tenth of the size of the suspension",
            brief(*amount),
            length.symbol(),
            setup.adjust[*adjustment].name
        ),
        SetUpError::OutOfReach(missed) => {
            let words = |miss: &MissedTarget| {
                let column = static_column(miss.of, length);
                if miss.value.is_finite() {
                    format!("{column} {}", ends_at(miss.value, miss.wanted))
                } else {
                    format!(
                        "{column} has no value, but the target is {}",
                        brief(miss.wanted)
                    )
                }
            };
            let missed: Vec<String> = missed.iter().map(words).collect();
            format!("the target values cannot be reached: {}", missed.join("; "))
        }
        SetUpError::Unsettled => {
            "the target values cannot be reached: the adjustments change none of them".to_owned()
        }
    }
}
