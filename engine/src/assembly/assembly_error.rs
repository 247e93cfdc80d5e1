//! Reasons why parts cannot be assembled.

use crate::mechanism::DesignFault;
use crate::model::Rod;

/// Reason why parts cannot be assembled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AssemblyError {
    /// The mechanism reaches a singular position when its dimensions are changed from the nominal to the built parts.
    /// Usually the links are too short or too long beyond this position.
    #[error(
        "the links cannot reach: the mechanism can be assembled with up to {:.0} % of these deviations",
        100.0 * share
    )]
    OutOfReach {
        /// Largest fraction of the deviations from nominal with which the mechanism can be assembled, from 0 to 1.
        share: f64,
    },
    /// The rod of a rocker is too short or too long, or at a toggle.
    #[error("the {0} is too short, too long or at its toggle")]
    Rod(Rod),
    /// The named member would have a length of zero or less.
    #[error("{0} would have no length")]
    NoLength(String),
    /// At no height near the nominal height does the spring have its required length, or there is no spring.
    #[error("the spring does not have its required length at any height near the design height")]
    Spring,
    /// Toe and camber cannot be set to their nominal values.
    #[error("toe and camber cannot be set to their design values")]
    Unaligned,
    /// The parts can be assembled, but the result cannot move.
    #[error("the assembled mechanism cannot move")]
    Immovable(DesignFault),
}

impl AssemblyError {
    /// Short name of the reason. Results count the failed builds under this name.
    pub fn word(&self) -> &'static str {
        match self {
            AssemblyError::OutOfReach { .. } => "out_of_reach",
            AssemblyError::Rod(_) => "rod_out_of_reach",
            AssemblyError::NoLength(_) => "no_length",
            AssemblyError::Spring => "no_rest",
            AssemblyError::Unaligned => "not_aligned",
            AssemblyError::Immovable(_) => "immovable",
        }
    }
}
