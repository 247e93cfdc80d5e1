//! Conditions for the end of a run.

/// Conditions for the end of a run. Each is an inequality; the first that holds ends the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Condition: misfit <= this. The misfit is the root mean square of the residuals, in tolerances. The default is the rounding
    /// of curves that are some thousand tolerances high. Below it, fits are equally good.
    pub misfit_below: f64,
    /// Condition: predicted and actual reduction of the cost <= this times the cost. The default, 1e-10, makes the misfit
    /// accurate to ten digits. A minimum with zero misfit is found to the last digit with any limit, because near it each step
    /// lowers the cost by a large fraction.
    pub reduction_below: f64,
    /// Condition: max_j |step_j| / range_j <= this. The default is the rounding of a coordinate that is up to sixteen times as
    /// large as its range.
    pub step_below: f64,
    /// |r . column_j| <= this |r| |column_j| for all columns of the Jacobian whose variable is free to
    /// descend. The default is the rounding of that inner product over some thousand residuals.
    pub gradient_below: f64,
    /// Number of iterations >= this.
    pub max_iterations: u64,
    /// Violation, in the unit of the rows, up to which a step under constraints may go if it lowers the goal. The default,
    /// infinity, allows a hundred times the violation of the start. With a small value, a run that starts feasible does not jump
    /// to another minimum.
    pub violation_below: f64,
    /// Condition: number of evaluations >= this. The default is ten for each iteration; most iterations take one.
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
