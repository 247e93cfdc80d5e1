//! Scale of an axis: converts values to lengths on the picture, and chooses round ticks.

use crate::report::figure::{power_of_ten, with_minus_signs};

/// Linear or logarithmic scale of an axis, with round ticks.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::report) struct Scale {
    /// Value at the left or lower end of the axis. It is the smaller value.
    pub low: f64,
    /// Value at the other end of the axis.
    pub high: f64,
    /// Distance between ticks: a difference of values, or a number of powers of ten for a logarithmic scale.
    step: f64,
    /// True for a logarithmic scale.
    pub is_log: bool,
    /// Positions of the ends `low` and `high` on the picture.
    ends: [f64; 2],
}

impl Scale {
    /// Scale that shows all values and has about this number of ticks. Its ends are round numbers. Without values it shows 0 to 1.
    pub(in crate::report) fn showing(
        values: impl Iterator<Item = f64>,
        ticks: f64,
        ends: [f64; 2],
    ) -> Self {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        // A constant gets a range that is wide enough. Otherwise its rounding errors would look like a slope.
        let least = 1e-6 * low.abs().max(high.abs()).max(1e-3);
        let (low, high) = if low == 0.0 && high == 0.0 {
            // If all values are exactly zero, they do not determine a scale.
            (-1.0, 1.0)
        } else if high - low < least {
            (low - least, high + least)
        } else {
            (low, high)
        };
        let step = round_step((high - low) / ticks);
        Scale {
            low: (low / step).floor() * step,
            high: (high / step).ceil() * step,
            step,
            is_log: false,
            ends,
        }
    }

    /// Scale that ends exactly at the smallest and largest value, with ticks at round numbers between. A constant has the same
    /// scale as in [`Scale::showing`].
    pub(super) fn within(values: impl Iterator<Item = f64>, ticks: f64, ends: [f64; 2]) -> Self {
        let values: Vec<f64> = values.collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let round = Scale::showing(values.into_iter(), ticks, ends);
        if most - least > 1e-6 * least.abs().max(most.abs()) {
            Scale {
                low: least,
                high: most,
                ..round
            }
        } else {
            round
        }
    }

    /// Logarithmic scale that shows all positive values. Both ends are powers of ten.
    pub(super) fn logarithmic(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let positive = values.filter(|v| *v > 0.0);
        let (low, high) = positive.fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = if low <= high {
            (low, high)
        } else {
            (1.0, 10.0)
        };
        let low = low.log10().floor();
        let high = high.log10().ceil().max(low + 1.0);
        Scale {
            low: 10f64.powf(low),
            high: 10f64.powf(high),
            step: ((high - low) / 8.0).ceil(),
            is_log: true,
            ends,
        }
    }

    /// Position of a value on the picture.
    pub(in crate::report) fn place(&self, value: f64) -> f64 {
        let share = if self.is_log {
            (value / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    /// Power of ten that the tick labels leave out, a multiple of three. 0 for labels that are short enough, and for a logarithmic
    /// scale.
    pub(super) fn power(&self) -> i32 {
        if self.is_log {
            return 0;
        }
        let largest = self.low.abs().max(self.high.abs());
        let order = |value: f64| value.log10().floor() as i32;
        match (order(largest), order(self.step)) {
            // For values near one, decimals are easier to read than a power of ten: 0.7075 is better than 707.5 with 10⁻³.
            (..6, -3..) | (-1..6, -5..) => 0,
            (largest, _) => 3 * largest.div_euclid(3),
        }
    }

    /// Positions and labels of the ticks. The labels are in units of [`Scale::power`].
    pub(in crate::report) fn ticks(&self) -> Vec<(f64, String)> {
        if self.is_log {
            let [low, high] = [self.low, self.high].map(|v| v.log10().round());
            let count = ((high - low) / self.step) as usize;
            let powers = (0..=count).map(|i| low + self.step * i as f64);
            let label = |power: f64| match power as i32 {
                -2..=3 => format!("{}", 10f64.powf(power)),
                power => power_of_ten(power),
            };
            return powers
                .map(|power| (self.place(10f64.powf(power)), label(power)))
                .collect();
        }
        let [first, last] = [self.low / self.step - 1e-6, self.high / self.step + 1e-6];
        let (first, last) = (first.ceil(), last.floor());
        let count = (last - first).max(0.0) as usize;
        let unit = 10f64.powi(self.power());
        let decimals = (-(self.step / unit).log10().floor()).clamp(0.0, 12.0) as usize;
        (0..=count)
            .map(|i| {
                let value = (first + i as f64) * self.step;
                // A tick near zero gets the value 0, because rounding could give a negative zero.
                let value = if value.abs() < 0.5 * self.step {
                    0.0
                } else {
                    value
                };
                let label = with_minus_signs(&format!("{:.decimals$}", value / unit));
                (self.place(value), label)
            })
            .collect()
    }
}

/// Smallest number that is at least `step` and is 1, 2 or 5 times a power of ten.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|f| f * power >= step * 0.999);
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let scale = Scale::showing([-80.0, 80.0].into_iter(), 8.0, [400.0, 0.0]);
        let labels: Vec<String> = scale.ticks().into_iter().map(|t| t.1).collect();
        assert_eq!(
            labels,
            ["−80", "−60", "−40", "−20", "0", "20", "40", "60", "80"]
        );
        assert_eq!(scale.place(0.0), 200.0);
    }

    /// The scale ends exactly at the smallest and the largest value, and its ticks are between them.
    #[test]
    fn a_scale_can_end_where_the_values_end() {
        let scale = Scale::within([-75.0, 82.0].into_iter(), 5.0, [0.0, 157.0]);
        assert_eq!((scale.place(-75.0), scale.place(82.0)), (0.0, 157.0));
        let ticks = scale.ticks();
        let labels: Vec<&str> = ticks.iter().map(|t| t.1.as_str()).collect();
        assert_eq!(labels, ["\u{2212}50", "0", "50"]);
        assert!((ticks[1].0 - 75.0).abs() < 1e-9);
        let constant = Scale::within([3.0, 3.0].into_iter(), 5.0, [0.0, 1.0]);
        assert!(constant.low < 3.0 && constant.high > 3.0);
    }

    #[test]
    fn small_ticks_are_short() {
        let scale = Scale::showing([0.0, 6.0e-4].into_iter(), 5.0, [0.0, 100.0]);
        assert_eq!(scale.power(), -6);
        let labels: Vec<String> = scale.ticks().into_iter().map(|t| t.1).collect();
        assert_eq!(labels, ["0", "200", "400", "600"]);
        let scale = Scale::showing([0.0, 0.06].into_iter(), 5.0, [0.0, 100.0]);
        assert_eq!((scale.power(), &*scale.ticks()[1].1), (0, "0.02"));
        let scale = Scale::within([0.7075, 0.7105].into_iter(), 5.0, [0.0, 1.0]);
        assert_eq!(scale.power(), 0);
        let scale = Scale::showing([-2.5e7, 0.0].into_iter(), 5.0, [0.0, 100.0]);
        assert_eq!((scale.power(), &*scale.ticks()[0].1), (6, "\u{2212}25"));
    }

    /// Each power of ten takes the same length, and both ends are powers of ten.
    #[test]
    fn powers_of_ten_are_evenly_spaced() {
        let scale = Scale::logarithmic([0.02, 0.0, 350.0].into_iter(), [0.0, 50.0]);
        let ticks = scale.ticks();
        let labels: Vec<&str> = ticks.iter().map(|t| t.1.as_str()).collect();
        assert_eq!(labels, ["0.01", "0.1", "1", "10", "100", "1000"]);
        for (k, (place, _)) in ticks.iter().enumerate() {
            assert!((place - 10.0 * k as f64).abs() < 1e-9, "{place}");
        }
        let wide = Scale::logarithmic([1e-12, 1e5].into_iter(), [0.0, 50.0]);
        assert!((3..=9).contains(&wide.ticks().len()));
    }

    #[test]
    fn a_constant_and_nothing_have_scales() {
        let constant = Scale::showing([3.0, 3.0].into_iter(), 5.0, [0.0, 100.0]);
        assert!((0.0..=100.0).contains(&constant.place(3.0)));
        assert!(constant.ticks().len() >= 2);
        assert!(
            Scale::showing([].into_iter(), 5.0, [0.0, 100.0])
                .place(0.5)
                .is_finite()
        );
    }
}
