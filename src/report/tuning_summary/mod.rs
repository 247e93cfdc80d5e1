//! Summary of a tuning.

mod of_tuning;
mod tables;
mod words;

use super::accuracy::{CertificateSummary, ConditionSummary};
use super::choices::{FrontPoint, FrontRecord, PriceRecord};
use super::figure::{as_written, brief, with_decimals};
use super::fitted::FittedOffset;
use super::side_effects::side_effects_in_words;
use super::table::{Cell, Column, Table};
use super::text::counted;
use super::yields::YieldRecord;
use crate::SideEffect;
use crate::curves::Curves;
use crate::model::Axis;
use crate::optimise::{
    ActiveBound, ConstraintOutcome, Fit, Fulfilment, Infeasible, Price, Termination, Tuning,
};
use crate::study::{Limit, Optimise, Study, Target, Wanted};
use serde::{Deserialize, Serialize};

/// `summary.json` of an optimisation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TuningSummary {
    command: String,
    version: String,
    study: String,
    topology: String,
    /// In tolerances; absent where the design itself cannot be evaluated.
    misfit_before: Option<f64>,
    /// Why the design itself cannot be evaluated.
    design_failure: Option<String>,
    misfit_after: Option<f64>,
    best_start: Option<usize>,
    /// Residual of the optimality conditions at the tuned design, relative to the sizes of their terms; below 1e-6 the
    /// tuning has converged.
    #[serde(default)]
    kkt_residual: Option<f64>,
    variables: Vec<VariableSummary>,
    targets: Vec<TargetSummary>,
    starts: Vec<StartSummary>,
    /// Number of independent directions of the variables that change the targets.
    rank: Option<usize>,
    singular_values: Vec<f64>,
    /// Combinations of variables that the targets cannot tell apart: offsets by variable.
    unseen: Vec<Vec<f64>>,
    /// For a fit: the scatter of the measurements about it, in tolerances.
    #[serde(default)]
    scatter: Option<f64>,
    /// For a fit: pairs of variables that the measurements hardly tell apart, with their correlation.
    #[serde(default)]
    correlations: Vec<(String, String, f64)>,
    /// The misfit below which no design was preferred to a nearer one.
    #[serde(default)]
    good_enough: f64,
    /// State of each constraint.
    #[serde(default)]
    constraints: Vec<ConstraintSummary>,
    /// Missed targets that no variable changes.
    #[serde(default)]
    unmoved: Vec<String>,
    /// Constraints that are violated and that no variable moves.
    #[serde(default)]
    unmoved_constraints: Vec<String>,
    /// Constraints that exclude one another.
    #[serde(default)]
    contradiction: Vec<String>,
    /// Stations added to those of the motion, where targets needed them.
    #[serde(default)]
    added_stations: Vec<AddedStations>,
    /// The least misfit by how far the design is moved, where that was asked for.
    #[serde(default)]
    pub prices: Vec<PriceRecord>,
    /// Changes that no target asks for; empty where they were not asked for.
    #[serde(default)]
    pub side_effects: Vec<SideEffect>,
    /// For a robust tuning: the shares of builds that keep to the bands before and after.
    #[serde(default)]
    pub yields: Option<YieldRecord>,
    /// For a robust tuning: the number of builds whose mean squared misfit was lowered; all misfits then are theirs.
    #[serde(default)]
    scatter_builds: Option<usize>,
    /// Conditioning of the tuned design along the motion.
    #[serde(default)]
    condition: Option<ConditionSummary>,
    /// Proofs of the tuned design, if the study asks for them.
    #[serde(default)]
    certificate: Option<CertificateSummary>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct VariableSummary {
    /// Joined by `+` where several move together.
    hardpoint: String,
    axis: String,
    /// The coordinate, of the first where several move together; none of a turn.
    design: Option<f64>,
    tuned: Option<f64>,
    offset: Option<f64>,
    range: [f64; 2],
    /// `lower` or `upper` where the variable ended at that bound.
    at_bound: Option<String>,
    /// For a fit: the standard error.
    #[serde(default)]
    standard_error: Option<f64>,
    /// For a fit: half the interval that holds the truth in 95 of 100 fits, where it has two sides.
    #[serde(default)]
    interval: Option<f64>,
    /// For a fit: that interval of the offset.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    fitted: Option<FittedOffset>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct TargetSummary {
    output: String,
    tolerance: f64,
    /// Least and largest wanted value, in the unit of the tolerance; open where a band has no limit.
    #[serde(default)]
    wanted: [Option<f64>; 2],
    weight: f64,
    before: Option<DeviationSummary>,
    after: Option<DeviationSummary>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct ConstraintSummary {
    name: String,
    /// Margin to the nearest limit in `unit`; negative if it is violated.
    room: f64,
    unit: String,
    /// Drive value with the least margin.
    at: Option<f64>,
    /// Unit of `at`.
    #[serde(default)]
    at_unit: String,
    /// Tolerances of misfit that a limit one unit further would save.
    price: Option<f64>,
    /// Absent in summaries of older versions, whose units are millimetres and degrees.
    #[serde(default)]
    status: Option<ConstraintStatus>,
    /// True if the price is open, because binding limits depend on one another.
    #[serde(default)]
    price_not_determined: bool,
}

/// Status of a constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ConstraintStatus {
    /// With margin to every limit.
    Kept,
    /// At a limit.
    Binds,
    Violated,
}

impl ConstraintStatus {
    /// The status of a margin, in units that are visible: a millimetre, a degree.
    fn of(margin: f64) -> Self {
        match margin {
            margin if margin < -VISIBLE => ConstraintStatus::Violated,
            margin if margin < BINDING => ConstraintStatus::Binds,
            _ => ConstraintStatus::Kept,
        }
    }
}

impl ConstraintSummary {
    fn status(&self) -> ConstraintStatus {
        self.status
            .unwrap_or_else(|| ConstraintStatus::of(self.room))
    }

    /// The drive value with the least margin, with its unit.
    fn place(&self) -> Cell {
        Cell::by(self.at, |at| with_unit(at, &self.at_unit))
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct AddedStations {
    target: String,
    at: Vec<f64>,
    /// Unit of `at`.
    #[serde(default)]
    unit: String,
}

/// In tolerances.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct DeviationSummary {
    rms: f64,
    worst: f64,
    /// The same in the unit of the target, with the sign of its values.
    #[serde(default)]
    worst_in_unit: Option<f64>,
    /// Travel in the study's unit, or arm angle in degrees; for an axle the number that the target is over.
    worst_at: f64,
    /// Unit of `worst_at`.
    #[serde(default)]
    worst_at_unit: String,
    /// Rack displacement there, in the study's axes.
    #[serde(default)]
    worst_rack: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct StartSummary {
    start: usize,
    offsets: Vec<f64>,
    /// Reason for its end, or for the failure of its start.
    ended: String,
    iterations: Option<u64>,
    evaluations: Option<u64>,
    misfit: Option<f64>,
    /// As `kkt_residual` of the summary, at the end of this start.
    #[serde(default)]
    kkt_residual: Option<f64>,
}

impl TuningSummary {
    /// Misfit before and after, in tolerances, for reading.
    pub fn misfits(&self) -> [Option<String>; 2] {
        [self.misfit_before, self.misfit_after].map(|m| m.map(misfit_in_words))
    }

    /// Returns true if some start reached a design.
    pub fn has_design(&self) -> bool {
        self.misfit_after.is_some()
    }

    /// Number of the point of a front that is the tuned design, to a thousandth of each range; `None` if no point is.
    pub(super) fn kept_point(&self, front: &FrontRecord) -> Option<usize> {
        let is_same = |point: &FrontPoint| {
            let pairs = self.variables.iter().zip(&point.offsets);
            let mut pairs = pairs.map(|(variable, at)| (variable.offset, variable.range, *at));
            point.offsets.len() == self.variables.len()
                && pairs.all(|(own, [low, high], at)| {
                    own.is_some_and(|own| (own - at).abs() <= 1e-3 * (high - low))
                })
        };
        front.points.iter().position(is_same)
    }

    /// The start whose end was kept.
    pub fn kept_start(&self) -> Option<usize> {
        self.best_start
    }

    /// Number of variables that ended at a bound, and number of all variables.
    pub fn at_bounds(&self) -> [usize; 2] {
        let active = self.variables.iter().filter(|v| v.at_bound.is_some());
        [active.count(), self.variables.len()]
    }

    /// Number of targets.
    pub fn targets(&self) -> usize {
        self.targets.len()
    }

    /// Returns the targets that are missed by more than their tolerance somewhere: their numbers and columns, and
    /// size and place of the deviation.
    pub fn missed(&self) -> Vec<(usize, &str, String)> {
        let targets = self.targets.iter().enumerate();
        let missed = targets.filter_map(|(number, t)| {
            let after = t.after.as_ref().filter(|d| d.worst.abs() > 1.0)?;
            let by = misfit_in_words(after.worst.abs());
            let at = with_unit(after.worst_at, &after.worst_at_unit);
            Some((number, &*t.output, format!("{by} tolerances at {at}")))
        });
        missed.collect()
    }

    /// The constraints that are violated, by their rows in [`TuningSummary::constraints_table`].
    pub fn violated(&self) -> Vec<usize> {
        let rows = self.constraints.iter().enumerate();
        let violated = rows.filter(|(_, c)| c.status() == ConstraintStatus::Violated);
        violated.map(|(row, _)| row).collect()
    }

    /// Returns true if a request cannot be met. A constraint is violated, or a target that no variable changes is
    /// missed by more than its tolerance.
    pub fn falls_short(&self) -> bool {
        let missed = |target: &TargetSummary| {
            let rms = target.after.as_ref().map_or(0.0, |after| after.rms);
            rms > 1.0 && self.unmoved.contains(&target.output)
        };
        !self.violated().is_empty() || self.targets.iter().any(missed)
    }

    /// Number of starts that were interrupted before their end, and number of all starts.
    pub fn interrupted(&self) -> [usize; 2] {
        let word = Termination::Interrupted.to_string();
        let interrupted = self.starts.iter().filter(|s| s.ended == word);
        [interrupted.count(), self.starts.len()]
    }
}

/// Constraints violated by less than this (a millimetre, a degree are 1) are kept.
const VISIBLE: f64 = 1e-6;
/// Constraints with less margin than this bind.
const BINDING: f64 = 1e-6;

/// A number with its unit; without one in summaries of older versions, which do not name it.
fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "" => as_written(value),
        unit => format!("{} {unit}", as_written(value)),
    }
}

/// A misfit for reading: two decimals, or its order of magnitude.
pub fn misfit_in_words(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else if value.abs() < 0.005 {
        format!("{value:.0e}")
    } else {
        format!("{value:.2}")
    }
}
