//! Member forces under load, as residuals and rows.
//!
//! A force is a multiplier of the closure equations under a load. So its derivatives need those of the equations' Jacobian.
//! Forward differentiation gives them: the design is a series along a variable, and the pose and the balance of forces follow as
//! series.

use super::moves::PointRate;
use crate::analyse::Balance;
use crate::characteristics::{CarriedForce, Constants, Measure, Slots, WheelReading};
use crate::derive::{DesignSeries, Linearised, MotionPoint};
use crate::model::Suspension;
use crate::number::{Jet, Vector3};
use crate::solve::Solver;

/// A design and its series along each of the variables.
pub(super) struct AlongVariables {
    /// For each variable, the design as a series along it.
    series: Vec<DesignSeries<2>>,
    constants: Constants,
    reads: Slots,
}

impl AlongVariables {
    /// Allocates for this number of variables. `None` if no measure is a force.
    pub(super) fn new<'m>(
        suspension: &Suspension,
        variables: usize,
        mut measures: impl Iterator<Item = &'m Measure>,
    ) -> Option<Self> {
        measures
            .any(|measure| matches!(measure, Measure::Carried(_)))
            .then(|| {
                let (mechanism, design) = (&suspension.mechanism, &suspension.design);
                let one = DesignSeries::new(mechanism, design).with_steering_axis(false);
                AlongVariables {
                    series: vec![one; variables],
                    constants: Constants::of(suspension),
                    reads: Slots::default().with(CarriedForce::READS),
                }
            })
    }

    /// Changes to a design, with the rates at which the variables move its points.
    pub(super) fn prepare(
        &mut self,
        solver: &Solver,
        design: &[Vector3<f64>],
        point_rates: &[PointRate],
    ) {
        for (column, series) in self.series.iter_mut().enumerate() {
            let own = point_rates.iter().filter(|rate| rate.column == column);
            let own = own.map(|rate| (rate.point, rate.by));
            series.prepare_moving(solver.mechanism(), design, own);
        }
    }

    /// Derivatives of a force by the variables in a pose, one by one. NaN if no member can carry the load.
    pub(super) fn slopes<const N: usize>(
        &self,
        force: &CarriedForce,
        solver: &Solver,
        linearised: &Linearised<'_, N>,
        motion: &MotionPoint<f64>,
    ) -> impl Iterator<Item = f64> {
        let pose = linearised.at.pose.map(|series| series[0]);
        let held = MotionPoint {
            drive: motion.drive,
            value: Jet::constant(motion.value),
            rack: Jet::constant(motion.rack),
        };
        self.series.iter().map(move |series| {
            let (factors, work) = (Some(linearised.factors()), linearised.work());
            let at = series.configuration(solver.mechanism(), &pose, &held, factors, work);
            let view = WheelReading::reading(&at, self.constants, self.reads);
            let balance = Balance::new(series.closure(), at, force.support, solver.size(), work);
            let moved = balance.and_then(|balance| force.value(&view, &balance));
            moved.map_or(f64::NAN, |moved| moved[1])
        })
    }
}

/// Value of a force along a series of poses. NaN if no member can carry the load.
pub(super) fn value<const N: usize>(
    force: &CarriedForce,
    view: &WheelReading<N>,
    linearised: &Linearised<'_, N>,
    size: f64,
) -> Jet<f64, N> {
    let (closure, work) = (linearised.closure(), linearised.work());
    let balance = Balance::new(closure, linearised.at, force.support, size, work);
    let value = balance.and_then(|balance| force.value(view, &balance));
    value.unwrap_or(Jet::constant(f64::NAN))
}
