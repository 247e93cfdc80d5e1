//! Main effects: how much each variable influences each output.
//!
//! The computation uses only designs that are solved at every station and have a value for every output. It gives two
//! measures of influence. The *change* is the change of the output from the low end of a variable's range to its high end,
//! in the least-squares plane through all designs. It has a sign and a unit. `r2` is the share of the variance that the
//! plane explains. The *share* is the first-order Sobol index S = Var(E[y|x]) / Var(y): the part of the output's variance
//! that vanishes when this variable is known. It includes curved responses. Shares need variables that are sampled
//! independently, so designs from a file have no shares.
//!
//! For a grid, a share is the exact ratio of sums of squares over the grid. If a variable has more than 32 values (levels),
//! neighbouring levels are combined. For other samples, the part of the share that the plane explains is exact. The other
//! part comes from r, the difference between output and plane. Only this other part must be distinguished from random
//! variation. With n designs, the scaled variables u_i, and the slopes b_i of the plane:
//!
//! ```text
//! n Var(E[y|x_j]) = n b_j^2 Var(u_j) + (sum of squares of r between the levels of x_j),   y = mean + sum b_i u_i + r
//! ```
//!
//! The code subtracts from each of the two terms on the right-hand side the value that random variation alone would give.
//! The second term is the correlation ratio over levels of equal width (T. L. Kelley, An unbiased correlation ratio
//! measure, PNAS 21, 1935). This term misses the variation within a level: about 1/levels^2 of the term. The better the
//! plane fits, the smaller is the random part. If designs fail, or have no value for an output, the variables of the
//! remaining designs are no longer independent. Then the plane's part cannot be divided among the variables, and the
//! share is the second term for y instead of r. This share is still the part of the variance that vanishes when this
//! variable is known. But the sum of all shares may exceed one.
//!
//! For Saltelli's samples, the share is the mean of (y_B - mean) (y_C - y_A) (A. Saltelli et al., Computer Physics
//! Communications 181, 2010). The total index is half the mean of (y_A - y_C)^2 (M. J. W. Jansen, Computer Physics
//! Communications 117, 1999). The total index is the part of the variance that remains when all other variables are known.
//! Random variation may move either index out of the interval from 0 to 1. Such an index is set to the nearer end of the
//! interval.

use super::{SweepRecord, SweepStatistics};
use nalgebra::{DMatrix, DVector};

/// Relative spread below which an output is constant except for rounding errors.
const CONSTANT: f64 = 1e-12;

/// Effects of the variables on one output.
#[derive(Clone, Debug, PartialEq)]
pub struct Effects {
    /// Mean of the output over the designs.
    pub mean: f64,
    /// Standard deviation of the output over the designs.
    pub deviation: f64,
    /// Part of the output's variance that the least-squares plane explains.
    pub r2: Option<f64>,
    /// Effect of each variable on the output.
    pub of: Vec<Effect>,
}

/// Effect of one variable on one output.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effect {
    /// Change of the output from the low end of the variable's range to the high end, in the least-squares plane.
    pub linear_change: Option<f64>,
    /// First-order Sobol index (the *share* of the module's description).
    pub first_order_index: Option<f64>,
    /// Total Sobol index: part of the output's variance that remains when all other variables are known.
    pub total: Option<f64>,
}

impl Effects {
    /// Effects on every output. `None` if no design has a value for all outputs.
    pub fn all(record: &SweepRecord, statistics: &SweepStatistics) -> Option<Vec<Effects>> {
        let count = statistics.moments.count;
        if count == 0 {
            return None;
        }
        let plane = Plane::of(statistics);
        let of = |k| Effects::of(record, statistics, plane.as_ref(), k);
        Some((0..record.outputs.len()).map(of).collect())
    }

    fn of(
        record: &SweepRecord,
        statistics: &SweepStatistics,
        plane: Option<&Plane>,
        k: usize,
    ) -> Effects {
        let moments = &statistics.moments;
        let n = moments.count as f64;
        let mean = moments.y[k] / n;
        let squares = (moments.yy[k] - n * mean * mean).max(0.0);
        let reference = record.outputs[k].at_design.unwrap_or(0.0);
        let mut effects = Effects {
            mean: mean + reference,
            deviation: (squares / n).sqrt(),
            r2: None,
            of: vec![Effect::default(); record.variables.len()],
        };
        let size = statistics.ranges[k].map_or(0.0, |r| r.min.0.abs().max(r.max.0.abs()));
        if effects.deviation <= CONSTANT * size {
            return effects;
        }
        let fitted = plane.map(|plane| (plane, plane.slopes(statistics, k)));
        if let Some((_, (slopes, explained))) = &fitted {
            effects.r2 = Some((explained / (squares / n)).clamp(0.0, 1.0));
            for (effect, slope) in effects.of.iter_mut().zip(slopes) {
                effect.linear_change = Some(2.0 * slope);
            }
        }
        for (variable, effect) in effects.of.iter_mut().enumerate() {
            match record.method.as_str() {
                "file" => {}
                "saltelli" => {
                    (effect.first_order_index, effect.total) = exchanged(statistics, variable, k);
                }
                "grid" if moments.count == record.designs => {
                    let (between, _) = between_levels(statistics, variable, k, None);
                    effect.first_order_index = Some((between / squares).clamp(0.0, 1.0));
                }
                // The variables of an incomplete grid are not independent either.
                method if method == "grid" || moments.count < statistics.designs => {
                    let by_levels = between_levels(statistics, variable, k, None);
                    let share = share(by_levels, squares, 0.0, n);
                    effect.first_order_index = share.map(|s| (s / squares).clamp(0.0, 1.0));
                }
                _ => {
                    if let Some((plane, (slopes, explained))) = &fitted {
                        let left = (squares - n * explained).max(0.0);
                        let linear = n * slopes[variable].powi(2) * plane.variances[variable];
                        let by_levels =
                            between_levels(statistics, variable, k, Some((plane, slopes)));
                        let share = share(by_levels, left, linear, n);
                        effect.first_order_index = share.map(|s| (s / squares).clamp(0.0, 1.0));
                    }
                }
            }
        }
        effects
    }
}

/// Returns the sum of squares of an output between the levels of a variable, and the number of levels that contain designs.
/// If `plane` is given, the function first subtracts the plane from the output.
fn between_levels(
    statistics: &SweepStatistics,
    variable: usize,
    k: usize,
    plane: Option<(&Plane, &Vec<f64>)>,
) -> (f64, f64) {
    let (binned, width) = (&statistics.binned.of[variable], statistics.moments.y.len());
    let mean = statistics.moments.y[k] / statistics.moments.count as f64;
    let (mut between, mut met) = (0.0, 0.0);
    for (level, count) in binned.counts.iter().enumerate().filter(|(_, c)| **c > 0) {
        let count = *count as f64;
        let mut off = binned.sums[level * width + k] / count - mean;
        if let Some((plane, slopes)) = plane {
            let places = &binned.places[level * slopes.len()..];
            for ((slope, place), middle) in slopes.iter().zip(places).zip(plane.mean.iter()) {
                off -= slope * (place / count - middle);
            }
        }
        between += count * off * off;
        met += 1.0;
    }
    (between, met)
}

/// Returns the sum of squares of an output due to a variable. The sum has two terms: the variable's part `linear` of the
/// plane, and the variation of the plane's residual between the levels of the variable. `left` is the sum of squares of
/// all residuals, and `n` the number of designs.
fn share((between, met): (f64, f64), left: f64, linear: f64, n: f64) -> Option<f64> {
    // With few designs per level (interval of a variable's range), the effect cannot be distinguished from random variation.
    if n < 4.0 * met {
        return None;
    }
    let chance = (left - between).max(0.0) / (n - met);
    Some((linear - chance).max(0.0) + (between - (met - 1.0) * chance).max(0.0))
}

/// Returns the first-order and the total Sobol index of a variable for output `k`, from Saltelli's samples.
fn exchanged(
    statistics: &SweepStatistics,
    variable: usize,
    k: usize,
) -> (Option<f64>, Option<f64>) {
    let sums = &statistics.saltelli;
    if sums.groups < 2 {
        return (None, None);
    }
    let n = sums.groups as f64;
    let mean = sums.sum[k] / (2.0 * n);
    let variance = sums.squares[k] / (2.0 * n) - mean * mean;
    let at = variable * sums.sum.len() + k;
    // Subtracts the mean from y_B. The result converges to the same value as without this subtraction, but with less noise.
    let first = (sums.first[at] - mean * sums.steps[at]) / n;
    let total = 0.5 * sums.total[at] / n;
    let part = |of: f64| Some((of / variance).clamp(0.0, 1.0));
    (part(first), part(total))
}

/// Least-squares plane of an output over the scaled variables, through all designs.
struct Plane {
    mean: DVector<f64>,
    /// Variances of the scaled variables.
    variances: DVector<f64>,
    factors: nalgebra::Cholesky<f64, nalgebra::Dyn>,
}

impl Plane {
    /// Fits the plane through the designs of some statistics. `None` if the designs do not determine a plane: there are
    /// too few designs, or variables depend on each other.
    fn of(statistics: &SweepStatistics) -> Option<Self> {
        let moments = &statistics.moments;
        let (n, d) = (moments.count as f64, moments.u.len());
        if moments.count as usize <= d + 1 {
            return None;
        }
        let mean = DVector::from_fn(d, |i, _| moments.u[i] / n);
        let covariance = DMatrix::from_fn(d, d, |i, j| {
            let (i, j) = (i.max(j), i.min(j));
            moments.uu[i * (i + 1) / 2 + j] / n - mean[i] * mean[j]
        });
        let independent = {
            let eigenvalues = covariance.clone().symmetric_eigenvalues();
            eigenvalues.min() > 1e-9 * eigenvalues.max()
        };
        let variances = covariance.diagonal();
        let factors = covariance.cholesky().filter(|_| independent)?;
        Some(Plane {
            mean,
            variances,
            factors,
        })
    }

    /// Returns the slopes of the plane of output `k` with respect to the scaled variables, and the part of the output's
    /// variance that the plane explains.
    fn slopes(&self, statistics: &SweepStatistics, k: usize) -> (Vec<f64>, f64) {
        let moments = &statistics.moments;
        let n = moments.count as f64;
        let mean = moments.y[k] / n;
        let with_y = DVector::from_fn(self.mean.len(), |i, _| {
            moments.uy[i * moments.y.len() + k] / n - self.mean[i] * mean
        });
        let slopes = self.factors.solve(&with_y);
        let explained = slopes.dot(&with_y);
        (slopes.iter().copied().collect(), explained)
    }
}
