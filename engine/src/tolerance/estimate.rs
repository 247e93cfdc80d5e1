//! Estimated scatter of one value, and its comparison with builds.

use super::Spread;

/// Limit for the second-order term as a share of the variance. Below it, the linear result is valid.
pub const HOLDS: f64 = 0.02;

/// Bound of rounding errors, relative to the value or to 1 of its unit (rad, mm). Values closer to one another are equal, for
/// example the camber of two builds that alignment sets.
const ROUNDING: f64 = 1e-12;

/// Largest rounding error of a value.
fn rounding(value: f64) -> f64 {
    ROUNDING * value.abs().max(1.0)
}

/// Limits of a band, moved outwards by the rounding error of a value there. A value that alignment holds at a limit keeps the
/// band.
pub fn with_rounding([low, high]: [f64; 2]) -> [f64; 2] {
    [low - rounding(low), high + rounding(high)]
}

/// Estimate of the scatter of a value by its derivatives at the nominal design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// First-order variance.
    pub variance: f64,
    /// Second-order terms of the mean and of the variance. NaN if unknown.
    pub second: [f64; 2],
}

/// Part of the variance of builds that remains after the first-order parts of the contributors: curvature, interaction and
/// sampling error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remainder {
    /// Remainder divided by the builds' variance. With the parts of the contributors it adds up to 1.
    pub part: f64,
    /// Standard error.
    pub error: f64,
    /// The remainder's share by second order. NaN if it is not known.
    pub second: f64,
}

impl Estimate {
    /// First-order standard deviation.
    pub fn sigma(&self) -> f64 {
        self.variance.sqrt()
    }

    /// Returns true if a value with this nominal scatters. Otherwise only rounding errors differ, and these have no shares and
    /// cost no yield.
    pub fn scatters(&self, drawn: f64) -> bool {
        self.sigma() > rounding(drawn)
    }

    /// Second-order term as a share of the first-order variance. NaN if it is not known.
    pub fn bend(&self) -> f64 {
        let [mean, variance] = self.second;
        (mean * mean).max(variance) / self.variance
    }

    /// Returns true if the linear result of a value that scatters is valid, by its second order and by builds. `None` if that is
    /// unknown.
    pub fn holds(&self, spread: &Spread) -> Option<bool> {
        // Without builds, the estimate cannot be confirmed.
        if spread.count == 0 {
            return None;
        }
        // The second order may be small while higher orders or rejected builds matter. Only the builds show this.
        let apart = (spread.sigma - self.sigma()).abs();
        if apart > HOLDS * self.sigma() + 4.0 * spread.sigma_error {
            return Some(false);
        }
        self.is_straight()
    }

    /// Returns true if the second-order term is small. `None` if it is not known.
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

    /// Estimate of the value in other units, `factor` times as large as a number.
    pub fn scaled(&self, factor: f64) -> Self {
        let [mean, variance] = self.second;
        Estimate {
            variance: factor * factor * self.variance,
            second: [factor * mean, factor * factor * variance],
        }
    }
}
