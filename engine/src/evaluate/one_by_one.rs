//! Evaluation of designs one at a time, with every check.

use super::Stations;
use super::block::Block;
use super::evaluator::{Design, SolvesOneByOne};
use crate::characteristics::{Constants, Quantity, Slots, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::{DesignFault, Failure, Pose};
use crate::model::{RockerId, Suspension};
use crate::solve::{Solver, Toggles};
use std::ops::ControlFlow;

/// Evaluates one design at a time, with `N` coefficients of the pose's Taylor series at every station.
pub(super) struct OneByOne<'a, const N: usize> {
    stations: &'a Stations,
    quantities: &'a [Quantity],
    constants: Constants,
    /// Inputs that the quantities read.
    slots: Slots,
    /// Rockers that influence each quantity.
    rockers: Vec<Vec<RockerId>>,
    toggles: Toggles,
    solver: Solver<'a>,
    design_series: DesignSeries<N>,
    with_slope: DesignSeries<2>,
}

impl<'a, const N: usize> OneByOne<'a, N> {
    /// Evaluates these quantities at these stations, with the solver of the suspension.
    pub(super) fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
        solver: Solver<'a>,
    ) -> Self {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let slots = Slots::of(quantities.iter().map(|q| q.reads()));
        let rockers: Vec<_> = quantities.iter().map(|q| q.rockers(mechanism)).collect();
        let steering_axis = slots.contain_steering_axis();
        OneByOne {
            stations,
            quantities,
            constants: Constants::of(suspension),
            slots,
            toggles: Toggles::of(mechanism, rockers.iter().flatten().copied()),
            rockers,
            solver,
            design_series: DesignSeries::new(mechanism, design).with_steering_axis(steering_axis),
            with_slope: DesignSeries::new(mechanism, design).with_steering_axis(steering_axis),
        }
    }
}

impl<const N: usize> SolvesOneByOne for OneByOne<'_, N> {
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block) -> Result<(), DesignFault> {
        let (number, [design, _]) = (design.number, design.wheels);
        let OneByOne {
            stations,
            quantities,
            constants,
            slots,
            rockers,
            toggles,
            solver,
            design_series,
            with_slope,
        } = self;
        solver.prepare(design)?;
        design_series.prepare(solver.mechanism(), design);
        with_slope.prepare(solver.mechanism(), design);
        let drive = stations.drive;
        for (r, rack) in stations.racks.iter().enumerate() {
            let rack = *rack;
            toggles.begin(solver, drive, rack)?;
            solver.for_each_pose(drive, &stations.station_order, rack, |solver, v, pose| {
                let station = stations.number(r, v);
                let motion = MotionPoint {
                    drive,
                    value: stations.values()[v],
                    rack,
                };
                let read = |pose: &Pose<f64>| {
                    let at =
                        solver.configuration_series(design_series, pose, &motion.along_drive())?;
                    let toggle = toggles.note(Some(solver), &at, motion.value);
                    let free = |k: &usize| !rockers[*k].iter().any(|id| toggles.holds(*id));
                    let view = WheelReading::reading(&at, *constants, *slots);
                    for k in (0..quantities.len()).filter(free) {
                        let quantity = &quantities[k];
                        block.put(number, k, station, view.value(&at, *quantity)[0]);
                    }
                    if station == stations.design() {
                        let at =
                            solver.configuration_series(with_slope, pose, &motion.along_drive())?;
                        let view = WheelReading::reading(&at, *constants, *slots);
                        for k in (0..quantities.len()).filter(free) {
                            let quantity = &quantities[k];
                            if quantity.rate_order() == 0 {
                                let slope = view.value(&at, *quantity).derivative(1);
                                block.put_slope(number, k, slope);
                            }
                        }
                    }
                    toggle.map_or(Ok(()), |rod| Err(Failure::Toggle(rod)))
                };
                if let Err(failure) = pose.and_then(read) {
                    block.fail(number, station, failure.into());
                }
                ControlFlow::Continue(())
            })?;
        }
        Ok(())
    }
}
