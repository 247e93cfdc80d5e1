//! What is known of a pose once it is found: its derivatives, its condition, the loads it carries.

use super::{ClosedFormPose, Solver};
use crate::derive::Factorised;
use crate::derive::Linearised;
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::Failure;
use crate::mechanism::{Configuration, Pose};
use crate::number::Jet;

impl Solver<'_> {
    /// The configuration in a pose found by this solver, as a power series along the motion.
    pub fn configuration_series<'a, const N: usize>(
        &'a self,
        design_series: &'a DesignSeries<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Result<Configuration<'a, Jet<f64, N>>, Failure> {
        if let Some(series) = self.formed_series(design_series, pose, motion) {
            return Ok(design_series.at(self.mechanism, series, motion.rack));
        }
        let (configuration, _) = self.factorised_series(design_series, pose, motion, false)?;
        Ok(configuration)
    }

    /// The configuration with the factors of its Jacobian, if there was a need for them; with `linearise` there
    /// is.
    pub(crate) fn factorised_series<'a, const N: usize>(
        &'a self,
        design_series: &'a DesignSeries<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
        linearise: bool,
    ) -> Result<Factorised<'a, N>, Failure> {
        let known = self.factors_at(pose, &motion.value_point());
        design_series
            .configuration(
                self.mechanism,
                &self.closure,
                &self.design,
                pose,
                motion,
                known,
                &self.work,
                linearise,
            )
            .ok_or(Failure::Singular)
    }

    /// The series of a pose that the closed form gave, by the closed form.
    pub(crate) fn formed_series<const N: usize>(
        &self,
        design_series: &DesignSeries<N>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Option<Pose<Jet<f64, N>>> {
        if N == 1 || design_series.is_steered() {
            return None;
        }
        let formed = self.formed_at(pose, &motion.value_point())?;
        self.work.note(|w| {
            w.closed_form_evaluations += 1;
            w.right_hand_sides += N as u64 - 1;
        });
        self.form.as_ref()?.pose_series(formed.tangent, motion)
    }

    /// What the closed form knows of a pose that it gave.
    fn formed_at(&self, pose: &Pose<f64>, point: &MotionPoint<f64>) -> Option<&ClosedFormPose> {
        let formed = self.formed.as_ref()?;
        (formed.pose == *pose && formed.point == *point).then_some(formed)
    }

    /// About the condition number of a pose that the closed form gave, where it is known.
    pub(crate) fn formed_condition(
        &self,
        pose: &Pose<f64>,
        point: &MotionPoint<f64>,
    ) -> Option<f64> {
        self.formed_at(pose, point)?.condition
    }

    /// As [`Solver::configuration_series`], ready for sensitivities.
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
