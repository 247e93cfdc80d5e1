//! How accurate a pose has to be, and how accurate it is.
//!
//! Newton's method squares the error with every iteration, so the last one mostly makes a pose better
//! than anybody asked. With c a bound on |f''/(2 f')| the error left after a correction d is no more than
//! c d^2; where that is small enough the iteration ends one evaluation earlier. c is taken from the change
//! of the slope since the place before, with a margin: the bound is an estimate on the safe side, tested
//! on random designs. What proves a pose is [`Certifier`](crate::analyse::Certifier).

use crate::mechanism::Pose;
use std::cell::Cell;

/// An error of a pose: how far a point of the knuckle may be from where it should be, and by how much
/// the knuckle may be turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseError {
    /// Of every hardpoint that the knuckle carries.
    pub length: f64,
    /// Of the knuckle's rotation (rad).
    pub angle: f64,
}

impl PoseError {
    /// No error.
    pub const ZERO: PoseError = PoseError {
        length: 0.0,
        angle: 0.0,
    };

    /// What rounding may make of a pose where coordinates go up to `coordinate_scale` and points are up to `size`
    /// apart: the closed form is used where it loses no more than four digits.
    pub fn of_rounding(coordinate_scale: f64, size: f64) -> Self {
        let length = 1e4 * f64::EPSILON * coordinate_scale;
        PoseError {
            length,
            angle: length / size,
        }
    }

    /// The larger of both in each part.
    pub fn max(self, other: Self) -> Self {
        PoseError {
            length: self.length.max(other.length),
            angle: self.angle.max(other.angle),
        }
    }

    /// What separates two poses of a mechanism of this size.
    #[inline]
    pub(crate) fn between(a: &Pose<f64>, b: &Pose<f64>, size: f64) -> Self {
        let columns = a.rotation.columns.into_iter().zip(b.rotation.columns);
        let squares: f64 = columns.map(|(p, q)| (p - q).norm_squared()).sum();
        // Between rotations by an angle t the columns' differences make 8 sin^2(t/2).
        let angle = (0.5 * squares).sqrt();
        PoseError {
            length: (a.origin - b.origin).norm() + angle * size,
            angle,
        }
    }

    #[inline]
    pub(crate) fn scaled(self, factor: f64) -> Self {
        PoseError {
            length: self.length * factor,
            angle: self.angle * factor,
        }
    }

    /// How often this error goes into the one allowed; infinite where nothing is off.
    #[inline]
    pub(crate) fn times_in(self, allowed: PoseError) -> f64 {
        (allowed.length / self.length).min(allowed.angle / self.angle)
    }
}

/// Margin on the rate at which a pose moves, and on the curvature of the equation.
pub(crate) const MARGIN: f64 = 4.0;

/// What is asked of a solver, and the worst that it had to leave.
#[derive(Clone, Debug)]
pub(crate) struct ErrorBudget {
    /// What may be off; nothing by default, so that only rounding is.
    pub allowed: PoseError,
    left: Cell<PoseError>,
}

impl Default for ErrorBudget {
    fn default() -> Self {
        ErrorBudget {
            allowed: PoseError::ZERO,
            left: Cell::new(PoseError::ZERO),
        }
    }
}

impl ErrorBudget {
    pub(crate) fn new(allowed: PoseError) -> Self {
        ErrorBudget {
            allowed,
            ..ErrorBudget::default()
        }
    }

    /// Whether less than everything is asked.
    #[inline]
    pub(crate) fn is_relaxed(&self) -> bool {
        self.allowed.length > 0.0
    }

    /// Notes what an iteration left.
    #[inline]
    pub(crate) fn note(&self, left: PoseError) {
        self.left.set(self.left.get().max(left));
    }

    /// The worst that was left, rounding included.
    pub(crate) fn bound(&self, coordinate_scale: f64, size: f64) -> PoseError {
        let rounding = PoseError::of_rounding(coordinate_scale, size);
        let left = self.left.get();
        PoseError {
            length: left.length + rounding.length,
            angle: left.angle + rounding.angle,
        }
    }
}
