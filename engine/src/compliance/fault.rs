//! Reasons why a suspension has no elastic model, or no equilibrium.

use super::definition::Compliance;
use crate::mechanism::{DesignFault, NoPose};
use crate::model::{Axis, Side, Suspension};

/// Reason why a suspension has no elastic model.
#[derive(Clone, Debug, PartialEq)]
pub enum ElasticFault {
    /// A part has a motion without stiffness.
    Loose {
        /// Name of the part.
        part: String,
        /// Free direction.
        motion: Motion,
    },
    /// Forces at the design load cannot be computed, because only the torsional stiffness of bushings resists one of
    /// the motions.
    NoBalance {
        /// Name of the part.
        part: String,
    },
    /// A bushing needs a certain force for balance at the design load, but its force curve does not contain this force.
    OutOfReach {
        /// Index of the bushing.
        bushing: usize,
        /// Index of the axis, 0 to 2.
        axis: usize,
    },
    /// The spring has no force in the design position, so no force supports the wheel.
    NoForce,
    /// The spring cannot support the wheel: its force produces no wheel load, or the wheel has no spring.
    NoLeverage,
}

/// Reason why an axle has no elastic model.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleFault {
    /// Wheel at which the fault is; `None` for parts that both wheels share.
    pub side: Option<Side>,
    /// Reason for the fault.
    pub fault: ElasticFault,
}

/// Motion of a part: its type and its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Rotation about an axis of the vehicle.
    Turn(Axis),
    /// Shift along an axis of the vehicle.
    Shift(Axis),
}

/// Reason why there is no equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct NoEquilibrium {
    /// Fraction of the change that the solver reached, from 0 (no part of the change) to 1 (full change). In a level of a
    /// test, the change starts at zero load.
    pub share: f64,
    /// True if the solver reached no fraction of its last change, because the equilibrium that it found is not stable.
    pub is_unstable: bool,
    /// Part that gives way, and its motion; `None` if they could not be found.
    pub softest: Option<(String, Motion)>,
}

impl ElasticFault {
    /// Describes the reason in words.
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
                "the forces at the design load cannot be found: only the torsional stiffness of bushings holds {part}"
            ),
            ElasticFault::OutOfReach { bushing, axis } => {
                let point = parts.bushings[*bushing].point;
                format!(
                    "the force curve along {} of the bushing {} does not reach the force that this bushing carries at the design load",
                    ["x", "y", "z"][*axis],
                    suspension.mechanism.name(point)
                )
            }
            ElasticFault::NoForce => {
                "the spring's force in the design position is 0, but with relaxed = \"at_design_load\" this force must carry the wheel: expected another force, or relaxed = \"free\"".to_owned()
            }
            ElasticFault::NoLeverage => {
                "the spring's force has no leverage on the wheel in the design position".to_owned()
            }
        }
    }

    /// Converts the reason to a fault of the design.
    pub fn of_design<T>(&self, parts: &Compliance<T>, suspension: &Suspension) -> DesignFault {
        DesignFault::Elastic(self.describe(parts, suspension))
    }
}

impl AxleFault {
    /// Describes the reason in words.
    pub fn describe<T>(&self, parts: &[Compliance<T>; 2], suspension: &Suspension) -> String {
        let number = self.side.map_or(0, |side| side as usize);
        let words = self.fault.describe(&parts[number], suspension);
        self.side.map_or(words.clone(), |side| side.about(&words))
    }
}

impl From<NoEquilibrium> for NoPose {
    fn from(why: NoEquilibrium) -> Self {
        if why.is_unstable {
            NoPose::Unstable
        } else {
            NoPose::NoEquilibrium { share: why.share }
        }
    }
}
