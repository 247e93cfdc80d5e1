//! Derivatives and condition number of a pose.
//!
//! They depend only on the pose and the motion, not on the solver or on earlier stations.

use super::Solver;
use crate::derive::Factorised;
use crate::derive::Linearised;
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::Failure;
use crate::mechanism::{Configuration, Pose};
use crate::model::Drive;
use crate::number::{Jet, Vector3};
use crate::solve::tracker::{FARTHEST, STEEPEST};

/// Distance from the origin up to which the closed form keeps its accuracy, in multiples of the mechanism's size.
const FAR: f64 = 1e3;
/// Distance, relative to the mechanism's size, below which poses count as equal. Assemblies closer than this are near a toggle,
/// where the closed form is not used.
const SAME: f64 = 1e-9;

impl Solver<'_> {
    /// Configuration in a pose found by this solver, as a power series along the motion.
    pub fn configuration_series<'a, const N: usize>(
        &'a self,
        design_series: &'a DesignSeries<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Result<Configuration<'a, Jet<f64, N>>, Failure> {
        if N > 1
            && !design_series.is_steered()
            && let Some((series, _)) = self.closed_form_series(pose, motion)
        {
            return Ok(design_series.at(self.mechanism(), series, motion.rack));
        }
        let (configuration, _) = self.factorised_series(design_series, pose, motion, false)?;
        Ok(configuration)
    }

    /// Configuration in a pose as a power series along the motion. Includes the LU factors of the closure equations'
    /// Jacobian if the series needs them or `linearise` is true.
    pub(crate) fn factorised_series<'a, const N: usize>(
        &'a self,
        design_series: &'a DesignSeries<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
        linearise: bool,
    ) -> Result<Factorised<'a, N>, Failure> {
        let factors = if linearise || design_series.takes_factors() {
            let factors = self.factorise(pose, &motion.value_point());
            Some(factors.ok_or(Failure::Singular)?)
        } else {
            None
        };
        let configuration =
            design_series.configuration(self.mechanism, pose, motion, factors.as_ref(), &self.work);
        Ok((configuration, factors))
    }

    /// Taylor series of a pose by the closed form, with an estimate of its condition number. `None` if there is no closed
    /// form, if it does not give this pose, or if the tracker would reject the pose. Also `None` if the rack moves along the
    /// motion, or if the design is far from the origin.
    pub(crate) fn closed_form_series<const N: usize>(
        &self,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Option<(Pose<Jet<f64, N>>, f64)> {
        let form = self.form.as_ref()?;
        if self.coordinate_scale >= FAR * self.size {
            return None;
        }
        let tangent = form.half_tangent(pose);
        // The comparison is false for NaN, so NaN is refused.
        let is_near = tangent.abs() < FARTHEST;
        let (series, state) = is_near.then(|| form.pose_series(tangent, motion))??;
        self.work.note(|w| {
            w.closed_form_evaluations += 1;
            w.right_hand_sides += N as u64 - 1;
        });
        // If the path has passed a toggle, the closed form gives another assembly.
        let mut turned = 0.0;
        for (k, column) in series.rotation.columns.iter().enumerate() {
            turned += (column.map(|c| c[0]) - pose.rotation.columns[k]).norm_squared();
        }
        let moved = (series.origin.map(|c| c[0]) - pose.origin).norm_squared();
        let size = self.size;
        let is_same = moved + turned * size * size <= (SAME * size).powi(2);
        if !(is_same && state.is_well_conditioned()) {
            return None;
        }
        let velocity = form.velocity(&state, tangent);
        let rate = match motion.drive {
            Drive::ArmAngle => None,
            Drive::Travel => {
                let tangent_rate = 0.5 * (1.0 + tangent * tangent) * velocity.arm_angle;
                let rise = velocity.rise.abs();
                // The comparison is false for NaN, so NaN is refused.
                let is_steady = tangent_rate.abs() * size <= STEEPEST * rise;
                let rate = velocity.ball_joint.norm() + velocity.turn.norm() * size;
                Some(is_steady.then_some(rate / rise)?)
            }
        };
        let condition = form.condition(&state, size, rate);
        // The constant term of the result is exactly the given pose, whatever the order of the series.
        let mut with_pose = pose.map(Jet::constant);
        with_pose.origin = with_constant(series.origin, pose.origin);
        for (k, column) in with_pose.rotation.columns.iter_mut().enumerate() {
            *column = with_constant(series.rotation.columns[k], pose.rotation.columns[k]);
        }
        Some((with_pose, condition))
    }

    /// Taylor series of the configuration as in [`Solver::configuration_series`], prepared for sensitivities.
    pub fn linearised<'a, const N: usize>(
        &'a self,
        design_series: &'a DesignSeries<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Result<Linearised<'a, N>, Failure> {
        let (configuration, factors) = self.factorised_series(design_series, pose, motion, true)?;
        let factors = factors.ok_or(Failure::Singular)?;
        Ok(design_series.linearised(configuration, factors, motion, &self.work))
    }
}

/// Replaces the constant terms of the Taylor series of a vector by `value`.
#[inline]
fn with_constant<const N: usize>(
    series: Vector3<Jet<f64, N>>,
    value: Vector3<f64>,
) -> Vector3<Jet<f64, N>> {
    let part = |mut series: Jet<f64, N>, value: f64| {
        series.0[0] = value;
        series
    };
    Vector3::new(
        part(series.x, value.x),
        part(series.y, value.y),
        part(series.z, value.z),
    )
}
