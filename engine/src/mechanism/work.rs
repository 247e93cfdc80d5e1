//! Counts of the solver's time-consuming steps.
//!
//! Counts are more reliable than a clock: they are the same on every machine. A study that requests less must show lower
//! counts.

use serde::{Deserialize, Serialize};
use std::cell::Cell;

/// Counts of the solver's steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Work {
    /// Poses from the closed form.
    pub closed_form_solves: u64,
    /// Evaluations of the closed form, for poses and for their Taylor series.
    pub closed_form_evaluations: u64,
    /// Newton iterations, on the closure equations or on the equations of the formulation `point_coordinates`.
    pub newton_iterations: u64,
    /// Factorisations of a Jacobian.
    pub factorisations: u64,
    /// Right-hand sides solved with the factors of a Jacobian or of its transpose. Each coefficient of a power series
    /// counts.
    pub right_hand_sides: u64,
    /// Closure equations that were differentiated with respect to the hardpoints, for sensitivities.
    pub gradient_rows: u64,
    /// Evaluations of characteristics, each with its derivatives with respect to the drive.
    pub characteristic_evaluations: u64,
    /// Gradients of characteristics with respect to their inputs.
    pub characteristic_gradients: u64,
}

impl Work {
    /// Counts one iteration of Newton's method, with its factorisation and its right-hand side.
    pub(crate) fn note_newton(&mut self) {
        self.newton_iterations += 1;
        self.factorisations += 1;
        self.right_hand_sides += 1;
    }
}

impl std::ops::Add for Work {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Work {
            closed_form_solves: self.closed_form_solves + other.closed_form_solves,
            closed_form_evaluations: self.closed_form_evaluations + other.closed_form_evaluations,
            newton_iterations: self.newton_iterations + other.newton_iterations,
            factorisations: self.factorisations + other.factorisations,
            right_hand_sides: self.right_hand_sides + other.right_hand_sides,
            gradient_rows: self.gradient_rows + other.gradient_rows,
            characteristic_evaluations: self.characteristic_evaluations
                + other.characteristic_evaluations,
            characteristic_gradients: self.characteristic_gradients
                + other.characteristic_gradients,
        }
    }
}

/// Counts of the solver's steps. Code that has only a shared reference can increase them.
#[derive(Clone, Debug, Default)]
pub struct WorkCounter(Cell<Work>);

impl WorkCounter {
    /// Adds to the counts.
    #[inline]
    pub fn note(&self, count: impl FnOnce(&mut Work)) {
        let mut work = self.0.get();
        count(&mut work);
        self.0.set(work);
    }

    /// Present counts.
    pub fn work(&self) -> Work {
        self.0.get()
    }
}
