//! Subject of the measurements: the suspension of a study over its travels, with exact answers.

use crate::DoubleDouble;
use crate::Unmeasurable;
use crate::single::Single;
use crate::trial::{Equations, SixEquations, solve};
use hardpoint_engine::ask::Need;
use hardpoint_engine::characteristics::{Characteristic, Constants, Inputs, Slots};
use hardpoint_engine::mechanism::{Configuration, DesignFault, Failure, Pose};
use hardpoint_engine::model::{Drive, SteeringAxis, Suspension};
use hardpoint_engine::number::{Real, Scalar, Vector3};
use hardpoint_engine::plan::Plan;
use hardpoint_engine::solve::{Solver, StationOrder};
use hardpoint_engine::study::WheelStudy;
use std::ops::ControlFlow;

/// A number type whose distance from the exact value can be measured.
pub trait Measured: Scalar {
    /// Returns the number nearest to `value`.
    fn of(value: f64) -> Self;
    /// Returns the same number in twice the precision of a double.
    fn exactly(self) -> DoubleDouble;
}

impl Measured for Single {
    fn of(value: f64) -> Self {
        value.into()
    }
    fn exactly(self) -> DoubleDouble {
        self.value().into()
    }
}

impl Measured for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn exactly(self) -> DoubleDouble {
        self.into()
    }
}

impl Measured for DoubleDouble {
    fn of(value: f64) -> Self {
        value.into()
    }
    fn exactly(self) -> DoubleDouble {
        self
    }
}

/// A suspension and its stations for measurements.
pub struct Subject<'s> {
    /// The suspension.
    pub suspension: &'s Suspension,
    /// Wheel travels in rising order.
    pub travels: Vec<f64>,
    /// Rack displacement, positive towards the kernel's +y (to the left, for a left wheel).
    pub rack: f64,
    /// Exact poses at the travels.
    pub poses: Vec<Pose<DoubleDouble>>,
    /// Exact camber at the travels, in radians.
    pub camber: Vec<DoubleDouble>,
}

/// Smallest number of stations that form a curve.
const FEWEST: usize = 5;

impl<'s> Subject<'s> {
    /// Collects the stations of a study that can be solved, with the rack at its first displacement. The drive is the
    /// wheel travel, even if the study has another drive.
    pub fn of(study: &'s WheelStudy) -> Result<Self, Unmeasurable> {
        let suspension = &study.suspension;
        let plan = Plan::of(study);
        let curves = hardpoint_engine::curves::curves(suspension, &plan)?;
        let count = plan.stations() / plan.racks.len();
        let stations = curves.stations[..count].iter().zip(curves.along("travel"));
        let mut travels: Vec<f64> = stations
            .filter(|(s, _)| s.status == hardpoint_engine::curves::Status::Ok)
            .filter_map(|(_, travel)| travel)
            .collect();
        travels.sort_by(f64::total_cmp);
        travels.dedup();
        let rack = plan.racks[0] * plan.rack_sign;
        let mut subject = Subject {
            suspension,
            travels,
            rack,
            poses: Vec::new(),
            camber: Vec::new(),
        };
        let travels = std::mem::take(&mut subject.travels);
        for (travel, pose) in subject.exact(&travels)? {
            subject.travels.push(travel);
            subject.camber.push(subject.camber_of(&pose));
            subject.poses.push(pose);
        }
        let solved = subject.travels.len();
        if solved < FEWEST {
            return Err(Unmeasurable::FewStations {
                solved,
                needed: FEWEST,
            });
        }
        Ok(subject)
    }

    /// Exact poses at rising travels. Travels without a pose are omitted.
    pub fn exact(&self, travels: &[f64]) -> Result<Vec<(f64, Pose<DoubleDouble>)>, Unmeasurable> {
        let design = self.design::<DoubleDouble>();
        let mechanism = &self.suspension.mechanism;
        let equations = SixEquations::new(mechanism, &design, DoubleDouble::of(self.rack));
        let mut solver = Solver::new(mechanism, &self.suspension.design)?;
        let mut found = Vec::new();
        let station_order = StationOrder::through(travels);
        self.for_each_pose(&mut solver, &station_order, |_, station, pose| {
            if let Ok(pose) = pose {
                let mut start = pose.map(DoubleDouble::from);
                // The rotation is orthonormal only to the digits of a double, so it is orthonormalised again in double-double
                // arithmetic.
                for _ in 0..2 {
                    start.rotation = start.rotation.orthonormalised();
                }
                let travel = DoubleDouble::of(travels[station]);
                let (exact, _) = solve(&equations, start, travel, 0.0);
                found.push((travels[station], equations.pose(&exact)));
            }
        })?;
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(found)
    }

    /// Calls `visit` with the pose at each of these travels, as soon as the program finds it. The rack displacement is
    /// `self.rack`.
    pub fn for_each_pose<'m>(
        &self,
        solver: &mut Solver<'m>,
        station_order: &StationOrder,
        mut visit: impl FnMut(&Solver<'m>, usize, Result<&Pose<f64>, Failure>),
    ) -> Result<(), DesignFault> {
        let (drive, rack) = (Drive::Travel, self.rack);
        solver.for_each_pose(drive, station_order, rack, |solver, station, pose| {
            visit(solver, station, pose);
            ControlFlow::Continue(())
        })
    }

    /// Returns the mechanism in a pose: the design positions of all points, and the pose of the wheel carrier.
    #[inline]
    pub fn configuration<'a, T: Measured>(
        &'a self,
        design: &'a [Vector3<T>],
        pose: Pose<T>,
    ) -> Configuration<'a, T> {
        Configuration::new(&self.suspension.mechanism, design, pose, T::of(self.rack))
    }

    /// Design coordinates in another number type.
    pub fn design<T: Measured>(&self) -> Vec<Vector3<T>> {
        let points = self.suspension.design.iter();
        points.map(|p| p.map(T::of)).collect()
    }

    /// Exact camber of an exact pose.
    pub fn camber_of(&self, pose: &Pose<DoubleDouble>) -> DoubleDouble {
        camber(&self.configuration(&self.design(), *pose))
    }

    /// Camber of a pose.
    #[inline]
    pub fn camber_at(&self, pose: &Pose<f64>) -> f64 {
        camber(&self.configuration(&self.suspension.design, *pose))
    }

    /// Error of a camber at a station, in degrees.
    pub fn error<T: Measured>(&self, station: usize, camber: T) -> f64 {
        let error = camber.exactly() - self.camber[station];
        error.value().abs().to_degrees()
    }

    /// Position characteristics that this suspension has: camber, toe, caster and kingpin inclination first. A characteristic that
    /// needs a steering axis is included only if the axis runs through two joints.
    pub fn characteristics(&self) -> Vec<Characteristic> {
        let mechanism = &self.suspension.mechanism;
        let has = |need: &Need| match need {
            Need::SteeringAxis => {
                matches!(mechanism.steering_axis, Some(SteeringAxis::Through { .. }))
            }
            Need::WheelRadius
            | Need::Spring
            | Need::Rocker
            | Need::AntiRollBar
            | Need::StrutUpper => need.met_by(self.suspension),
            _ => false,
        };
        let all = Characteristic::ALL.iter().copied();
        all.filter(|c| !c.info().reads_rates() && c.info().needs.iter().all(has))
            .collect()
    }

    /// Vehicle data that formulas need.
    pub fn constants(&self) -> Constants {
        Constants::of(self.suspension)
    }
}

/// Camber of a configuration.
#[inline]
pub(super) fn camber<T: Real>(at: &Configuration<T>) -> T {
    let slots = Slots::default().with(Characteristic::Camber.info().reads);
    let inputs = Inputs::without_rates(at, Constants::default(), slots);
    Characteristic::Camber.evaluate(&inputs)
}
