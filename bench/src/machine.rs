//! The machine and the program of a measurement.

use super::Clock;
use serde::Serialize;

/// Machine, program and settings of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Name of the processor, as it calls itself; its architecture where it has none.
    pub processor: String,
    /// Threads it runs at once.
    pub cores: usize,
    /// Operating system.
    pub system: &'static str,
    /// Version of the program.
    pub version: &'static str,
    /// True if the program was built without optimisation; its times then mean little.
    pub unoptimised: bool,
    /// Samples of each time.
    pub samples: usize,
    /// Shortest duration of a sample, in milliseconds.
    pub shortest_sample_ms: f64,
}

impl Machine {
    /// This machine.
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

    /// In one line.
    pub fn line(&self) -> String {
        let warning = match self.unoptimised {
            true => "; built without optimisation: times mean little",
            false => "",
        };
        format!(
            "{} ({} threads), hardpoint {}, medians of {} samples of {} ms or more{warning}",
            self.processor, self.cores, self.version, self.samples, self.shortest_sample_ms
        )
    }
}

/// Linux says it in a file; elsewhere it takes a library.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
