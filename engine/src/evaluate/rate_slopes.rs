//! Slopes in the design position, for quantities that contain velocities, such as `motion_ratio` and `roll_centre_height`.
//!
//! The derivatives of such quantities with respect to the drive coordinate need accelerations, which the code for SIMD
//! lanes does not compute. Only one pose of each design is needed, so the code computes the slopes one design at a
//! time, with Taylor series.

use super::Stations;
use super::block::Block;
use super::evaluator::{Design, FindsSlopes};
use crate::characteristics::{Constants, Quantity, Slots, WheelReading};
use crate::derive::{DesignSeries, MotionPoint};
use crate::mechanism::DesignFault;
use crate::model::{RockerId, Suspension};
use crate::number::Vector3;
use crate::solve::{Solver, StationOrder, Toggles};
use std::ops::ControlFlow;

/// Computes the slopes (derivatives with respect to the drive coordinate) of quantities that contain velocities.
pub(super) struct RateSlopes<'a> {
    /// Quantities with their indices, and the rockers that influence each quantity.
    quantities: Vec<(usize, Quantity, Vec<RockerId>)>,
    /// Index of the station of the design position.
    station: usize,
    /// Station order with only the design position.
    order: StationOrder,
    /// Drive value and rack displacement of the design position.
    motion: MotionPoint<f64>,
    constants: Constants,
    slots: Slots,
    toggles: Toggles,
    solver: Solver<'a>,
    series: DesignSeries<3>,
}

impl<'a> RateSlopes<'a> {
    /// Prepares the slopes of all quantities that contain velocities and whose index satisfies `is_wanted`. `None` if there are no
    /// such quantities. The error is the reason why the nominal design cannot be solved.
    pub(super) fn of(
        suspension: &'a Suspension,
        stations: &Stations,
        quantities: &[Quantity],
        is_wanted: impl Fn(usize) -> bool,
    ) -> Result<Option<Self>, DesignFault> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let all = quantities.iter().copied().enumerate();
        let quantities: Vec<_> = all
            .filter(|(k, quantity)| quantity.rate_order() > 0 && is_wanted(*k))
            .map(|(k, quantity)| (k, quantity, quantity.rockers(mechanism)))
            .collect();
        if quantities.is_empty() {
            return Ok(None);
        }
        let slots = Slots::of(quantities.iter().map(|(_, quantity, _)| quantity.reads()));
        let station = stations.design();
        let value = stations.values()[stations.value_of(station)];
        let rockers = quantities.iter().flat_map(|(_, _, rockers)| rockers);
        let series = DesignSeries::new(mechanism, design);
        Ok(Some(RateSlopes {
            station,
            order: StationOrder::through(&[value]),
            motion: MotionPoint {
                drive: stations.drive,
                value,
                rack: stations.racks[stations.rack_of(station)],
            },
            constants: Constants::of(suspension),
            slots,
            toggles: Toggles::of(mechanism, rockers.copied()),
            quantities,
            solver: Solver::new(mechanism, design)?,
            series: series.with_steering_axis(slots.contain_steering_axis()),
        }))
    }
}

impl FindsSlopes for RateSlopes<'_> {
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block) {
        let number = design.number;
        for (k, ..) in &self.quantities {
            block.put_slope(number, *k, f64::NAN);
        }
        let outputs = self.quantities.iter().map(|(k, ..)| *k);
        if block.has_value_of(number, outputs, self.station) {
            // A fault of the design needs no second report: the evaluation of the values has already reported it.
            let _: Result<(), DesignFault> = self.evaluate_design(number, design.wheels[0], block);
        }
    }
}

impl RateSlopes<'_> {
    fn evaluate_design(
        &mut self,
        number: usize,
        design: &[Vector3<f64>],
        block: &mut Block,
    ) -> Result<(), DesignFault> {
        let RateSlopes {
            quantities,
            order,
            motion,
            constants,
            slots,
            toggles,
            solver,
            series,
            ..
        } = self;
        solver.prepare(design)?;
        series.prepare(solver.mechanism(), design);
        toggles.begin(solver, motion.drive, motion.rack)?;
        solver.for_each_pose(motion.drive, order, motion.rack, |solver, _, pose| {
            let at = pose
                .and_then(|pose| solver.configuration_series(series, pose, &motion.along_drive()));
            if let Ok(at) = at {
                toggles.note(Some(solver), &at, motion.value);
                let view = WheelReading::reading(&at, *constants, *slots);
                for (k, quantity, rockers) in quantities.iter() {
                    if !rockers.iter().any(|id| toggles.holds(*id)) {
                        let slope = view.value(&at, *quantity).derivative(1);
                        block.put_slope(number, *k, slope);
                    }
                }
            }
            ControlFlow::Continue(())
        })
    }
}
