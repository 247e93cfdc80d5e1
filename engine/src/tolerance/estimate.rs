//! Estimated scatter of one value, and its comparison with builds.

use super::Spread;
use super::monte_carlo::FEWEST;

/// Largest second-order term for which the linear result is valid, as a share of the variance. Also the largest difference
/// between the standard deviations of builds and of the linear result, as a share, beyond the sampling error.
pub const HOLDS: f64 = 0.02;

/// Bound of rounding errors, relative to the value, or to 1 unit (rad, mm) for small values. Values with a smaller difference
/// count as equal. Example: the cambers of two builds that alignment sets to the same value.
const ROUNDING: f64 = 1e-12;

/// Largest rounding error of a value.
fn rounding(value: f64) -> f64 {
    ROUNDING * value.abs().max(1.0)
}

/// Limits of a band, moved outwards by the rounding error at each limit. So a value that alignment sets exactly to a limit
/// counts as within the band.
pub fn with_rounding([low, high]: [f64; 2]) -> [f64; 2] {
    [low - rounding(low), high + rounding(high)]
}

/// Estimate of the scatter of a value, from its derivatives at the nominal design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// First-order variance of the value.
    pub variance: f64,
    /// Second-order terms of the value's mean and of its variance. NaN if unknown.
    pub second: [f64; 2],
}

/// Part of the variance of builds that the first-order parts of the contributors do not explain: curvature, interaction and
/// sampling error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder {
    /// Remainder divided by the builds' variance. This share and the shares of the contributors add up to 1.
    pub part: f64,
    /// Standard error of `part`.
    pub error: f64,
    /// Part of the variance that the second-order terms predict. NaN if unknown.
    pub second: f64,
}

impl Estimate {
    /// First-order standard deviation of the value.
    pub fn sigma(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Returns true if a value with this nominal value scatters. If it does not scatter, builds differ only by rounding
    /// errors. Rounding errors have no shares in the variance and do not reduce the yield.
    pub fn scatters(&self, drawn: f64) -> bool {
        self.sigma() > rounding(drawn)
    }

    /// Second-order term as a share of the first-order variance. NaN if unknown.
    pub fn bend(&self) -> f64 {
        let [mean, variance] = self.second;
        (mean * mean).max(variance) / self.variance
    }

    /// Returns true if the linear result of a value that scatters is valid. The second-order term and the builds must confirm
    /// it. `None` with fewer than four builds, or if the linear result has no standard deviation. Also `None` if the builds do
    /// not refute the linear result, but the second-order term is unknown.
    pub fn holds(&self, spread: &Spread) -> Option<bool> {
        // So few builds have no standard error, so they cannot confirm the estimate.
        if spread.count < FEWEST {
            return None;
        }
        // The second-order term may be small although higher orders or rejected builds matter. Only the builds show such
        // effects.
        let apart = (spread.sigma - self.sigma()).abs();
        // A missing nominal value has no linear result.
        if apart.is_nan() {
            return None;
        }
        if apart > HOLDS * self.sigma() + 4.0 * spread.sigma_error {
            return Some(false);
        }
        self.is_straight()
    }

    /// Returns true if the second-order term is small. `None` if the term is unknown.
    pub fn is_straight(&self) -> Option<bool> {
        let bend = self.bend();
        (!bend.is_nan()).then_some(bend < HOLDS)
    }

    /// Part of the builds' variance that first order does not explain.
    pub fn remainder(&self, spread: &Spread) -> Remainder {
        let variance = spread.sigma * spread.sigma;
        let explained = self.variance / variance;
        Remainder {
            part: 1.0 - explained,
            error: 2.0 * explained * spread.sigma_error / spread.sigma,
            second: self.second[1] / variance,
        }
    }

    /// Converts the estimate to another unit, in which numbers are `factor` times as large.
    pub fn scaled(&self, factor: f64) -> Self {
        let [mean, variance] = self.second;
        Estimate {
            variance: factor * factor * self.variance,
            second: [factor * mean, factor * factor * variance],
        }
    }
}
