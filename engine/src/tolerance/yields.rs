//! Yield, and effect of each tolerance on the yield.
//!
//! The gain from a tighter tolerance comes from the first-order result over a fixed random sample. The code stores the
//! contribution of each contributor to each value with a band. So the effect of half or twice a tolerance needs no new random
//! numbers and no derivatives, only sums. A predicted yield is the yield of the Monte Carlo analysis plus the change of the
//! linear yield.

use super::{Expansion, MonteCarlo, Problem};
use crate::sorting::sort_by;

/// Largest number of random draws in the sample.
const SAMPLE: u64 = 20_000;
/// Largest loss of yield, if a tolerance is doubled, for which the tolerance can be relaxed.
const LITTLE: f64 = 0.001;
/// Smallest yield for which tolerances can be relaxed. With a smaller yield, so few builds are within the bands that a
/// larger tolerance hardly changes the yield.
const LEAST: f64 = 0.05;

/// Yield of a band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandYield {
    /// Share of the builds within the band.
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
    /// Yield with half the tolerance.
    pub halved: f64,
    /// Yield with twice the tolerance.
    pub doubled: f64,
    /// True if the tolerance can be relaxed: doubling it reduces the yield very little.
    pub may_be_looser: bool,
}

/// Random sample that gives the yield of all bands when tolerances of contributors are multiplied by factors.
struct Sample {
    /// Rows of the sample: each row is one value with a band, a result at one station. `parts` holds the contribution of each
    /// contributor to each value, `[draw][row][contributor]`.
    parts: Vec<f64>,
    /// Nominal value of each row.
    drawn: Vec<f64>,
    /// Index of the band of each row, and the limits of this band.
    rows: Vec<(usize, [f64; 2])>,
    contributors: usize,
    bands: usize,
}

impl Sample {
    fn of(problem: &Problem, expansion: &Expansion, drawn: &[f64]) -> Self {
        let tolerance = problem.tolerance;
        let mut rows = Vec::new();
        let mut cells = Vec::new();
        let bands = problem.bands.iter().zip(problem.cells_of_bands());
        for (number, ((_, limits), own)) in bands.enumerate() {
            rows.extend(own.iter().map(|_| (number, *limits)));
            cells.extend(own);
        }
        let contributors = tolerance.scatter.len();
        let draws = tolerance.builds.min(SAMPLE);
        let mut parts = vec![0.0; draws as usize * rows.len() * contributors];
        let mut z = vec![0.0; tolerance.sources()];
        let mut place = 0;
        for draw in 0..draws {
            tolerance.draw(draw, &mut z);
            for cell in &cells {
                if !expansion.scatters(*cell, drawn[*cell]) {
                    place += contributors;
                    continue;
                }
                let mut terms = expansion.gradient(*cell).iter().zip(&z);
                for contributor in &tolerance.scatter {
                    let own = terms.by_ref().take(contributor.sources.len());
                    parts[place] = own.map(|(g, z)| g * z).sum();
                    place += 1;
                }
            }
        }
        Sample {
            parts,
            drawn: cells.iter().map(|cell| drawn[*cell]).collect(),
            rows,
            contributors,
            bands: tolerance.bands.len(),
        }
    }

    /// Share of the sample in each band, and in all bands. `changed` gives a contributor and the factor for its tolerance;
    /// `None` leaves all tolerances unchanged.
    fn yields(&self, changed: Option<(usize, f64)>) -> (Vec<f64>, f64) {
        let mut in_bands = vec![0_u64; self.bands];
        let (mut in_all, mut draws) = (0_u64, 0_u64);
        let mut is_in = vec![true; self.bands];
        for draw in self.parts.chunks(self.rows.len() * self.contributors) {
            is_in.fill(true);
            let rows = draw
                .chunks(self.contributors)
                .zip(&self.rows)
                .zip(&self.drawn);
            for ((parts, (band, [low, high])), drawn) in rows {
                let mut value = drawn + parts.iter().sum::<f64>();
                if let Some((contributor, factor)) = changed {
                    value += (factor - 1.0) * parts[contributor];
                }
                is_in[*band] &= value >= *low && value <= *high;
            }
            for (count, is_in) in in_bands.iter_mut().zip(&is_in) {
                *count += u64::from(*is_in);
            }
            in_all += u64::from(is_in.iter().all(|is_in| *is_in));
            draws += 1;
        }
        let share = |count: u64| count as f64 / draws as f64;
        (in_bands.into_iter().map(share).collect(), share(in_all))
    }
}

/// First-order part of yields and ranking. The forecast does not need builds.
pub struct Forecast {
    /// Share of the sample in each band, and in all bands.
    bands: Vec<f64>,
    all: f64,
    contributors: Vec<Worth>,
}

/// Effect of a contributor's tolerance on the yield, by the first-order result.
struct Worth {
    share: f64,
    /// Change of the yield with half the tolerance, and with twice the tolerance.
    halved: f64,
    doubled: f64,
}

impl Forecast {
    /// Makes the forecast of a problem. `None` if the study has no bands.
    pub fn of(problem: &Problem, expansion: &Expansion, drawn: &[f64]) -> Option<Self> {
        if problem.tolerance.bands.is_empty() {
            return None;
        }
        let sample = Sample::of(problem, expansion, drawn);
        let (bands, all) = sample.yields(None);
        let moved =
            |contributor: usize, factor: f64| sample.yields(Some((contributor, factor))).1 - all;
        let worth = |contributor: usize| {
            let cells = problem.cells_of_bands().flatten();
            let cells = cells.filter(|cell| expansion.scatters(*cell, drawn[*cell]));
            let share =
                |cell: usize| expansion.part(problem, cell, contributor) / expansion.variance[cell];
            Worth {
                share: cells.map(share).fold(0.0, f64::max),
                halved: moved(contributor, 0.5),
                doubled: moved(contributor, 2.0),
            }
        };
        let contributors = (0..problem.tolerance.scatter.len()).map(worth).collect();
        Some(Forecast {
            bands,
            all,
            contributors,
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
