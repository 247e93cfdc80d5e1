//! Estimate of the condition number from intermediate results of the closed form.
//!
//! With the arm held, a unit of residual, in sizes of the mechanism, moves the knuckle in two ways: the upper
//! end gives way about its lever u, and the tie rod lets the knuckle turn about the steering axis d with its
//! own lever w, more so as the tie rod's outer end t follows the upper end,
//!
//! ```text
//! u = s (the strut's length above the foot) or |d| cos(upper arm's circle, d),   w = ga |n|^2/(|d| L)
//! X = 1 + 1/u + (1 + |t|/u)/w
//! ```
//!
//! A unit of travel moves it by v = |x_q|, and cancels what the residuals have done to the travel, so that
//! |J^-1| is about X + v (1 + X); with the arm as the drive it is about X. These are sums of absolute values,
//! on the large side, and J's rows, a unit force and its moment, are somewhat larger than one: taken as one
//! the product is right to within a factor of ten (`tests/it/hard_cases.rs`).

use super::{ArmState, ClosedForm};

impl ClosedForm<f64> {
    /// An estimate of the condition number in a state of a mechanism of this size. `rate` is the move of the pose
    /// per unit of travel; `None` if the arm's angle drives.
    #[inline]
    pub(crate) fn condition(&self, state: &ArmState<f64>, size: f64, rate: Option<f64>) -> f64 {
        let tie_rod_squared = self.tie_squared - 2.0 * self.tie_difference;
        let upper = self.upper.lever(state);
        let steering = state.ga.abs() * state.gram;
        let steering_lever = (state.dd * tie_rod_squared).sqrt();
        let outer = self.tie_squared.sqrt();
        // One division for both levers.
        let turned = size / (upper * steering);
        let held = 1.0 + turned * (steering + (upper + outer) * steering_lever);
        match rate {
            Some(rate) => held + rate * (1.0 + held),
            None => held,
        }
    }
}
