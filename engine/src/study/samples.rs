//! Target values at each drive value. The values between the points of a curve are interpolated.

use super::drive_rounding::{DriveRounding, ends_of_curve};
use super::{Interpolation, Limit, Target, TargetKind, Wanted};
use crate::axle::{Axle, Placement, Quantity};
use crate::number::Each;

/// Range of target values at a drive value, from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Drive value at which the target range applies.
    pub drive: f64,
    /// Lowest target value.
    pub low: f64,
    /// Highest target value. It equals `low` if the target is a single value.
    pub high: f64,
}

impl Sample {
    /// Returns true if the target is a range: any value between two limits meets the target.
    #[inline]
    pub fn is_band(&self) -> bool {
        self.low < self.high
    }

    /// Deviation of a value from the target range. 0 within the limits.
    #[inline]
    pub fn deviation(&self, found: f64) -> f64 {
        found - found.clamp(self.low, self.high)
    }
}

/// Target range of a quantity of an axle in one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxleSample {
    /// Pose of the axle.
    pub placement: Placement,
    /// Quantity with the target range.
    pub quantity: Quantity,
    /// Target range of the quantity. Its field `drive` is the value of the coordinate that varies, as written in the study.
    pub wanted: Sample,
}

impl Target {
    /// Target ranges for an axle: one for each value of the varying coordinate at which the target applies, each pose with this
    /// value, and each quantity. Empty for a target of one wheel.
    pub fn axle_samples(&self, axle: &Axle) -> Vec<AxleSample> {
        let (TargetKind::Axle(quantities), Some(site)) = (&self.of.kind, &self.site.axle) else {
            return Vec::new();
        };
        let mut samples = Vec::new();
        for wanted in self.wanted.samples(&self.stations_among(&site.values)) {
            for placement in site.placements(wanted.drive, axle) {
                samples.extend(quantities.iter().map(|quantity| AxleSample {
                    placement,
                    quantity: *quantity,
                    wanted,
                }));
            }
        }
        samples
    }
}

impl Wanted {
    /// Target ranges at the stations within the target's curve, or at the target's own drive values.
    pub fn samples(&self, stations: &[f64]) -> Vec<Sample> {
        let rounding = DriveRounding::of(stations);
        let value = |(drive, value)| Sample {
            drive,
            low: value,
            high: value,
        };
        match self {
            Wanted::Band { at, lower, upper } => {
                let stations = at.as_ref().map_or(stations, std::slice::from_ref);
                let limit = |limit: &Option<Limit>, drive: f64| limit.as_ref()?.at(drive, rounding);
                // Each limit applies only within its own curve. A station without a limit has no sample.
                let sample = |drive: &f64| {
                    let limits = [lower, upper].each(|own| limit(own, *drive));
                    let [low, high] = limits;
                    limits.iter().any(Option::is_some).then(|| Sample {
                        drive: *drive,
                        low: low.unwrap_or(f64::NEG_INFINITY),
                        high: high.unwrap_or(f64::INFINITY),
                    })
                };
                stations.iter().filter_map(sample).collect()
            }
            _ => self.at_stations(stations).into_iter().map(value).collect(),
        }
    }

    /// Target values of a single value or a curve, as (drive value, value). They apply at the stations within the curve, or
    /// at the target's own drive values. Empty for a band.
    pub fn at_stations(&self, stations: &[f64]) -> Vec<(f64, f64)> {
        match self {
            Wanted::At { drive, value } => vec![(*drive, *value)],
            Wanted::Points(points) => points.iter().map(|p| (p[0], p[1])).collect(),
            Wanted::Band { .. } => Vec::new(),
            Wanted::Curve {
                points,
                interpolation,
            } => {
                let slopes = interpolation.slopes(points);
                let (ends, rounding) = (ends_of_curve(points), DriveRounding::of(stations));
                let on_curve = stations.iter().filter(|s| rounding.is_within(**s, ends));
                on_curve
                    .map(|s| (*s, at(points, slopes.as_deref(), *s)))
                    .collect()
            }
        }
    }
}

impl Limit {
    /// Limit at a drive value. `None` outside the limit's curve.
    fn at(&self, drive: f64, rounding: DriveRounding) -> Option<f64> {
        match self {
            Limit::Value(value) => Some(*value),
            Limit::Curve {
                points,
                interpolation,
            } => {
                let slopes = interpolation.slopes(points);
                rounding
                    .is_within(drive, ends_of_curve(points))
                    .then(|| at(points, slopes.as_deref(), drive))
            }
        }
    }
}

impl Interpolation {
    /// Slopes at the points of a curve. `None` for straight lines.
    fn slopes(self, points: &[[f64; 2]]) -> Option<Vec<f64>> {
        match self {
            Interpolation::Linear => None,
            Interpolation::MonotoneCubic => Some(monotone_slopes(points)),
        }
    }
}

/// Value of the curve at `x`. `x` lies between the first and the last point, or outside by a rounding error only.
fn at(points: &[[f64; 2]], slopes: Option<&[f64]>, x: f64) -> f64 {
    let right = points
        .partition_point(|p| p[0] <= x)
        .clamp(1, points.len() - 1);
    let ([x0, y0], [x1, y1]) = (points[right - 1], points[right]);
    let width = x1 - x0;
    let t = (x - x0) / width;
    match slopes {
        None => y0 + (y1 - y0) * t,
        Some(slopes) => {
            // Cubic Hermite polynomial between the two neighbouring points.
            let (m0, m1) = (slopes[right - 1] * width, slopes[right] * width);
            let rise = y1 - y0;
            y0 + t * (m0 + t * ((3.0 * rise - 2.0 * m0 - m1) + t * (m0 + m1 - 2.0 * rise)))
        }
    }
}

/// Slopes of a piecewise cubic that is monotone in each interval in which its points are monotone. A slope is zero at
/// turning points. Elsewhere it is the weighted harmonic mean of the neighbouring secants (F. N. Fritsch, J. Butland, A
/// method for constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat. Comput. 5, 1984). At the ends it
/// is the slope of the parabola through three points, limited in the same way.
fn monotone_slopes(points: &[[f64; 2]]) -> Vec<f64> {
    let widths: Vec<f64> = points.windows(2).map(|p| p[1][0] - p[0][0]).collect();
    let secants: Vec<f64> = points
        .windows(2)
        .zip(&widths)
        .map(|(p, width)| (p[1][1] - p[0][1]) / width)
        .collect();
    let last = points.len() - 1;
    if last == 1 {
        return vec![secants[0]; 2];
    }
    let inner = |k: usize| {
        let (before, after) = (secants[k - 1], secants[k]);
        if before * after <= 0.0 {
            return 0.0;
        }
        let (a, b) = (
            2.0 * widths[k] + widths[k - 1],
            widths[k] + 2.0 * widths[k - 1],
        );
        (a + b) / (a / before + b / after)
    };
    let end = |near: usize, far: usize| {
        let (h0, h1) = (widths[near], widths[far]);
        let (s0, s1) = (secants[near], secants[far]);
        let slope = ((2.0 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
        if slope * s0 <= 0.0 {
            0.0
        } else if s0 * s1 <= 0.0 && slope.abs() > 3.0 * s0.abs() {
            3.0 * s0
        } else {
            slope
        }
    };
    (0..=last)
        .map(|k| match k {
            0 => end(0, 1),
            k if k == last => end(last - 1, last - 2),
            k => inner(k),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[[f64; 2]], interpolation: Interpolation) -> Wanted {
        Wanted::Curve {
            points: points.to_vec(),
            interpolation,
        }
    }

    #[test]
    fn a_curve_is_compared_between_its_ends_only() {
        let wanted = curve(&[[-1.0, 2.0], [1.0, 4.0]], Interpolation::MonotoneCubic);
        let found = wanted.at_stations(&[-2.0, -1.0, 0.0, 0.5, 1.0, 1.5]);
        assert_eq!(found, [(-1.0, 2.0), (0.0, 3.0), (0.5, 3.5), (1.0, 4.0)]);
    }

    #[test]
    fn limits_of_a_band_do_not_shorten_each_other() {
        let lower = Limit::Curve {
            points: vec![[-1.0, -2.0], [1.0, -1.0]],
            interpolation: Interpolation::Linear,
        };
        let band = |upper| Wanted::Band {
            at: None,
            lower: Some(lower.clone()),
            upper,
        };
        let limits = |band: Wanted| -> Vec<[f64; 3]> {
            let samples = band.samples(&[-3.0, 0.0, 3.0]).into_iter();
            samples.map(|s| [s.drive, s.low, s.high]).collect()
        };
        let none = f64::NEG_INFINITY;
        assert_eq!(
            limits(band(Some(Limit::Value(-0.5)))),
            [[-3.0, none, -0.5], [0.0, -1.5, -0.5], [3.0, none, -0.5]]
        );
        // Beyond its ends, the curve sets no limit.
        assert_eq!(limits(band(None)), [[0.0, -1.5, f64::INFINITY]]);
    }

    #[test]
    fn three_points_of_a_monotone_parabola_give_the_parabola_near_its_ends() {
        // For y = x^2 at 1, 2, 3, the end slopes 2 and 6 are exact.
        let slopes = monotone_slopes(&[[1.0, 1.0], [2.0, 4.0], [3.0, 9.0]]);
        assert_eq!((slopes[0], slopes[2]), (2.0, 6.0));
    }

    #[test]
    fn nothing_overshoots() {
        let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 1.0], [5.0, -2.0]];
        let stations: Vec<f64> = (0..=500).map(|i| f64::from(i) / 100.0).collect();
        let found = curve(&points, Interpolation::MonotoneCubic).at_stations(&stations);
        for pair in found.windows(2) {
            let (x, rise) = (pair[0].0, pair[1].1 - pair[0].1);
            let wanted = if x < 1.0 || (2.0..3.0).contains(&x) {
                rise.abs() < 1e-15
            } else if x < 2.0 {
                rise >= 0.0
            } else {
                rise <= 0.0
            };
            assert!(wanted, "at {x}: {rise}");
        }
    }
}
