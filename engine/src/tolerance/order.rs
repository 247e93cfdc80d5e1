//! Exact percentiles in bounded memory. The p-th percentile of n values is the smallest value such that at least p percent of
//! the values are not larger.
//!
//! For every output the code keeps a few *windows*: ranges of values in which percentiles can still lie. It stores values
//! within the windows, and only counts values outside of them. Whenever the number of builds has doubled (n is the new
//! number), the windows become narrower. With p as a fraction, the p-quantile of any larger number of builds lies between two
//! of the n sorted values. The ranks of these two values are
//!
//! ```text
//! n p +- (7 sqrt(n p (1 - p)) + 24)
//! ```
//!
//! Fewer than one in 10^10 binomial random numbers differ more than this from their mean. The number of stored values grows
//! as the square root of n. Equal values are stored once. If a percentile lies outside the windows, the code detects this,
//! and the percentile has no value. Results do not depend on the windows that a CPU thread uses, so they are bit-identical
//! for any number of CPU threads.

use super::PERCENTILES;
use super::histogram::Histogram;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// Number of builds at which the windows (ranges that can contain percentiles) become narrower for the first time.
const FIRST: u64 = 4096;
/// Number of stored values of an output below which equal values are not merged.
const FEW: usize = 4096;
/// Largest number of windows (ranges that can contain percentiles) of a value.
const MOST: usize = PERCENTILES.len();
/// Entry for a missing window: a range that contains no value.
const NONE: [f64; 2] = [f64::INFINITY; 2];

/// Windows of every cell (a value at a station). Each window is a [smallest, largest] value, and windows are in rising order.
type Windows = Vec<[[f64; 2]; MOST]>;

/// Contribution of some builds to the percentiles: counts of values, and stored values.
pub(super) struct Sifted {
    windows: Arc<Windows>,
    /// Number of values outside the windows, for each cell (a value at a station). The first number counts the values
    /// below the first window. The next number counts the values between the first and the second window, and so on.
    between: Vec<[u32; MOST + 1]>,
    /// Values within the windows, for one cell (a value at a station) after another.
    kept: Vec<f64>,
    /// For each cell, the index in `kept` after the last value of the cell.
    ends: Vec<usize>,
}

/// Shared state of the percentile computation.
pub(super) struct Order {
    /// Current windows (ranges that can contain percentiles), for the builds that follow.
    windows: Mutex<Arc<Windows>>,
}

/// Contributions of all builds so far to the percentiles.
pub(super) struct Gathered {
    windows: Arc<Windows>,
    cells: Vec<Cell>,
    narrows_at: u64,
    /// Histograms of the builds before the windows first become narrower. Empty until then.
    histograms: Vec<Option<Histogram>>,
}

/// Values of one cell (a value at a station) over all builds so far.
#[derive(Clone, Default)]
struct Cell {
    between: [u64; MOST + 1],
    /// Values of the cell within the windows, each with its number of occurrences.
    kept: Vec<(f64, u64)>,
    /// Length of `kept` at which equal values are merged next.
    compact_at: usize,
}

impl Order {
    /// Makes the state for this number of cells (values at a station), without any values. At first, every value is
    /// kept.
    pub(super) fn of(cells: usize) -> (Order, Gathered) {
        let mut all = [NONE; MOST];
        all[0] = [f64::NEG_INFINITY, f64::INFINITY];
        let windows = Arc::new(vec![all; cells]);
        let order = Order {
            windows: Mutex::new(windows.clone()),
        };
        let gathered = Gathered {
            windows,
            cells: vec![Cell::default(); cells],
            narrows_at: FIRST,
            histograms: Vec::new(),
        };
        (order, gathered)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Arc<Windows>> {
        self.windows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Prepares the sorting of the values of some builds into the windows.
    pub(super) fn begin(&self) -> Sifted {
        let windows = self.lock().clone();
        Sifted {
            between: Vec::with_capacity(windows.len()),
            kept: Vec::new(),
            ends: Vec::with_capacity(windows.len()),
            windows,
        }
    }
}

impl Sifted {
    /// Adds the values of the next cell (a value at a station, over several builds). NaN counts as missing.
    pub(super) fn cell<'v>(&mut self, values: impl Iterator<Item = &'v [f64]>) {
        let windows = &self.windows[self.between.len()];
        let used = windows.iter().take_while(|w| **w != NONE).count();
        let windows = &windows[..used];
        let mut between = [0_u32; MOST + 1];
        for values in values {
            for value in values {
                let (mut above, mut inside) = (0, false);
                for [least, greatest] in windows {
                    above += usize::from(value > greatest);
                    inside |= value >= least && value <= greatest;
                }
                if inside {
                    self.kept.push(*value);
                } else {
                    between[above] += u32::from(!value.is_nan());
                }
            }
        }
        self.between.push(between);
        self.ends.push(self.kept.len());
    }
}

impl Gathered {
    /// Adds the contribution of some builds to the percentiles. `builds` is the number of builds so far.
    pub(super) fn take(&mut self, sifted: &Sifted, builds: u64, order: &Order) {
        let mut first = 0;
        for (number, cell) in self.cells.iter_mut().enumerate() {
            let (now, then) = (&self.windows[number], &sifted.windows[number]);
            // The windows may have become narrower since the values of these builds were sorted into windows. Each new window
            // lies within an old window.
            for (gap, count) in sifted.between[number].iter().enumerate() {
                cell.between[moved(gap, then, now)] += u64::from(*count);
            }
            let end = sifted.ends[number];
            for value in &sifted.kept[first..end] {
                cell.add(*value, 1, now);
            }
            first = end;
            if cell.kept.len() >= cell.compact_at {
                cell.compact();
            }
        }
        if builds >= self.narrows_at {
            self.narrows_at = 2 * builds;
            if self.histograms.is_empty() {
                self.histograms = self.cells.par_iter_mut().map(Cell::histogram).collect();
            }
            self.narrow();
            *order.lock() = self.windows.clone();
        }
    }

    fn narrow(&mut self) {
        let cells = self.cells.par_iter_mut().zip(&self.windows[..]);
        let windows = cells.map(|(cell, windows)| cell.narrow(windows));
        self.windows = Arc::new(windows.collect());
    }

    /// Histogram of a cell (a value at a station). The histogram covers all builds, or the first [`FIRST`] builds and
    /// the rest of their block. `None` if there are no values.
    pub(super) fn histogram(&mut self, cell: usize) -> Option<Histogram> {
        match self.histograms.get(cell) {
            Some(histogram) => *histogram,
            None => self.cells[cell].histogram(),
        }
    }

    /// Percentiles of a cell (a value at a station). NaN if there are no values, or if the percentile lies outside the windows.
    pub(super) fn percentiles(&mut self, cell: usize) -> [f64; MOST] {
        let windows = &self.windows[cell];
        let cell = &mut self.cells[cell];
        cell.compact();
        let ranks = Ranks::of(cell, windows);
        PERCENTILES.map(|percent| {
            let number = (percent / 100.0 * ranks.count as f64).ceil().max(1.0) as u64;
            ranks.at(number - 1).unwrap_or(f64::NAN)
        })
    }
}

impl Cell {
    fn count(&self) -> u64 {
        let kept: u64 = self.kept.iter().map(|(_, count)| count).sum();
        self.between.iter().sum::<u64>() + kept
    }

    fn add(&mut self, value: f64, count: u64, windows: &[[f64; 2]; MOST]) {
        let above = windows.iter().filter(|w| value > w[1]).count();
        if windows.get(above).is_some_and(|w| value >= w[0]) {
            self.kept.push((value, count))
        } else {
            self.between[above] += count
        }
    }

    /// Sorts the stored values and merges equal ones.
    fn compact(&mut self) {
        self.kept.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        self.kept.dedup_by(|next, last| {
            let is_equal = next.0 == last.0;
            last.1 += u64::from(is_equal) * next.1;
            is_equal
        });
        self.compact_at = 2 * self.kept.len() + FEW;
    }

    /// Histogram of the cell's stored values.
    fn histogram(&mut self) -> Option<Histogram> {
        self.compact();
        Histogram::of(self.kept.iter().copied())
    }

    /// Reduces the cell's windows to ranges that can still contain a percentile.
    fn narrow(&mut self, windows: &[[f64; 2]; MOST]) -> [[f64; 2]; MOST] {
        self.compact();
        let ranks = Ranks::of(self, windows);
        let (count, n) = (ranks.count, ranks.count as f64);
        if count == 0 {
            return *windows;
        }
        let mut into = [NONE; MOST];
        let mut used = 0;
        for percent in PERCENTILES {
            let p = percent / 100.0;
            let middle = ranks.at(((n * p) as u64).min(count - 1));
            let own = middle.and_then(|m| windows.iter().find(|w| w[0] <= m && m <= w[1]));
            let Some(own) = own else {
                continue;
            };
            // If there are not enough values for this rank, this end of the window does not change. The same applies if the value
            // with this rank lies outside all windows.
            let reach = 7.0 * (n * p * (1.0 - p)).sqrt() + 24.0;
            let least = (n * p - reach).floor();
            let least = if least < 0.0 {
                None
            } else {
                ranks.at(least as u64)
            };
            let greatest = ranks.at((n * p + reach).ceil() as u64);
            let window = [
                least.map_or(own[0], |v| v.max(own[0])),
                greatest.map_or(own[1], |v| v.min(own[1])),
            ];
            match into[..used].last_mut() {
                Some(last) if window[0] <= last[1] => last[1] = last[1].max(window[1]),
                _ => {
                    into[used] = window;
                    used += 1;
                }
            }
        }
        let between = std::mem::take(&mut self.between);
        for (gap, count) in between.into_iter().enumerate() {
            self.between[moved(gap, windows, &into)] += count;
        }
        for (value, count) in std::mem::take(&mut self.kept) {
            self.add(value, count, &into);
        }
        into
    }
}

/// Returns the index of the gap between the windows `now` that contains the gap with index `gap` between the windows `then`. Gap 0
/// lies below the first window, gap 1 above it, and so on. Each new window lies within an old window.
fn moved(gap: usize, then: &[[f64; 2]; MOST], now: &[[f64; 2]; MOST]) -> usize {
    match gap {
        0 => 0,
        _ => now.iter().filter(|w| w[1] <= then[gap - 1][1]).count(),
    }
}

/// Values of a cell (an output at a station) by rank. The smallest value has rank 0.
struct Ranks<'c> {
    cell: &'c Cell,
    windows: &'c [[f64; 2]; MOST],
    /// For each kept value, the number of builds with a smaller kept value. The last number counts the builds of all kept values.
    before: Vec<u64>,
    count: u64,
}

impl<'c> Ranks<'c> {
    /// Makes the ranks for a compacted cell, whose values are sorted and without duplicates.
    fn of(cell: &'c Cell, windows: &'c [[f64; 2]; MOST]) -> Self {
        let mut before = Vec::with_capacity(cell.kept.len() + 1);
        let mut sum = 0;
        before.push(0);
        for (_, count) in &cell.kept {
            sum += count;
            before.push(sum);
        }
        Ranks {
            cell,
            windows,
            before,
            count: cell.count(),
        }
    }

    /// Value with this rank. `None` if the value lies outside all windows.
    fn at(&self, number: u64) -> Option<f64> {
        let (mut below, mut first) = (0, 0);
        for (between, [_, greatest]) in self.cell.between.iter().zip(self.windows) {
            below += between;
            let end = self.cell.kept.partition_point(|(v, _)| v <= greatest);
            if number < below + self.before[end] {
                let kept = number.checked_sub(below)?;
                let place = self.before.partition_point(|before| *before <= kept) - 1;
                return (place >= first).then(|| self.cell.kept[place].0);
            }
            first = end;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::uniform;
    use crate::tolerance::normal_quantile;

    const BLOCK: usize = 128;

    /// Collects normal values, a few distinct values, rising values and missing values, block by block. Every third block uses
    /// windows that are two blocks old.
    fn gathered(builds: usize) -> (Vec<Vec<f64>>, Order, Gathered) {
        let value = |cell: usize, build: usize| {
            let fraction = uniform(build as u64, cell, 9);
            match cell {
                0 => normal_quantile(fraction + 1e-17),
                1 => (fraction * 3.0).floor(),
                2 => build as f64,
                _ if fraction < 0.4 => f64::NAN,
                _ => fraction,
            }
        };
        let (order, mut gathered) = Order::of(4);
        let mut all = vec![Vec::new(); 4];
        let mut old: Option<Sifted> = None;
        for first in (0..builds).step_by(BLOCK) {
            let last = (first + BLOCK).min(builds);
            let mut sifted = match first / BLOCK % 3 {
                2 => old.take().unwrap(),
                _ => order.begin(),
            };
            if (first / BLOCK).is_multiple_of(3) {
                old = Some(order.begin());
            }
            for (cell, all) in all.iter_mut().enumerate() {
                let values: Vec<f64> = (first..last).map(|build| value(cell, build)).collect();
                sifted.cell(values.chunks(16));
                all.extend(values.into_iter().filter(|v| !v.is_nan()));
            }
            gathered.take(&sifted, last as u64, &order);
        }
        (all, order, gathered)
    }

    #[test]
    fn percentiles_are_order_statistics() {
        for builds in [1, 2, 100, 4096, 10_000, 150_000] {
            let (all, _, mut gathered) = gathered(builds);
            for (cell, mut values) in all.into_iter().enumerate() {
                values.sort_unstable_by(f64::total_cmp);
                let found = gathered.percentiles(cell);
                // Values that rise with the number of the build are not a random sample. Their percentiles may be missing,
                // but must not be wrong.
                let is_sample = cell != 2;
                for (percent, found) in PERCENTILES.into_iter().zip(found) {
                    let number = (percent / 100.0 * values.len() as f64).ceil().max(1.0);
                    let Some(expected) = values.get(number as usize - 1) else {
                        assert!(found.is_nan());
                        continue;
                    };
                    assert!(
                        found == *expected || (!is_sample && found.is_nan()),
                        "{cell} {percent} of {builds}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_kept_grows_as_the_root_of_the_number() {
        let kept = |cell: usize, builds: usize| {
            let (_, _, gathered) = gathered(builds);
            gathered.cells[cell].kept.len()
        };
        let (few, many) = (kept(0, 8192), kept(0, 131_072));
        assert!(few < 5000 && many < 5 * few, "{few} {many}");
        assert!(kept(1, 131_072) < 2 * FEW + 10);
    }
}
