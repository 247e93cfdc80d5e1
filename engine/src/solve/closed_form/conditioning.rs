//! Estimate of the condition number from intermediate results of the closed form.
//!
//! With the arm fixed, a unit residual, relative to the mechanism's size, moves the knuckle in two ways. The upper end
//! moves, limited by its lever u. The knuckle rotates about the steering axis d, limited by the tie rod's lever w. This
//! rotation is larger because the tie rod's outer end t follows the upper end:
//!
//! ```text
//! u = s (the strut's length above the foot) or |d| cos(upper arm's circle, d),   w = ga |n|^2/(|d| L)
//! X = 1 + 1/u + (1 + |t|/u)/w
//! ```
//!
//! The module `closed_form` defines the other symbols. J is the Jacobian of the closure equations. A unit of travel q moves
//! the pose x by v = |x_q|. This motion must also cancel the travel that the residuals have caused. So |J^-1| is about X +
//! v (1 + X). With the arm as the drive, |J^-1| is about X. These sums of absolute values tend to overestimate. Each row of
//! J is a unit force and its moment, so the norm |J| is somewhat above one. The estimate uses |J| = 1. The product |J|
//! |J^-1| is correct within a factor of ten up to 1000 (`tests/it/hard_cases.rs`).

use super::{ArmState, ClosedForm};

impl ClosedForm<f64> {
    /// Estimate of the closure equations' condition number in a state of a mechanism of this size. `rate` is the
    /// displacement of the pose per unit of travel. `rate` is `None` if the arm's angle is the drive.
    #[inline]
    pub(crate) fn condition(&self, state: &ArmState<f64>, size: f64, rate: Option<f64>) -> f64 {
        let tie_rod_squared = self.tie_squared - 2.0 * self.tie_difference;
        let upper = self.upper.lever(state);
        let steering = state.ga.abs() * state.gram;
        let steering_lever = (state.dd * tie_rod_squared).sqrt();
        let outer = self.tie_squared.sqrt();
        // One division is enough for both lever arms.
        let turned = size / (upper * steering);
        let held = 1.0 + turned * (steering + (upper + outer) * steering_lever);
        match rate {
            Some(rate) => held + rate * (1.0 + held),
            None => held,
        }
    }
}
