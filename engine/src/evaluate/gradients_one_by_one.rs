//! Gradients of one design at a time, with the adjoint of the closure equations.

use super::evaluator::Design;
use super::{Evaluated, Stations};
use crate::characteristics::{Constants, Quantity, Slots, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::DesignFault;
use crate::model::{PointId, RockerId, Side, Suspension};
use crate::number::{Jet, Vector3};
use crate::solve::{Solver, Toggles};
use std::ops::ControlFlow;

/// Solver of one design after another.
pub(super) trait DifferentiatesOneByOne: Send {
    /// Evaluates a design at every station with a pose.
    fn evaluate(&mut self, design: Design<'_>, into: &mut Evaluated) -> Result<(), DesignFault>;
}

/// Solver of one design after another. Each Taylor series has `N` coefficients.
pub(super) struct OneByOne<'a, const N: usize> {
    stations: &'a Stations,
    quantities: &'a [Quantity],
    constants: Constants,
    reads: Slots,
    /// Rockers that influence each quantity.
    rockers: Vec<Vec<RockerId>>,
    toggles: Toggles,
    solver: Solver<'a>,
    design_series: DesignSeries<N>,
    buffer: Vec<Vector3<Jet<f64, N>>>,
}

impl<'a, const N: usize> OneByOne<'a, N> {
    pub(super) fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
        points: &[PointId],
    ) -> Result<Box<Self>, DesignFault> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let reads = Slots::of(quantities.iter().map(|q| q.reads()));
        let rockers: Vec<_> = quantities.iter().map(|q| q.rockers(mechanism)).collect();
        let none = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        Ok(Box::new(OneByOne {
            stations,
            quantities,
            constants: Constants::of(suspension),
            reads,
            toggles: Toggles::of(mechanism, rockers.iter().flatten().copied()),
            rockers,
            solver: Solver::new(mechanism, design)?,
            design_series: DesignSeries::new(mechanism, design)
                .with_steering_axis(reads.contain_steering_axis())
                .with_sensitivities_to(mechanism, points),
            buffer: vec![none; design.len()],
        }))
    }
}

impl<const N: usize> DifferentiatesOneByOne for OneByOne<'_, N> {
    fn evaluate(&mut self, design: Design<'_>, into: &mut Evaluated) -> Result<(), DesignFault> {
        let (number, [design, _]) = (design.number, design.wheels);
        let OneByOne {
            stations,
            quantities,
            constants,
            reads,
            rockers,
            toggles,
            solver,
            design_series,
            buffer,
        } = self;
        solver.prepare(design)?;
        design_series.prepare(solver.mechanism(), design);
        let drive = stations.drive;
        for (r, rack) in stations.racks.iter().copied().enumerate() {
            toggles.begin(solver, drive, rack)?;
            solver.for_each_pose(drive, &stations.station_order, rack, |solver, v, pose| {
                let station = stations.number(r, v);
                let value = stations.values()[v];
                let motion = MotionPoint { drive, value, rack }.along_drive::<N>();
                let linearised =
                    pose.and_then(|pose| solver.linearised(design_series, pose, &motion));
                let Ok(linearised) = linearised else {
                    return ControlFlow::Continue(());
                };
                let toggle = toggles.note(Some(solver), &linearised.at, value);
                let free = |k: &usize| !rockers[*k].iter().any(|id| toggles.holds(*id));
                let reading = WheelReading::reading(&linearised.at, *constants, *reads);
                for k in (0..quantities.len()).filter(free) {
                    let quantity = &quantities[k];
                    let found = reading.value(&linearised.at, *quantity)[0];
                    into.put(number, k, station, found);
                    let mut receive = |_: usize, id: PointId, by: Vector3<f64>| {
                        into.put_gradient((number, k, station), Side::Left, id, by);
                    };
                    reading.gradients(&linearised, *quantity, 0, buffer, &mut receive);
                }
                into.solved_of(number)[station] = toggle.is_none();
                ControlFlow::Continue(())
            })?;
        }
        Ok(())
    }
}
