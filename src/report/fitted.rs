//! Confidence intervals of fitted variables, for files and tables.

use super::figure::{brief, with_decimals, with_plus};
use super::table::{Cell, Column};
use crate::optimise::ConfidenceInterval;
use serde::{Deserialize, Serialize};

/// 95 % confidence interval of the offset of a fitted variable, as in `summary.json`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "confidence", rename_all = "snake_case")]
pub enum FittedOffset {
    /// The offset is between two ends. One of them may be the end of the range.
    TwoSided {
        /// Lowest offset of the interval.
        offset_lower: f64,
        /// Highest offset of the interval.
        offset_upper: f64,
    },
    /// The variable is at its lower bound, so the interval has only an upper end.
    AtMost {
        /// Highest offset of the interval.
        offset_upper: f64,
    },
    /// The variable is at its upper bound, so the interval has only a lower end.
    AtLeast {
        /// Lowest offset of the interval.
        offset_lower: f64,
    },
    /// The offset can be anywhere in the range.
    NotDetermined,
}

impl From<ConfidenceInterval> for FittedOffset {
    fn from(interval: ConfidenceInterval) -> Self {
        // Adding 0.0 avoids negative zeros in files.
        match interval {
            ConfidenceInterval::TwoSided { lower, upper } => FittedOffset::TwoSided {
                offset_lower: lower + 0.0,
                offset_upper: upper + 0.0,
            },
            ConfidenceInterval::AtMost(upper) => FittedOffset::AtMost {
                offset_upper: upper + 0.0,
            },
            ConfidenceInterval::AtLeast(lower) => FittedOffset::AtLeast {
                offset_lower: lower + 0.0,
            },
            ConfidenceInterval::NotDetermined => FittedOffset::NotDetermined,
        }
    }
}

impl FittedOffset {
    /// Machine-readable word: `two_sided`, `at_most`, `at_least` or `not_determined`.
    pub fn word(&self) -> &'static str {
        match self {
            FittedOffset::TwoSided { .. } => "two_sided",
            FittedOffset::AtMost { .. } => "at_most",
            FittedOffset::AtLeast { .. } => "at_least",
            FittedOffset::NotDetermined => "not_determined",
        }
    }

    /// Lowest and highest offset, if the interval has them.
    pub fn ends(&self) -> [Option<f64>; 2] {
        match *self {
            FittedOffset::TwoSided {
                offset_lower,
                offset_upper,
            } => [Some(offset_lower), Some(offset_upper)],
            FittedOffset::AtMost { offset_upper } => [None, Some(offset_upper)],
            FittedOffset::AtLeast { offset_lower } => [Some(offset_lower), None],
            FittedOffset::NotDetermined => [None, None],
        }
    }

    /// Half the width of a two-sided interval.
    pub fn half(&self) -> Option<f64> {
        match self.ends() {
            [Some(lower), Some(upper)] => Some(0.5 * (upper - lower)),
            _ => None,
        }
    }

    /// Number of useful decimals of the variable's offset. They show two digits of a quarter of the interval's width. If the
    /// interval has only one end, its distance from the offset counts as the width. `None` without a width above 0.
    pub(super) fn decimals(&self, offset: Option<f64>) -> Option<usize> {
        let width = match (self.ends(), offset) {
            ([Some(lower), Some(upper)], _) => upper - lower,
            ([Some(end), None] | [None, Some(end)], Some(offset)) => (end - offset).abs(),
            _ => return None,
        };
        let error = 0.25 * width;
        (error > 0.0).then(|| (1.0 - error.log10().floor()).clamp(0.0, 12.0) as usize)
    }

    /// Interval in words, with `decimals` decimals. Without `decimals`, numbers have six digits.
    fn in_words(&self, decimals: Option<usize>) -> String {
        let show = |value: f64| {
            let text = decimals.map_or_else(|| brief(value), |d| with_decimals(value, d));
            with_plus(value, text)
        };
        match self.ends() {
            [Some(lower), Some(upper)] => format!("{} .. {}", show(lower), show(upper)),
            [Some(lower), None] => format!(">= {}", show(lower)),
            [None, Some(upper)] => format!("<= {}", show(upper)),
            [None, None] => "not determined".to_owned(),
        }
    }

    /// Table columns of the interval, for fits that have intervals.
    pub(super) fn columns() -> [Column; 4] {
        [
            Column::for_readers("moved, 95 %"),
            Column::for_programs("95 % +-"),
            Column::for_programs("moved min"),
            Column::for_programs("moved max"),
        ]
    }

    /// Table cells for the columns of [`FittedOffset::columns`]. Without `decimals`, numbers have six digits.
    pub(super) fn cells(&self, decimals: Option<usize>) -> [Cell; 4] {
        let half = match self {
            FittedOffset::NotDetermined => Cell::from("not determined"),
            _ => self.half().into(),
        };
        let [lower, upper] = self.ends();
        [
            Cell::from(self.in_words(decimals)),
            half,
            lower.into(),
            upper.into(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_read_as_they_are() {
        let two = FittedOffset::from(ConfidenceInterval::TwoSided {
            lower: -12.345,
            upper: 8.0,
        });
        let decimals = two.decimals(Some(0.0));
        assert_eq!((decimals, two.half()), (Some(1), Some(10.1725)));
        assert_eq!(two.in_words(decimals), "-12.3 .. +8.0");
        let most = FittedOffset::from(ConfidenceInterval::AtMost(-19.0));
        assert_eq!(most.ends(), [None, Some(-19.0)]);
        assert_eq!(most.decimals(Some(-20.0)), Some(2));
        assert_eq!(most.in_words(Some(2)), "<= -19.00");
        assert_eq!(FittedOffset::NotDetermined.in_words(None), "not determined");
        let written = serde_json::to_value(two).unwrap();
        assert_eq!(written["confidence"], "two_sided");
        assert_eq!(written["offset_lower"], -12.345);
    }
}
