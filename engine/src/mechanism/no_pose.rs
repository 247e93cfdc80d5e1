//! Reasons why a vehicle has no pose at a station.

use super::Failure;
use crate::model::{Frame, LengthUnit, Side};

/// Reason why a vehicle has no pose at a station. Or reason why its pose is not certified, is not stable, or gives no values
/// that depend on a rocker.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoPose {
    /// The wheel of a single-wheel study has no pose.
    #[error("{0}")]
    Corner(#[from] Failure),
    /// A wheel of an axle has no pose at its travel.
    #[error("{} wheel at travel {travel:.6}: {failure}", side.name())]
    Wheel {
        /// Wheel that has no pose.
        side: Side,
        /// Travel of this wheel.
        travel: f64,
        /// Reason for the failure.
        failure: Failure,
    },
    /// A rigid axle has no pose at the requested difference of its two travels.
    #[error("axle at a travel difference of {difference:.6} (left - right): {failure}")]
    RigidAxle {
        /// Travel of the left wheel minus the travel of the right wheel.
        difference: f64,
        /// Reason for the failure. The limit of the drive is half a difference of travels, in the frame of a wheel. The limit of
        /// the rack is a mean travel.
        failure: Failure,
        /// Wheel in whose frame the limit is given.
        side: Side,
    },
    /// No difference of travels puts both wheels on the ground at this roll angle. Either a wheel falls when the difference
    /// of travels should raise it, or the iteration did not converge.
    #[error("there is no difference of the travels at which both wheels touch the ground")]
    NoGround,
    /// No mean travel gives the axle the required load. Either the load does not grow with the travel, a wheel cannot reach
    /// the travel, or the iteration did not converge.
    #[error("there is no mean travel at which the wheels carry the required load")]
    NoLoad,
    /// A certificate was requested. The poses of both wheels are certified, but the ground under the wheels is not
    /// certified to be unique.
    #[error("both poses are certified, but not the uniqueness of the ground position")]
    Unproven,
    /// The elastic parts have no equilibrium.
    #[error(
        "no equilibrium: equilibria exist only up to {share:.6} of the change from the design \
         position (1 = full change); \
         `hardpoint kc` names the part that limits them"
    )]
    NoEquilibrium {
        /// Largest fraction (0 to 1) of the change from the design position up to which equilibria exist.
        share: f64,
    },
    /// The elastic parts have an equilibrium, but it is unstable.
    #[error("the equilibrium is not stable")]
    Unstable,
    /// The elastic parts have an equilibrium, but a motion has no stiffness there.
    #[error(
        "the equilibrium has no derivatives: its equations are singular, because a motion of the parts has no stiffness"
    )]
    NoDerivatives,
    /// The elastic parts have no model under the conditions of a test: rack locked, or anti-roll bar disconnected.
    #[error(
        "the elastic parts have no equilibrium under the conditions of a test; `hardpoint kc` states the reason"
    )]
    NoModel,
}

impl NoPose {
    /// Describes the reason in words, with lengths in this unit and the rack in the axes of this frame. The frame belongs
    /// to a single wheel, or to an axle's left wheel. If the rack is the limit, the text omits the wheel's travel, which is
    /// irrelevant.
    pub fn describe(&self, unit: LengthUnit, frame: Frame) -> String {
        let frame_of = |side: Side| match side {
            Side::Left => frame,
            Side::Right => frame.of_other_side(),
        };
        match self {
            NoPose::Corner(failure) => failure.describe(unit, frame),
            NoPose::Wheel {
                side,
                failure: failure @ Failure::RackUnreachable { .. },
                ..
            } => side.about(&failure.describe(unit, frame_of(*side))),
            NoPose::Wheel {
                side,
                travel,
                failure,
            } => format!(
                "{} wheel at travel {travel:.6} {}: {}",
                side.name(),
                unit.symbol(),
                failure.describe(unit, frame_of(*side))
            ),
            NoPose::RigidAxle {
                difference,
                failure,
                side,
            } => {
                let length = |value: f64| format!("{value:.6} {}", unit.symbol());
                let reason = match failure {
                    Failure::Unreachable { limit, cause, .. } => format!(
                        "the difference ends at {}: {}",
                        length(2.0 * side.sign() * limit),
                        cause
                    ),
                    Failure::RackUnreachable { limit, cause } => {
                        format!("the mean travel ends at {}: {}", length(*limit), cause)
                    }
                    other => other.describe(unit, frame),
                };
                let difference = length(*difference);
                format!("axle at a travel difference of {difference} (left - right): {reason}")
            }
            other => other.to_string(),
        }
    }

    /// Failure of a wheel or of a rigid axle, if such a failure is the reason.
    pub fn of_wheel(&self) -> Option<&Failure> {
        match self {
            NoPose::Corner(failure)
            | NoPose::Wheel { failure, .. }
            | NoPose::RigidAxle { failure, .. } => Some(failure),
            NoPose::NoGround
            | NoPose::NoLoad
            | NoPose::Unproven
            | NoPose::NoEquilibrium { .. }
            | NoPose::Unstable
            | NoPose::NoDerivatives
            | NoPose::NoModel => None,
        }
    }

    /// Returns true if there is a pose, but it could not be certified.
    pub fn is_unproven(&self) -> bool {
        match self.of_wheel() {
            Some(failure) => matches!(failure, Failure::Uncertified(_)),
            None => *self == NoPose::Unproven,
        }
    }
}
