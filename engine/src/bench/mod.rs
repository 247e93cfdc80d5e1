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
use std::fmt;

/// Why there is nothing to measure.
#[derive(Clone, Debug, PartialEq)]
pub enum Unmeasurable {
    /// The design cannot be solved.
    Design(DesignFault),
    /// Fewer stations have a pose than a curve needs.
    FewStations {
        /// How many have one.
        solved: usize,
        /// How many it takes.
        needed: usize,
    },
    /// So many threads cannot be had.
    Threads(usize),
}

impl From<DesignFault> for Unmeasurable {
    fn from(fault: DesignFault) -> Self {
        Unmeasurable::Design(fault)
    }
}

impl fmt::Display for Unmeasurable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unmeasurable::Design(fault) => write!(f, "the design cannot be solved: {fault:?}"),
            Unmeasurable::Threads(count) => write!(f, "{count} threads cannot be started"),
            Unmeasurable::FewStations { solved, needed } => write!(
                f,
                "the motion has {solved} stations of different travel with a pose; it takes {needed} to \
                 measure a curve"
            ),
        }
    }
}
