//! Reasons why a suspension has no elastic model, or no equilibrium.

use super::solve::Obstacle;
use crate::mechanism::{DesignFault, NoPose};
use crate::model::{Axis, Side};

/// Reason why a suspension has no elastic model.
#[derive(Clone, Debug, PartialEq)]
pub enum ElasticFault {
    /// A part has a motion without stiffness.
    Loose {
        /// Name of the part.
        part: String,
        /// Direction in which the part moves without stiffness.
        motion: Motion,
    },
    /// Forces at the design load cannot be computed, because only the torsional stiffness of bushings resists a motion of
    /// the part.
    NoBalance {
        /// Name of the part that only torsional stiffness holds.
        part: String,
    },
    /// A bushing needs a certain force for balance at the design load, but no point of its force curve has this force.
    OutOfReach {
        /// Name of the bushing, or of the mount of the subframe.
        bushing: String,
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

/// What is missing at a state that has no result.
#[derive(Clone, Debug, PartialEq)]
pub enum Lack {
    /// The solver found no equilibrium beyond a fraction of the requested change of loads, travel and rack.
    Equilibrium,
    /// The equilibrium that the solver found is not stable. So the solver reached no fraction of its last change of
    /// loads, travel and rack.
    Stability,
    /// The equilibrium is not stable, because nothing but the torsional stiffness of bushings holds a part. The text is
    /// the name of this part.
    Stiffness(String),
    /// The equilibrium has no derivatives, because its equations are singular.
    Derivatives,
    /// The parts have no elastic model, for example while the rack is locked. The text is the reason in words.
    Model(String),
}

/// Reason why there is no equilibrium, or no result in an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct NoEquilibrium {
    /// Fraction of the change of loads, travel and rack that the solver reached, from 0 (no part of the change) to 1
    /// (full change). In a level of a test, the change starts at zero load.
    pub share: f64,
    /// Kind of the failure.
    pub lack: Lack,
    /// Part that gives way, and its motion; `None` if they could not be found.
    pub softest: Option<(String, Motion)>,
}

impl ElasticFault {
    /// Describes the reason in words.
    pub fn describe(&self) -> String {
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
                format!(
                    "the force curve along {} of the bushing {bushing} does not reach the force that this bushing carries at the design load",
                    ["x", "y", "z"][*axis]
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
    pub fn of_design(&self) -> DesignFault {
        DesignFault::Elastic(self.describe())
    }
}

impl AxleFault {
    /// Describes the reason in words.
    pub fn describe(&self) -> String {
        let words = self.fault.describe();
        self.side.map_or(words.clone(), |side| side.about(&words))
    }
}

impl NoEquilibrium {
    /// Failure at an equilibrium whose equations are singular.
    pub(crate) fn without_derivatives() -> Self {
        NoEquilibrium {
            share: 1.0,
            lack: Lack::Derivatives,
            softest: None,
        }
    }

    /// Failure of parts without elastic model. `reason` states the fault in words.
    pub(super) fn without_model(reason: String) -> Self {
        NoEquilibrium {
            share: 0.0,
            lack: Lack::Model(reason),
            softest: None,
        }
    }

    /// Selects the failure after a fraction `share` of the change: no equilibrium, or no stability. `barely_held` returns
    /// the part that nothing but the torsional stiffness of bushings holds.
    pub(super) fn lack(
        share: f64,
        obstacle: &Obstacle,
        barely_held: impl FnOnce() -> Option<String>,
    ) -> Lack {
        match obstacle {
            Obstacle::Unstable(_) if share == 0.0 => {
                barely_held().map_or(Lack::Stability, Lack::Stiffness)
            }
            _ => Lack::Equilibrium,
        }
    }
}

impl From<NoEquilibrium> for NoPose {
    fn from(why: NoEquilibrium) -> Self {
        match why.lack {
            Lack::Equilibrium => NoPose::NoEquilibrium { share: why.share },
            Lack::Stability | Lack::Stiffness(_) => NoPose::Unstable,
            Lack::Derivatives => NoPose::NoDerivatives,
            Lack::Model(_) => NoPose::NoModel,
        }
    }
}
