//! Comparison of drive values, with an allowance for rounding errors.
//!
//! The program computes the stations of a range, converts angles, and rounds numbers in a conversion of units. A station and
//! a drive value that denote the same pose can therefore differ in their last digits.

/// Bound of the rounding errors of a station and of a drive value together, relative to the largest value. Each has at most
/// five rounded operations: conversion of the unit, product, sum and quotient for the position in the range, and conversion of
/// an angle. The error of one operation is at most half of `EPSILON`.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Largest difference of two drive values that denote the same pose.
#[derive(Clone, Copy, Debug)]
pub struct DriveRounding {
    allowance: f64,
}

impl DriveRounding {
    /// Returns the allowance for stations and other drive values in the same unit.
    pub fn of<'a>(values: impl IntoIterator<Item = &'a f64>) -> Self {
        let sizes = values.into_iter().map(|value| value.abs());
        DriveRounding {
            allowance: ROUNDING * sizes.fold(0.0, f64::max),
        }
    }

    /// Returns true if a drive value lies in the range between two others, both included.
    pub fn is_within(self, value: f64, [low, high]: [f64; 2]) -> bool {
        (low - self.allowance..=high + self.allowance).contains(&value)
    }

    /// Returns true if two drive values are the same.
    pub(crate) fn is_same(self, one: f64, other: f64) -> bool {
        self.is_within(one, [other; 2])
    }

    /// Returns true if a list has this drive value.
    pub(crate) fn is_among(self, value: f64, list: &[f64]) -> bool {
        list.iter().any(|own| self.is_same(value, *own))
    }
}

/// First and last drive value of a curve.
pub(crate) fn ends_of_curve(points: &[[f64; 2]]) -> [f64; 2] {
    [points[0][0], points[points.len() - 1][0]]
}

/// Lowest and highest of these drive values.
pub(crate) fn ends(values: &[f64]) -> [f64; 2] {
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [lowest, highest]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stations of ranges in inches, computed in floating point, lie within a target curve that ends at the same travels.
    #[test]
    fn computed_stations_lie_within_a_range_with_the_same_ends() {
        for last in 1..60_i32 {
            let ends = [-f64::from(last) / 25.4, f64::from(last) / 25.4];
            let stations = (0..=120).map(|i| (-60.0 / 25.4) + f64::from(i) * (1.0 / 25.4));
            let stations: Vec<f64> = stations.collect();
            let rounding = DriveRounding::of(&stations);
            let within = stations.iter().filter(|at| rounding.is_within(**at, ends));
            assert_eq!(within.count() as i32, 2 * last + 1, "to {last} mm");
        }
    }

    /// A difference of a nanometre in a metre is no rounding.
    #[test]
    fn different_drive_values_stay_different() {
        let rounding = DriveRounding::of(&[1000.0]);
        assert!(!rounding.is_same(1000.0, 1000.0 + 1e-6));
        assert!(!rounding.is_within(-1e-6, [0.0, 1000.0]));
        assert!(!DriveRounding::of(&[0.0]).is_same(0.0, f64::MIN_POSITIVE));
    }
}
