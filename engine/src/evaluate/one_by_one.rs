//! One design at a time, by the adjoint of the closure equations.

use super::{Evaluated, Unsolved};
use crate::characteristics::{Constants, Quantity, Slots, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::{DesignFault, Failure, Toggles};
use crate::model::{PointId, Suspension};
use crate::number::{Jet, Vector3};
use crate::solve::Solver;
use crate::sweep::Stations;
use std::ops::ControlFlow;

/// Solves one design after another; `N` coefficients of every series.
pub(super) struct OneByOne<'a, const N: usize> {
    stations: &'a Stations,
    quantities: &'a [Quantity],
    constants: Constants,
    reads: Slots,
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
    ) -> Result<Self, DesignFault> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let reads = Slots::of(quantities.iter().map(|q| q.reads()));
        let rockers = quantities.iter().flat_map(|q| q.rockers(mechanism));
        let none = Vector3::new(0.0, 0.0, 0.0).map(Jet::constant);
        Ok(OneByOne {
            stations,
            quantities,
            constants: Constants::of(suspension),
            reads,
            toggles: Toggles::of(mechanism, rockers),
            solver: Solver::new(mechanism, design)?,
            design_series: DesignSeries::new(mechanism, design)
                .with_steering_axis(reads.contain_steering_axis()),
            buffer: vec![none; design.len()],
        })
    }

    /// Forms gradients by these points only.
    pub(super) fn differentiate_by(&mut self, points: &[PointId]) {
        let series = self.design_series.clone();
        self.design_series = series.with_sensitivities_to(self.solver.mechanism(), points);
    }

    /// Evaluates the design of this number; the first station that fails ends it, unless every station is wanted.
    pub(super) fn evaluate(
        &mut self,
        design: &[Vector3<f64>],
        number: usize,
        every_station: bool,
        into: &mut Evaluated,
    ) -> Result<(), Unsolved> {
        let OneByOne {
            stations,
            quantities,
            constants,
            reads,
            toggles,
            solver,
            design_series,
            buffer,
        } = self;
        solver.prepare(design).map_err(Unsolved::Fault)?;
        design_series.prepare(solver.mechanism(), design);
        let drive = stations.drive;
        let mut failed = None;
        for (r, rack) in stations.racks.iter().copied().enumerate() {
            toggles
                .begin(solver, drive, rack)
                .map_err(Unsolved::Fault)?;
            let visited =
                solver.for_each_pose(drive, &stations.station_order, rack, |solver, v, pose| {
                    let station = stations.number(r, v);
                    let value = stations.values()[v];
                    let motion = MotionPoint { drive, value, rack }.along_drive::<N>();
                    let linearised = pose
                        .and_then(|pose| solver.linearised(design_series, pose, &motion))
                        .and_then(|linearised| {
                            match toggles.note(Some(solver), &linearised.at, value) {
                                None => Ok(linearised),
                                Some(rod) => Err(Failure::Toggle(rod)),
                            }
                        });
                    let linearised = match linearised {
                        Ok(linearised) => linearised,
                        Err(failure) => {
                            failed.get_or_insert(Unsolved::Station(station, failure));
                            return match every_station {
                                true => ControlFlow::Continue(()),
                                false => ControlFlow::Break(()),
                            };
                        }
                    };
                    let reading = WheelReading::reading(&linearised.at, *constants, *reads);
                    for (k, quantity) in quantities.iter().enumerate() {
                        let found = reading.value(&linearised.at, *quantity)[0];
                        into.put(number, k, station, found);
                        let mut receive = |_: usize, id: PointId, by: Vector3<f64>| {
                            into.put_gradient((number, k, station), id, by);
                        };
                        reading.gradients(&linearised, *quantity, 0, buffer, &mut receive);
                    }
                    into.solved_of(number)[station] = true;
                    ControlFlow::Continue(())
                });
            visited.map_err(Unsolved::Fault)?;
            if failed.is_some() && !every_station {
                break;
            }
        }
        match failed {
            Some(why) => Err(why),
            None => Ok(()),
        }
    }
}
