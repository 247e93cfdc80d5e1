//! Designs one at a time, by the careful path.

use super::Stations;
use super::evaluate::{Block, FailedStation, finite};
use crate::characteristics::{Constants, Quantity, Slots, View};
use crate::kinematics::{DesignFault, Failure, Lifted, March, MotionPoint, Pose, Solver};
use crate::model::Suspension;
use crate::number::Vector3;
use std::ops::ControlFlow;

/// One design at a time. `N` coefficients of a pose's series at every station, `M` in the design
/// position.
pub(super) struct Careful<'a, const N: usize, const M: usize> {
    stations: &'a Stations,
    quantities: &'a [Quantity],
    constants: Constants,
    /// What the quantities read.
    slots: Slots,
    solver: Solver<'a>,
    lifted: Lifted<N>,
    with_slope: Lifted<M>,
}

impl<'a, const N: usize, const M: usize> Careful<'a, N, M> {
    /// A solver of these quantities. An error says why the suspension's own design cannot be solved.
    pub(super) fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
    ) -> Result<Self, DesignFault> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let slots = quantities
            .iter()
            .fold(Slots::default(), |slots, q| slots.with(q.reads()));
        let steering_axis = slots.contain_steering_axis();
        Ok(Careful {
            stations,
            quantities,
            constants: Constants::of(suspension),
            slots,
            solver: Solver::new(mechanism, design)?,
            lifted: Lifted::new(mechanism, design).with_steering_axis(steering_axis),
            with_slope: Lifted::new(mechanism, design).with_steering_axis(steering_axis),
        })
    }

    /// Evaluates the designs of these numbers.
    pub(super) fn evaluate(
        &mut self,
        designs: &[Vector3<f64>],
        numbers: &[usize],
        block: &mut Block,
    ) {
        let points = self.solver.design().len();
        for &number in numbers {
            let design = &designs[number * points..(number + 1) * points];
            if let Err(fault) = self.evaluate_design(number, design, block) {
                // What was found before the fault showed is not to be used.
                let (outputs, stations) = (block.outputs, block.stations);
                let size = outputs * stations;
                block.values[number * size..(number + 1) * size].fill(f64::NAN);
                block.slopes[number * outputs..(number + 1) * outputs].fill(f64::NAN);
                block.failures.retain(|f| f.design != number);
                block.faults.push((number, fault));
            }
        }
    }

    fn evaluate_design(
        &mut self,
        number: usize,
        design: &[Vector3<f64>],
        block: &mut Block,
    ) -> Result<(), DesignFault> {
        let Careful {
            stations,
            quantities,
            constants,
            slots,
            solver,
            lifted,
            with_slope,
        } = self;
        solver.prepare(design)?;
        lifted.prepare(solver.mechanism(), design);
        with_slope.prepare(solver.mechanism(), design);
        let (count, drive) = (stations.count(), stations.drive);
        let first = number * quantities.len();
        for (r, rack) in stations.racks.iter().enumerate() {
            let rack = *rack;
            solver.march(drive, &stations.march, rack, |solver, v, pose| {
                let station = stations.number(r, v);
                let motion = MotionPoint {
                    drive,
                    value: stations.values()[v],
                    rack,
                };
                let read = |pose: &Pose<f64>| {
                    let at = solver.posture_series(lifted, pose, &motion.along_drive())?;
                    let view = View::reading(&at, *constants, *slots);
                    for (k, quantity) in quantities.iter().enumerate() {
                        let value = view.value(&at, *quantity)[0];
                        block.values[(first + k) * count + station] = finite(value);
                    }
                    if station == stations.design() {
                        let at = solver.posture_series(with_slope, pose, &motion.along_drive())?;
                        let view = View::reading(&at, *constants, *slots);
                        for (k, quantity) in quantities.iter().enumerate() {
                            let slope = view.value(&at, *quantity).derivative(1);
                            block.slopes[first + k] = finite(slope);
                        }
                    }
                    Ok(())
                };
                if let Err(failure) = pose.and_then(read) {
                    block.failures.push(FailedStation {
                        design: number,
                        station,
                        failure,
                    });
                }
                ControlFlow::Continue(())
            })?;
        }
        Ok(())
    }

    /// Puts in the slopes of quantities made of velocities, for the designs not among these numbers: their
    /// values are known.
    pub(super) fn add_slopes(
        &mut self,
        designs: &[Vector3<f64>],
        except: &[usize],
        block: &mut Block,
    ) {
        let points = self.solver.design().len();
        let design_station = self.stations.design();
        let rack = self.stations.racks[design_station / self.stations.values().len()];
        let march = March::through(&[0.0]);
        let motion = MotionPoint {
            drive: self.stations.drive,
            value: 0.0,
            rack,
        };
        let mut left = except.iter().peekable();
        for (number, design) in designs.chunks_exact(points).enumerate() {
            if left.next_if(|n| **n == number).is_some() {
                continue;
            }
            let first = number * self.quantities.len();
            self.with_slope.prepare(self.solver.mechanism(), design);
            let (with_slope, quantities) = (&self.with_slope, self.quantities);
            let (constants, slots) = (self.constants, self.slots);
            let read = |solver: &Solver, _: usize, pose: Result<&Pose<f64>, Failure>| {
                let along = motion.along_drive();
                let found = pose.and_then(|pose| solver.posture_series(with_slope, pose, &along));
                if let Ok(at) = found {
                    let view = View::reading(&at, constants, slots);
                    for (k, quantity) in quantities.iter().enumerate() {
                        if quantity.depth() > 0 {
                            let slope = view.value(&at, *quantity).derivative(1);
                            block.slopes[first + k] = finite(slope);
                        }
                    }
                }
                ControlFlow::Continue(())
            };
            // A design that the lanes solved has no fault; if it had, the slope would be missing.
            let prepared = self.solver.prepare(design);
            let _ = prepared.and_then(|()| self.solver.march(motion.drive, &march, rack, read));
        }
    }
}
