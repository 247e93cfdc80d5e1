//! Measures the program on this machine: poses per second, the time for each correct digit, and the time for each effect.
//!
//! The clock takes one sample of each job in turn, so that other load on the machine affects all jobs alike. Compare times within
//! one run only. This crate is the only library code with finite differences; they are a reference for comparison.

#![warn(clippy::allow_attributes_without_reason, unreachable_pub)]

pub mod accuracy;
mod axle;
pub mod cars;
mod double_double;
pub mod effects;
pub mod equilibria;
mod machine;
mod single;
pub mod throughput;
mod timing;
mod trial;

pub use double_double::DoubleDouble;
pub use machine::Machine;
pub use timing::{Clock, Job, Timing};

use hardpoint_engine::mechanism::DesignFault;
use hardpoint_engine::study::{Drive, Motion};
use hardpoint_engine::sweep::ColumnFault;

/// Measured time of one job.
#[derive(Clone, Debug, PartialEq)]
pub struct JobTime {
    /// Name of the job in words.
    pub job: &'static str,
    /// Time per item that the job processes, such as a pose.
    pub timing: Timing,
}

/// Reason why nothing can be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unmeasurable {
    /// The design cannot be solved.
    #[error("the design cannot be solved: {0}")]
    Design(DesignFault),
    /// Fewer stations have a pose than a curve needs.
    #[error(
        "only {solved} stations with different travels have a pose; measuring a curve needs {needed}"
    )]
    FewStations {
        /// Number of stations that have a pose.
        solved: usize,
        /// Number of stations that the measurement needs.
        needed: usize,
    },
    /// The columns of the measured sweep cannot be written.
    #[error("{0}")]
    Columns(ColumnFault),
    /// A wheel of the axle cannot be solved.
    #[error("{0}")]
    Axle(String),
    /// A wheel of the car cannot be solved.
    #[error("{0}")]
    Car(String),
    /// No state of the car's g-g map exists.
    #[error("no state of the g-g map has an equilibrium")]
    NoState,
    /// The study has no elastic parts.
    #[error("equilibria need a study with [compliance]")]
    Rigid,
    /// The design position has no equilibrium.
    #[error("the suspension has no equilibrium at its design height")]
    NoEquilibrium,
    /// CPU threads cannot be started.
    #[error(
        "{threads} threads cannot be started; the measurement can use 1 to {most} threads: give a smaller number with --threads"
    )]
    Threads {
        /// Number of CPU threads that cannot be started.
        threads: usize,
        /// Largest number of CPU threads in the measurement.
        most: usize,
    },
}

impl Unmeasurable {
    /// Makes the error for a number of CPU threads that cannot be started.
    fn threads(threads: usize) -> Self {
        let most = threads;
        Unmeasurable::Threads { threads, most }
    }

    /// Adds to the error the largest number of CPU threads in the measurement.
    fn up_to(self, most: usize) -> Self {
        match self {
            Unmeasurable::Threads { threads, .. } => Unmeasurable::Threads { threads, most },
            other => other,
        }
    }
}

impl From<DesignFault> for Unmeasurable {
    fn from(fault: DesignFault) -> Self {
        Unmeasurable::Design(fault)
    }
}

/// Motion through these wheel travels, with the rack at 0.
fn wheel_travel(travels: &[f64]) -> Motion {
    Motion {
        drive: Drive::Travel,
        values: travels.to_vec(),
        rack: vec![0.0],
        rack_moves: false,
        time: None,
    }
}
