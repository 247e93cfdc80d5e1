//! The program measures itself: poses per second, what a digit costs, and what an effect costs, on this
//! machine.
//!
//! Times are taken in rounds, so that what else the machine does falls on all alike; compare within one
//! run. Finite differences live here and nowhere else in the library, as the thing to beat.

pub mod accuracy;
pub mod effects;
mod machine;
pub mod throughput;
mod timing;

pub use machine::Machine;
pub use timing::{Clock, Job, Timing};

use crate::mechanism::DesignFault;

/// Why there is nothing to measure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unmeasurable {
    /// The design cannot be solved.
    #[error("the design cannot be solved: {0:?}")]
    Design(DesignFault),
    /// Fewer stations have a pose than a curve needs.
    #[error(
        "the motion has {solved} stations of different travel with a pose; it takes {needed} to measure a curve"
    )]
    FewStations {
        /// How many have one.
        solved: usize,
        /// How many it takes.
        needed: usize,
    },
    /// This number of threads cannot be started.
    #[error("{0} threads cannot be started")]
    Threads(usize),
}

impl From<DesignFault> for Unmeasurable {
    fn from(fault: DesignFault) -> Self {
        Unmeasurable::Design(fault)
    }
}
