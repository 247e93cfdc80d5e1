//! Student's distribution with a whole number of degrees of freedom.

use std::f64::consts::FRAC_2_PI;

/// Student's distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Student {
    freedoms: usize,
}

impl Student {
    /// Makes the distribution with this number of degrees of freedom, at least one.
    pub(super) fn new(freedoms: usize) -> Self {
        assert!(freedoms > 0, "a distribution has a degree of freedom");
        Student { freedoms }
    }

    /// Probability of a value above `t` >= 0, by the finite series of M. Abramowitz and I. A. Stegun, Handbook of
    /// mathematical functions, 26.7.3 and 26.7.4.
    pub(super) fn tail(&self, t: f64) -> f64 {
        let n = self.freedoms;
        let angle = (t / (n as f64).sqrt()).atan();
        let (sine, cosine) = angle.sin_cos();
        let is_odd = n % 2 == 1;
        let (first, mut term) = if is_odd { (3, cosine) } else { (2, 1.0) };
        let mut sum = if n == 1 { 0.0 } else { term };
        for i in (first..n.saturating_sub(1)).step_by(2) {
            term *= cosine * cosine * (i - 1) as f64 / i as f64;
            sum += term;
        }
        let within = if is_odd {
            FRAC_2_PI * (angle + sine * sum)
        } else {
            sine * sum
        };
        0.5 * (1.0 - within)
    }

    /// Value that a sample exceeds with the probability `tail`, which must be below one half.
    pub(super) fn quantile(&self, tail: f64) -> f64 {
        let mut high = 1.0;
        while self.tail(high) > tail && high < 1e9 {
            high *= 2.0;
        }
        root(0.0, high, |t| self.tail(t) > tail)
    }
}

/// Finds by bisection the value between `low` and `high` up to which `is_below` is true.
pub(super) fn root(mut low: f64, mut high: f64, is_below: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = low.midpoint(high);
        if is_below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low.midpoint(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the quantiles with published tables for 97.5 % and 95 %.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedoms, two_sided, one_sided) in [
            (1, 12.706_204_736, 6.313_751_515),
            (2, 4.302_652_730, 2.919_985_580),
            (3, 3.182_446_305, 2.353_363_435),
            (4, 2.776_445_105, 2.131_846_786),
            (5, 2.570_581_836, 2.015_048_373),
            (10, 2.228_138_852, 1.812_461_123),
            (30, 2.042_272_456, 1.697_260_887),
            (120, 1.979_930_405, 1.657_650_899),
        ] {
            let student = Student::new(freedoms);
            for (tail, wanted) in [(0.025, two_sided), (0.05, one_sided)] {
                let found = student.quantile(tail);
                assert!((found - wanted).abs() < 2e-9, "{freedoms}: {found}");
            }
        }
    }
}
