//! Monte Carlo analysis: results of many builds.

use super::builds::{Builder, Outcome, Unbuilt};
use super::histogram::Histogram;
use super::order::{Order, Sifted};
use super::{PERCENTILES, Problem};
use crate::assembly::AssemblyError;
use crate::evaluate::{BLOCK, Block};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::number::Width;
use crate::sweep::in_order;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// Number of partial sums that are computed side by side.
const SIDE_BY_SIDE: usize = 8;

/// Results of many builds.
#[derive(Clone, Debug)]
pub struct MonteCarlo {
    /// Number of finished builds.
    pub builds: u64,
    /// Spread of each cell (an output at a station, see [`Problem::cell`]).
    pub spreads: Vec<Spread>,
    /// Builds that cannot be assembled, grouped by a word for the reason.
    pub rejects: BTreeMap<&'static str, Rejected>,
    /// Number of assembled builds without a pose, or without values because of a toggle, at some station.
    pub incomplete: u64,
    /// Number of the first assembled build without a pose, or without values because of a toggle, at some station.
    pub first_incomplete: Option<u64>,
    /// Number of builds within the limits of every band.
    pub in_all_bands: u64,
    /// For each band (lower and upper limit of a quantity), the number of builds within these limits.
    pub in_bands: Vec<u64>,
}

/// Builds that cannot be assembled.
#[derive(Clone, Debug, PartialEq)]
pub struct Rejected {
    /// Number of builds that were rejected for this reason.
    pub builds: u64,
    /// Number of the first build that was rejected for this reason.
    pub first: u64,
    /// For an axle: the wheel that cannot be assembled in the first build that was rejected for this reason.
    pub side: Option<Side>,
    /// Reason why the first rejected build of this group cannot be assembled.
    pub why: AssemblyError,
}

/// Scatter of a value over builds, in radians and length units; for a car, in printed units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Number of builds that have the value.
    pub count: u64,
    /// Mean of the value over the builds.
    pub mean: f64,
    /// Standard deviation of the value over the builds.
    pub sigma: f64,
    /// Standard error of `sigma`, from the fourth moment. NaN with fewer than four builds.
    pub sigma_error: f64,
    /// Smallest and largest value of all builds.
    pub range: [f64; 2],
    /// Percentiles at [`PERCENTILES`]. NaN if unknown.
    pub percentiles: [f64; PERCENTILES.len()],
    /// Histogram of all builds up to 4,096. With more builds, the histogram covers the first 4,096 builds and the rest of
    /// their block; for a car, it covers all builds. `None` if there are no values.
    pub histogram: Option<Histogram>,
}

impl MonteCarlo {
    /// Counts the rejected builds of a block.
    fn add_rejects(&mut self, rejects: Vec<Unbuilt>) {
        for (first, side, why) in rejects {
            let entry = self.rejects.entry(why.word());
            let entry = entry.or_insert(Rejected {
                builds: 0,
                first,
                side,
                why,
            });
            entry.builds += 1;
        }
    }

    /// Number of builds that could not be assembled.
    pub fn rejected(&self) -> u64 {
        self.rejects.values().map(|rejected| rejected.builds).sum()
    }

    /// Share of builds within every band. Builds that cannot be assembled count as outside the bands.
    pub fn yield_of_all(&self) -> f64 {
        self.in_all_bands as f64 / self.builds as f64
    }
}

/// Values from which deviations are measured: the nominal values. If a nominal value is missing, the first value of the
/// builds of the first block is used instead, or 0 if these builds have no value either.
fn references(problem: &Problem, builder: &mut Builder, drawn: &[f64]) -> Vec<f64> {
    let mut about = drawn.to_vec();
    if !drawn.iter().any(|value| value.is_nan()) {
        return about;
    }
    let count = problem.tolerance.builds.min(BLOCK as u64) as usize;
    let is_solved = builder.solve(0, count).is_some();
    for output in 0..problem.outputs().len() {
        for station in 0..problem.stations().count() {
            let own = &mut about[problem.cell(output, station)];
            if own.is_nan() {
                let mut values = builder.block.across(output, station).flatten();
                let first = values.find(|value| is_solved && !value.is_nan());
                *own = first.copied().unwrap_or(0.0);
            }
        }
    }
    about
}

/// Sums of deviations over a block, from the values of [`references`].
struct Sums {
    /// Number of values, and sums of the first to fourth powers of the deviations, for each cell (an output at a
    /// station).
    powers: Vec<[f64; 5]>,
    ranges: Vec<[f64; 2]>,
    sifted: Sifted,
    in_all_bands: u64,
    in_bands: Vec<u64>,
}

impl Sums {
    /// Sums over the builds of one block: powers of the deviations from the values `about`, one for each cell.
    fn of(problem: &Problem, about: &[f64], block: &Block, order: &Order) -> Self {
        let bands = &problem.bands;
        let mut sums = Sums {
            powers: Vec::with_capacity(problem.cells()),
            ranges: Vec::with_capacity(problem.cells()),
            sifted: order.begin(),
            in_all_bands: 0,
            in_bands: Vec::with_capacity(bands.len()),
        };
        let mut has_values = [false; BLOCK];
        for output in 0..problem.outputs().len() {
            for station in 0..problem.stations().count() {
                let about = about[problem.cell(output, station)];
                let (powers, range) = powers(block.across(output, station), about);
                sums.powers.push(powers);
                sums.ranges.push(range);
                sums.sifted.cell(block.across(output, station));
                let values = block.across(output, station).flatten();
                for (has, value) in has_values.iter_mut().zip(values) {
                    *has |= !value.is_nan();
                }
            }
        }
        // Without bands, every build counts as good that has at least one value: an output that could be computed at a station.
        let mut in_all = if bands.is_empty() {
            has_values
        } else {
            [true; BLOCK]
        };
        for (cells, [low, high]) in bands {
            let mut in_band = [true; BLOCK];
            for [output, station] in cells {
                let values = block.across(*output, *station).flatten();
                for (is_in, value) in in_band.iter_mut().zip(values) {
                    // A missing value does not count as within its band.
                    *is_in &= value >= low && value <= high;
                }
            }
            sums.in_bands.push(count(&in_band[..block.designs()]));
            for (in_all, in_band) in in_all.iter_mut().zip(in_band) {
                *in_all &= in_band;
            }
        }
        sums.in_all_bands = count(&in_all[..block.designs()]);
        sums
    }
}

fn count(flags: &[bool]) -> u64 {
    flags.iter().map(|is| u64::from(*is)).sum()
}

/// Returns the number of values, the sums of the first to fourth powers of the differences from `about`, and the range of the
/// values.
fn powers<'v>(pieces: impl Iterator<Item = &'v [f64]>, about: f64) -> ([f64; 5], [f64; 2]) {
    // Computes several sums at a time and adds them at the end. Each sum adds the values in the order of the builds' numbers.
    let mut sums = [[0.0; SIDE_BY_SIDE]; 5];
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for values in pieces {
        for values in values.chunks(SIDE_BY_SIDE) {
            for (k, value) in values.iter().enumerate() {
                // The comparisons are false for NaN, so NaN does not change the range.
                range[0] = if *value < range[0] { *value } else { range[0] };
                range[1] = if *value > range[1] { *value } else { range[1] };
                let is = f64::from(u8::from(!value.is_nan()));
                let d = if value.is_nan() { 0.0 } else { value - about };
                let square = d * d;
                sums[0][k] += is;
                sums[1][k] += d;
                sums[2][k] += square;
                sums[3][k] += square * d;
                sums[4][k] += square * square;
            }
        }
    }
    (sums.map(|side_by_side| side_by_side.iter().sum()), range)
}

/// Draws, assembles and solves the builds of a problem on the CPU threads of the current rayon pool. `drawn` are the nominal
/// values. `note` gets the number of finished builds, and may stop the work.
pub fn monte_carlo(
    problem: &Problem,
    drawn: &[f64],
    note: impl FnMut(u64) -> ControlFlow<()> + Send,
) -> Result<MonteCarlo, DesignFault> {
    monte_carlo_in(Width::widest(), problem, drawn, note)
}

/// Runs builds like [`monte_carlo`], in lanes of this width, or one by one if `width` is `None`.
pub fn monte_carlo_in(
    width: Option<Width>,
    problem: &Problem,
    drawn: &[f64],
    mut note: impl FnMut(u64) -> ControlFlow<()> + Send,
) -> Result<MonteCarlo, DesignFault> {
    let tolerance = problem.tolerance;
    let cells = problem.cells();
    let (order, mut gathered) = Order::of(cells);
    let blocks = tolerance.builds.div_ceil(BLOCK as u64);
    // This builder also reports an error if the design cannot be solved.
    let about = references(problem, &mut Builder::new(problem, width)?, drawn);
    let worker = || Builder::new(problem, width).ok();
    let work = |worker: &mut Option<Builder>, block: u64| {
        let builder = worker.as_mut()?;
        let first = block * BLOCK as u64;
        let count = (tolerance.builds - first).min(BLOCK as u64);
        let outcome = builder.solve(first, count as usize)?;
        let sums = Sums::of(problem, &about, &builder.block, &order);
        Some((count, outcome, sums))
    };
    let mut powers = vec![[0.0; 5]; cells];
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; cells];
    let mut total = MonteCarlo {
        builds: 0,
        spreads: Vec::with_capacity(cells),
        rejects: BTreeMap::new(),
        incomplete: 0,
        first_incomplete: None,
        in_all_bands: 0,
        in_bands: vec![0; problem.bands.len()],
    };
    let taken = in_order(0..blocks, worker, work, |done: (u64, Outcome, Sums)| {
        let (count, outcome, sums) = done;
        for (sum, of_block) in powers.iter_mut().zip(&sums.powers) {
            for (s, b) in sum.iter_mut().zip(of_block) {
                *s += b;
            }
        }
        for (range, [least, greatest]) in ranges.iter_mut().zip(&sums.ranges) {
            *range = [range[0].min(*least), range[1].max(*greatest)];
        }
        total.builds += count;
        gathered.take(&sums.sifted, total.builds, &order);
        let (incomplete, first_incomplete) = outcome.incomplete;
        total.incomplete += incomplete;
        total.first_incomplete = total.first_incomplete.or(first_incomplete);
        total.in_all_bands += sums.in_all_bands;
        for (kept, of_block) in total.in_bands.iter_mut().zip(&sums.in_bands) {
            *kept += of_block;
        }
        total.add_rejects(outcome.rejects);
        match note(total.builds) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(()),
        }
    });
    // After an early stop, the result covers only the finished builds.
    let (Ok(()) | Err(())) = taken;
    for (cell, (powers, range)) in powers.into_iter().zip(ranges).enumerate() {
        let [mean, sigma, sigma_error] = moments(powers);
        total.spreads.push(Spread {
            count: powers[0] as u64,
            mean: about[cell] + mean,
            sigma,
            sigma_error,
            range,
            percentiles: gathered.percentiles(cell),
            histogram: gathered.histogram(cell),
        });
    }
    Ok(total)
}

/// Mean, standard deviation s, and standard error of s from sums of powers. The standard error is sqrt(var(s^2)) / (2 s). With
/// fewer than [`FEWEST`] builds, it has no value (NaN).
pub(super) fn moments([n, s1, s2, s3, s4]: [f64; 5]) -> [f64; 3] {
    if n == 0.0 {
        return [f64::NAN; 3];
    }
    let mean = s1 / n;
    let m2 = (s2 / n - mean * mean).max(0.0);
    let m4 = s4 / n - mean * (4.0 * s3 / n - mean * (6.0 * s2 / n - 3.0 * mean * mean));
    let square = m2 * n / (n - 1.0);
    let mut variance = variance_of_square(n, m2, m4);
    // The estimate of a few builds may be negative. (`f64::max` would replace NaN by 0.)
    if variance < 0.0 {
        variance = 0.0;
    }
    [mean, square.sqrt(), (variance / (4.0 * square)).sqrt()]
}

/// Fewest builds with a standard error of the standard deviation.
pub const FEWEST: u64 = 4;

/// Unbiased estimate of the variance of s^2 for `n` builds, from the second and the fourth central moment of the builds. NaN with
/// fewer than [`FEWEST`] builds.
///
/// Let c2 and c4 be the cumulants of a build. Then var(s^2) = c4 / n + 2 c2^2 / (n - 1). The k-statistic k4 has the mean c4. The
/// mean of k2^2, with k2 = s^2, is c2^2 (n + 1) / (n - 1) + c4 / n. So (2 n k2^2 + (n - 1) k4) / (n (n + 1)) has the mean var(s^2).
fn variance_of_square(n: f64, m2: f64, m4: f64) -> f64 {
    if n < FEWEST as f64 {
        return f64::NAN;
    }
    let k2 = m2 * n / (n - 1.0);
    let k4 =
        n * n * ((n + 1.0) * m4 - 3.0 * (n - 1.0) * m2 * m2) / ((n - 1.0) * (n - 2.0) * (n - 3.0));
    (2.0 * n * k2 * k2 + (n - 1.0) * k4) / (n * (n + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of the estimate over all samples of 4 and 5 builds from three values is the variance of s^2 over these samples.
    #[test]
    fn the_variance_of_a_square_is_unbiased() {
        let values = [0.0, 1.0, 3.5];
        for n in [4, 5] {
            let samples = values.len().pow(n);
            let (mut estimate, mut sum, mut squares) = (0.0, 0.0, 0.0);
            for sample in 0..samples {
                let builds = (0..n).map(|k| values[sample / values.len().pow(k) % values.len()]);
                let count = f64::from(n);
                let mean = builds.clone().sum::<f64>() / count;
                let central = |power| builds.clone().map(|v| (v - mean).powi(power)).sum::<f64>();
                let (m2, m4) = (central(2) / count, central(4) / count);
                let square = central(2) / (count - 1.0);
                estimate += variance_of_square(count, m2, m4) / samples as f64;
                sum += square / samples as f64;
                squares += square * square / samples as f64;
            }
            let variance = squares - sum * sum;
            assert!(
                (estimate - variance).abs() < 1e-12 * squares,
                "{estimate} {variance}"
            );
        }
    }

    /// Fewer than four builds have a standard deviation, but no standard error.
    #[test]
    fn few_builds_have_no_standard_error() {
        let [mean, sigma, error] = moments([2.0, 2.0, 4.0, 8.0, 16.0]);
        assert_eq!((mean, sigma), (1.0, 2_f64.sqrt()));
        assert!(error.is_nan());
    }
}
