//! Conditions for the end of a run.

/// Conditions for the end of a run. Each condition is an inequality. The first condition that holds ends the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Condition: misfit <= `misfit_below`. The misfit is the root mean square of the residuals, in multiples of the
    /// tolerance. The default is the rounding error of curves that are some thousand tolerances high. Fits with misfits below
    /// the default are equally good.
    pub misfit_below: f64,
    /// Condition: predicted and actual reduction of the cost <= `reduction_below` times the cost. The default, 1e-10, makes
    /// the misfit accurate to ten digits. The limit does not matter for a minimum with zero misfit. Near such a minimum each
    /// step lowers the cost by a large fraction, so the run finds it to the last digit.
    pub reduction_below: f64,
    /// Condition: max_j |step_j| / range_j <= `step_below`. The default is the rounding error of a coordinate that is up to
    /// sixteen times as large as its range.
    pub step_below: f64,
    /// Condition: |r . column_j| <= `gradient_below` |r| |column_j|, with r the residuals. The condition must hold for all
    /// columns of the Jacobian whose variable can lower the cost within its bounds. The default is the rounding error of the
    /// inner product of some thousand residuals.
    pub gradient_below: f64,
    /// Condition: number of iterations >= `max_iterations`.
    pub max_iterations: u64,
    /// Not a condition: rise of the violation that a step may cause above the violation of the start, in the unit of the rows.
    /// Whatever this value, the violation may not exceed 100, or 100 times the violation of the start if that is larger. The
    /// default is infinity. A small value prevents a run with a feasible start from jumping to another minimum.
    pub violation_below: f64,
    /// Condition: number of evaluations >= `max_evaluations`. The default is ten for each iteration; most iterations need one
    /// evaluation.
    pub max_evaluations: u64,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            misfit_below: 4096.0 * f64::EPSILON,
            reduction_below: 1e-10,
            step_below: 16.0 * f64::EPSILON,
            gradient_below: 64.0 * f64::EPSILON,
            max_iterations: 200,
            violation_below: f64::INFINITY,
            max_evaluations: 2000,
        }
    }
}
