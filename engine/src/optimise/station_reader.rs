//! Values and gradients of the quantities that targets and constraints use, evaluated in the poses of the stations.

use super::carried::{self, AlongVariables};
use super::layout::{Leg, TargetLayout};
use super::moves::PointRate;
use super::{Infeasible, Linearisation};
use crate::characteristics::{Constants, Measure, WheelReading};
use crate::derive::{DesignSeries, Linearised, MotionPoint};
use crate::mechanism::{DesignFault, Failure, Pose};
use crate::model::{Drive, Mechanism, PointId, Suspension};
use crate::number::{Jet, Vector3};
use crate::solve::{Solver, StationOrder, Toggles};
use std::ops::ControlFlow;

/// Values of constraint parts at the stations of a leg (a motion at one rack displacement), indexed by part and station.
pub(super) type PartValues = Vec<Vec<f64>>;

/// Inputs and memory for the evaluation of the stations of a leg (a motion at one rack displacement).
pub(super) struct Visit<'v, 'a> {
    pub(super) leg: &'v Leg,
    /// Stations of the leg that this evaluation needs ([`Leg::order_of`]).
    pub(super) order: &'v StationOrder,
    pub(super) layout: &'v TargetLayout,
    pub(super) constants: Constants,
    pub(super) point_rates: &'v [PointRate],
    pub(super) toggles: &'v Toggles,
    pub(super) moving: Option<&'v AlongVariables>,
    pub(super) solver: &'v mut Solver<'a>,
    pub(super) values: &'v mut PartValues,
    /// Memory for the residuals, with the index of their first row.
    pub(super) into: Option<(&'v mut Linearisation, usize)>,
    /// Memory for the rows of the constraints.
    pub(super) rows: Option<&'v mut Linearisation>,
}

/// Interface of a [`Reader`], independent of its number of coefficients.
pub(super) trait ReadStations: Send {
    /// Prepares to read poses of this design.
    fn prepare(&mut self, mechanism: &Mechanism, design: &[Vector3<f64>]);
    /// Evaluates the stations of a leg (a motion at one rack displacement).
    fn visit(&mut self, visit: Visit<'_, '_>) -> Result<(), Infeasible>;
}

/// Makes the evaluator ([`Reader`]) of the quantities that the layout lists, with their sensitivities to the points.
pub(super) fn reader(
    suspension: &Suspension,
    layout: &TargetLayout,
    points: &[PointId],
    variables: usize,
) -> Box<dyn ReadStations> {
    match layout.rate_order() {
        0 => Box::new(Reader::<1>::new(suspension, layout, points, variables)),
        _ => Box::new(Reader::<2>::new(suspension, layout, points, variables)),
    }
}

/// Reads values and gradients from poses. Each Taylor series along the motion has `N` coefficients.
pub(super) struct Reader<const N: usize> {
    pub(super) series: DesignSeries<N>,
    pub(super) slopes: Slopes<N>,
}

impl<const N: usize> Reader<N> {
    pub(super) fn new(
        suspension: &Suspension,
        layout: &TargetLayout,
        points: &[PointId],
        variables: usize,
    ) -> Self {
        let design = &suspension.design;
        Reader {
            series: DesignSeries::new(&suspension.mechanism, design)
                .with_steering_axis(layout.reads.contain_steering_axis())
                .with_sensitivities_to(&suspension.mechanism, points),
            slopes: Slopes {
                buffer: vec![Vector3::new(0.0, 0.0, 0.0).map(Jet::constant); design.len()],
                gradient: vec![Vector3::new(0.0, 0.0, 0.0); design.len()],
                by_variable: vec![0.0; variables],
            },
        }
    }
}

impl<const N: usize> ReadStations for Reader<N> {
    fn prepare(&mut self, mechanism: &Mechanism, design: &[Vector3<f64>]) {
        self.series.prepare(mechanism, design);
    }

    fn visit(&mut self, visit: Visit<'_, '_>) -> Result<(), Infeasible> {
        let Visit {
            leg,
            order,
            layout,
            constants,
            point_rates,
            toggles,
            moving,
            solver,
            values,
            mut into,
            mut rows,
        } = visit;
        for values in values.iter_mut() {
            values.clear();
            values.resize(leg.order.values().len(), f64::NAN);
        }
        let mut failed = None;
        read_poses(solver, leg, order, |solver, station, place, pose| {
            let motion = place.along_drive::<N>();
            let linearised = solver.linearised(&self.series, pose, &motion)?;
            if let Some(rod) = toggles.note(Some(solver), &linearised.at, place.value) {
                return Err(Failure::Toggle(rod));
            }
            let view = WheelReading::reading(&linearised.at, constants, layout.reads);
            let reading = |measure| Reading {
                measure,
                view: &view,
                linearised: &linearised,
                solver,
                motion: place,
                point_rates,
                moving,
            };
            let slopes = &mut self.slopes;
            if let Some((into, first)) = &mut into {
                for sample in &leg.targets[station] {
                    let (measure, row) = (&layout.measures[sample.of], *first + sample.row);
                    let found = read(measure, &view, &linearised, solver.size())[0];
                    failed = failed.take().or_else(|| uncarried(measure, found, place));
                    if sample.write_residual(row, found, into) {
                        slopes.form(&reading(measure));
                        into.write_slopes(row, &slopes.by_variable, sample.scale);
                    }
                }
            }
            let Some(rows) = &mut rows else {
                return Ok(());
            };
            for check in &leg.checks[station] {
                let part = &layout.parts[check.part].limited;
                let found = read(&part.of, &view, &linearised, solver.size())[0];
                failed = failed.take().or_else(|| uncarried(&part.of, found, place));
                values[check.part][station] = found;
                slopes.form(&reading(&part.of));
                check.write(part, found, &slopes.by_variable, rows);
            }
            Ok(())
        })?;
        failed.map_or(Ok(()), Err)
    }
}

/// Derivatives of a measure with respect to the variables.
pub(super) struct Slopes<const N: usize> {
    pub(super) buffer: Vec<Vector3<Jet<f64, N>>>,
    pub(super) gradient: Vec<Vector3<f64>>,
    pub(super) by_variable: Vec<f64>,
}

/// Inputs for the derivatives of one measure in one pose, for example the rates at which the variables move the points.
pub(super) struct Reading<'r, 'a, const N: usize> {
    pub(super) measure: &'r Measure,
    pub(super) view: &'r WheelReading<N>,
    pub(super) linearised: &'r Linearised<'a, N>,
    pub(super) solver: &'r Solver<'a>,
    pub(super) motion: &'r MotionPoint<f64>,
    pub(super) point_rates: &'r [PointRate],
    /// Taylor series of the design along each variable. Required if the measure is a force.
    pub(super) moving: Option<&'r AlongVariables>,
}

impl<const N: usize> Slopes<N> {
    pub(super) fn form(&mut self, of: &Reading<'_, '_, N>) {
        let (view, linearised) = (of.view, of.linearised);
        let (buffer, gradient) = (&mut self.buffer, &mut self.gradient);
        match of.measure {
            Measure::Carried(force) => {
                let moving = of.moving.iter();
                let found = moving.flat_map(|m| m.slopes(force, of.solver, linearised, of.motion));
                for (slope, found) in self.by_variable.iter_mut().zip(found) {
                    *slope = found;
                }
                return;
            }
            Measure::Quantity(quantity) => {
                view.gradients(
                    linearised,
                    *quantity,
                    0,
                    buffer,
                    &mut |_, PointId(p), found| {
                        gradient[p] = found;
                    },
                );
            }
            measure => {
                buffer.fill(Vector3::new(0.0, 0.0, 0.0).map(Jet::constant));
                linearised.gradient(buffer, |seeds| measure.seed(&linearised.at, seeds));
                for (gradient, series) in gradient.iter_mut().zip(buffer) {
                    *gradient = series.map(|c| c[0]);
                }
            }
        }
        self.by_variable.fill(0.0);
        for rate in of.point_rates {
            self.by_variable[rate.column] += self.gradient[rate.point].dot(rate.by);
        }
    }
}

/// Taylor series of a measure along the motion. NaN for a force if no member can carry the load.
pub(super) fn read<const N: usize>(
    measure: &Measure,
    view: &WheelReading<N>,
    linearised: &Linearised<'_, N>,
    size: f64,
) -> Jet<f64, N> {
    match measure {
        Measure::Quantity(quantity) => view.value(&linearised.at, *quantity),
        Measure::Carried(force) => carried::value(force, view, linearised, size),
        _ => measure.value(&linearised.at),
    }
}

/// Describes a drive value in words.
pub(super) fn place_in_words(drive: Drive, value: f64) -> String {
    match drive {
        Drive::Travel => format!("travel {value}"),
        Drive::ArmAngle => format!("arm angle {} deg", value.to_degrees()),
    }
}

/// Returns a function that converts the fault of an unsolvable design into the reason why residuals are missing.
pub(super) fn refused(mechanism: &Mechanism) -> impl Fn(DesignFault) -> Infeasible {
    |fault| Infeasible::Refused(fault.describe(mechanism))
}

/// Reads the poses of a leg (a motion at one rack displacement) at some drive values, one after another. Stops with an
/// error at the first drive value without a pose.
pub(super) fn read_poses<'a>(
    solver: &mut Solver<'a>,
    leg: &Leg,
    order: &StationOrder,
    mut read: impl FnMut(&Solver<'a>, usize, &MotionPoint<f64>, &Pose<f64>) -> Result<(), Failure>,
) -> Result<(), Infeasible> {
    let mechanism = solver.mechanism();
    let mut failed = None;
    let visited = solver.for_each_pose(leg.drive, order, leg.rack, |solver, number, pose| {
        let place = MotionPoint {
            drive: leg.drive,
            value: order.values()[number],
            rack: leg.rack,
        };
        match pose.and_then(|pose| read(solver, number, &place, pose)) {
            Ok(()) => ControlFlow::Continue(()),
            Err(failure) => {
                let place = place_in_words(place.drive, place.value);
                let why = format!("the mechanism does not reach {place}: {failure}");
                failed = Some(Infeasible::Refused(why));
                ControlFlow::Break(())
            }
        }
    });
    visited.map_err(refused(mechanism))?;
    failed.map_or(Ok(()), Err)
}

/// Makes the error for a force that no member can carry: the value `found` of such a force is NaN. Returns `None` for all
/// other measures and values.
pub(super) fn uncarried(
    measure: &Measure,
    found: f64,
    place: &MotionPoint<f64>,
) -> Option<Infeasible> {
    let is_uncarried = matches!(measure, Measure::Carried(_)) && found.is_nan();
    is_uncarried.then(|| {
        let place = place_in_words(place.drive, place.value);
        Infeasible::Refused(format!(
            "at {place}, no part has a lever arm that can carry the load"
        ))
    })
}
