//! Chooses the designs that the page shows, if it cannot show all designs.

use super::SweepSummary;
use crate::sweep::{Rows, SweepRecord};
use serde::Serialize;
use std::collections::BTreeSet;

/// Largest number of values (variables and outputs of all designs) on a page.
const MOST_NUMBERS: usize = 45_000;
/// Largest number of designs on a page.
const MOST_DESIGNS: usize = 4_000;

/// Choice of the designs that the page shows: the best ones, the Pareto front, examples of failures, and some others at regular
/// intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Numbers of the designs that are always shown.
    always: BTreeSet<u64>,
    /// Numbers of the designs of the Pareto front that are always shown. Of a large front, every n-th design.
    pub front: Vec<u64>,
    /// Designs whose number is a multiple of this stride are shown, too.
    pub every: u64,
}

impl Choice {
    /// Chooses the designs of a sweep that are shown, so that their number stays near the limits of a page.
    pub fn of(record: &SweepRecord, summary: &SweepSummary) -> Self {
        let room = (MOST_NUMBERS / record.columns().len()).clamp(2, MOST_DESIGNS);
        let mut always: BTreeSet<u64> = summary.best.iter().map(|d| d.design).collect();
        let failures = summary.failures.iter().take(room / 40);
        always.extend(failures.flat_map(|f| &f.examples));
        // With many targets, the Pareto front can contain most of the designs.
        let front = summary.pareto.as_deref().unwrap_or_default();
        let step = front.len().div_ceil(room / 2).max(1);
        let front: Vec<u64> = front.iter().copied().step_by(step).collect();
        always.extend(&front);
        let left = room.saturating_sub(always.len()).max(1);
        let every = stride(record, summary.done.div_ceil(left as u64));
        Choice {
            always,
            front,
            every,
        }
    }

    /// True if a design is shown.
    pub fn has(&self, design: u64) -> bool {
        design.is_multiple_of(self.every) || self.always.contains(&design)
    }
}

/// Smallest stride, at least `least`, that has no common divisor with the periods in the order of the designs. 1 if `least` is at
/// most 1. The periods are the step counts of grid variables, the group size of Saltelli's samples, and 2. An even stride would
/// restrict a Sobol sequence to a part of the ranges.
fn stride(record: &SweepRecord, least: u64) -> u64 {
    if least <= 1 {
        return 1;
    }
    let steps = record.variables.iter().filter_map(|v| v.steps);
    let periods: Vec<u64> = steps.chain(record.group()).chain([2]).collect();
    let free = |stride: &u64| periods.iter().all(|p| common_divisor(*p, *stride) == 1);
    (least..).find(free).unwrap_or(least)
}

fn common_divisor(a: u64, b: u64) -> u64 {
    match b {
        0 => a,
        b => common_divisor(b, a % b),
    }
}

/// Rows of designs, stored column by column.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ShownDesigns {
    /// Numbers of the designs, in rising order.
    pub design: Vec<u64>,
    /// Values of the designs as `[column][row]`: variables, then outputs. `None` for a missing value.
    pub columns: Vec<Vec<Option<f64>>>,
    /// For each row, the index in `reasons` of the reason why the design was not solved everywhere. `None` for a solved design.
    pub failing: Vec<Option<usize>>,
    /// For each row, the drive value (travel or angle) of the failed station that is nearest to the design position. `None` for a
    /// solved design.
    pub failed_at: Vec<Option<f64>>,
    /// Different failures of designs, each with its status and reason.
    pub reasons: Vec<[String; 2]>,
}

impl ShownDesigns {
    /// Adds the chosen designs of a block. The blocks must come in rising order.
    pub fn take(&mut self, rows: &Rows, choice: &Choice) {
        for place in 0..rows.designs() {
            let design = rows.first + place as u64;
            if !choice.has(design) {
                continue;
            }
            self.design.push(design);
            let cells = rows.variables(place).iter().chain(rows.outputs(place));
            for (column, value) in cells.enumerate() {
                if self.columns.len() <= column {
                    self.columns.push(Vec::new());
                }
                self.columns[column].push(Some(*value).filter(|v| v.is_finite()));
            }
            let failing = rows.failing[place].as_ref();
            self.failed_at.push(failing.and_then(|f| f.at));
            let reason = failing.map(|f| [f.status.clone(), f.reason.clone()]);
            let number = reason.map(|reason| self.number_of(reason));
            self.failing.push(number);
        }
    }

    /// Index of a reason in `reasons`. A new reason is added to the list.
    fn number_of(&mut self, reason: [String; 2]) -> usize {
        let known = self.reasons.iter().position(|r| *r == reason);
        known.unwrap_or_else(|| {
            self.reasons.push(reason);
            self.reasons.len() - 1
        })
    }

    /// Index of the row of a design. `None` if the design is not shown.
    pub fn row(&self, design: u64) -> Option<usize> {
        self.design.binary_search(&design).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For any grid, the chosen designs include every grid value of every variable.
    #[test]
    fn thinning_keeps_every_level_of_a_grid() {
        let variable = |steps| {
            serde_json::json!({
                "column": "a", "low": 0.0, "high": 1.0, "steps": steps, "at_design": 0.0, "moves": []
            })
        };
        let record: SweepRecord = serde_json::from_value(serde_json::json!({
            "form": 1, "version": "", "digest": "", "study": "", "topology": "", "length_unit": "mm",
            "method": "grid", "seed": null, "designs": 7700, "blocks_of_part": 1024, "drive": "travel_mm",
            "stations": 2, "variables": [variable(7), variable(11), variable(100)], "outputs": [],
            "targets": [], "curves": false, "format": "csv"
        }))
        .unwrap();
        for least in [2, 5, 10, 20, 70] {
            let stride = stride(&record, least);
            assert!(stride >= least && stride < 2 * least + 20, "{stride}");
            let kept: Vec<u64> = (0..7700).step_by(stride as usize).collect();
            let levels = |level: &dyn Fn(u64) -> u64| {
                kept.iter()
                    .map(|d| level(*d))
                    .collect::<BTreeSet<_>>()
                    .len()
            };
            assert_eq!(levels(&|d| d / 1100), 7);
            assert_eq!(levels(&|d| d / 100 % 11), 11);
            assert_eq!(levels(&|d| d % 100), 100.min(kept.len()));
        }
        assert_eq!(stride(&record, 1), 1);
    }
}
