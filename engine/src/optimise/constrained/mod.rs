//! Least squares under constraints, by a sequence of convex programs.
//!
//! Minimise |a(x)|^2 / 2 within the box of the variables, subject to
//!
//! ```text
//! c_i(x)  = 0    for the first rows,
//! c_i(x) <= 0    for the others,
//! |b_k(x)| <= level_k
//! ```
//!
//! where a is the *goal*, c are the *rows* and each b is something held to a *level*: the residuals of a
//! tuning that is to move as little as can be while it stays good enough, or those of some targets on the
//! way along a front. At x a step d (in half ranges of the variables) is the minimum of
//!
//! ```text
//! |A d + a|^2 / 2 + d . S d / 2    with  C d + c <= 0 (= 0),  |B d + b| <= level,  |d_j| <= radius   (1)
//! ```
//!
//! A, B, C being the Jacobians ([`ConvexModel`](model)). What is squared stays squared: linearised, the
//! level would have a multiplier that runs away wherever b vanishes. The multiplier of a level is found by a
//! secant over the same programs with the level's squares weighed in; of several levels, one within the
//! other, as a level's excess falls with its own weight whatever the others do to keep theirs. S is nothing in the first
//! iterations. Where a run takes more than those, residuals are large or constraints are curved, and
//! Gauss and Newton's method converges slowly; from then on S is a symmetric rank-one estimate of the
//! curvature that A^T A leaves out (J. E. Dennis, D. M. Gay, R. E. Welsch, An adaptive nonlinear
//! least-squares algorithm, ACM Trans. Math. Softw. 7, 1981). Earlier it would do harm.
//!
//! A filter accepts steps: no earlier pair of goal and violation may be better in both (R. Fletcher, S. Leyffer,
//! Nonlinear programming without a penalty function, Mathematical Programming 91, 2002). If curvature of the
//! constraints is the reason for a rejection, one second-order correction is tried before the step is shortened. If
//! the rows of (1) exclude one another, they are relaxed by the least possible value of the largest violation. If
//! that is no less than the present violation, no small move reduces it. The run then ends with the rows to blame.
//!
//! Rows that no variable moves are left out ([`movable`]). A run has converged where its multipliers balance the slope
//! ([`stationarity`](super::stationarity)).

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
    /// Size of the problem.
    fn shape(&self) -> Shape;

    /// Sizes of the limits that the rows are measured from, in the rows' unit; they tell the rounding of a row.
    fn row_limits(&self) -> Vec<f64> {
        vec![0.0; self.shape().rows]
    }

    /// Writes everything at `x`, with its exact derivatives. It must depend on `x` alone.
    fn assess(&mut self, x: &DVector<f64>, into: &mut Assessment) -> Result<(), Infeasible>;
}

/// Numbers of variables, residuals and rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Variables, at least one.
    pub variables: usize,
    /// Residuals of the goal, at least one.
    pub goal: usize,
    /// Residuals held to each level, and the limit of their norm.
    pub levels: Vec<(usize, f64)>,
    /// Rows, all.
    pub rows: usize,
    /// Number of leading rows that must vanish.
    pub equalities: usize,
}

/// A problem at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// a and A.
    pub goal: Linearisation,
    /// b and B, level by level.
    pub levels: Vec<Linearisation>,
    /// c and C. A violation of 1 is one that anybody would see: a millimetre, a degree.
    pub rows: Linearisation,
}

impl Assessment {
    /// Room for a problem.
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

    /// The largest violation of a row, and of a level as a mean over its residuals.
    pub fn violation(&self, equalities: usize, levels: &[f64]) -> f64 {
        self.violation_of(equalities, levels, |_| true)
    }

    /// The same, of some of the rows.
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
