//! Summary of a tuning.

mod holding;
mod of_tuning;
mod starts;
mod tables;
mod verdict;
mod words;

pub use holding::{HOLDING_NOTE, HoldingRecord, holding_table, shown_holding};
pub(in crate::report) use holding::{Missed, Moved, not_held};
pub(in crate::report) use of_tuning::wanted;
pub use starts::{StartSummary, starts_in_words, starts_table};
pub use tables::misfit_table;
pub use verdict::{ConstraintStatus, SlightEffectRecord};
pub(in crate::report) use verdict::{
    least_violation_in_words, price_in_words, unmoved_constraint_in_words, unmoved_in_words,
    violation_in_words,
};
pub use words::{contradiction_in_words, interrupted_in_words};

use super::accuracy::{CertificateSummary, ConditionSummary};
use super::choices::{FrontPoint, FrontRecord, PriceRecord};
use super::figure::{as_written, brief, to_digits, with_decimals, with_plus};
use super::fitted::FittedOffset;
use super::side_effects::{decimals_beside, range_in_words, side_effects_in_words};
use super::table::{Cell, Column, Table};
use super::text::counted;
use super::yields::YieldRecord;
use crate::SideEffect;
use crate::curves::Curves;
use crate::model::Axis;
use crate::optimise::{ActiveBound, ConstraintOutcome, Direction, Fulfilment, Price, Tuning};
use crate::study::{Limit, Optimise, Study, Target, Wanted};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Content of `summary.json` of an optimisation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TuningSummary {
    command: String,
    version: String,
    study: String,
    topology: String,
    /// Misfit of the given design, as a multiple of the tolerances. Absent if the design cannot be evaluated.
    misfit_before: Option<f64>,
    /// Reason why the given design cannot be evaluated.
    design_failure: Option<String>,
    /// Misfit of the tuned design. Absent if no start could be evaluated.
    misfit_after: Option<f64>,
    /// Index of the start whose result is the tuned design.
    best_start: Option<usize>,
    /// Residual of the optimality conditions (KKT) at the tuned design, relative to the sizes of their terms. Below 1e-6 the
    /// tuning has converged.
    #[serde(default)]
    kkt_residual: Option<f64>,
    variables: Vec<VariableSummary>,
    targets: Vec<TargetSummary>,
    starts: Vec<StartSummary>,
    /// Number of independent directions in the variables that change the targets.
    rank: Option<usize>,
    /// Singular values of the Jacobian of the targets at the tuned design.
    singular_values: Vec<f64>,
    /// Moves from the tuned design that raise the misfit by at most 0.1 and keep the constraints. Each move has one offset per
    /// variable.
    unseen: Vec<Vec<f64>>,
    /// For a fit: scatter of the measurements about the fit, as a multiple of their tolerances.
    #[serde(default)]
    scatter: Option<f64>,
    /// For a fit: pairs of variables that the measurements hardly distinguish, with their correlation.
    #[serde(default)]
    correlations: Vec<(String, String, f64)>,
    /// Misfit that is good enough. Among designs with a smaller misfit, the tuning prefers the design nearest to the given one.
    #[serde(default)]
    good_enough: f64,
    /// State of each constraint. Empty if no start could be evaluated.
    #[serde(default)]
    constraints: Vec<ConstraintSummary>,
    /// Missed targets on which no variable has an effect.
    #[serde(default)]
    unmoved: Vec<String>,
    /// Keys of `[wheel]` that give the values of the targets in `unmoved`, by the name of the target.
    #[serde(default)]
    unmoved_keys: BTreeMap<String, String>,
    /// Missed targets on which the variables have only a small effect.
    #[serde(default)]
    hardly_moved: Vec<SlightEffectRecord>,
    /// Bounds of variables that keep targets from being met. `None` if they are not known, because the tuning did not end at a
    /// minimum of the misfit.
    #[serde(default)]
    pub holding: Option<Vec<HoldingRecord>>,
    /// Violated constraints on which no variable has an effect.
    #[serde(default)]
    unmoved_constraints: Vec<String>,
    /// Constraints that contradict each other.
    #[serde(default)]
    contradiction: Vec<String>,
    /// Stations added to those of the motion, because targets need them.
    #[serde(default)]
    added_stations: Vec<AddedStations>,
    /// Price list, if it was requested: smallest misfit for each size of the change.
    #[serde(default)]
    pub prices: Vec<PriceRecord>,
    /// Changes that no target requests, if they were requested.
    #[serde(default)]
    pub side_effects: Vec<SideEffect>,
    /// For a robust tuning: share of builds within the bands, before and after.
    #[serde(default)]
    pub yields: Option<YieldRecord>,
    /// For a robust tuning: number of random builds. The tuning minimised the mean squared misfit of these builds, and all
    /// misfits here are misfits of these builds.
    #[serde(default)]
    scatter_builds: Option<usize>,
    /// Conditioning of the tuned design along the motion.
    #[serde(default)]
    condition: Option<ConditionSummary>,
    /// Certificates of the tuned design, if the study requests them.
    #[serde(default)]
    certificate: Option<CertificateSummary>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct VariableSummary {
    /// Name of the hardpoint. If several move together, their names are joined by `+`.
    hardpoint: String,
    axis: String,
    /// Coordinate or rate in the given design. If several hardpoints move together, it is the coordinate of the first one. `None`
    /// for a turn, and for a move along a direction.
    design: Option<f64>,
    /// Coordinate or rate in the tuned design.
    tuned: Option<f64>,
    /// Value of the variable at the tuned design, in `unit`.
    offset: Option<f64>,
    /// Unit of the offset in words: `mm`, `N/mm`. `factor` if the offset is the logarithm of a factor.
    #[serde(default)]
    unit: String,
    /// Lowest and highest allowed offset, in `unit`.
    range: [f64; 2],
    /// `lower` or `upper`, if the variable ended at that bound.
    at_bound: Option<String>,
    /// For a fit: standard error of the offset.
    #[serde(default)]
    standard_error: Option<f64>,
    /// For a fit: half the width of the 95 % confidence interval, if it has two sides.
    #[serde(default)]
    interval: Option<f64>,
    /// For a fit: 95 % confidence interval of the offset.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    fitted: Option<FittedOffset>,
}

impl VariableSummary {
    /// True if the offset is the logarithm of a factor of a rate.
    fn is_factor(&self) -> bool {
        self.unit == "factor"
    }

    /// 95 % confidence interval of the rate that a fitted factor gives, in words. `None` for other variables.
    fn tuned_interval(&self) -> Option<String> {
        let (fitted, design) = (self.fitted.filter(|_| self.is_factor())?, self.design?);
        // Four digits are enough for the ends of an interval.
        let rate = |offset: f64| {
            let rate = design * offset.exp();
            as_written(to_digits(rate, 4))
        };
        Some(match fitted.ends().map(|end| end.map(rate)) {
            [Some(lower), Some(upper)] => format!("{lower} .. {upper}"),
            [Some(lower), None] => format!(">= {lower}"),
            [None, Some(upper)] => format!("<= {upper}"),
            [None, None] => "not determined".to_owned(),
        })
    }

    /// Kind of move without its unit: `z`, `turn about x`, `rate`.
    fn way(&self) -> &str {
        self.axis.split(',').next().unwrap_or_default()
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct TargetSummary {
    /// Column of the output that the target is for, with the stations of the target.
    output: String,
    /// Tolerance of the target, in the unit of the column.
    tolerance: f64,
    /// Smallest and largest target value, in the unit of the tolerance. `None` on a side on which a band has no limit.
    #[serde(default)]
    wanted: [Option<f64>; 2],
    /// True for a band with a curve as a limit. Then `wanted` has the smallest value of the lower limit and the largest value of
    /// the upper limit.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    between_curves: bool,
    weight: f64,
    /// Smallest and largest value of the output at the stations of the target before the tuning, in the unit of the tolerance.
    /// `values_after` has the values after it. For a robust tuning: values of the nominal design.
    #[serde(default)]
    values_before: Option<[f64; 2]>,
    #[serde(default)]
    values_after: Option<[f64; 2]>,
    before: Option<DeviationSummary>,
    after: Option<DeviationSummary>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct ConstraintSummary {
    name: String,
    /// Value of the constrained quantity where the margin is smallest, in `unit`. `limit` is the nearest limit. Both are `None` for
    /// a constraint whose limits are not limits of a single quantity.
    #[serde(default)]
    value: Option<f64>,
    #[serde(default)]
    limit: Option<f64>,
    /// True if `limit` is the upper limit.
    #[serde(default)]
    is_upper: bool,
    /// Margin of the constraint to the nearest limit in `unit`; negative if this limit is violated. `None` if it is not known.
    #[serde(alias = "room")]
    margin: Option<f64>,
    unit: String,
    /// Drive value (travel or angle of the station) with the smallest margin.
    at: Option<f64>,
    /// Unit of `at`.
    #[serde(default)]
    at_unit: String,
    /// Decrease of the misfit if the limit moves outward by one unit. The misfit is a multiple of the tolerances.
    price: Option<f64>,
    /// Status of the constraint. Absent in summaries of older versions, whose margins are in millimetres and degrees.
    #[serde(default)]
    status: Option<ConstraintStatus>,
    /// True if the price (decrease of the misfit per unit of the limit) is not determined, because binding limits depend on
    /// each other.
    #[serde(default)]
    price_not_determined: bool,
}

impl ConstraintSummary {
    fn status(&self) -> ConstraintStatus {
        self.status
            .unwrap_or_else(|| ConstraintStatus::of(self.margin.unwrap_or(f64::NAN)))
    }

    /// Nearest limit of the constraint in words. `None` if it is not known.
    fn limit_in_words(&self) -> Option<String> {
        let words = if self.is_upper { "at most" } else { "at least" };
        self.limit.map(|limit| format!("{words} {}", brief(limit)))
    }

    /// Table cell: drive value at which the constraint has its smallest margin, with unit.
    fn place(&self) -> Cell {
        Cell::by(self.at, |at| with_unit(to_digits(at, 6), &self.at_unit))
    }
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct AddedStations {
    /// Name of the target.
    target: String,
    /// Drive values (travels or angles) of the added stations.
    at: Vec<f64>,
    /// Unit of `at`.
    #[serde(default)]
    unit: String,
}

/// Deviation from a target, as a multiple of its tolerance.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct DeviationSummary {
    /// Root mean square deviation over the stations of the target.
    rms: f64,
    /// Largest deviation at a station of the target, with its sign.
    worst: f64,
    /// Largest deviation in the unit of the target, with its sign.
    #[serde(default)]
    worst_in_unit: Option<f64>,
    /// Position of the largest deviation: travel in the study's unit, or arm angle in degrees. For an axle, the coordinate to
    /// which the target refers.
    worst_at: f64,
    /// Unit of `worst_at`.
    #[serde(default)]
    worst_at_unit: String,
    /// Rack displacement at the largest deviation, in the study's axes and length unit.
    #[serde(default)]
    worst_rack: f64,
}

impl TuningSummary {
    /// Misfit before and after in words, as a multiple of the tolerances. `None` if it is unknown.
    pub fn misfits(&self) -> [Option<String>; 2] {
        [self.misfit_before, self.misfit_after].map(|m| m.map(misfit_in_words))
    }

    /// Text `before` with the number of builds to which deviations and misfits belong, as in ` over 64 builds`. Empty if they
    /// belong to the nominal design.
    pub fn over_builds(&self, before: &str) -> String {
        self.scatter_builds.map_or(String::new(), |builds| {
            format!("{before} {}", counted(builds, "build"))
        })
    }

    /// True if the tuning reached a design from at least one start.
    pub fn has_design(&self) -> bool {
        self.misfit_after.is_some()
    }

    /// Index of the point of a Pareto front that equals the tuned design, to a thousandth of each range. `None` if there is no
    /// such point.
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

    /// Index of the start whose result is the tuned design.
    pub fn kept_start(&self) -> Option<usize> {
        self.best_start
    }

    /// Number of variables that ended at a bound, and total number of variables.
    pub fn at_bounds(&self) -> [usize; 2] {
        let active = self.variables.iter().filter(|v| v.at_bound.is_some());
        [active.count(), self.variables.len()]
    }

    /// Number of targets.
    pub fn targets(&self) -> usize {
        self.targets.len()
    }

    /// Targets that are missed by more than their tolerance somewhere: their indices and columns, and the size and position of the
    /// largest deviation.
    pub fn missed(&self) -> Vec<(usize, &str, String)> {
        let targets = self.targets.iter().enumerate();
        let missed = targets.filter_map(|(number, t)| {
            let after = t.after.as_ref().filter(|d| d.worst.abs() > 1.0)?;
            let by = misfit_in_words(after.worst.abs());
            let at = with_unit(after.worst_at, &after.worst_at_unit);
            let of = self.over_builds(" in one of");
            Some((number, &*t.output, format!("{by} tolerances at {at}{of}")))
        });
        missed.collect()
    }

    /// Rows of the violated constraints in [`TuningSummary::constraints_table`].
    pub fn violated(&self) -> Vec<usize> {
        let rows = self.constraints.iter().enumerate();
        let violated = rows.filter(|(_, c)| c.status().is_violated());
        violated.map(|(row, _)| row).collect()
    }

    /// True if a request cannot be met: a constraint is violated, or the RMS deviation from a target that no variable changes
    /// exceeds its tolerance.
    pub fn falls_short(&self) -> bool {
        let missed = |target: &TargetSummary| {
            let rms = target.after.as_ref().map_or(0.0, |after| after.rms);
            rms > 1.0 && self.unmoved.contains(&target.output)
        };
        !self.violated().is_empty() || self.targets.iter().any(missed)
    }

    /// Number of starts that were interrupted, and total number of starts.
    pub fn interrupted(&self) -> [usize; 2] {
        let interrupted = self.starts.iter().filter(|s| s.is_interrupted());
        [interrupted.count(), self.starts.len()]
    }
}

/// Word for a bound at which a variable ended: `lower` or `upper`. `None` between the bounds.
pub(in crate::report) fn bound_in_words(bound: ActiveBound) -> Option<String> {
    match bound {
        ActiveBound::Free => None,
        ActiveBound::Lower => Some("lower".to_owned()),
        ActiveBound::Upper => Some("upper".to_owned()),
    }
}

/// Number with its unit. Summaries of older versions have no unit.
fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "" => as_written(value),
        unit => format!("{} {unit}", as_written(value)),
    }
}

/// Misfit in words: two decimals, or one significant digit if it is below 0.005.
pub fn misfit_in_words(value: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else if value.abs() < 0.005 {
        format!("{value:.0e}")
    } else {
        format!("{value:.2}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cell of a band between curves contains the word "curves", because the band is not a range of allowed values.
    #[test]
    fn a_band_between_curves_is_named() {
        let target = |between_curves| TargetSummary {
            output: "camber_deg".to_owned(),
            tolerance: 0.1,
            wanted: [Some(-2.6), Some(-0.4)],
            between_curves,
            weight: 1.0,
            values_before: None,
            values_after: None,
            before: None,
            after: None,
        };
        assert_eq!(target(false).wanted_in_words(), "-2.6 .. -0.4");
        assert_eq!(target(true).wanted_in_words(), "curves, -2.6 .. -0.4");
    }

    /// A fitted factor is shown as the rate that it gives, with its interval: 2200 N/mm times exp(-0.4417 .. -0.4161).
    #[test]
    fn the_interval_of_a_factor_is_that_of_its_rate() {
        let variable = |unit: &str| VariableSummary {
            hardpoint: "bushing:lower_arm_rear".to_owned(),
            axis: "stiffness y".to_owned(),
            design: Some(2200.0),
            tuned: Some(1432.6),
            offset: Some(-0.429),
            unit: unit.to_owned(),
            range: [-1.2, 1.1],
            at_bound: None,
            standard_error: None,
            interval: None,
            fitted: Some(FittedOffset::TwoSided {
                offset_lower: -0.4417,
                offset_upper: -0.4161,
            }),
        };
        let factor = variable("factor").tuned_interval();
        assert_eq!(factor.as_deref(), Some("1414 .. 1451"));
        assert_eq!(variable("N/mm").tuned_interval(), None);
    }
}
