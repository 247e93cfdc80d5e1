//! Box of the design variables.

use super::ActiveBound;
use nalgebra::DVector;

/// Lowest and highest values of the variables, in their own units.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    lower: DVector<f64>,
    upper: DVector<f64>,
    width: DVector<f64>,
}

/// A range that is empty, or not finite.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("variable {variable}: the range {lower} to {upper} is empty or not finite")]
pub struct EmptyRange {
    /// Index of the variable that has this range.
    pub variable: usize,
    /// Lowest value of the range, in the variable's unit.
    pub lower: f64,
    /// Highest value of the range, in the variable's unit.
    pub upper: f64,
}

impl Bounds {
    /// Makes the box of the ranges `[lowest, highest]`. Every range needs a positive, finite width, because steps are
    /// measured in fractions of the width.
    pub fn new(ranges: &[[f64; 2]]) -> Result<Self, EmptyRange> {
        for (variable, &[lower, upper]) in ranges.iter().enumerate() {
            if !(lower < upper && (upper - lower).is_finite()) {
                return Err(EmptyRange {
                    variable,
                    lower,
                    upper,
                });
            }
        }
        let column = |value: fn(&[f64; 2]) -> f64| {
            DVector::from_iterator(ranges.len(), ranges.iter().map(value))
        };
        Ok(Bounds {
            lower: column(|range| range[0]),
            upper: column(|range| range[1]),
            width: column(|range| range[1] - range[0]),
        })
    }

    /// Number of variables.
    pub fn variables(&self) -> usize {
        self.width.len()
    }

    /// Lowest values of the variables.
    pub fn lower(&self) -> &DVector<f64> {
        &self.lower
    }

    /// Highest values of the variables.
    pub fn upper(&self) -> &DVector<f64> {
        &self.upper
    }

    /// Widths of the variables' ranges: highest minus lowest values.
    pub fn width(&self) -> &DVector<f64> {
        &self.width
    }

    /// Point of the box nearest to `x`.
    pub fn nearest(&self, x: &DVector<f64>) -> DVector<f64> {
        x.zip_zip_map(&self.lower, &self.upper, |x, lower, upper| {
            x.clamp(lower, upper)
        })
    }

    /// Position of each variable of `x` relative to its bounds.
    pub fn active_bounds(&self, x: &DVector<f64>) -> Vec<ActiveBound> {
        let of = |j: usize| match x[j] {
            x if x <= self.lower[j] => ActiveBound::Lower,
            x if x >= self.upper[j] => ActiveBound::Upper,
            _ => ActiveBound::Free,
        };
        (0..self.variables()).map(of).collect()
    }

    /// Length of the move from `from` to `to`, with each coordinate in fractions of its range.
    pub fn distance(&self, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
        (to - from).component_div(&self.width).norm()
    }
}
