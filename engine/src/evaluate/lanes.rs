//! Evaluation of designs in SIMD lanes.

use super::Stations;
use super::block::SIDE_BY_SIDE;
use super::evaluator::{LaneWork, SolvesInLanes};
use super::lane_gradients::Differentiating;
use crate::characteristics::{Constants, LaneInputs, LaneReader, LaneWheels, Quantity};
use crate::model::Suspension;
use crate::number::{MOST_LANES, SimdReal, SimdTask, Vector3, Width};
use crate::solve::{Acceptance, AdjointPose, CornerTracker, Visit};

/// Reason why no design of a sweep is solved in SIMD lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotInLanes {
    /// The caller requested to solve designs one by one.
    Asked,
    /// The tracker does not support the drive or the study's own design, or an axle in roll has no wheel radius.
    Mechanism,
    /// Two stations coincide, or a station is too far away.
    Stations,
    /// A requested quantity cannot be read in lanes.
    Reading,
    /// The study gives different travels of an axle's wheels, or travels on a plane ground. Or their mean travel follows
    /// from a load.
    Travels,
    /// Lanes do not support these elastic parts: an elastic mount of a strut, or an axle with elastic parts.
    Elastic,
}

impl NotInLanes {
    /// Reason in words, as the end of a sentence.
    pub fn describe(self) -> &'static str {
        match self {
            NotInLanes::Asked => "the run requested it",
            NotInLanes::Mechanism => {
                "the tracker does not support this drive or this design (a linkage driven by its arm's angle, a design \
                 close to a singularity or far from the origin)"
            }
            NotInLanes::Elastic => {
                "lanes do not support the elastic mount of a strut, or elastic parts of an axle"
            }
            NotInLanes::Stations => "two stations coincide, or one is far out of reach",
            NotInLanes::Reading => "lanes do not support a requested output",
            NotInLanes::Travels => {
                "the study gives travels of both wheels, or they follow from a load"
            }
        }
    }
}

/// Solver of as many designs at a time as the processor has lanes.
pub(super) struct LaneSolver<'a> {
    width: Width,
    batch: CornerTracker<'a>,
    reader: LaneReader<'a>,
    stations: &'a Stations,
    points: usize,
}

impl<'a> LaneSolver<'a> {
    /// Makes a solver of these quantities, or returns the reason why they cannot be read in SIMD lanes.
    pub(super) fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &[Quantity],
        width: Width,
    ) -> Result<Self, NotInLanes> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let (drive, racks) = (stations.drive, &stations.racks);
        let batch = CornerTracker::new(mechanism, design, drive, &stations.station_order, racks);
        let batch = batch.ok_or(NotInLanes::Mechanism)?;
        if !batch.is_complete() {
            return Err(NotInLanes::Stations);
        }
        let constants = Constants::of(suspension);
        let reader = LaneReader::new(mechanism, &batch, constants, quantities.to_vec());
        let reader = reader.ok_or(NotInLanes::Reading)?;
        Ok(LaneSolver {
            width,
            batch,
            reader,
            stations,
            points: design.len(),
        })
    }
}

impl SolvesInLanes for LaneSolver<'_> {
    fn evaluate(&mut self, work: LaneWork<'_>) {
        self.width.run(BlockTask { solver: self, work });
    }
}

struct BlockTask<'s, 'a> {
    solver: &'s mut LaneSolver<'a>,
    work: LaneWork<'s>,
}

impl SimdTask for BlockTask<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let BlockTask { solver, work } = self;
        let LaneWork {
            designs,
            interrupt,
            block,
            fallback,
        } = work;
        let [designs, _] = designs.wheels;
        let LaneSolver {
            batch,
            reader,
            stations,
            points,
            ..
        } = solver;
        let mut history = batch.history(like);
        let mut group = vec![Vector3::new(like, like, like); *points];
        let mut inputs = reader.inputs(like);
        let count = designs.len() / *points;
        let mut first = 0;
        while first < count && !interrupt.is_raised() {
            let lanes = (count - first).min(B::LANES);
            gather(designs, *points, first, lanes, &mut group);
            let design = batch.design(&group);
            let wheels = reader.wheels(&design, &group);
            reader.read_designs(&group, &mut inputs);
            let (values, slopes) = block.from(first);
            let mut reading = Reading {
                reader,
                wheels: &wheels,
                inputs: &mut inputs,
                rack: like,
                accepted: like.everywhere(),
                count: stations.count(),
                first: 0,
                design_station: stations.design(),
                values,
                slopes,
            };
            let mut rack = 0;
            while rack < stations.racks.len() {
                reading.first = stations.number(rack, 0);
                reading.inputs.begin();
                reading.rack = like.constant(stations.racks[rack]);
                let mut visitor = Visitor::Values(&mut reading);
                let solved = batch.solve(&design, rack, &mut history, &mut visitor);
                reading.accepted = reading.accepted & solved.everywhere();
                rack += 1;
            }
            let solved = reading.accepted;
            for lane in 0..lanes {
                if !B::lane(solved, lane) {
                    fallback.push(first + lane);
                }
            }
            first += lanes;
        }
    }
}

/// Puts designs side by side, one in each SIMD lane. Lanes beyond the last design repeat the last design.
#[inline(always)]
pub(super) fn gather<B: SimdReal>(
    designs: &[Vector3<f64>],
    points: usize,
    first: usize,
    lanes: usize,
    group: &mut [Vector3<B>],
) {
    let mut coordinates = [[0.0; MOST_LANES]; 3];
    for (point, gathered) in group.iter_mut().enumerate() {
        for lane in 0..B::LANES {
            let p = designs[(first + lane.min(lanes - 1)) * points + point];
            coordinates[0][lane] = p.x;
            coordinates[1][lane] = p.y;
            coordinates[2][lane] = p.z;
        }
        let like = gathered.x;
        *gathered = Vector3::new(
            like.load(&coordinates[0]),
            like.load(&coordinates[1]),
            like.load(&coordinates[2]),
        );
    }
}

/// Writes the points of the designs, which are in SIMD lanes, one design after another.
#[inline(always)]
pub(crate) fn scatter<B: SimdReal>(
    group: &[Vector3<B>],
    first: usize,
    lanes: usize,
    designs: &mut [Vector3<f64>],
) {
    let points = group.len();
    let mut coordinates = [[0.0; MOST_LANES]; 3];
    for (point, gathered) in group.iter().enumerate() {
        gathered.x.store(&mut coordinates[0]);
        gathered.y.store(&mut coordinates[1]);
        gathered.z.store(&mut coordinates[2]);
        for lane in 0..lanes {
            designs[(first + lane) * points + point] = Vector3::new(
                coordinates[0][lane],
                coordinates[1][lane],
                coordinates[2][lane],
            );
        }
    }
}

/// Visitor of the poses of a group: it reads values or computes gradients. Both uses share this type, so that the tracker is
/// compiled only once.
pub(super) enum Visitor<'v, 'r, 't, B: SimdReal> {
    /// Reads values of quantities.
    Values(&'v mut Reading<'r, B>),
    /// Computes gradients of quantities.
    Gradients(&'v mut Differentiating<'r, 't, B>),
}

impl<B: SimdReal> Visit<B> for Visitor<'_, '_, '_, B> {
    #[inline(always)]
    fn pose(&mut self, station: usize, at: &impl AdjointPose<B>, _: Acceptance<B>) {
        match self {
            Visitor::Values(reading) => reading.read(station, at),
            Visitor::Gradients(differentiating) => differentiating.differentiate(station, at),
        }
    }
}

/// Reads the quantities from the poses of a group.
pub(super) struct Reading<'r, B: SimdReal> {
    reader: &'r LaneReader<'r>,
    wheels: &'r LaneWheels<B>,
    inputs: &'r mut LaneInputs<B>,
    rack: B,
    /// SIMD lanes whose poses the pose tracker has accepted so far.
    accepted: B::Mask,
    /// Number of stations at all rack displacements.
    count: usize,
    /// Index of the first station at this rack displacement.
    first: usize,
    design_station: usize,
    /// Destination of the values, in the order of [`Block::from`](super::Block::from).
    values: &'r mut [f64],
    slopes: &'r mut [f64],
}

impl<B: SimdReal> Reading<'_, B> {
    #[inline(always)]
    fn read(&mut self, station: usize, at: &impl AdjointPose<B>) {
        let station = self.first + station;
        let in_design = station == self.design_station;
        let rates = in_design || self.reader.reads_rates();
        let accepted = self
            .reader
            .read(self.wheels, at, self.rack, rates, self.inputs);
        self.accepted = self.accepted & accepted;
        let values = &mut self.values[station * SIDE_BY_SIDE..];
        self.reader
            .values(self.inputs, values, self.count * SIDE_BY_SIDE);
        if in_design {
            self.reader.slopes(self.inputs, self.slopes, SIDE_BY_SIDE);
        }
    }
}
