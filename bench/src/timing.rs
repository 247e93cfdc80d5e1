//! Times: median and spread of many samples.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Time per item, in nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Median: half of the samples are faster.
    pub median: f64,
    /// Lower quartile: a quarter of the samples is faster.
    pub lower: f64,
    /// Upper quartile: a quarter of the samples is slower.
    pub upper: f64,
}

impl Timing {
    /// Computes median and quartiles of samples in ns per item. Needs at least one sample.
    fn of(mut samples: Vec<f64>) -> Self {
        samples.sort_by(f64::total_cmp);
        let at = |share: f64| samples[((samples.len() - 1) as f64 * share).round() as usize];
        Timing {
            median: at(0.5),
            lower: at(0.25),
            upper: at(0.75),
        }
    }

    /// Half of the distance between the quartiles, relative to the median.
    pub fn spread(&self) -> f64 {
        0.5 * (self.upper - self.lower) / self.median
    }
}

/// Settings of the measurements: number and duration of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Number of samples of each job.
    pub samples: usize,
    /// Shortest duration of a sample. Short work is repeated until it takes this long.
    pub shortest: Duration,
}

impl Default for Clock {
    fn default() -> Self {
        Clock {
            samples: 51,
            // A sample is shorter than the time slice of a scheduler, so most samples run without interruption.
            shortest: Duration::from_micros(200),
        }
    }
}

impl Clock {
    /// Measures the time per item of `work`, which processes `items` items.
    pub fn time<R>(&self, items: usize, mut work: impl FnMut() -> R) -> Timing {
        let work = Job {
            items,
            work: Box::new(move || {
                black_box(work());
            }),
        };
        self.in_rounds(&mut [work])[0]
    }

    /// Measures several jobs in turn: one sample of each job per round.
    pub fn in_rounds(&self, jobs: &mut [Job<'_>]) -> Vec<Timing> {
        let repeats: Vec<u32> = jobs.iter_mut().map(|job| self.repeats(job)).collect();
        let mut samples = vec![Vec::with_capacity(self.samples); jobs.len()];
        for _ in 0..self.samples {
            for ((job, repeats), samples) in jobs.iter_mut().zip(&repeats).zip(&mut samples) {
                // The clock does not count this run. The run restores the processor's caches after the previous job.
                elapsed(job, *repeats);
                let time = elapsed(job, *repeats).as_secs_f64() * 1e9;
                samples.push(time / f64::from(*repeats) / job.items as f64);
            }
        }
        samples.into_iter().map(Timing::of).collect()
    }

    /// Returns the number of repetitions of a job that fill a sample.
    fn repeats(&self, job: &mut Job<'_>) -> u32 {
        let mut repeats = 1;
        while elapsed(job, repeats) < self.shortest && repeats < 1 << 24 {
            repeats *= 2;
        }
        repeats
    }
}

/// Work to be timed.
pub struct Job<'a> {
    /// Number of items that the job processes.
    pub items: usize,
    /// The work that is timed.
    pub work: Box<dyn FnMut() + 'a>,
}

fn elapsed(job: &mut Job<'_>, repeats: u32) -> Duration {
    let start = Instant::now();
    for _ in 0..repeats {
        (job.work)();
    }
    start.elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_of_the_sorted_samples() {
        let timing = Timing::of(vec![5.0, 1.0, 3.0, 2.0, 4.0]);
        let expected = Timing {
            median: 3.0,
            lower: 2.0,
            upper: 4.0,
        };
        assert_eq!(timing, expected);
        assert_eq!(timing.spread(), 1.0 / 3.0);
    }
}
