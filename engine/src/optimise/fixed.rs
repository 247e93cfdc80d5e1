//! Constant residuals, which no variable changes, are removed during a tuning.
//!
//! A target that no variable changes adds a constant to the squared misfit. If the target is missed by far, that constant
//! hides the other targets. A run stops as soon as an iteration lowers the misfit only by a small share. With the constant,
//! the run would stop too early. Designs within a hundredth of the best misfit could still miss all other targets. So such a
//! residual counts as zero while a tuning runs. Afterwards the residual is restored, and the result names the target.
//!
//! A residual counts as constant if a move of any variable across its range changes it by less than [`UNMOVED`]. The tuning
//! checks this at its start and at every evaluation. If such a residual changes later, the tuning runs again with it. Only
//! residuals above 1 (one tolerance, if the weights are equal) are removed, because smaller ones hide nothing. So a target
//! whose value is within its band stays in the problem: its residual is zero, and grows when the value leaves the band.

use super::constrained::{Assessment, Constrained, Shape};
use super::{Bounds, Fit, Infeasible, LeastSquares, Linearisation, Multistart, Termination};
use nalgebra::DVector;
use std::sync::atomic::{AtomicBool, Ordering};

/// A residual counts as constant if a move of any variable across its range changes the residual by less than this multiple
/// of the tolerance. Values of some thousand tolerances have rounding errors of this size if the errors are amplified a
/// thousand times.
pub(super) const UNMOVED: f64 = 1e-9;

/// Largest number of repetitions of all starts. The starts run again if a residual changes that was constant at the design.
const ROUNDS: usize = 3;

/// Residual or deviation above which a target is missed, in multiples of the tolerance.
pub(super) const MISSED: f64 = 1.0;

/// Returns true if a move of some variable across its range changes a residual.
pub(super) fn moves(at: &Linearisation, row: usize, bounds: &Bounds) -> bool {
    let entries = at.jacobian.row(row);
    let mut entries = entries.iter().zip(bounds.width().iter());
    entries.any(|(j, width)| (j * width).abs() > UNMOVED)
}

/// Runs every start without the residuals that are constant at the design. If some of them change elsewhere, they are restored,
/// and the starts run again. `run` runs the starts without the given residuals.
pub(crate) fn starts_without_fixed(
    at_design: Option<&Linearisation>,
    bounds: &Bounds,
    run: impl Fn(&FixedRows) -> Multistart,
) -> Multistart {
    let mut fixed = at_design.map_or_else(FixedRows::default, |at| FixedRows::at(at, bounds));
    let mut starts = run(&fixed);
    for round in 1..=ROUNDS {
        let Some(fewer) = fixed.without_moved() else {
            break;
        };
        fixed = if round < ROUNDS {
            fewer
        } else {
            FixedRows::default()
        };
        starts = run(&fixed);
    }
    for start in &mut starts.starts {
        if let Ok(fit) = &mut start.outcome {
            fixed.put_back(fit);
        }
    }
    starts
}

/// Residuals of missed targets that no variable changes.
#[derive(Debug, Default)]
pub(crate) struct FixedRows {
    /// For each residual: row, value, and a flag. The flag is true if a variable changes the row at an evaluated point.
    rows: Vec<(usize, f64, AtomicBool)>,
}

impl FixedRows {
    /// Finds the residuals above [`MISSED`] that no variable changes at the point of `at`.
    pub(super) fn at(at: &Linearisation, bounds: &Bounds) -> Self {
        let rows = at.residuals.iter().enumerate();
        let rows = rows.filter(|(row, value)| value.abs() > MISSED && !moves(at, *row, bounds));
        let rows = rows.map(|(row, value)| (row, *value, AtomicBool::new(false)));
        FixedRows {
            rows: rows.collect(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Sum of the squares of the constant residuals.
    pub(super) fn square(&self) -> f64 {
        self.rows.iter().map(|(_, value, _)| value * value).sum()
    }

    /// Returns only the rows that no variable has changed at any evaluated point. `None` if all rows are still constant.
    pub(super) fn without_moved(&self) -> Option<Self> {
        let has_moved = |moved: &AtomicBool| moved.load(Ordering::Relaxed);
        if !self.rows.iter().any(|(.., moved)| has_moved(moved)) {
            return None;
        }
        let rows = self.rows.iter().filter(|(.., moved)| !has_moved(moved));
        let rows = rows.map(|(row, value, _)| (*row, *value, AtomicBool::new(false)));
        Some(FixedRows {
            rows: rows.collect(),
        })
    }

    /// Sets the constant residuals to zero. Marks residuals that a variable changes at this point.
    fn take_out(&self, at: &mut Linearisation, bounds: &Bounds) {
        for (row, _, moved) in &self.rows {
            if moves(at, *row, bounds) {
                moved.store(true, Ordering::Relaxed);
            }
            at.residuals[*row] = 0.0;
            at.jacobian.row_mut(*row).fill(0.0);
        }
    }

    /// Puts the constant residuals back into a fit.
    pub(super) fn put_back(&self, fit: &mut Fit) {
        if self.is_empty() {
            return;
        }
        let square = self.square();
        for (row, value, _) in &self.rows {
            fit.evaluation.residuals[*row] = *value;
        }
        let count = fit.evaluation.residuals.len() as f64;
        for iteration in &mut fit.history {
            iteration.cost += 0.5 * square;
            iteration.misfit = (2.0 * iteration.cost / count).sqrt();
        }
        if fit.termination == Termination::MisfitReached {
            fit.termination = Termination::MovedTargetsMet;
        }
    }
}

/// A problem whose constant residuals are set to zero.
pub(crate) struct Without<'a, P> {
    pub problem: P,
    pub fixed: &'a FixedRows,
    pub bounds: &'a Bounds,
}

impl<P: LeastSquares> LeastSquares for Without<'_, P> {
    fn variables(&self) -> usize {
        self.problem.variables()
    }

    fn residuals(&self) -> usize {
        self.problem.residuals()
    }

    fn evaluate(&mut self, x: &DVector<f64>, into: &mut Linearisation) -> Result<(), Infeasible> {
        self.problem.evaluate(x, into)?;
        self.fixed.take_out(into, self.bounds);
        Ok(())
    }
}

impl<P: Constrained> Constrained for Without<'_, P> {
    fn shape(&self) -> Shape {
        self.problem.shape()
    }

    fn row_limits(&self) -> Vec<f64> {
        self.problem.row_limits()
    }

    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible> {
        self.problem.assess(x, into)?;
        self.fixed.take_out(&mut into.goal, self.bounds);
        Ok(())
    }
}
