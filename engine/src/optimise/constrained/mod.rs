//! Least squares under constraints, by a sequence of convex subproblems.
//!
//! Minimise |a(x)|^2 / 2 within the box of the variables, subject to
//!
//! ```text
//! c_i(x)  = 0    for the first rows,
//! c_i(x) <= 0    for the others,
//! |b_k(x)| <= level_k
//! ```
//!
//! where a is the *goal*, c are the *rows*, and the norm of each b may not exceed a *level*. For the smallest change of a
//! design, b are the residuals of the tuning, whose norm must stay below a limit. For a Pareto front, b are the residuals of
//! some of the targets. At x a step d (in half ranges of the variables) is the minimum of
//!
//! ```text
//! |A d + a|^2 / 2 + d . S d / 2    with  C d + c <= 0 (= 0),  |B d + b| <= level,  |d_j| <= radius   (1)
//! ```
//!
//! with the Jacobians A, B, C ([`ConvexModel`](model)). The levels stay quadratic. If they were linearised, their
//! multipliers would grow without bound wherever b vanishes. A secant method finds the multiplier of a level: it solves the
//! same quadratic program with the squares of the level added, times a weight. Several levels use nested secant methods.
//! The nested methods converge, because the excess of a level falls as its own weight rises. This holds even if the weights
//! of the other levels are adjusted each time.
//!
//! S is zero in the first iterations. If a run takes longer, residuals are large or constraints are curved, and the
//! Gauss-Newton method converges slowly. From then on S is a symmetric rank-one estimate of the curvature that A^T A does not
//! contain (J. E. Dennis, D. M. Gay, R. E. Welsch, An adaptive nonlinear least-squares algorithm, ACM Trans. Math. Softw. 7,
//! 1981). In the first iterations, such an estimate would slow down convergence.
//!
//! A filter accepts steps: no earlier pair of goal and violation may be better in both (R. Fletcher, S. Leyffer, Nonlinear
//! programming without a penalty function, Mathematical Programming 91, 2002). If curvature of the constraints is the reason
//! for a rejection, the method tries one second-order correction before it shortens the step. If the rows of (1) contradict
//! one another, the method relaxes them, so that the largest violation is as small as possible. If even this smallest value
//! is not below the present violation, no small move reduces the violation. The run then ends and names the rows that
//! contradict one another.
//!
//! Rows that no variable changes are left out ([`movable`]). A run has converged if its multipliers cancel the gradient of the
//! objective ([`stationarity`](super::stationarity)).

mod curvature;
mod filter;
mod model;
mod movable;
mod solver;
#[cfg(test)]
mod tests;

pub(super) use solver::KEPT;
pub use solver::{ConstrainedFit, constrained_fit};

use super::{Infeasible, Linearisation};
use nalgebra::DVector;

/// A least-squares problem with constraints.
pub trait Constrained {
    /// Numbers of variables, residuals and rows of the problem.
    fn shape(&self) -> Shape;

    /// Absolute values of the limits of the rows, in the rows' unit. They determine the rounding error of a row.
    fn row_limits(&self) -> Vec<f64> {
        vec![0.0; self.shape().rows]
    }

    /// Evaluates the problem at `x`, with its exact derivatives. The result must depend on `x` alone.
    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible>;
}

/// Numbers of variables, residuals and rows of a problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Number of variables, at least one.
    pub variables: usize,
    /// Number of residuals of the goal, at least one.
    pub goal: usize,
    /// Number of residuals of each level, and the limit of their norm.
    pub levels: Vec<(usize, f64)>,
    /// Number of all rows, including the equalities.
    pub rows: usize,
    /// Number of leading rows that must be zero.
    pub equalities: usize,
}

/// Values and derivatives of a problem at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// Goal a and its Jacobian A.
    pub goal: Linearisation,
    /// Residuals b and Jacobian B of each level.
    pub levels: Vec<Linearisation>,
    /// Rows c and their Jacobian C. The rows are scaled: a value of 1 is a violation that a user would see, 1 mm or 1 degree.
    pub rows: Linearisation,
}

impl Assessment {
    /// Allocates memory for a problem of this size.
    pub fn new(shape: &Shape) -> Self {
        let room = |residuals: usize| Linearisation::new(residuals, shape.variables);
        Assessment {
            goal: room(shape.goal),
            levels: shape.levels.iter().map(|level| room(level.0)).collect(),
            rows: room(shape.rows),
        }
    }

    /// Returns an error unless every number is finite.
    pub fn check(&self) -> Result<(), Infeasible> {
        self.goal.check()?;
        self.levels.iter().try_for_each(Linearisation::check)?;
        self.rows.check()
    }

    /// Returns the largest violation among all rows and levels. The violation of a level is the amount by which the norm
    /// exceeds the level, divided by the root of the number of residuals.
    pub fn violation(&self, equalities: usize, levels: &[f64]) -> f64 {
        self.violation_of(equalities, levels, |_| true)
    }

    /// Returns the largest violation among selected constraint rows and the levels (limits of a norm of residuals).
    pub fn violation_of(
        &self,
        equalities: usize,
        levels: &[f64],
        counts: impl Fn(usize) -> bool,
    ) -> f64 {
        let rows = self.rows.residuals.iter().enumerate();
        let rows = rows.filter(|(i, _)| counts(*i));
        let rows = rows.map(|(i, c)| if i < equalities { c.abs() } else { *c });
        let above = self.levels.iter().zip(levels).map(|(held, level)| {
            let count = held.residuals.len().max(1) as f64;
            (held.residuals.norm() - level) / count.sqrt()
        });
        rows.chain(above).fold(0.0, f64::max)
    }
}
