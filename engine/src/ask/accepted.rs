//! Values that a study accepts for a number.

use std::fmt;

/// Values that a study accepts for a number. The code that reads a study checks numbers, ranges of variables and scatter
/// against these values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accepted {
    /// Every number.
    All,
    /// Numbers above this limit.
    Above(f64),
    /// Numbers below this limit.
    Below(f64),
    /// Numbers between these two limits. The limits themselves are not accepted.
    Between(f64, f64),
    /// Shares: numbers from 0 to 1, both included.
    Share,
}

impl Accepted {
    /// Returns true if the study accepts this value. It accepts no value that is not a number.
    pub fn contains(self, value: f64) -> bool {
        match self {
            Accepted::All => !value.is_nan(),
            Accepted::Above(low) => value > low,
            Accepted::Below(high) => value < high,
            Accepted::Between(low, high) => value > low && value < high,
            Accepted::Share => (0.0..=1.0).contains(&value),
        }
    }

    /// Returns the first end of a range that is not an accepted value. `None` if the study accepts both ends.
    pub fn first_outside(self, range: [f64; 2]) -> Option<f64> {
        range.into_iter().find(|end| !self.contains(*end))
    }
}

/// Limits of the values, as in `expected a rate above 0`.
impl fmt::Display for Accepted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Accepted::All => f.write_str("of any size"),
            Accepted::Above(low) => write!(f, "above {}", six_digits(*low)),
            Accepted::Below(high) => write!(f, "below {}", six_digits(*high)),
            Accepted::Between(low, high) => {
                write!(f, "between {} and {}", six_digits(*low), six_digits(*high))
            }
            Accepted::Share => f.write_str("from 0 to 1"),
        }
    }
}

/// Rounds a computed number to six digits, for messages.
pub(crate) fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
