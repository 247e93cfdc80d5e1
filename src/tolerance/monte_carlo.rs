//! Builds by the thousand.

use super::builds::Builder;
use super::histogram::{Bins, Counts};
use super::{PERCENTILES, Problem};
use crate::build::Reject;
use crate::mechanism::DesignFault;
use crate::sweep::{BLOCK, in_order};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::Mutex;

/// Builds that tell where the bins of percentiles lie.
const PILOT: u64 = 1024;

/// What builds came to.
#[derive(Clone, Debug)]
pub struct MonteCarlo {
    /// Number of builds.
    pub builds: u64,
    /// By cell.
    pub spreads: Vec<Spread>,
    /// Builds that cannot be put together, by word: how many, and the first with why.
    pub rejects: BTreeMap<&'static str, (u64, u64, Reject)>,
    /// Builds put together that have no pose somewhere in the motion.
    pub incomplete: u64,
    /// Builds that keep to every band.
    pub in_all_bands: u64,
    /// Builds that keep to each band.
    pub in_bands: Vec<u64>,
}

/// How a value scatters over builds. In radians and length units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Builds that have the value.
    pub count: u64,
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub sigma: f64,
    /// Standard error of the standard deviation: by the fourth moment.
    pub sigma_error: f64,
    /// The least and the greatest value.
    pub range: [f64; 2],
    /// See [`PERCENTILES`].
    pub percentiles: [f64; PERCENTILES.len()],
}

impl MonteCarlo {
    /// Number of builds that could not be put together.
    pub fn rejected(&self) -> u64 {
        self.rejects.values().map(|(count, ..)| count).sum()
    }

    /// The share of builds that keep to every band. Those that cannot be put together do not.
    pub fn yield_of_all(&self) -> f64 {
        self.in_all_bands as f64 / self.builds as f64
    }
}

/// Sums of a block, about the drawn values.
struct Sums {
    /// By cell: count, powers one to four.
    powers: Vec<[f64; 5]>,
    ranges: Vec<[f64; 2]>,
    rejects: Vec<(u64, Reject)>,
    incomplete: u64,
    in_all_bands: u64,
    in_bands: Vec<u64>,
}

impl Sums {
    fn new(cells: usize, bands: usize) -> Self {
        Sums {
            powers: vec![[0.0; 5]; cells],
            ranges: vec![[f64::INFINITY, f64::NEG_INFINITY]; cells],
            rejects: Vec::new(),
            incomplete: 0,
            in_all_bands: 0,
            in_bands: vec![0; bands],
        }
    }
}

/// A thread's builder with its counts, which are added to everyone's when the thread is done.
struct Worker<'a> {
    builder: Builder<'a>,
    counts: Counts,
    all: &'a Mutex<Counts>,
}

impl Drop for Worker<'_> {
    fn drop(&mut self) {
        if let Ok(mut all) = self.all.lock() {
            all.add(&self.counts);
        }
    }
}

/// Draws, puts together and solves the builds of a problem on the threads of the current rayon pool. `drawn` are the
/// values of the drawing; `note` is told how many builds are done, and may end the work there.
pub fn monte_carlo(
    problem: &Problem,
    drawn: &[f64],
    mut note: impl FnMut(u64) -> ControlFlow<()> + Send,
) -> Result<MonteCarlo, DesignFault> {
    let tolerance = problem.tolerance;
    let cells = problem.cells();
    let bands: Vec<(Vec<usize>, [f64; 2])> = tolerance
        .bands
        .iter()
        .map(|band| {
            let output = problem.output(band.characteristic);
            let stations = problem.stations_of(band).into_iter();
            let cells = stations.map(|station| problem.cell(output, station));
            (cells.collect(), band.between)
        })
        .collect();
    let bins = pilot(problem, drawn)?;
    let all = Mutex::new(bins.counts());
    let blocks = tolerance.builds.div_ceil(BLOCK as u64);
    // One worker is made here, so that a design that cannot be solved is known.
    Builder::new(problem)?;
    let worker = || {
        let builder = Builder::new(problem);
        builder.ok().map(|builder| Worker {
            builder,
            counts: bins.counts(),
            all: &all,
        })
    };
    let work = |worker: &mut Option<Worker>, block: u64| {
        let Worker {
            builder, counts, ..
        } = worker.as_mut()?;
        let first = block * BLOCK as u64;
        let count = (tolerance.builds - first).min(BLOCK as u64) as usize;
        let outcome = builder.solve(first, count);
        let mut sums = Sums::new(cells, bands.len());
        for build in 0..count {
            let values = &builder.values[build * cells..(build + 1) * cells];
            for (cell, value) in values.iter().enumerate() {
                if value.is_nan() {
                    continue;
                }
                let d = value - drawn[cell];
                let (sum, square) = (&mut sums.powers[cell], d * d);
                sum[0] += 1.0;
                sum[1] += d;
                sum[2] += square;
                sum[3] += square * d;
                sum[4] += square * square;
                let [least, greatest] = &mut sums.ranges[cell];
                *least = least.min(*value);
                *greatest = greatest.max(*value);
                bins.count(counts, cell, *value);
            }
            let mut in_all = true;
            for ((cells, [low, high]), kept) in bands.iter().zip(&mut sums.in_bands) {
                // Written so that a value that is not there is not in its band.
                let is_in = cells
                    .iter()
                    .all(|cell| values[*cell] >= *low && values[*cell] <= *high);
                *kept += u64::from(is_in);
                in_all &= is_in;
            }
            // Without bands every build that goes together is as wanted.
            in_all &= !bands.is_empty() || values.iter().any(|v| !v.is_nan());
            sums.in_all_bands += u64::from(in_all);
        }
        sums.incomplete = outcome.incomplete.len() as u64;
        let rejects = outcome.rejects.into_iter();
        sums.rejects = rejects
            .map(|(place, why)| (first + place as u64, why))
            .collect();
        Some((count as u64, sums))
    };
    let mut total = Sums::new(cells, bands.len());
    let mut rejects: BTreeMap<&'static str, (u64, u64, Reject)> = BTreeMap::new();
    let mut done = 0;
    let taken = in_order(0..blocks, worker, work, |(count, sums): (u64, Sums)| {
        for (sum, of_block) in total.powers.iter_mut().zip(&sums.powers) {
            for (s, b) in sum.iter_mut().zip(of_block) {
                *s += b;
            }
        }
        for (range, [least, greatest]) in total.ranges.iter_mut().zip(&sums.ranges) {
            *range = [range[0].min(*least), range[1].max(*greatest)];
        }
        total.incomplete += sums.incomplete;
        total.in_all_bands += sums.in_all_bands;
        for (kept, of_block) in total.in_bands.iter_mut().zip(&sums.in_bands) {
            *kept += of_block;
        }
        for (build, why) in sums.rejects {
            let entry = rejects.entry(why.word());
            entry
                .and_modify(|(count, ..)| *count += 1)
                .or_insert((1, build, why));
        }
        done += count;
        match note(done) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(()),
        }
    });
    // Ended early, it is of the builds that were taken; percentiles are of a few more, that were under way.
    let (Ok(()) | Err(())) = taken;
    // All workers are gone: every count is there.
    let counts = all
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let spreads = (0..cells).map(|cell| {
        let [n, ..] = total.powers[cell];
        let [mean, sigma, sigma_error] = moments(total.powers[cell]);
        Spread {
            count: n as u64,
            mean: drawn[cell] + mean,
            sigma,
            sigma_error,
            range: total.ranges[cell],
            percentiles: bins.percentiles(&counts, cell, total.ranges[cell]),
        }
    });
    Ok(MonteCarlo {
        builds: done,
        spreads: spreads.collect(),
        rejects,
        incomplete: total.incomplete,
        in_all_bands: total.in_all_bands,
        in_bands: total.in_bands,
    })
}

/// Mean, standard deviation and its standard error from sums of powers: var(s) = (m4 - m2^2)/(4 n m2).
fn moments([n, s1, s2, s3, s4]: [f64; 5]) -> [f64; 3] {
    let mean = s1 / n;
    let m2 = (s2 / n - mean * mean).max(0.0);
    let m4 = s4 / n - mean * (4.0 * s3 / n - mean * (6.0 * s2 / n - 3.0 * mean * mean));
    let sigma = (m2 * n / (n - 1.0)).sqrt();
    let error = ((m4 - m2 * m2).max(0.0) / (4.0 * n * m2)).sqrt();
    [mean, sigma, error]
}

/// The bins of percentiles, about the first builds.
fn pilot(problem: &Problem, drawn: &[f64]) -> Result<Bins, DesignFault> {
    let cells = problem.cells();
    let mut builder = Builder::new(problem)?;
    let mut powers = vec![[0.0; 5]; cells];
    let builds = problem.tolerance.builds.min(PILOT);
    let mut first = 0;
    while first < builds {
        let count = (builds - first).min(BLOCK as u64) as usize;
        builder.solve(first, count);
        for values in builder.values[..count * cells].chunks(cells) {
            for ((sum, value), drawn) in powers.iter_mut().zip(values).zip(drawn) {
                let d = value - drawn;
                if !d.is_nan() {
                    sum[0] += 1.0;
                    sum[1] += d;
                    sum[2] += d * d;
                }
            }
        }
        first += count as u64;
    }
    let moments: Vec<[f64; 3]> = powers.into_iter().map(moments).collect();
    let finite = |v: f64| if v.is_finite() { v } else { 0.0 };
    let means: Vec<f64> = moments
        .iter()
        .zip(drawn)
        .map(|(m, d)| finite(d + m[0]))
        .collect();
    let sigmas: Vec<f64> = moments.iter().map(|m| finite(m[1])).collect();
    Ok(Bins::about(&means, &sigmas))
}
