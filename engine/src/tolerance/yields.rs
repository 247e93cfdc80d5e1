//! Yield, and the tolerances that are worth spending money on.
//!
//! The first-order answer over a fixed sample of draws gives the gain from a tighter tolerance. Each contributor's
//! part of each banded value is stored, so that a tolerance is halved or doubled with one addition. Predicted yields
//! are those of the Monte Carlo analysis, changed by the difference of the linear ones.

use super::{Expansion, MonteCarlo, Problem};

/// Draws of the sample.
const SAMPLE: u64 = 20_000;
/// A tolerance may be looser if doubling it costs less than this part of the yield.
const LITTLE: f64 = 0.001;
/// Nothing is called loose if the yield is below this, or if the contributor has more than this share of a variance.
const SMALL: f64 = 0.05;

/// The yield of a band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandYield {
    /// Share of the builds that keep to the band.
    pub monte_carlo: f64,
    /// The same share by the first-order answer, over a sample of draws.
    pub linear: f64,
}

/// Yields, and the effect of each contributor on them.
#[derive(Clone, Debug, PartialEq)]
pub struct Yields {
    /// Yield of each band.
    pub bands: Vec<BandYield>,
    /// Yield of all bands together: of builds that keep to every one.
    pub all: BandYield,
    /// Contributors, the one first whose halving gains most.
    pub ranking: Vec<Ranking>,
}

/// Effects of a contributor's tolerance on variance and yield.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranking {
    /// Number among those of the study.
    pub contributor: usize,
    /// Largest share of the variance of a banded value.
    pub share: f64,
    /// The yield if its tolerance were half.
    pub halved: f64,
    /// The yield if it were double.
    pub doubled: f64,
    /// True if the tolerance may be looser: doubling it costs almost no yield.
    pub may_be_looser: bool,
}

/// The yield of all bands if the tolerance of several contributors is multiplied by factors.
struct Sample {
    /// `[draw][row][contributor]`: the contributor's part of the row's value.
    parts: Vec<f64>,
    /// Drawn values by row.
    drawn: Vec<f64>,
    /// Band of each row and its ends.
    rows: Vec<(usize, [f64; 2])>,
    contributors: usize,
    bands: usize,
}

impl Sample {
    fn of(problem: &Problem, expansion: &Expansion, drawn: &[f64]) -> Self {
        let tolerance = problem.tolerance;
        let mut rows = Vec::new();
        let mut cells = Vec::new();
        for (number, (band, own)) in tolerance
            .bands
            .iter()
            .zip(problem.cells_of_bands())
            .enumerate()
        {
            rows.extend(own.iter().map(|_| (number, band.between)));
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

    /// The share of draws in each band and in all of them, with the tolerance of one contributor multiplied.
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

/// The first-order part of yields and ranking, which no build is needed for.
pub struct Forecast {
    /// Share of the sample in each band, and in all of them.
    bands: Vec<f64>,
    all: f64,
    contributors: Vec<Worth>,
}

/// The first-order worth of a contributor.
struct Worth {
    share: f64,
    /// The change of the yield if its tolerance were half, and if it were double.
    halved: f64,
    doubled: f64,
}

impl Forecast {
    /// The forecast of a problem; `None` where a study has no bands.
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
            let share =
                |cell: usize| expansion.part(problem, cell, contributor) / expansion.variance[cell];
            let shares = cells.map(share).filter(|share| share.is_finite());
            Worth {
                share: shares.fold(0.0, f64::max),
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

    /// Yields and ranking: the builds' yields, changed by the difference of the forecast.
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
                    may_be_looser: total > SMALL && share < SMALL && total - doubled < LITTLE,
                }
            })
            .collect();
        // Equal gains are ordered by the cost of letting go, then by share.
        ranking.sort_by(|a, b| {
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

/// Yields and ranking; `None` where a study has no bands.
pub fn rank(
    problem: &Problem,
    expansion: &Expansion,
    builds: &MonteCarlo,
    drawn: &[f64],
) -> Option<Yields> {
    Forecast::of(problem, expansion, drawn).map(|forecast| forecast.rank(builds))
}
