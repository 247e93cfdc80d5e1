//! Bounds of variables that keep targets from being met.

use super::*;
use crate::optimise::HoldingBound;

/// Largest number of bounds that the terminal shows for a target.
const MOST_BOUNDS: usize = 4;

/// A bound of a variable that keeps a target from being met, and the effect of moving this bound outwards.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct HoldingRecord {
    /// Name of the missed target.
    target: String,
    /// Name of the variable.
    variable: String,
    /// End of the variable's range: `lower` or `upper`.
    bound: String,
    /// Value of the variable at the bound, in `variable_unit`.
    limit: f64,
    /// Unit of the variable: `mm`. `factor` if the variable is the logarithm of a factor.
    variable_unit: String,
    /// Change of the target's root mean square deviation per unit by which the bound moves outwards, in `unit`.
    deviation_per_unit: f64,
    /// Unit of the target; empty for a plain number.
    unit: String,
    /// Change of the misfit per unit by which the bound moves outwards.
    misfit_per_unit: f64,
}

/// A target that is missed: its name, its root mean square deviation, and the unit of this deviation.
pub(in crate::report) struct Missed {
    pub name: String,
    pub rms: f64,
    pub unit: String,
}

/// A variable of a tuning: its name, its unit and its range.
pub(in crate::report) struct Moved {
    pub name: String,
    pub unit: String,
    pub range: [f64; 2],
}

impl HoldingRecord {
    /// Makes the records, target by target. `missed` returns the target with an index, if it is missed. `moved` returns the
    /// variable with an index.
    pub(in crate::report) fn all(
        targets: usize,
        found: &[HoldingBound],
        missed: impl Fn(usize) -> Option<Missed>,
        moved: impl Fn(usize) -> Moved,
    ) -> Vec<Self> {
        let mut records = Vec::new();
        for (number, missed) in (0..targets).filter_map(|k| Some((k, missed(k)?))) {
            let mut bounds: Vec<(&HoldingBound, Moved, f64)> = found
                .iter()
                .filter_map(|bound| {
                    let share = bound.targets.iter().find(|(target, _)| *target == number)?;
                    Some((bound, moved(bound.variable), share.1))
                })
                .collect();
            let effect = |(_, own, share): &(_, Moved, f64)| share * (own.range[1] - own.range[0]);
            bounds.sort_by(|a, b| effect(b).total_cmp(&effect(a)));
            records.extend(bounds.into_iter().map(|(bound, own, share)| HoldingRecord {
                target: missed.name.clone(),
                variable: own.name,
                bound: if bound.is_upper { "upper" } else { "lower" }.to_owned(),
                limit: own.range[usize::from(bound.is_upper)],
                variable_unit: own.unit,
                deviation_per_unit: -share * missed.rms,
                unit: missed.unit.clone(),
                misfit_per_unit: -bound.price,
            }));
        }
        records
    }

    /// Bound of the variable as an inequality: `strut_top y <= 20 mm`.
    fn limit_in_words(&self) -> String {
        let sign = if self.bound == "upper" { "<=" } else { ">=" };
        let limit = match self.variable_unit.as_str() {
            "factor" => format!("factor {}", brief(to_digits(self.limit.exp(), 4))),
            unit => with_unit(self.limit, unit),
        };
        format!("{} {sign} {limit}", self.variable)
    }

    /// Change per unit by which the bound moves, in words with two digits: `-0.041 deg per mm`. For a factor, the change belongs to
    /// a change of the factor by 10 %.
    fn change_in_words(&self, per_unit: f64, unit: &str) -> String {
        let (change, per) = match self.variable_unit.as_str() {
            "factor" => (per_unit * 1.1_f64.ln(), "10 %"),
            "" => (per_unit, "unit"),
            own => (per_unit, own),
        };
        format!("{} per {per}", with_unit(to_digits(change, 2), unit))
    }
}

/// Table of the bounds that keep targets from being met.
pub fn holding_table(records: &[HoldingRecord]) -> Table {
    let readers = ["missed target", "held by bound", "rms deviation", "misfit"];
    let programs = [
        "target",
        "variable",
        "bound",
        "limit",
        "variable unit",
        "rms deviation per unit",
        "unit",
        "misfit per unit",
    ];
    let readers = readers.map(Column::for_readers).into_iter();
    let mut table = Table::with_columns(readers.chain(programs.map(Column::for_programs)));
    for own in records {
        table.push([
            Cell::from(own.target.as_str()),
            own.limit_in_words().into(),
            own.change_in_words(own.deviation_per_unit, &own.unit)
                .into(),
            own.change_in_words(own.misfit_per_unit, "").into(),
            own.target.as_str().into(),
            own.variable.as_str().into(),
            own.bound.as_str().into(),
            own.limit.into(),
            own.variable_unit.as_str().into(),
            own.deviation_per_unit.into(),
            own.unit.as_str().into(),
            own.misfit_per_unit.into(),
        ]);
    }
    table
}

/// Records for the terminal: up to four bounds for each target. Also returns the number of records that are left out.
pub fn shown_holding(records: &[HoldingRecord]) -> (Vec<HoldingRecord>, usize) {
    let mut shown: Vec<HoldingRecord> = Vec::new();
    for own in records {
        let of_target = shown.iter().filter(|other| other.target == own.target);
        if of_target.count() < MOST_BOUNDS {
            shown.push(own.clone());
        }
    }
    let more = records.len() - shown.len();
    (shown, more)
}

/// Meaning of the effects in [`holding_table`].
pub const HOLDING_NOTE: &str = "bounds reached at the smallest misfit; changes to first order, if this bound moves outwards \
     and the tuning runs again";

/// Sentence about a missed target that no bound of a variable keeps from being met.
pub(in crate::report) fn not_held_in_words(target: &str) -> String {
    format!(
        "no bound of a variable keeps {target} from its goal: other targets, constraints or the geometry do"
    )
}

/// Sentences about missed targets that no bound keeps from being met. `missed` has the names of targets on which the variables have
/// an effect.
pub(in crate::report) fn not_held(missed: &[&str], records: &[HoldingRecord]) -> Vec<String> {
    let is_held = |target: &str| records.iter().any(|own| own.target == target);
    let others = missed.iter().filter(|target| !is_held(target));
    others.map(|target| not_held_in_words(target)).collect()
}
