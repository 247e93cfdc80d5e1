//! The pose along the motion from the closed form, without linear algebra.
//!
//! Let t be the tangent of half the arm's angle. One evaluation on Taylor series in t gives the travel
//! z(t0 + d) = z0 + z1 d + z2 d^2 + ... and the pose. Along the motion z(t0 + d(s)) = z(s), so the coefficients of d(s)
//! follow one after the other:
//!
//! ```text
//! d_k = (z_k(s) - [sum_(j >= 2) z_j d^j]_k) / z1                                  (1)
//! ```
//!
//! [..]_k is the coefficient of s^k. This bracket contains only coefficients of lower order than d_k. The pose along the
//! motion is the Taylor series of the pose in t, evaluated at t0 + d(s).

use super::{ArmState, ClosedForm};
use crate::derive::MotionPoint;
use crate::mechanism::Pose;
use crate::model::Drive;
use crate::number::Jet;
use crate::number::Real;

impl ClosedForm<f64> {
    /// Pose as a Taylor series along a motion with the rack fixed. `tangent` is the tangent of half the arm's angle. If the arm's
    /// angle is the drive, the angle is read from `motion` and `tangent` is not used. Also returns the state of the closed form at
    /// the start of the series. `None` if the rack moves, or if the series does not exist.
    pub(crate) fn pose_series<const N: usize>(
        &self,
        tangent: f64,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Option<(Pose<Jet<f64, N>>, ArmState<f64>)> {
        if motion.rack.0[1..].iter().any(|c| *c != 0.0) {
            return None;
        }
        let design_series = self.map(Jet::constant);
        let (series, state) = match motion.drive {
            Drive::ArmAngle => {
                let (sine, cosine) = motion.value.scaled(0.5).sin_cos();
                let state = design_series.at_half_tangent(sine / cosine, motion.rack);
                (design_series.pose(&state), state)
            }
            Drive::Travel => {
                let mut variable = Jet::constant(tangent);
                if N > 1 {
                    variable.0[1] = 1.0;
                }
                let state = design_series.at_half_tangent(variable, motion.rack);
                let rise = design_series.travel(&state);
                let mut along = Jet::constant(0.0);
                for k in 1..N {
                    let known = composed(rise, along)[k];
                    along.0[k] = (motion.value[k] - known) / rise[1];
                }
                let pose = design_series.pose(&state).map(|c| composed(c, along));
                (pose, state)
            }
        };
        let origin = series.origin;
        let is_finite = origin.x.0.iter().all(|c| c.is_finite());
        is_finite.then(|| (series, state.now()))
    }
}

/// Composes two Taylor series. The constant term of `inner` must be zero.
#[inline]
fn composed<const N: usize>(outer: Jet<f64, N>, inner: Jet<f64, N>) -> Jet<f64, N> {
    let mut sum = Jet::constant(outer[N - 1]);
    for coefficient in outer.0[..N - 1].iter().rev() {
        sum = sum * inner;
        sum.0[0] += coefficient;
    }
    sum
}
