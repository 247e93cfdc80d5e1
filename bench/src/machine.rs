//! Machine and program version of a measurement.

use super::Clock;
use serde::Serialize;

/// Machine, program and settings of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Name that the processor reports, or its architecture if it reports none.
    pub processor: String,
    /// Number of CPU threads that the machine runs at once.
    pub cores: usize,
    /// Operating system.
    pub system: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// True if the program was built without optimisation. Its times then mean little.
    pub unoptimised: bool,
    /// Number of samples of each job.
    pub samples: usize,
    /// Shortest duration of a sample, in milliseconds.
    pub shortest_sample_ms: f64,
}

impl Machine {
    /// Describes this machine.
    pub fn here(clock: &Clock) -> Self {
        Machine {
            processor: processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: std::env::consts::OS,
            version: env!("CARGO_PKG_VERSION"),
            unoptimised: cfg!(debug_assertions),
            samples: clock.samples,
            shortest_sample_ms: clock.shortest.as_secs_f64() * 1e3,
        }
    }

    /// Description of the machine in one line.
    pub fn line(&self) -> String {
        let warning = if self.unoptimised {
            "; built without optimisation: times are not representative"
        } else {
            ""
        };
        format!(
            "{} ({} threads), hardpoint {}, medians of {} samples of {} ms or more{warning}",
            self.processor, self.cores, self.version, self.samples, self.shortest_sample_ms
        )
    }
}

/// Name of the processor, on Linux only. Linux provides it in a file; other systems would need a library.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
