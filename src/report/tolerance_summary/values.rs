//! Scatter of the values, in printed units.

use super::super::figure::finite;
use super::super::given_columns::GivenColumns;
use super::super::shortest;
use crate::model::Axis;
use crate::study::AxleStudy;
use crate::tolerance::{Expansion, FEWEST, HOLDS, MonteCarlo, PERCENTILES, Problem};
use serde::{Deserialize, Serialize};

/// Scatter of an output at one position, in the unit of the output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ValueRecord {
    /// Name of the output, with its unit.
    pub output: String,
    /// Wheel travel in the study's length unit, in a study of one wheel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub travel: Option<f64>,
    /// Rack displacement in the study's axes, in a study of one wheel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rack: Option<f64>,
    /// For an axle: values of the coordinates [`ToleranceSummary::places`](super::ToleranceSummary::places).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub place: Vec<f64>,
    /// Number of builds in which the output has a value at this position.
    pub builds: u64,
    /// Value of the output in the nominal design.
    #[serde(alias = "drawn")]
    pub nominal: Option<f64>,
    /// Mean of the output over the builds.
    pub mean: Option<f64>,
    /// Standard error of the mean.
    pub mean_error: Option<f64>,
    /// Standard deviation of the output over the builds.
    pub sigma: Option<f64>,
    /// Standard error of the standard deviation.
    pub sigma_error: Option<f64>,
    /// Standard deviation of the output, according to the first-order estimate.
    pub sigma_linear: Option<f64>,
    /// Second-order term, as a fraction of the first-order variance. `None` if it is unknown.
    pub second_order: Option<f64>,
    /// True if the first-order estimate is accurate enough. `None` if this is unknown.
    pub linear_holds: Option<bool>,
    /// Percentiles of the output over the builds, see [`PERCENTILES`].
    pub percentiles: [Option<f64>; PERCENTILES.len()],
    /// Smallest and largest value of the output in the builds.
    pub range: [Option<f64>; 2],
    /// Histogram, for a value that the page shows with its band.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub histogram: Option<HistogramRecord>,
    /// Share of each contributor in the first-order variance, in the order of the study. `None` if the value does not scatter.
    pub shares: Vec<Option<f64>>,
    /// Fraction of the builds' variance that is not first order: curvature, interaction and sampling error. It may be negative.
    pub remainder: Option<f64>,
    /// Standard error of `remainder`.
    pub remainder_error: Option<f64>,
    /// Estimate of `remainder` from second-order derivatives.
    pub remainder_second_order: Option<f64>,
    /// False if the output differs between the builds only by rounding errors. Earlier versions did not write this field.
    #[serde(default = "scatters")]
    pub scatters: bool,
    /// True for a value at the design position.
    pub(super) at_rest: bool,
    /// Unit of the output.
    pub(super) unit: String,
}

/// Accuracy of the first-order estimate of a value's scatter.
pub(in crate::report) struct LinearResult {
    /// True if the first-order estimate is accurate enough. `None` if this is unknown.
    pub holds: Option<bool>,
    /// Second-order term, as a fraction of the first-order variance. `None` if it is unknown.
    pub second_order: Option<f64>,
    /// True if the nominal design has the value.
    pub has_nominal: bool,
    /// Number of builds that have the value.
    pub builds: u64,
    /// False if the builds differ only by rounding errors.
    pub scatters: bool,
}

impl LinearResult {
    /// Accuracy of the first-order estimate in words: `yes`, or `no` with the reason. Empty if the value is not computed.
    pub(in crate::report) fn in_words(&self) -> &'static str {
        match self.holds {
            Some(true) => "yes",
            Some(false) if self.second_order.is_some_and(|s| s >= HOLDS) => "no: curved",
            Some(false) => "no: builds differ",
            None if !self.has_nominal || self.builds == 0 => "",
            None if !self.scatters => "does not scatter",
            None if self.builds < FEWEST => "too few builds",
            None => "not known",
        }
    }

    /// Reason why the first-order estimate is not accurate enough, or why this is unknown. Empty if it is accurate.
    pub(in crate::report) fn because(&self) -> &'static str {
        match self.holds {
            Some(true) => "",
            _ => self.in_words(),
        }
    }
}

/// Histogram of a value, as printed numbers. Its bins have equal widths.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistogramRecord {
    /// Lower end of the first bin, and upper end of the last bin.
    pub range: [f64; 2],
    /// Number of builds in each bin.
    pub counts: Vec<u32>,
}

/// Default of [`ValueRecord::scatters`].
fn scatters() -> bool {
    true
}

impl ValueRecord {
    /// Accuracy of the first-order estimate of this value's scatter.
    pub(super) fn linear_result(&self) -> LinearResult {
        LinearResult {
            holds: self.linear_holds,
            second_order: self.second_order,
            has_nominal: self.nominal.is_some(),
            builds: self.builds,
            scatters: self.scatters,
        }
    }

    /// Coordinates that give the position of the value, as cells of CSV files.
    pub(super) fn place(&self) -> impl Iterator<Item = String> + '_ {
        let of_wheel = self.travel.into_iter().chain(self.rack);
        of_wheel.chain(self.place.iter().copied()).map(shortest)
    }

    /// Fraction of the builds' variance that a contributor causes in first order. `contributor` is its index in `shares`.
    pub(super) fn share_of_builds(&self, contributor: usize) -> Option<f64> {
        Some(self.shares[contributor]? * (1.0 - self.remainder?))
    }
}

/// Scatter of each output at each station. `drawn` has all values of the nominal design.
pub(super) fn values(
    problem: &Problem,
    drawn: &[f64],
    expansion: &Expansion,
    builds: &MonteCarlo,
) -> Vec<ValueRecord> {
    let stations = problem.stations();
    let sign = problem.study.wheel().frame.sign(Axis::Y);
    let mut values = Vec::new();
    let of_axle = problem.study.axle();
    for (output, looked) in problem.outputs().iter().enumerate() {
        let (unit, factor) = (&looked.unit, looked.factor());
        let scaled = |v: f64| finite(v * factor);
        for station in 0..stations.count() {
            let cell = problem.cell(output, station);
            let spread = &builds.spreads[cell];
            let travel = stations.values()[stations.value_of(station)];
            let rack = stations.racks[stations.rack_of(station)];
            let estimate = expansion.estimate(cell);
            let deviation = estimate.sigma();
            let scatters = estimate.scatters(drawn[cell]);
            let variance = if scatters {
                deviation * deviation
            } else {
                f64::NAN
            };
            let remainder = estimate.remainder(spread);
            let of_scatter = |part: f64| finite(part).filter(|_| scatters);
            let shares = (0..problem.tolerance.scatter.len())
                .map(|number| finite(expansion.part(problem, cell, number) / variance));
            values.push(ValueRecord {
                output: looked.name.clone(),
                travel: of_axle.is_none().then_some(travel + 0.0),
                rack: of_axle.is_none().then_some(rack * sign + 0.0),
                place: of_axle.map_or_else(Vec::new, |AxleStudy { axle, plan, .. }| {
                    let columns = GivenColumns { plan, axle };
                    columns.values_anywhere(&problem.placements()[station])
                }),
                builds: spread.count,
                nominal: scaled(drawn[cell]),
                mean: scaled(spread.mean),
                mean_error: scaled(spread.sigma / (spread.count as f64).sqrt()),
                sigma: scaled(spread.sigma),
                sigma_error: scaled(spread.sigma_error),
                sigma_linear: scaled(deviation),
                second_order: finite(estimate.bend()).filter(|_| scatters),
                linear_holds: estimate.holds(spread).filter(|_| scatters),
                percentiles: spread.percentiles.map(scaled),
                range: spread.range.map(scaled),
                histogram: spread.histogram.and_then(|of| {
                    let [low, high] = of.range.map(scaled);
                    Some(HistogramRecord {
                        range: [low?, high?],
                        counts: of.counts.to_vec(),
                    })
                }),
                shares: shares.collect(),
                remainder: of_scatter(remainder.part),
                remainder_error: of_scatter(remainder.error),
                remainder_second_order: of_scatter(remainder.second),
                scatters,
                at_rest: station == stations.design(),
                unit: unit.clone(),
            });
        }
    }
    values
}
