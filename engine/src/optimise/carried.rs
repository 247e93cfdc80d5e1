//! Forces in members under load, as residuals of targets and rows of constraints.
//!
//! A force is a multiplier of the closure equations under a load. So the derivatives of the force need the derivatives of the
//! equations' Jacobian. Forward differentiation gives these derivatives: the design is a Taylor series along a variable. The
//! pose and the balance of forces then become Taylor series, too.

use super::moves::PointRate;
use crate::analyse::Balance;
use crate::characteristics::{CarriedForce, Constants, Measure, Slots, WheelReading};
use crate::derive::{DesignSeries, Linearised, MotionPoint};
use crate::model::Suspension;
use crate::number::{Jet, Vector3};
use crate::solve::Solver;

/// A design and its Taylor series along each variable.
pub(super) struct AlongVariables {
    /// For each variable, the Taylor series of the design along the variable.
    series: Vec<DesignSeries<2>>,
    constants: Constants,
    reads: Slots,
}

impl AlongVariables {
    /// Allocates memory for this number of variables. `None` if no measure is a force in a member.
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

    /// Sets the design, and the rates at which the variables move its points.
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

    /// Derivatives of a force in a pose with respect to the variables, one variable after the other. NaN if no member can
    /// carry the load.
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

/// Taylor series of a force at a pose. NaN if no member can carry the load.
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
