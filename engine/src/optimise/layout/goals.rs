//! Targets and limits of values at one station of an axle or of a wheel with elastic parts.

use super::super::Linearisation;
use super::{Check, TargetSample};
use crate::study::Limited;

/// Limits of one value at a station.
#[derive(Clone, Debug)]
pub(in crate::optimise) struct LimitedValue {
    /// Index of the part (one measure with its limits) among the parts of all constraints.
    pub part: usize,
    /// Index of the value among all values that are read.
    pub of: usize,
    /// Limits of the value.
    pub limited: Limited,
    /// Indices of the rows that hold the limits of the value.
    pub check: Check,
}

/// Targets and limits of the values at one station.
#[derive(Clone, Debug, Default)]
pub(in crate::optimise) struct StationGoals {
    pub samples: Vec<TargetSample>,
    pub limits: Vec<LimitedValue>,
}

impl StationGoals {
    /// Adds limits of a value for a part of a constraint. The rows of the limits are not numbered yet.
    pub(in crate::optimise) fn limit(&mut self, part: usize, of: usize, limited: &Limited) {
        self.limits.push(LimitedValue {
            part,
            of,
            limited: limited.clone(),
            check: Check {
                part,
                lower: None,
                upper: None,
                equal: None,
            },
        });
    }

    /// Indices of the values that the targets, the limits, or both use, in rising order.
    pub(in crate::optimise) fn used(&self, with_targets: bool, with_limits: bool) -> Vec<usize> {
        let samples = self.samples.iter().filter(|_| with_targets);
        let limits = self.limits.iter().filter(|_| with_limits);
        let of_samples = samples.map(|own| own.of);
        let mut used: Vec<usize> = of_samples.chain(limits.map(|own| own.of)).collect();
        used.sort_unstable();
        used.dedup();
        used
    }

    /// Writes the residuals of the value with the index `of` into `into`, and the rows of the value's limits into `rows`.
    /// The second item of `into` is added to the row numbers of the residuals. `slopes` are the derivatives of the value
    /// with respect to the variables.
    pub(in crate::optimise) fn write(
        &self,
        of: usize,
        value: f64,
        slopes: &[f64],
        into: &mut Option<(&mut Linearisation, usize)>,
        rows: &mut Option<&mut Linearisation>,
    ) {
        if let Some((into, first)) = into {
            for sample in self.samples.iter().filter(|sample| sample.of == of) {
                let row = *first + sample.row;
                if sample.write_residual(row, value, into) {
                    into.write_slopes(row, slopes, sample.scale);
                }
            }
        }
        if let Some(rows) = rows {
            for own in self.limits.iter().filter(|own| own.of == of) {
                own.check.write(&own.limited, value, slopes, rows);
            }
        }
    }
}
