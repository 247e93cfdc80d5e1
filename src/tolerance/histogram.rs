//! Percentiles in bounded memory.
//!
//! Each value falls into one of many equal bins about the pilot builds' mean, nine of their standard deviations to
//! either side. Counts are whole numbers, so that their sums do not depend on who counts first: results have
//! the same bytes for any number of threads. Within a bin builds are taken to lie evenly.

use super::PERCENTILES;

/// Half the width of the bins together, in standard deviations.
const REACH: f64 = 9.0;
/// The most counts kept in all by a thread, and the most and fewest bins of a value.
const MOST_COUNTS: usize = 1 << 23;
const BINS: [usize; 2] = [512, 1 << 15];

/// Where the bins of each value are.
#[derive(Clone, Debug)]
pub(super) struct Bins {
    bins: usize,
    /// By cell: the lowest end, and bins per unit.
    ends: Vec<[f64; 2]>,
}

/// How many builds fell into each bin.
#[derive(Clone, Debug)]
pub(super) struct Counts {
    /// `[cell][bin]`, values below and above in the first and the last.
    counts: Vec<u64>,
}

impl Bins {
    /// Bins about these means, with these standard deviations.
    pub(super) fn about(means: &[f64], sigmas: &[f64]) -> Self {
        let bins = (MOST_COUNTS / means.len().max(1)).clamp(BINS[0], BINS[1]);
        let ends = means.iter().zip(sigmas).map(|(mean, sigma)| {
            // A value that does not scatter has one bin's width of rounding.
            let reach = (REACH * sigma).max(1e-9 * mean.abs()).max(1e-12);
            [mean - reach, bins as f64 / (2.0 * reach)]
        });
        Bins {
            bins,
            ends: ends.collect(),
        }
    }

    pub(super) fn counts(&self) -> Counts {
        Counts {
            counts: vec![0; self.bins * self.ends.len()],
        }
    }

    /// Counts a value; one that is not there is not counted.
    #[inline]
    pub(super) fn count(&self, counts: &mut Counts, cell: usize, value: f64) {
        let [lowest, per_unit] = self.ends[cell];
        if value.is_nan() {
            return;
        }
        // The conversion saturates at either end.
        let bin = (((value - lowest) * per_unit) as usize).min(self.bins - 1);
        counts.counts[cell * self.bins + bin] += 1;
    }

    /// The percentiles of a value between its least and greatest; NaN without values.
    pub(super) fn percentiles(
        &self,
        counts: &Counts,
        cell: usize,
        [least, greatest]: [f64; 2],
    ) -> [f64; PERCENTILES.len()] {
        let counts = &counts.counts[cell * self.bins..(cell + 1) * self.bins];
        let total: u64 = counts.iter().sum();
        let [lowest, per_unit] = self.ends[cell];
        PERCENTILES.map(|percent| {
            if total == 0 {
                return f64::NAN;
            }
            let wanted = percent / 100.0 * total as f64;
            let mut below = 0.0;
            for (bin, count) in counts.iter().enumerate() {
                let count = *count as f64;
                if below + count >= wanted && count > 0.0 {
                    let place = bin as f64 + (wanted - below) / count;
                    return (lowest + place / per_unit).clamp(least, greatest);
                }
                below += count;
            }
            greatest
        })
    }
}

impl Counts {
    pub(super) fn add(&mut self, other: &Counts) {
        for (sum, count) in self.counts.iter_mut().zip(&other.counts) {
            *sum += count;
        }
    }
}
