//! Evaluation of a block of designs: hardpoints in, values out.
//!
//! This module separates a sweep from the solver. A sweep handles samples, CPU threads and files. The solver handles poses.
//! The values of a design depend only on this design, never on its neighbours in the block.

use super::lanes::{LaneSolver, NotInLanes};
use super::one_by_one::OneByOne;
use super::{Block, Stations};
use crate::axle::Axle;
use crate::characteristics::Quantity;
use crate::mechanism::DesignFault;
use crate::model::Suspension;
use crate::number::{Vector3, Width};
use crate::solve::Solver;
use crate::threads::Interrupt;

/// Hardpoints of left and right wheels, design after design. The second slice is empty for a single wheel, and for an axle
/// whose right wheel is the mirror image of the left wheel.
pub type Pairs<'d> = [&'d [Vector3<f64>]; 2];

/// Designs of a block.
#[derive(Clone, Copy)]
pub(super) struct Designs<'d> {
    pub wheels: Pairs<'d>,
    /// Number of points of a wheel.
    points: usize,
    /// Rates of elastic parts that vary, one design after another.
    rates: &'d [f64],
}

/// One design of a block.
#[derive(Clone, Copy)]
pub(super) struct Design<'d> {
    /// Index of the design in the block.
    pub number: usize,
    /// Points of both wheels. They are the same for a single wheel, and for an axle whose right wheel is the mirror image.
    pub wheels: Pairs<'d>,
    /// Rates of elastic parts that vary.
    pub rates: &'d [f64],
}

impl<'d> Designs<'d> {
    pub(super) fn new(wheels: Pairs<'d>, points: usize, rates: &'d [f64]) -> Self {
        Designs {
            wheels,
            points,
            rates,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.wheels[0].len() / self.points
    }

    /// The design with this index.
    pub(super) fn get(&self, number: usize) -> Design<'d> {
        let [left, right] = self.wheels;
        let right = if right.is_empty() { left } else { right };
        let own = number * self.points..(number + 1) * self.points;
        let width = self.rates.len() / self.count();
        Design {
            number,
            wheels: [&left[own.clone()], &right[own]],
            rates: &self.rates[number * width..][..width],
        }
    }
}

/// Designs to be solved in SIMD lanes, and the block for their values.
pub(super) struct LaneWork<'w> {
    pub designs: Designs<'w>,
    /// Flag that stops the work early.
    pub interrupt: Interrupt<'w>,
    pub block: &'w mut Block,
    /// Indices of the designs that must be solved one by one.
    pub fallback: &'w mut Vec<usize>,
}

/// Solver of designs in SIMD lanes.
pub(super) trait SolvesInLanes: Send {
    /// Evaluates the designs of a block.
    fn evaluate(&mut self, work: LaneWork<'_>);
}

/// Solver of designs one at a time.
pub(super) trait SolvesOneByOne: Send {
    /// Evaluates a design whose values in the block are NaN.
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block) -> Result<(), DesignFault>;
}

/// Computes slopes, which need one order of derivatives more than the values.
pub(super) trait FindsSlopes: Send {
    /// Writes the slopes of a design to a block with evaluated values. A slope without a value is NaN.
    fn evaluate(&mut self, design: Design<'_>, block: &mut Block);
}

/// Evaluator of blocks of designs of a wheel or an axle. Each thread has a separate evaluator.
///
/// Designs are solved in SIMD lanes if lanes support the vehicle, the stations and every requested quantity ([`NotInLanes`]).
/// Designs that are rejected in lanes are solved one by one. Without lanes, all designs are solved one by one. The choice of
/// method depends only on the design.
pub struct Evaluator<'a> {
    /// Number of points of a wheel.
    points: usize,
    pub(super) lanes: Result<Box<dyn SolvesInLanes + 'a>, NotInLanes>,
    one_by_one: Box<dyn SolvesOneByOne + 'a>,
    pub(super) slopes: Option<Box<dyn FindsSlopes + 'a>>,
    /// Axle of the designs. If the hardpoints of the two wheels differ, the evaluator makes the right wheels in `rights`.
    pub(super) axle: Option<&'a Axle>,
    rights: Vec<Vector3<f64>>,
    /// Rates of elastic parts in the next block's designs. Empty if no rate varies.
    rates: Vec<f64>,
    /// Indices of the designs of the block that must be solved one by one.
    fallback: Vec<usize>,
    /// Flag that stops a block early. The values of the block must then not be used.
    pub(crate) interrupt: Interrupt<'a>,
}

impl<'a> Evaluator<'a> {
    /// Makes an evaluator of these quantities. An error says why the suspension's own design cannot be solved.
    pub fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
    ) -> Result<Self, DesignFault> {
        Evaluator::with_width(suspension, stations, quantities, Width::widest())
    }

    /// Makes an evaluator like [`Evaluator::new`], with lanes of this width, or without lanes.
    pub fn with_width(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
        width: Option<Width>,
    ) -> Result<Self, DesignFault> {
        let solver = Solver::new(&suspension.mechanism, &suspension.design)?;
        let mut evaluator = Evaluator::of_wheel(suspension, stations, quantities, solver);
        if let Some(width) = width {
            let lanes = LaneSolver::new(suspension, stations, quantities, width);
            evaluator.lanes = lanes.map(|lanes| Box::new(lanes) as _);
        }
        Ok(evaluator)
    }

    /// Makes an evaluator like [`Evaluator::new`] that finds every pose by continuation. This method computes the same values
    /// more slowly, for comparison.
    pub fn by_continuation(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
    ) -> Result<Self, DesignFault> {
        let solver = Solver::new(&suspension.mechanism, &suspension.design)?.by_continuation();
        Ok(Evaluator::of_wheel(
            suspension, stations, quantities, solver,
        ))
    }

    fn of_wheel(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
        solver: Solver<'a>,
    ) -> Self {
        let rate_order = quantities.iter().map(|q| q.rate_order()).max().unwrap_or(0);
        let one_by_one: Box<dyn SolvesOneByOne + 'a> = match rate_order {
            0 => Box::new(OneByOne::<1>::new(suspension, stations, quantities, solver)),
            _ => Box::new(OneByOne::<2>::new(suspension, stations, quantities, solver)),
        };
        Evaluator::of(suspension.design.len(), one_by_one)
    }

    /// Makes an evaluator that solves designs one by one, for wheels with this number of points.
    pub(super) fn of(points: usize, one_by_one: Box<dyn SolvesOneByOne + 'a>) -> Self {
        Evaluator {
            points,
            lanes: Err(NotInLanes::Asked),
            one_by_one,
            slopes: None,
            axle: None,
            rights: Vec::new(),
            rates: Vec::new(),
            fallback: Vec::new(),
            interrupt: Interrupt::default(),
        }
    }

    /// Reason why no design is solved in lanes. `None` if lanes are in use.
    pub fn not_in_lanes(&self) -> Option<NotInLanes> {
        self.lanes.as_ref().err().copied()
    }

    /// Indices of the designs of the last block that were solved one by one, in order.
    pub fn one_by_one(&self) -> &[usize] {
        &self.fallback
    }

    /// Evaluates designs, given as their points one design after the other, in the kernel's frame. For an axle these are the
    /// points of the left wheel. Returns the number of designs that were solved one by one.
    pub fn evaluate(&mut self, designs: &[Vector3<f64>], block: &mut Block) -> usize {
        let mut rights = std::mem::take(&mut self.rights);
        rights.clear();
        if let Some(axle) = self.axle {
            for left in designs.chunks_exact(self.points) {
                rights.extend(axle.right_design(left).into_iter().flatten());
            }
        }
        self.evaluate_pairs([designs, &rights], block);
        self.rights = rights;
        self.fallback.len()
    }

    /// Sets the rates of elastic parts that vary, for the next designs, design after design.
    pub(crate) fn set_rates(&mut self, rates: &[f64]) {
        self.rates.clear();
        self.rates.extend_from_slice(rates);
    }

    /// Evaluates designs, given as points of left and of right wheels, each in the frame of its side. If there are no points
    /// of right wheels, the right wheels are mirror images.
    pub(crate) fn evaluate_pairs(&mut self, wheels: Pairs<'_>, block: &mut Block) {
        let designs = Designs::new(wheels, self.points, &self.rates);
        block.clear(designs.count());
        self.fallback.clear();
        match &mut self.lanes {
            Ok(lanes) => lanes.evaluate(LaneWork {
                designs,
                interrupt: self.interrupt,
                block,
                fallback: &mut self.fallback,
            }),
            Err(_) => self.fallback.extend(0..designs.count()),
        }
        for &number in &self.fallback {
            if self.interrupt.is_raised() {
                return;
            }
            block.forget(number);
            if let Err(fault) = self.one_by_one.evaluate(designs.get(number), block) {
                block.refuse(number, fault);
            }
        }
        if let Some(slopes) = &mut self.slopes {
            for number in 0..designs.count() {
                if self.interrupt.is_raised() {
                    return;
                }
                slopes.evaluate(designs.get(number), block);
            }
        }
    }
}
