//! A block of designs in, their values out.
//!
//! This is the seam between a sweep and the solver: what is above it knows of samples, threads and
//! files, what is below it of poses. A design's values depend on that design alone, never on its
//! neighbours in the block, and nothing is allocated from block to block but for failures.

use super::Stations;
use super::aligned::Aligned;
use super::lanes::{LaneSolver, NotInLanes};
use super::one_by_one::OneByOne;
use crate::axle::Axle;
use crate::characteristics::Quantity;
use crate::mechanism::{DesignFault, NoPose};
use crate::model::Suspension;
use crate::number::{MOST_LANES, SimdReal, Vector3, Width};
use crate::solve::Solver;
use crate::threads::Interrupt;

/// Number of designs in a full block. Blocks are also the unit of sums, shards and resumption: the designs from
/// `k * BLOCK` on always belong together, for any number of threads.
pub const BLOCK: usize = 128;
/// Designs whose values are stored side by side, as the lanes return them.
pub(super) const SIDE_BY_SIDE: usize = MOST_LANES;
const _: () = assert!(BLOCK.is_multiple_of(SIDE_BY_SIDE));

/// A station of a design without a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FailedStation {
    /// Number of the design in the block.
    pub design: usize,
    /// Number of the station.
    pub station: usize,
    /// Reason for the missing pose.
    pub failure: NoPose,
}

/// Values of up to [`BLOCK`] designs, in the kernel's frame, in radians and length units; NaN if a value does not exist.
#[derive(Clone, Debug)]
pub struct Block {
    outputs: usize,
    stations: usize,
    /// Slopes of each design.
    gains: usize,
    designs: usize,
    /// `[design / SIDE_BY_SIDE][output][station][design % SIDE_BY_SIDE]`
    values: Aligned,
    /// `[design / SIDE_BY_SIDE][output][design % SIDE_BY_SIDE]`: derivatives by the drive in the design
    /// position; of an axle by each number that moves.
    slopes: Aligned,
    /// In rising order of the design's number.
    pub(super) failures: Vec<FailedStation>,
    /// Designs that cannot be solved at all, by rising number.
    pub(super) faults: Vec<(usize, DesignFault)>,
}

impl Block {
    /// Room for this number of outputs and stations, with a slope for each output.
    pub fn new(outputs: usize, stations: usize) -> Self {
        Block::with_gains(outputs, stations, outputs)
    }

    /// Room for values as in [`Block::new`], with `gains` slopes per design.
    pub(super) fn with_gains(outputs: usize, stations: usize, gains: usize) -> Self {
        // `from` points into the slopes, so at least one must exist even if none is requested.
        let gains = gains.max(1);
        Block {
            outputs,
            stations,
            gains,
            designs: 0,
            values: Aligned::new(f64::NAN, BLOCK * outputs * stations),
            slopes: Aligned::new(f64::NAN, BLOCK * gains),
            failures: Vec::new(),
            faults: Vec::new(),
        }
    }

    /// Makes ready for this number of designs. Values are still those of the block before.
    pub(super) fn clear(&mut self, designs: usize) {
        assert!(designs <= BLOCK);
        self.designs = designs;
        self.failures.clear();
        self.faults.clear();
    }

    /// Number of designs.
    pub fn designs(&self) -> usize {
        self.designs
    }

    /// The value of an output of a design at a station.
    #[inline]
    pub fn value(&self, design: usize, output: usize, station: usize) -> f64 {
        self.values[self.place(design, output, station)]
    }

    /// The values of an output of a design, by station.
    pub fn values(&self, design: usize, output: usize) -> impl Iterator<Item = f64> {
        (0..self.stations).map(move |station| self.value(design, output, station))
    }

    /// The values of an output of all designs at a station, in pieces, by rising number of the design.
    pub(crate) fn across(&self, output: usize, station: usize) -> impl Iterator<Item = &[f64]> {
        (0..self.designs).step_by(SIDE_BY_SIDE).map(move |first| {
            let count = (self.designs - first).min(SIDE_BY_SIDE);
            &self.values[self.place(first, output, station)..][..count]
        })
    }

    /// Derivative by the drive in the design position. NaN for a quantity made of velocities, unless the sweep requests it.
    #[inline]
    pub fn slope(&self, design: usize, output: usize) -> f64 {
        self.slopes[self.slope_place(design, output)]
    }

    /// Writes down a value, or NaN for one that is not finite (a swing arm of a wheel that does not turn).
    pub(super) fn put(&mut self, design: usize, output: usize, station: usize, value: f64) {
        let place = self.place(design, output, station);
        self.values[place] = value.finite();
    }

    /// Writes down a slope, or NaN for one that is not finite.
    pub(super) fn put_slope(&mut self, design: usize, output: usize, slope: f64) {
        let place = self.slope_place(design, output);
        self.slopes[place] = slope.finite();
    }

    /// Writes down why a station of a design has no pose, or not all values.
    pub(super) fn fail(&mut self, design: usize, station: usize, failure: NoPose) {
        self.failures.push(FailedStation {
            design,
            station,
            failure,
        });
    }

    /// Room for the values and the slopes of the designs from one on, as many as are solved together: those
    /// of the next station [`SIDE_BY_SIDE`] numbers on, those of the next output after all stations.
    #[inline(always)]
    pub(super) fn from(&mut self, design: usize) -> (&mut [f64], &mut [f64]) {
        let (value, slope) = (self.place(design, 0, 0), self.slope_place(design, 0));
        (&mut self.values[value..], &mut self.slopes[slope..])
    }

    /// Leaves a design without values.
    pub(super) fn forget(&mut self, design: usize) {
        for output in 0..self.outputs {
            for station in 0..self.stations {
                self.put(design, output, station, f64::NAN);
            }
        }
        for gain in 0..self.gains {
            self.put_slope(design, gain, f64::NAN);
        }
    }

    #[inline(always)]
    fn place(&self, design: usize, output: usize, station: usize) -> usize {
        let row = (design / SIDE_BY_SIDE * self.outputs + output) * self.stations + station;
        row * SIDE_BY_SIDE + design % SIDE_BY_SIDE
    }

    #[inline(always)]
    fn slope_place(&self, design: usize, gain: usize) -> usize {
        let row = design / SIDE_BY_SIDE * self.gains + gain;
        row * SIDE_BY_SIDE + design % SIDE_BY_SIDE
    }

    /// The stations without a pose, by rising number of the design.
    pub fn failures(&self) -> &[FailedStation] {
        &self.failures
    }

    /// The designs that cannot be solved at all, by rising number.
    pub fn faults(&self) -> &[(usize, DesignFault)] {
        &self.faults
    }
}

/// Hardpoints of left and right wheels, design after design. The second slice is empty for a single wheel and for an axle
/// whose right wheel mirrors the left.
pub(crate) type Pairs<'d> = [&'d [Vector3<f64>]; 2];

/// Solver of designs in SIMD lanes.
pub(super) trait SolvesInLanes: Send {
    /// Evaluates the designs of a block, up to the point at which the interrupt is raised. Adds the numbers of the designs
    /// that remain for one-by-one solution to `fallback`.
    fn evaluate(
        &mut self,
        designs: Pairs<'_>,
        interrupt: Interrupt<'_>,
        block: &mut Block,
        fallback: &mut Vec<usize>,
    );
}

/// Solver of designs one at a time.
pub(super) trait SolvesOneByOne: Send {
    /// Evaluates the designs of these numbers.
    fn evaluate(&mut self, designs: Pairs<'_>, numbers: &[usize], block: &mut Block);
}

/// Finds the slopes that take one derivative more than the values do.
pub(super) trait FindsSlopes: Send {
    /// Adds these slopes to a block with evaluated values. A slope that is not found stays NaN.
    fn evaluate(&mut self, designs: Pairs<'_>, block: &mut Block);
}

/// Evaluator of blocks of designs, of a wheel or of an axle. Each thread has its own.
///
/// Designs are solved in SIMD lanes if every requested quantity can be read there. Designs that the tracker rejects, and all
/// designs otherwise, are solved one by one. The design alone decides which.
pub struct Evaluator<'a> {
    /// Number of points of a wheel.
    points: usize,
    pub(super) lanes: Result<Box<dyn SolvesInLanes + 'a>, NotInLanes>,
    one_by_one: Box<dyn SolvesOneByOne + 'a>,
    pub(super) slopes: Option<Box<dyn FindsSlopes + 'a>>,
    /// The axle, if the designs are of one. It makes the right wheels in `rights` if their hardpoints differ.
    pub(super) axle: Option<&'a Axle>,
    rights: Vec<Vector3<f64>>,
    /// Designs of the block left to be solved one by one, by number.
    fallback: Vec<usize>,
    /// Ends a block early, whose values are not to be used then.
    pub(crate) interrupt: Interrupt<'a>,
}

impl<'a> Evaluator<'a> {
    /// An evaluator of these quantities. Errors if the suspension's own design cannot be solved.
    pub fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &'a [Quantity],
    ) -> Result<Self, DesignFault> {
        Evaluator::with_width(suspension, stations, quantities, Some(Width::widest()))
    }

    /// The same as [`Evaluator::new`], with lanes of this width, or one by one only.
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

    /// The same as [`Evaluator::new`], with every pose by the continuation: the same values, more slowly, for comparison.
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

    /// An evaluator that solves designs one by one, of wheels with this number of points.
    pub(super) fn of(points: usize, one_by_one: Box<dyn SolvesOneByOne + 'a>) -> Self {
        Evaluator {
            points,
            lanes: Err(NotInLanes::Asked),
            one_by_one,
            slopes: None,
            axle: None,
            rights: Vec::new(),
            fallback: Vec::new(),
            interrupt: Interrupt::default(),
        }
    }

    /// Reason why no design is solved in lanes; `None` if lanes are in use.
    pub fn not_in_lanes(&self) -> Option<NotInLanes> {
        self.lanes.as_ref().err().copied()
    }

    /// The designs of the last block that were left to be solved one by one, by rising number.
    pub fn one_by_one(&self) -> &[usize] {
        &self.fallback
    }

    /// Evaluates designs given as the points of one after the other, in the kernel's frame; of an axle those of the left
    /// wheel. Returns how many were left to be solved one by one.
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

    /// Evaluates designs given as the points of left and of right wheels, each in the frame of its side; without right
    /// ones they are the mirror images.
    pub(crate) fn evaluate_pairs(&mut self, designs: Pairs<'_>, block: &mut Block) {
        let count = designs[0].len() / self.points;
        block.clear(count);
        self.fallback.clear();
        match &mut self.lanes {
            Ok(lanes) => lanes.evaluate(designs, self.interrupt, block, &mut self.fallback),
            Err(_) => self.fallback.extend(0..count),
        }
        for number in &self.fallback {
            if self.interrupt.is_raised() {
                return;
            }
            let number = std::slice::from_ref(number);
            self.one_by_one.evaluate(designs, number, block);
        }
        if let Some(slopes) = &mut self.slopes {
            slopes.evaluate(designs, block);
        }
    }
}
