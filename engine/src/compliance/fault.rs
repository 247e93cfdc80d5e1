//! Reasons why a suspension has no elastic model, or no equilibrium.

use super::definition::Compliance;
use crate::mechanism::{DesignFault, NoPose};
use crate::model::{Axis, Side, Suspension};

/// Reason why a suspension has no elastic model.
#[derive(Clone, Debug, PartialEq)]
pub enum ElasticFault {
    /// Nothing holds a motion: the part, and the direction in which it is free.
    Loose {
        /// Name of the part.
        part: String,
        /// The motion.
        motion: Motion,
    },
    /// The forces at the design load cannot be found: nothing holds a motion without torsion.
    NoBalance {
        /// Name of the part.
        part: String,
    },
    /// The law of a bushing does not reach the force that it has at the design load.
    OutOfReach {
        /// Number of the bushing.
        bushing: usize,
        /// Axis, 0 to 2.
        axis: usize,
    },
    /// The spring has no leverage on the wheel, or does not exist.
    NoLeverage,
}

/// Reason why an axle has no elastic model.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleFault {
    /// The wheel; `None` for the parts that both share.
    pub side: Option<Side>,
    /// The reason.
    pub fault: ElasticFault,
}

/// A motion of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// A turn about an axis of the vehicle.
    Turn(Axis),
    /// A shift along an axis of the vehicle.
    Shift(Axis),
}

/// Reason why there is no equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct NoEquilibrium {
    /// Share of the way that was reached, 0 to 1.
    pub share: f64,
    /// True if an equilibrium was found at the end of the way, but not a stable one.
    pub is_unstable: bool,
    /// The part that gives way, and how.
    pub softest: Option<(String, Motion)>,
}

impl ElasticFault {
    /// The reason in words.
    pub fn describe<T>(&self, parts: &Compliance<T>, suspension: &Suspension) -> String {
        match self {
            ElasticFault::Loose { part, motion } => {
                let motion = match motion {
                    Motion::Turn(axis) => format!("turns freely about a line near {}", axis.name()),
                    Motion::Shift(axis) => format!("moves freely along {}", axis.name()),
                };
                format!(
                    "{part} {motion}: expected stiffness about or along that direction in its bushings"
                )
            }
            ElasticFault::NoBalance { part } => format!(
                "the forces at the design load cannot be found: without torsion nothing holds {part}"
            ),
            ElasticFault::OutOfReach { bushing, axis } => {
                let point = parts.bushings[*bushing].point;
                format!(
                    "the curve along {} of {} does not reach its force at the design load",
                    ["x", "y", "z"][*axis],
                    suspension.mechanism.name(point)
                )
            }
            ElasticFault::NoLeverage => {
                "the spring's force has no leverage on the wheel in the design position".to_owned()
            }
        }
    }

    /// The same as a fault of the design.
    pub fn of_design<T>(&self, parts: &Compliance<T>, suspension: &Suspension) -> DesignFault {
        DesignFault::Elastic(self.describe(parts, suspension))
    }
}

impl AxleFault {
    /// The reason in words.
    pub fn describe<T>(&self, parts: &[Compliance<T>; 2], suspension: &Suspension) -> String {
        let number = self.side.map_or(0, |side| side as usize);
        let words = self.fault.describe(&parts[number], suspension);
        self.side.map_or(words.clone(), |side| side.about(&words))
    }
}

impl From<NoEquilibrium> for NoPose {
    fn from(why: NoEquilibrium) -> Self {
        match why.is_unstable {
            true => NoPose::Unstable,
            false => NoPose::NoEquilibrium { share: why.share },
        }
    }
}
