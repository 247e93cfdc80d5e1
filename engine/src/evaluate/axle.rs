//! Designs of an axle. The evaluator solves both wheels at every required position of the axle.
//!
//! A variable moves a point of the left wheel and the same point of the right wheel. The two displacements are mirror images,
//! even if the hardpoints of the right wheel differ from the left ones.

use super::axle_lanes::AxleLanes;
use super::elastic_axle::ElasticAxleParts;
use super::evaluator::{Design, Evaluator, FindsSlopes, Pairs, SolvesOneByOne};
use super::stations::index_or_push;
use super::{Block, Stations};
use crate::axle::{
    Axle, AxleColumn, AxleMotion, AxlePlan, AxleSolver, ByGear, Placement, Quantity, Read,
};
use crate::curves::{ByTime, Column};
use crate::mechanism::DesignFault;
use crate::model::Side;
use crate::number::{Each, Width};
use std::borrow::Cow;

/// Poses and quantities of an axle that a sweep evaluates.
#[derive(Clone, Debug)]
pub(crate) struct AxleStations<'s> {
    pub axle: Cow<'s, Axle>,
    pub quantities: Vec<Quantity>,
    /// Derivatives in the design position that the study requests, quantity by quantity.
    pub gains: Vec<AxleColumn>,
    /// True if some of the requested derivatives (`gains`) are derivatives with respect to the rack.
    pub steers: bool,
    /// Required positions of the axle: first the positions of the motion, then the design position, then positions of targets
    /// that the motion does not contain.
    pub placements: Vec<Placement>,
    of_motion: usize,
    pub(super) design: usize,
    /// True if the designs are builds (vehicles with manufacturing deviations). Each half of a rigid axle (solid axle or
    /// twist beam) then has separate points.
    pub of_builds: bool,
    /// Values and rates to read, for an axle with elastic parts. `None` for an axle without elastic parts.
    pub elastic: Option<ElasticAxleParts>,
    /// Value of the first moving coordinate in the study's unit, for each required position of the axle.
    values: Vec<f64>,
}

impl<'s> AxleStations<'s> {
    /// Returns true for a station of the motion and for the design position, false for a station of a target outside of the
    /// motion.
    pub(crate) fn is_in_motion(&self, station: usize) -> bool {
        station < self.of_motion || station == self.design
    }

    /// Collects the stations of the plan's motion, the design position, and the positions `further`.
    pub(crate) fn of(
        axle: Cow<'s, Axle>,
        plan: &AxlePlan,
        further: impl IntoIterator<Item = Placement>,
    ) -> Self {
        let over = plan.motion.moving()[0];
        let mut placements = plan.motion.placements();
        let of_motion = placements.len();
        let design = index_or_push(&mut placements, plan.motion.at_design().placements()[0]);
        for placement in further {
            index_or_push(&mut placements, placement);
        }
        let value = |placement: &Placement| over.written(placement.along(over), &axle);
        // Gains (first derivatives of outputs) are with respect to the moving coordinate, even if the curves use derivatives with
        // respect to time.
        let by_motion = AxlePlan {
            motion: AxleMotion {
                time: None,
                ..plan.motion.clone()
            },
            ..plan.clone()
        };
        AxleStations {
            gains: by_motion
                .columns(&axle)
                .into_iter()
                .filter(|c| c.order == 1 && c.quantity().is_some())
                .collect(),
            steers: plan.derivatives > 0 && plan.motion.shows_rack,
            quantities: plan.quantities.clone(),
            values: placements.iter().map(value).collect(),
            axle,
            placements,
            of_motion,
            design,
            of_builds: false,
            elastic: None,
        }
    }

    /// Changes a solver to new designs of both wheels.
    pub(super) fn prepare<const N: usize>(
        &self,
        solver: &mut AxleSolver<'_, N>,
        wheels: Pairs<'_>,
    ) -> Result<(), (Side, DesignFault)> {
        if self.of_builds {
            solver.prepare_whole(wheels)
        } else {
            solver.prepare(wheels)
        }
    }

    /// Returns true if a design of a block has a value of at least one quantity in the design position. Without any value, the
    /// design position has no slopes either.
    pub(super) fn has_values_at_design(&self, number: usize, block: &Block) -> bool {
        block.has_value_of(number, 0..self.quantities.len(), self.design)
    }

    /// Indices of a quantity and of a required position of the axle. Both must be part of the evaluation.
    pub(crate) fn place(&self, quantity: Quantity, placement: Placement) -> [usize; 2] {
        let quantity = self.quantities.iter().position(|q| *q == quantity);
        let station = self.placements.iter().position(|p| *p == placement);
        [quantity, station].each(|place| place.expect("the plan contains the requested value"))
    }

    /// Required positions of the axle, as stations of a sweep.
    pub(crate) fn stations(&self) -> Stations {
        Stations::listed(&self.values, self.of_motion, self.design)
    }

    /// Columns of the quantities, one for each quantity.
    pub(crate) fn columns(&self) -> Vec<Column> {
        let length = self.axle.left.length_unit;
        let column = |q: &Quantity| {
            let unit = q.info().unit;
            let factor = unit.printed_factor(length);
            Column::of_value(q.name(), unit.suffix(length), q.info().positive, factor)
        };
        self.quantities.iter().map(column).collect()
    }

    /// Evaluator of designs in lanes of this width, or one by one if `width` is `None`. An error says why the axle's own
    /// design cannot be solved.
    pub(crate) fn evaluator(&self, width: Option<Width>) -> Result<Evaluator<'_>, DesignFault> {
        if let Some(elastic) = &self.axle.elastic {
            return self.elastic_evaluator(elastic);
        }
        let orders = self.quantities.iter().map(|q| q.rate_order());
        let one_by_one: Box<dyn SolvesOneByOne> = match orders.max() {
            None | Some(0) => OneByOne::<1>::new(self, false)?,
            Some(1) => OneByOne::<2>::new(self, false)?,
            Some(_) => OneByOne::<3>::new(self, false)?,
        };
        let mut evaluator = Evaluator::of(self.axle.left.design.len(), one_by_one);
        evaluator.axle = Some(&self.axle);
        // Gains need one more order of derivatives than values. The code for SIMD lanes does not compute this order.
        let quantities = self.gains.iter().filter_map(|gain| gain.quantity());
        if let Some(order) = quantities.map(|q| q.rate_order()).max() {
            evaluator.slopes = Some(match order {
                0 => OneByOne::<2>::new(self, self.steers)?,
                1 => OneByOne::<3>::new(self, self.steers)?,
                _ => OneByOne::<4>::new(self, self.steers)?,
            });
        }
        if let Some(width) = width {
            evaluator.lanes = AxleLanes::new(self, width).map(|lanes| Box::new(lanes) as _);
        }
        Ok(evaluator)
    }
}

/// Solves axles one after another. Each Taylor series has `N` coefficients.
struct OneByOne<'a, const N: usize> {
    stations: &'a AxleStations<'a>,
    solver: AxleSolver<'a, N>,
}

impl<const N: usize> SolvesOneByOne for OneByOne<'_, N> {
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block) -> Result<(), DesignFault> {
        let OneByOne { stations, solver } = self;
        let number = design.number;
        let prepared = stations.prepare(solver, design.wheels);
        prepared.map_err(|(_, fault)| fault)?;
        let placed = solver.place_all(&stations.placements);
        for (station, placed) in placed.into_iter().enumerate() {
            let read = placed.and_then(|placed| Ok((placed, solver.read(&placed)?)));
            let (placed, read) = match read {
                Ok(found) => found,
                Err(failure) => {
                    block.fail(number, station, failure);
                    continue;
                }
            };
            for (k, quantity) in stations.quantities.iter().enumerate() {
                // The value stays NaN if the quantity is not defined in this pose.
                if let Ok(value) = read.value(*quantity) {
                    block.put(number, k, station, value);
                }
            }
            if let Some(failure) = read.toggle_failure(&placed) {
                block.fail(number, station, failure);
            }
        }
        Ok(())
    }
}

/// Computes derivatives in the design position with respect to each moving coordinate.
impl<const N: usize> FindsSlopes for OneByOne<'_, N> {
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block) {
        let stations = self.stations;
        let read = if stations.has_values_at_design(design.number, block) {
            self.read_design(design.wheels)
        } else {
            None
        };
        for (k, column) in stations.gains.iter().enumerate() {
            let gain = read.as_ref().and_then(|(read, by_drag_link)| {
                let time = ByTime::at(None, 0);
                let by = by_drag_link.get(k).copied().flatten();
                column.evaluate(read, time, by)?.ok()
            });
            block.put_slope(design.number, k, gain.unwrap_or(f64::NAN));
        }
    }
}

impl<'a, const N: usize> OneByOne<'a, N> {
    fn new(stations: &'a AxleStations<'a>, by_rack: bool) -> Result<Box<Self>, DesignFault> {
        let solver = AxleSolver::new(&stations.axle, &stations.quantities, by_rack);
        Ok(Box::new(OneByOne {
            stations,
            solver: solver.map_err(|(_, fault)| fault)?,
        }))
    }

    /// Reads the design position. Includes the derivatives with respect to the steering gear if gains need them.
    fn read_design(&mut self, wheels: Pairs<'_>) -> Option<(Read<'a>, Vec<Option<ByGear>>)> {
        self.stations.prepare(&mut self.solver, wheels).ok()?;
        let design = self.stations.placements[self.stations.design];
        let placed = self.solver.place(&design).ok()?;
        let by_drag_link = self
            .solver
            .by_drag_link(&placed, &self.stations.gains)
            .ok()?;
        Some((self.solver.read(&placed).ok()?, by_drag_link))
    }
}
