//! Yield, and effect of each tolerance on the yield.
//!
//! The gain from a tighter tolerance comes from the first-order result over a fixed random sample. For each random draw, the
//! code computes the contribution of each contributor to each value with a band. So the effect of half or twice a tolerance
//! needs no new random numbers and no derivatives, only sums. A predicted yield is the yield of the Monte Carlo analysis plus
//! the change of the linear yield.

use super::{Expansion, MonteCarlo, Problem};
use crate::sorting::sort_by;

/// Largest number of random draws in the sample.
const SAMPLE: u64 = 20_000;
/// Largest loss of yield, if a tolerance is doubled, for which the tolerance can be relaxed.
const LITTLE: f64 = 0.001;
/// Smallest yield for which tolerances can be relaxed. With a smaller yield, so few builds are within the bands that a
/// larger tolerance hardly changes the yield.
const LEAST: f64 = 0.05;

/// Yield of a band: share of builds within the band's lower and upper limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandYield {
    /// Share of the builds of the Monte Carlo analysis that are within the band.
    pub monte_carlo: f64,
    /// Share of a random sample within the band, by the first-order result.
    pub linear: f64,
}

/// Yields, and the effect of each contributor's tolerance on the yields.
#[derive(Clone, Debug, PartialEq)]
pub struct Yields {
    /// Yield of each band.
    pub bands: Vec<BandYield>,
    /// Yield of all bands together: share of builds within every band.
    pub all: BandYield,
    /// Contributors, in the order of the gain from halving their tolerance, largest first.
    pub ranking: Vec<Ranking>,
}

/// Effects of a contributor's tolerance on variance and yield.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranking {
    /// Index of the contributor in the study.
    pub contributor: usize,
    /// Largest share of the contributor in the variance of a value with a band.
    pub share: f64,
    /// Yield of all bands with half the tolerance of this contributor.
    pub halved: f64,
    /// Yield of all bands with twice the tolerance of this contributor.
    pub doubled: f64,
    /// True if the tolerance can be relaxed: doubling it reduces the yield very little.
    pub may_be_looser: bool,
}

/// Factors of a contributor's tolerance whose effects on the yield the ranking shows.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// A value with a band: a result at one station.
struct BandRow {
    cell: usize,
    band: usize,
    limits: [f64; 2],
    scatters: bool,
}

/// Shares of the random sample within the bands, by the first-order result.
struct Shares {
    /// Share of the sample within each band.
    bands: Vec<f64>,
    /// Share of the sample within all bands.
    all: f64,
    /// Share of the sample within all bands if the tolerance of one contributor is multiplied by each of the [`FACTORS`],
    /// `[contributor]`.
    changed: Vec<[f64; 2]>,
}

impl Shares {
    fn of(problem: &Problem, expansion: &Expansion, drawn: &[f64]) -> Self {
        let tolerance = problem.tolerance;
        let mut rows = Vec::new();
        let bands = problem.bands.iter().zip(problem.cells_of_bands());
        for (band, ((_, limits), cells)) in bands.enumerate() {
            rows.extend(cells.into_iter().map(|cell| BandRow {
                cell,
                band,
                limits: *limits,
                scatters: expansion.scatters(cell, drawn[cell]),
            }));
        }
        let contributors = tolerance.scatter.len();
        let draws = tolerance.builds.min(SAMPLE);
        let mut z = vec![0.0; tolerance.sources()];
        // The contributions and values of one draw: `[row][contributor]` and `[row]`.
        let mut parts = vec![0.0; rows.len() * contributors];
        let mut values = vec![0.0; rows.len()];
        let mut is_in = vec![true; tolerance.bands.len()];
        let mut in_bands = vec![0_u64; is_in.len()];
        let mut in_all = 0_u64;
        let mut changed = vec![[0_u64; FACTORS.len()]; contributors];
        for draw in 0..draws {
            tolerance.draw(draw, &mut z);
            is_in.fill(true);
            for (k, row) in rows.iter().enumerate() {
                let own = &mut parts[k * contributors..][..contributors];
                if row.scatters {
                    let mut terms = expansion.gradient(row.cell).iter().zip(&z);
                    for (part, contributor) in own.iter_mut().zip(&tolerance.scatter) {
                        let terms = terms.by_ref().take(contributor.sources.len());
                        *part = terms.map(|(g, z)| g * z).sum();
                    }
                }
                values[k] = drawn[row.cell] + own.iter().sum::<f64>();
                is_in[row.band] &= is_within(values[k], row.limits);
            }
            for (count, is_in) in in_bands.iter_mut().zip(&is_in) {
                *count += u64::from(*is_in);
            }
            in_all += u64::from(is_in.iter().all(|is_in| *is_in));
            for (contributor, counts) in changed.iter_mut().enumerate() {
                for (count, factor) in counts.iter_mut().zip(FACTORS) {
                    let mut of_rows = rows.iter().zip(&values).enumerate();
                    *count += u64::from(of_rows.all(|(k, (row, value))| {
                        let part = parts[k * contributors + contributor];
                        is_within(value + (factor - 1.0) * part, row.limits)
                    }));
                }
            }
        }
        let share = |count: u64| count as f64 / draws as f64;
        Shares {
            bands: in_bands.into_iter().map(share).collect(),
            all: share(in_all),
            changed: changed
                .into_iter()
                .map(|counts| counts.map(share))
                .collect(),
        }
    }
}

fn is_within(value: f64, [low, high]: [f64; 2]) -> bool {
    value >= low && value <= high
}

/// First-order part of yields and ranking. The forecast does not need builds.
pub struct Forecast {
    /// Share of the sample within each band.
    bands: Vec<f64>,
    /// Share of the sample within all bands at once.
    all: f64,
    contributors: Vec<Worth>,
}

/// Effect of a contributor's tolerance on the yield, by the first-order result.
struct Worth {
    share: f64,
    /// Change of the yield of all bands with half the contributor's tolerance.
    halved: f64,
    /// Change of the yield of all bands with twice the contributor's tolerance.
    doubled: f64,
}

impl Forecast {
    /// Makes the forecast of a problem. `None` if the study has no bands.
    pub fn of(problem: &Problem, expansion: &Expansion, drawn: &[f64]) -> Option<Self> {
        if problem.tolerance.bands.is_empty() {
            return None;
        }
        let shares = Shares::of(problem, expansion, drawn);
        let worth = |(contributor, changed): (usize, &[f64; 2])| {
            let cells = problem.cells_of_bands().flatten();
            let cells = cells.filter(|cell| expansion.scatters(*cell, drawn[*cell]));
            let share =
                |cell: usize| expansion.part(problem, cell, contributor) / expansion.variance[cell];
            let [halved, doubled] = changed.map(|all| all - shares.all);
            Worth {
                share: cells.map(share).fold(0.0, f64::max),
                halved,
                doubled,
            }
        };
        let contributors = shares.changed.iter().enumerate().map(worth).collect();
        Some(Forecast {
            contributors,
            bands: shares.bands,
            all: shares.all,
        })
    }

    /// Returns yields and ranking: the yields of the builds, plus the changes that the forecast gives.
    pub fn rank(&self, builds: &MonteCarlo) -> Yields {
        let total = builds.yield_of_all();
        let predicted = |moved: f64| (total + moved).clamp(0.0, 1.0);
        let contributors = self.contributors.iter().enumerate();
        let mut ranking: Vec<Ranking> = contributors
            .map(|(contributor, worth)| {
                let (share, doubled) = (worth.share, predicted(worth.doubled));
                Ranking {
                    contributor,
                    share,
                    halved: predicted(worth.halved),
                    doubled,
                    may_be_looser: total > LEAST && total - doubled < LITTLE,
                }
            })
            .collect();
        // Contributors with equal gains are ordered by the loss from doubling, then by their share.
        sort_by(&mut ranking, |a, b| {
            let gain = b.halved.total_cmp(&a.halved);
            gain.then(a.doubled.total_cmp(&b.doubled))
                .then(b.share.total_cmp(&a.share))
        });
        let bands = builds.in_bands.iter().zip(&self.bands);
        Yields {
            bands: bands
                .map(|(kept, linear)| BandYield {
                    monte_carlo: *kept as f64 / builds.builds as f64,
                    linear: *linear,
                })
                .collect(),
            all: BandYield {
                monte_carlo: total,
                linear: self.all,
            },
            ranking,
        }
    }
}

/// Yields and ranking. `None` if the study has no bands.
pub fn rank(
    problem: &Problem,
    expansion: &Expansion,
    builds: &MonteCarlo,
    drawn: &[f64],
) -> Option<Yields> {
    Forecast::of(problem, expansion, drawn).map(|forecast| forecast.rank(builds))
}
