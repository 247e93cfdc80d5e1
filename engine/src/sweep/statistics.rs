//! Statistics of the designs of a block, of a part (a fixed number of blocks), of a run or of all shards. Statistics can
//! be added.
//!
//! Each block has statistics of its rows. A part adds the statistics of its blocks in order, and the sweep adds the
//! statistics of its parts in order. So the order of additions is the same for any number of CPU threads, shards and
//! machines. Statistics are bit-identical after they are written as JSON and read again.

use super::front::{Candidate, Front};
use super::moments::{BinnedSums, Moments, SaltelliSums, Span};
use super::{Rows, SweepRecord};
use serde::{Deserialize, Serialize};

/// Number of best designs in the statistics. Designs that fail at a station are not ranked. Of these failed designs, the
/// statistics keep the smallest misfits, up to the same number.
pub const KEPT: usize = 10;
/// Largest number of example designs that are stored for each reason of failure.
const EXAMPLES: usize = 5;

/// Statistics of some designs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepStatistics {
    /// Number of designs in these statistics.
    pub designs: u64,
    /// Number of designs solved at every station.
    pub solved: u64,
    /// Number of designs that were not solved in SIMD lanes.
    pub one_by_one: u64,
    /// Reasons why designs were not solved at every station, in order of first appearance.
    pub failures: Vec<FailureCount>,
    /// Smallest and largest value of each output over all designs. `None` if no design has a value.
    pub ranges: Vec<Option<OutputRange>>,
    /// Number of solved designs that have a value of each output. Older statistics do not have these numbers
    /// ([`SweepStatistics::are_of`]).
    #[serde(default)]
    pub solved_values: Vec<u64>,
    /// Best designs by misfit, in order. All are solved at every station and satisfy the constraints.
    pub best: Vec<Candidate>,
    /// For each output, the number of solved designs that violate its limit ([`super::OutputColumn::least`]), or for which the
    /// output has no value. Empty if no output has a limit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub violating: Vec<u64>,
    /// Number of solved designs that violate a limit, or whose margin has no value. These designs are not ranked.
    #[serde(default)]
    pub violators: u64,
    /// Smallest misfits of designs that are not solved at every station, in order. These designs are not ranked.
    #[serde(default)]
    pub unranked: Vec<f64>,
    /// Designs of the Pareto front, if there are several targets. All are solved at every station and satisfy the constraints.
    pub front: Front,
    /// Sums over designs that are solved at every station and have a value for every output. For Saltelli's samples, only
    /// the designs A and B.
    pub moments: Moments,
    /// Sums of outputs, grouped by the level (interval of the range) of each variable.
    #[serde(rename = "levels")]
    pub binned: BinnedSums,
    /// Sums over Saltelli's groups.
    #[serde(rename = "exchanges")]
    pub saltelli: SaltelliSums,
}

/// Designs that failed for the same reason.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailureCount {
    /// Kind of failure: the word in the `status` column.
    pub status: String,
    /// Reason of the failure in words.
    pub reason: String,
    /// Number of designs that failed for this reason.
    pub designs: u64,
    /// Number of stations without a pose in these designs.
    pub stations: u64,
    /// Drive value of the failed station that is nearest to the design position. For a car, the index of a failed load case.
    /// `None` if no such value is known.
    pub nearest: Option<f64>,
    /// Numbers of the first few designs that failed for this reason.
    pub examples: Vec<u64>,
}

/// Range of an output, and the designs at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputRange {
    /// Number of designs that have a value of the output.
    pub count: u64,
    /// Smallest value, and the first design that has it.
    pub min: (f64, u64),
    /// Largest value, and the first design that has it.
    pub max: (f64, u64),
}

impl SweepStatistics {
    /// Statistics without any designs.
    pub fn empty(record: &SweepRecord) -> Self {
        SweepStatistics {
            designs: 0,
            solved: 0,
            one_by_one: 0,
            failures: Vec::new(),
            ranges: vec![None; record.outputs.len()],
            solved_values: vec![0; record.outputs.len()],
            best: Vec::new(),
            violating: if record.limits().is_empty() {
                Vec::new()
            } else {
                vec![0; record.outputs.len()]
            },
            violators: 0,
            unranked: Vec::new(),
            front: Front::default(),
            moments: Moments::empty(record),
            binned: BinnedSums::empty(record),
            saltelli: SaltelliSums::empty(record),
        }
    }

    /// Statistics of the rows of one block.
    pub fn of(record: &SweepRecord, rows: &Rows) -> Self {
        let mut statistics = SweepStatistics::empty(record);
        let (misfit, deviations, limits) = (record.misfit(), record.deviations(), record.limits());
        let reference: Vec<f64> = record
            .outputs
            .iter()
            .map(|o| o.at_design.unwrap_or(0.0))
            .collect();
        // Outputs minus the outputs of the study's own design. The differences are small, so sums of squares do not lose digits.
        let mut shifted = vec![0.0; reference.len()];
        let spans = Span::all(record);
        let mut scaled = vec![0.0; spans.len()];
        let group = record.group();
        for place in 0..rows.designs() {
            let number = rows.first + place as u64;
            let (variables, outputs) = (rows.variables(place), rows.outputs(place));
            statistics.designs += 1;
            match &rows.failing[place] {
                None => statistics.solved += 1,
                Some(failing) => statistics.count_failure(&FailureCount {
                    status: failing.status.clone(),
                    reason: failing.reason.clone(),
                    designs: 1,
                    stations: failing.stations,
                    nearest: failing.at,
                    examples: vec![number],
                }),
            }
            for (range, value) in statistics.ranges.iter_mut().zip(outputs) {
                if !value.is_nan() {
                    OutputRange::extend(range, &OutputRange::of(*value, number));
                }
            }
            let candidate = || Candidate {
                design: number,
                variables: variables.to_vec(),
                outputs: outputs.to_vec(),
                failing: rows.failing[place].clone(),
            };
            // A low misfit at some stations does not count if the design cannot reach the other stations.
            let is_solved = rows.failing[place].is_none();
            for (count, value) in statistics.solved_values.iter_mut().zip(outputs) {
                *count += u64::from(is_solved && !value.is_nan());
            }
            let mut violates = false;
            for (k, least) in limits.iter().filter(|_| is_solved) {
                if outputs[*k].is_nan() || outputs[*k] < *least {
                    statistics.violating[*k] += 1;
                    violates = true;
                }
            }
            statistics.violators += u64::from(violates);
            match misfit.filter(|m| !outputs[*m].is_nan()) {
                Some(_) if violates => {}
                Some(misfit) if is_solved => {
                    keep_best(&mut statistics.best, misfit, outputs[misfit], candidate);
                    if deviations.len() > 1 {
                        statistics.front.offer(&deviations, outputs, candidate);
                    }
                }
                Some(misfit) => keep_least(&mut statistics.unranked, outputs[misfit]),
                None => {}
            }
            let complete = is_solved && outputs.iter().all(|v| !v.is_nan());
            for ((shifted, value), reference) in shifted.iter_mut().zip(outputs).zip(&reference) {
                *shifted = value - reference;
            }
            // The designs C of Saltelli's groups combine the variables of A and B. So they are not independent samples, and
            // `moments` and `binned` do not include them.
            let independent = group.is_none_or(|group| number % group < 2);
            if complete && independent {
                for ((scaled, span), value) in scaled.iter_mut().zip(&spans).zip(variables) {
                    *scaled = span.scaled(*value);
                }
                statistics.moments.add(&scaled, &shifted);
                statistics.binned.add(&scaled, &shifted);
            }
            if let Some(group) = group {
                let role = number % group;
                statistics.saltelli.add(role as usize, complete, &shifted);
            }
        }
        statistics
    }

    /// Returns true if these statistics have the dimensions of this sweep, for example the same number of outputs.
    pub fn are_of(&self, record: &SweepRecord) -> bool {
        let empty = SweepStatistics::empty(record);
        let [variables, outputs] = [record.variables.len(), record.outputs.len()];
        let fits = |c: &Candidate| c.variables.len() == variables && c.outputs.len() == outputs;
        self.ranges.len() == outputs
            && self.solved_values.len() == outputs
            && self.violating.len() == empty.violating.len()
            && self.best.iter().all(fits)
            && self.front.sorted().into_iter().all(fits)
            && self.moments.fits(&empty.moments)
            && self.binned.fits(&empty.binned)
            && self.saltelli.fits(&empty.saltelli)
    }

    /// Adds the statistics of the following designs.
    pub fn absorb(&mut self, record: &SweepRecord, next: &SweepStatistics) {
        self.designs += next.designs;
        self.solved += next.solved;
        self.one_by_one += next.one_by_one;
        self.violators += next.violators;
        for (own, other) in self.violating.iter_mut().zip(&next.violating) {
            *own += other;
        }
        for (own, other) in self.solved_values.iter_mut().zip(&next.solved_values) {
            *own += other;
        }
        for failure in &next.failures {
            self.count_failure(failure);
        }
        for (range, other) in self.ranges.iter_mut().zip(&next.ranges) {
            if let Some(other) = other {
                OutputRange::extend(range, other);
            }
        }
        if let Some(misfit) = record.misfit() {
            for candidate in &next.best {
                let value = candidate.outputs[misfit];
                keep_best(&mut self.best, misfit, value, || candidate.clone());
            }
        }
        for misfit in &next.unranked {
            keep_least(&mut self.unranked, *misfit);
        }
        let deviations = record.deviations();
        for candidate in next.front.sorted() {
            let outputs = &candidate.outputs;
            self.front.offer(&deviations, outputs, || candidate.clone());
        }
        self.moments.absorb(&next.moments);
        self.binned.absorb(&next.binned);
        self.saltelli.absorb(&next.saltelli);
    }

    fn count_failure(&mut self, failure: &FailureCount) {
        let same = |f: &&mut FailureCount| f.status == failure.status && f.reason == failure.reason;
        let Some(known) = self.failures.iter_mut().find(same) else {
            self.failures.push(failure.clone());
            return;
        };
        known.designs += failure.designs;
        known.stations += failure.stations;
        known.nearest = match (known.nearest, failure.nearest) {
            (Some(known), Some(other)) if other.abs() < known.abs() => Some(other),
            (known, other) => known.or(other),
        };
        let room = EXAMPLES - known.examples.len();
        known.examples.extend(failure.examples.iter().take(room));
    }
}

impl OutputRange {
    fn of(value: f64, design: u64) -> Self {
        OutputRange {
            count: 1,
            min: (value, design),
            max: (value, design),
        }
    }

    fn extend(range: &mut Option<Self>, next: &Self) {
        let Some(range) = range else {
            *range = Some(*next);
            return;
        };
        range.count += next.count;
        if next.min.0 < range.min.0 {
            range.min = next.min;
        }
        if next.max.0 > range.max.0 {
            range.max = next.max;
        }
    }
}

/// Inserts a design into the list of best designs if its misfit is among the smallest. Equal designs keep their order.
fn keep_best(
    best: &mut Vec<Candidate>,
    misfit: usize,
    value: f64,
    candidate: impl FnOnce() -> Candidate,
) {
    let place = best.partition_point(|b| b.outputs[misfit] <= value);
    if place < KEPT {
        best.truncate(KEPT - 1);
        best.insert(place, candidate());
    }
}

/// Inserts a misfit into the list of smallest misfits if it is among the smallest.
fn keep_least(least: &mut Vec<f64>, misfit: f64) {
    let place = least.partition_point(|other| *other <= misfit);
    if place < KEPT && misfit.is_finite() {
        least.truncate(KEPT - 1);
        least.insert(place, misfit);
    }
}
