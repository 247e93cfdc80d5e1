//! A design as power series, for poses along the motion.

use super::rates::{angular_velocity, pose_series};
use super::sensitivity::Linearised;
use super::steering::{Steered, twist_by_rack};
use crate::linear::lu::{Lu6, Vector6};
use crate::mechanism::RowSet;
use crate::mechanism::WorkCounter;
use crate::mechanism::{Closure, Driver};
use crate::mechanism::{Configuration, Pose};
use crate::model::{Drive, Mechanism, PointId, SteeringAxis};
use crate::number::Jet;
use crate::number::Vector3;

/// A point of the motion: type and value of the drive, and rack displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionPoint<T> {
    /// Type of drive.
    pub drive: Drive,
    /// Value of the drive: a length or an angle in radians.
    pub value: T,
    /// Rack displacement, towards the kernel's +y.
    pub rack: T,
}

impl MotionPoint<f64> {
    /// Drive equation at this point.
    pub(crate) fn driver(&self) -> Driver<f64> {
        match self.drive {
            Drive::Travel => Driver::Travel(self.value),
            Drive::ArmAngle => {
                let (sine, cosine) = self.value.sin_cos();
                Driver::ArmAngle { sine, cosine }
            }
        }
    }

    /// Returns this point with the drive as the variable of a power series. The rack does not move.
    pub fn along_drive<const N: usize>(&self) -> MotionPoint<Jet<f64, N>> {
        MotionPoint {
            drive: self.drive,
            value: Jet::variable(self.value),
            rack: Jet::constant(self.rack),
        }
    }
}

impl<const N: usize> MotionPoint<Jet<f64, N>> {
    /// Constant part of the series.
    pub(crate) fn value_point(&self) -> MotionPoint<f64> {
        MotionPoint {
            drive: self.drive,
            value: self.value[0],
            rack: self.rack[0],
        }
    }

    /// Drive equation along the motion.
    pub(crate) fn driver(&self) -> Driver<Jet<f64, N>> {
        match self.drive {
            Drive::Travel => Driver::Travel(self.value),
            Drive::ArmAngle => {
                let (sine, cosine) = self.value.sin_cos();
                Driver::ArmAngle { sine, cosine }
            }
        }
    }
}

/// A configuration along the motion, and the LU factors of the closure equations' Jacobian if they were computed.
pub(crate) type Factorised<'a, const N: usize> = (Configuration<'a, Jet<f64, N>>, Option<Lu6<f64>>);

/// A design as power series in the drive value with `N` coefficients, and its closure equations.
#[derive(Clone, Debug)]
pub struct DesignSeries<const N: usize> {
    design: Vec<Vector3<Jet<f64, N>>>,
    closure: Closure<Jet<f64, N>>,
    /// Data for the series of an instantaneous steering axis; `None` if the axis is not instantaneous or not requested.
    steered: Option<Steered<N>>,
    /// Closure equations that depend on the points of [`DesignSeries::with_sensitivities_to`].
    rows: RowSet,
}

impl<const N: usize> DesignSeries<N> {
    /// Makes the power series of a design. Its points do not move along the motion.
    pub fn new(mechanism: &Mechanism, design: &[Vector3<f64>]) -> Self {
        let design: Vec<_> = design.iter().map(|p| p.map(Jet::constant)).collect();
        let closure = Closure::new(mechanism, &design);
        let steered = (mechanism.steering_axis == Some(SteeringAxis::Instantaneous))
            .then(|| Steered::new(mechanism, &design));
        DesignSeries {
            design,
            closure,
            steered,
            rows: RowSet::ALL,
        }
    }

    /// Limits sensitivities to these points. Gradients with respect to other points are then undefined.
    pub fn with_sensitivities_to(mut self, mechanism: &Mechanism, points: &[PointId]) -> Self {
        let design: Vec<_> = self.design.iter().map(|p| p.map(|c| c[0])).collect();
        self.rows = Closure::new(mechanism, &design).rows_holding(mechanism, &design, points);
        self
    }

    /// Omits the instantaneous steering axis if it is not `wanted`. A steering axis through two joints stays available.
    pub fn with_steering_axis(mut self, wanted: bool) -> Self {
        if !wanted {
            self.steered = None;
        }
        self
    }

    /// Closure equations of the design as power series along the motion.
    pub(crate) fn closure(&self) -> &Closure<Jet<f64, N>> {
        &self.closure
    }

    /// Returns true if configurations contain the velocity of the knuckle per unit of rack displacement (twist of the
    /// steering motion).
    pub(crate) fn is_steered(&self) -> bool {
        self.steered.is_some()
    }

    /// Replaces the design with another design of the same mechanism, without allocation.
    pub fn prepare(&mut self, mechanism: &Mechanism, design: &[Vector3<f64>]) {
        self.prepare_points(design);
        self.prepare_equations(mechanism);
    }

    fn prepare_points(&mut self, design: &[Vector3<f64>]) {
        for (design_series, point) in self.design.iter_mut().zip(design) {
            *design_series = point.map(Jet::constant);
        }
    }

    fn prepare_equations(&mut self, mechanism: &Mechanism) {
        self.closure.prepare(mechanism, &self.design);
        if let Some(steered) = &mut self.steered {
            steered.prepare(mechanism, &self.design);
        }
    }

    /// Replaces the design with a design whose points move along the series. Each entry is `(point number, rate)`.
    pub(crate) fn prepare_moving(
        &mut self,
        mechanism: &Mechanism,
        design: &[Vector3<f64>],
        ways: impl Iterator<Item = (usize, Vector3<f64>)>,
    ) {
        self.prepare_points(design);
        for (point, by) in ways {
            let rate = by.map(|rate| {
                let mut series = [0.0; N];
                series[1] = rate;
                Jet(series)
            });
            self.design[point] = self.design[point] + rate;
        }
        self.prepare_equations(mechanism);
    }

    /// Returns true if configurations need the factors of the closure equations' Jacobian.
    pub(crate) fn takes_factors(&self) -> bool {
        N > 1 || self.is_steered()
    }

    /// Configuration in a solved pose, as a series along `motion`. `factors` are the factors of the closure equations'
    /// Jacobian in this pose. They may be `None` unless [`DesignSeries::takes_factors`] is true.
    pub(crate) fn configuration<'a>(
        &'a self,
        mechanism: &'a Mechanism,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
        factors: Option<&Lu6<f64>>,
        work: &WorkCounter,
    ) -> Configuration<'a, Jet<f64, N>> {
        let series = match factors {
            Some(lu) if N > 1 => {
                work.note(|w| w.right_hand_sides += N as u64 - 1);
                self.series(mechanism, lu, pose, motion)
            }
            _ => pose.map(Jet::constant),
        };
        let mut configuration = Configuration::new(mechanism, &self.design, series, motion.rack);
        if let (Some(_), Some(lu)) = (&self.steered, factors) {
            work.note(|w| w.right_hand_sides += N as u64);
            let twist = twist_by_rack(&configuration, &self.closure, motion.driver(), lu);
            configuration.steering = Some(twist);
        }
        configuration
    }

    /// Pose as a series along `motion`, from the factors of the closure equations' Jacobian.
    pub(crate) fn series(
        &self,
        mechanism: &Mechanism,
        lu: &Lu6<f64>,
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Pose<Jet<f64, N>> {
        pose_series(
            mechanism,
            &self.design,
            &self.closure,
            lu,
            pose,
            motion.driver(),
            motion.rack,
        )
    }

    /// Residuals of the closure equations along a series of poses.
    pub(crate) fn residuals(
        &self,
        mechanism: &Mechanism,
        pose: &Pose<Jet<f64, N>>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Vector6<Jet<f64, N>> {
        let at = Configuration::new(mechanism, &self.design, *pose, motion.rack);
        self.closure.residuals(&at, motion.driver())
    }

    /// Configuration of this design along a series of poses.
    pub fn at<'a>(
        &'a self,
        mechanism: &'a Mechanism,
        pose: Pose<Jet<f64, N>>,
        rack: Jet<f64, N>,
    ) -> Configuration<'a, Jet<f64, N>> {
        Configuration::new(mechanism, &self.design, pose, rack)
    }

    /// Configuration, prepared for sensitivities.
    pub(crate) fn linearised<'a>(
        &'a self,
        configuration: Configuration<'a, Jet<f64, N>>,
        factors: Lu6<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
        work: &'a WorkCounter,
    ) -> Linearised<'a, N> {
        Linearised::new(
            configuration,
            &self.closure,
            self.rows,
            self.steered.as_ref(),
            motion.driver(),
            factors,
            work,
        )
    }
}

impl<const N: usize> Configuration<'_, Jet<f64, N>> {
    /// Angular velocity of the knuckle along the series. The highest coefficient of the result is unknown; do not use it.
    pub fn angular_velocity(&self) -> Vector3<Jet<f64, N>> {
        angular_velocity(&self.pose)
    }
}
