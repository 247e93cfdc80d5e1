//! A design lifted to power series, to be evaluated pose by pose.

use super::closure::{Closure, Driver};
use super::lu::{Lu6, Vector6};
use super::pose::{Pose, Posture};
use super::rates::{angular_velocity, pose_series};
use super::sensitivity::Linearised;
use super::steering::{Steered, twist_by_rack};
use crate::model::{Drive, Mechanism, SteeringAxis};
use crate::number::{Jet, Vector3};

/// Where the motion is: the drive with its kind, and the rack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionPoint<T> {
    /// What drives.
    pub drive: Drive,
    /// Length or angle (radians).
    pub value: T,
    /// Rack displacement, towards the kernel's +y.
    pub rack: T,
}

impl MotionPoint<f64> {
    /// The drive equation.
    pub(super) fn driver(&self) -> Driver<f64> {
        match self.drive {
            Drive::Travel => Driver::Travel(self.value),
            Drive::ArmAngle => {
                let (sine, cosine) = self.value.sin_cos();
                Driver::ArmAngle { sine, cosine }
            }
        }
    }

    /// The same point with the drive as the variable of a power series, the rack held.
    pub fn along_drive<const N: usize>(&self) -> MotionPoint<Jet<f64, N>> {
        MotionPoint {
            drive: self.drive,
            value: Jet::variable(self.value),
            rack: Jet::constant(self.rack),
        }
    }
}

impl<const N: usize> MotionPoint<Jet<f64, N>> {
    /// The drive equation along the motion.
    pub(super) fn driver(&self) -> Driver<Jet<f64, N>> {
        match self.drive {
            Drive::Travel => Driver::Travel(self.value),
            Drive::ArmAngle => {
                let (sine, cosine) = self.value.sin_cos();
                Driver::ArmAngle { sine, cosine }
            }
        }
    }
}

/// A posture along the motion with, where there was a need for them, the factors of its Jacobian.
pub(super) type Factorised<'a, const N: usize> = (Posture<'a, Jet<f64, N>>, Option<Lu6<f64>>);

/// A design over power series with `N` coefficients, and its closure equations.
#[derive(Clone, Debug)]
pub struct Lifted<const N: usize> {
    design: Vec<Vector3<Jet<f64, N>>>,
    closure: Closure<Jet<f64, N>>,
    /// Where the steering axis is an instantaneous one.
    steered: Option<Steered<N>>,
}

impl<const N: usize> Lifted<N> {
    /// Lifts a design.
    pub fn new(mechanism: &Mechanism, design: &[Vector3<f64>]) -> Self {
        let design: Vec<_> = design.iter().map(|p| p.map(Jet::constant)).collect();
        let closure = Closure::new(mechanism, &design);
        let steered = (mechanism.steering_axis == Some(SteeringAxis::Instantaneous))
            .then(|| Steered::new(mechanism, &design));
        Lifted {
            design,
            closure,
            steered,
        }
    }

    /// Leaves out the steering axis if it is not `wanted` and takes more than the position of two
    /// joints.
    pub fn with_steering_axis(mut self, wanted: bool) -> Self {
        if !wanted {
            self.steered = None;
        }
        self
    }

    /// Takes over another design of the same mechanism, without allocating.
    pub fn prepare(&mut self, mechanism: &Mechanism, design: &[Vector3<f64>]) {
        for (lifted, point) in self.design.iter_mut().zip(design) {
            *lifted = point.map(Jet::constant);
        }
        self.closure.prepare(mechanism, &self.design);
        if let Some(steered) = &mut self.steered {
            steered.prepare(mechanism, &self.design);
        }
    }

    /// The posture in a solved pose, as a series along `motion`, with the factors of its Jacobian if
    /// there was a need for them (a series beyond its constant part, or `linearise`). `None` where the
    /// Jacobian is singular.
    pub(super) fn posture<'a>(
        &'a self,
        mechanism: &'a Mechanism,
        closure: &Closure<f64>,
        design: &[Vector3<f64>],
        pose: &Pose<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
        linearise: bool,
    ) -> Option<Factorised<'a, N>> {
        let mut series = pose.map(Jet::constant);
        let mut factors = None;
        if N > 1 || linearise || self.steered.is_some() {
            let rack = motion.rack[0];
            let at = Posture {
                mechanism,
                design,
                pose: *pose,
                rack,
                steering: None,
            };
            let point = MotionPoint {
                drive: motion.drive,
                value: motion.value[0],
                rack,
            };
            let lu = Lu6::new(closure.jacobian(&at, point.driver()), 1.0)?;
            series = self.series(mechanism, &lu, pose, motion);
            factors = Some(lu);
        }
        let mut posture = Posture {
            mechanism,
            design: &self.design,
            pose: series,
            rack: motion.rack,
            steering: None,
        };
        if let (Some(_), Some(lu)) = (&self.steered, &factors) {
            let twist = twist_by_rack(&posture, &self.closure, motion.driver(), lu);
            posture.steering = Some(twist);
        }
        Some((posture, factors))
    }

    /// The pose as a series along `motion`.
    pub(super) fn series(
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

    /// The residuals of the closure equations along a series of poses.
    pub(super) fn residuals(
        &self,
        mechanism: &Mechanism,
        pose: &Pose<Jet<f64, N>>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Vector6<Jet<f64, N>> {
        let at = Posture {
            mechanism,
            design: &self.design,
            pose: *pose,
            rack: motion.rack,
            steering: None,
        };
        self.closure.residuals(&at, motion.driver())
    }

    /// A series of poses of this design.
    pub fn at<'a>(
        &'a self,
        mechanism: &'a Mechanism,
        pose: Pose<Jet<f64, N>>,
        rack: Jet<f64, N>,
    ) -> Posture<'a, Jet<f64, N>> {
        Posture {
            mechanism,
            design: &self.design,
            pose,
            rack,
            steering: None,
        }
    }

    /// The posture made ready for sensitivities.
    pub(super) fn linearised<'a>(
        &'a self,
        posture: Posture<'a, Jet<f64, N>>,
        factors: Lu6<f64>,
        motion: &MotionPoint<Jet<f64, N>>,
    ) -> Linearised<'a, N> {
        Linearised::new(
            posture,
            &self.closure,
            self.steered.as_ref(),
            motion.driver(),
            factors,
        )
    }
}

impl<const N: usize> Posture<'_, Jet<f64, N>> {
    /// Angular velocity of the knuckle along the series. Its highest coefficient is unknown.
    pub fn angular_velocity(&self) -> Vector3<Jet<f64, N>> {
        angular_velocity(&self.pose)
    }
}
