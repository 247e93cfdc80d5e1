//! When a run ends.

/// When to stop. Each is an inequality; the first that holds ends the run.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// misfit <= this, the misfit being the root mean square of the residuals, in tolerances. The
    /// default is the rounding of curves that are some thousand tolerances high. Below it, fits are
    /// equally good.
    pub misfit_below: f64,
    /// Reductions of the cost, both predicted and found, <= this times the cost. The default, 1e-10,
    /// leaves the misfit right to ten digits; a minimum with zero misfit is found to the last digit
    /// whatever this is, because the cost keeps falling by large fractions of itself.
    pub reduction_below: f64,
    /// max_j |step_j| / range_j <= this. The default is the rounding of a coordinate up to sixteen
    /// times as large as the range it moves in.
    pub step_below: f64,
    /// |r . column_j| <= this |r| |column_j| for all columns of the Jacobian whose variable is free to
    /// descend. The default is the rounding of that inner product over some thousand residuals.
    pub gradient_below: f64,
    /// iterations >= this.
    pub max_iterations: u64,
    /// Violation, in the unit of the rows, up to which a step under constraints may go if it lowers the goal. The default,
    /// infinity, bears a hundred times that of the start. A small one keeps a run that begins where everything is kept
    /// from leaping into another valley.
    pub violation_below: f64,
    /// evaluations >= this. The default is ten for each iteration; most iterations take one.
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
