//! Designs of an axle, one at a time: both wheels of each are moved, and solved at every position of the motion.
//!
//! A variable moves the same point of both wheels, one as the mirror image of the other, also where the right
//! wheel has hardpoints of its own.

use super::Stations;
use super::evaluate::{Block, FailedStation};
use crate::axle::{Axle, AxleFailure, AxlePlan, AxleSolver, Placement, Quantity, WheelMotion};
use crate::curves::Column;
use crate::mechanism::{DesignFault, Failure, LimitCause};
use crate::model::{Drive, Side};
use crate::number::Vector3;

/// Where and what of an axle a sweep evaluates.
#[derive(Clone, Debug)]
pub(super) struct AxleStations<'s> {
    pub axle: &'s Axle,
    pub quantities: Vec<Quantity>,
    /// Those of the motion, then the design position.
    placements: Vec<Placement>,
    /// The printed value of `over` at each.
    values: Vec<f64>,
}

impl<'s> AxleStations<'s> {
    pub(super) fn of(axle: &'s Axle, plan: &AxlePlan) -> Self {
        let over = plan.course.moving()[0];
        let mut placements = plan.course.placements();
        // On the ground that the motion is on.
        placements.push(match plan.course.wheels {
            WheelMotion::Travels { on_plane: true, .. } => Placement::Travels {
                travels: [0.0; 2],
                rack: 0.0,
                on_plane: true,
            },
            _ => plan.course.design(),
        });
        let value = |placement: &Placement| over.written(placement.along(over), axle);
        AxleStations {
            axle,
            quantities: plan.quantities.clone(),
            values: placements.iter().map(value).collect(),
            placements,
        }
    }

    /// As the stations of a sweep.
    pub(super) fn stations(&self) -> Stations {
        let design = self.placements.len() - 1;
        Stations::listed(&self.values, design)
    }

    /// The columns of values.
    pub(super) fn columns(&self) -> Vec<Column> {
        let length = self.axle.left.length_unit;
        let column = |q: &Quantity| {
            let unit = q.unit();
            let factor = unit.printed_factor(length);
            Column::of_value(q.name(), unit.suffix(length), q.positive(), factor)
        };
        self.quantities.iter().map(column).collect()
    }

    /// An evaluator of designs.
    pub(super) fn evaluator(&self) -> Result<Box<dyn AxleEvaluator + '_>, DesignFault> {
        fn of<'a, const N: usize>(
            stations: &'a AxleStations<'a>,
        ) -> Result<Box<dyn AxleEvaluator + 'a>, DesignFault> {
            let solver = AxleSolver::<N>::new(stations.axle, &stations.quantities, false);
            Ok(Box::new(OneByOne {
                stations,
                solver: solver.map_err(|(_, fault)| fault)?,
                right: Vec::new(),
            }))
        }
        let orders = self.quantities.iter().map(|q| q.rate_order());
        match orders.max().unwrap_or(0) {
            0 => of::<1>(self),
            1 => of::<2>(self),
            _ => of::<3>(self),
        }
    }

    /// The right wheel's design where it has one of its own, moved as the left one is.
    pub(super) fn right_design(&self, left: &[Vector3<f64>], into: &mut Vec<Vector3<f64>>) -> bool {
        let Some(own) = &self.axle.right else {
            return false;
        };
        into.clear();
        let moved = left.iter().zip(&self.axle.left.design);
        let moved = own.design.iter().zip(moved);
        into.extend(moved.map(|(own, (now, before))| *own + (*now - *before)));
        true
    }
}

/// Evaluates designs of an axle.
pub(super) trait AxleEvaluator: Send {
    /// Evaluates designs given as the left wheel's points of one after the other.
    fn evaluate(&mut self, designs: &[Vector3<f64>], block: &mut Block);
}

struct OneByOne<'a, const N: usize> {
    stations: &'a AxleStations<'a>,
    solver: AxleSolver<'a, N>,
    right: Vec<Vector3<f64>>,
}

impl<const N: usize> AxleEvaluator for OneByOne<'_, N> {
    fn evaluate(&mut self, designs: &[Vector3<f64>], block: &mut Block) {
        let points = self.stations.axle.left.design.len();
        block.clear(designs.len() / points);
        for (number, left) in designs.chunks_exact(points).enumerate() {
            block.forget(number);
            if let Err((_, fault)) = self.evaluate_design(number, left, block) {
                block.faults.push((number, fault));
            }
        }
    }
}

impl<const N: usize> OneByOne<'_, N> {
    fn evaluate_design(
        &mut self,
        number: usize,
        left: &[Vector3<f64>],
        block: &mut Block,
    ) -> Result<(), (Side, DesignFault)> {
        let OneByOne {
            stations,
            solver,
            right,
        } = self;
        let is_own = stations.right_design(left, right);
        solver.prepare([left, if is_own { right } else { left }])?;
        let placed = solver.place_all(&stations.placements);
        for (station, placed) in placed.into_iter().enumerate() {
            let read = placed.and_then(|placed| solver.read(&placed));
            let read = match read {
                Ok(read) => read,
                Err(failure) => {
                    block.failures.push(FailedStation {
                        design: number,
                        station,
                        failure: of_one_wheel(failure),
                    });
                    continue;
                }
            };
            for (k, quantity) in stations.quantities.iter().enumerate() {
                // What has no value by its definition leaves its cell empty.
                if !read.is_stuck(*quantity)
                    && let Ok(value) = quantity.value(&read.state)
                {
                    block.put(number, k, station, value);
                }
            }
        }
        Ok(())
    }
}

/// The failure of the wheel that failed.
fn of_one_wheel(failure: AxleFailure) -> Failure {
    match failure {
        AxleFailure::Wheel { failure, .. } => failure,
        AxleFailure::NoGround => Failure::Unreachable {
            drive: Drive::Travel,
            limit: 0.0,
            cause: LimitCause::Unresolved,
        },
    }
}
