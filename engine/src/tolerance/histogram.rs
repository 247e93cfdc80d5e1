//! Histograms of builds.

/// Number of bins of a histogram.
pub const BINS: usize = 32;

/// Numbers of builds in bins of equal width, from the smallest to the largest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Histogram {
    /// Smallest and largest value of all builds.
    pub range: [f64; 2],
    /// Number of builds in each bin.
    pub counts: [u32; BINS],
}

impl Histogram {
    /// Makes the histogram from values in rising order, each with its number of builds. `None` if there are no values.
    pub(super) fn of(values: impl DoubleEndedIterator<Item = (f64, u64)> + Clone) -> Option<Self> {
        let least = values.clone().next()?.0;
        let greatest = values.clone().next_back()?.0;
        let width = (greatest - least) / BINS as f64;
        let mut counts = [0; BINS];
        for (value, count) in values {
            // If all values are equal, the quotient is NaN, and all values are counted in the first bin.
            let bin = ((value - least) / width) as usize;
            counts[bin.min(BINS - 1)] += u32::try_from(count).unwrap_or(u32::MAX);
        }
        Some(Histogram {
            range: [least, greatest],
            counts,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> Histogram {
        Histogram::of(values.iter().map(|value| (*value, 1))).unwrap()
    }

    #[test]
    fn every_value_is_in_its_bin() {
        // The test values are the middles of the bins between 0 and 32, and the ends 0 and 32.
        let mut values: Vec<f64> = (0..BINS).map(|bin| bin as f64 + 0.5).collect();
        values.insert(0, 0.0);
        values.push(BINS as f64);
        let found = of(&values);
        assert_eq!(found.range, [0.0, BINS as f64]);
        assert_eq!(found.counts[0], 2);
        assert_eq!(found.counts[BINS - 1], 2);
        assert!(found.counts[1..BINS - 1].iter().all(|count| *count == 1));
    }

    #[test]
    fn equal_values_are_in_one_bin() {
        let found = of(&[3.0; 5]);
        assert_eq!((found.range, found.counts[0]), ([3.0; 2], 5));
        assert_eq!(found.counts.iter().sum::<u32>(), 5);
        assert_eq!(Histogram::of(std::iter::empty()), None);
    }
}
