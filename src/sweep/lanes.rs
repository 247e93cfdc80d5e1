//! Designs in SIMD lanes.

use super::Stations;
use super::evaluate::{Block, finite};
use crate::characteristics::{Characteristic, Constants, Inputs, LaneReader, LaneWheels, Quantity};
use crate::kinematics::{Batch, LanePose, Visit};
use crate::model::Suspension;
use crate::number::{Bundle, InLanes, MOST_LANES, Vector3, Width};

/// Solves as many designs at a time as the processor has lanes.
pub(super) struct LaneSolver<'a> {
    width: Width,
    batch: Batch<'a>,
    reader: LaneReader<'a>,
    stations: &'a Stations,
    points: usize,
    /// Values of a group of designs: `[output][station][lane]`
    values: Vec<f64>,
    /// `[output][lane]`
    slopes: Vec<f64>,
}

impl<'a> LaneSolver<'a> {
    /// A solver of these quantities; `None` where they, or the mechanism, cannot be had in lanes.
    pub(super) fn new(
        suspension: &'a Suspension,
        stations: &'a Stations,
        quantities: &[Quantity],
        width: Width,
    ) -> Option<Self> {
        let (mechanism, design) = (&suspension.mechanism, &suspension.design);
        let characteristics: Vec<Characteristic> = quantities
            .iter()
            .map(|quantity| match quantity {
                Quantity::Characteristic(c) => Some(*c),
                _ => None,
            })
            .collect::<Option<_>>()?;
        let (drive, racks) = (stations.drive, &stations.racks);
        let batch = Batch::new(mechanism, design, drive, &stations.march, racks)?;
        let constants = Constants::of(suspension);
        let outputs = characteristics.len();
        let reader = LaneReader::new(mechanism, &batch, constants, characteristics)?;
        Some(LaneSolver {
            width,
            batch,
            reader,
            stations,
            points: design.len(),
            values: vec![0.0; outputs * stations.count() * MOST_LANES],
            slopes: vec![0.0; outputs * MOST_LANES],
        })
    }

    /// Evaluates the designs of a block; the numbers of those left to the careful path are added to
    /// `left`.
    pub(super) fn evaluate(
        &mut self,
        designs: &[Vector3<f64>],
        block: &mut Block,
        left: &mut Vec<usize>,
    ) {
        self.width.run(Evaluation {
            solver: self,
            designs,
            block,
            left,
        });
    }
}

struct Evaluation<'s, 'a> {
    solver: &'s mut LaneSolver<'a>,
    designs: &'s [Vector3<f64>],
    block: &'s mut Block,
    left: &'s mut Vec<usize>,
}

impl InLanes for Evaluation<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: Bundle>(self, like: B) {
        let Evaluation {
            solver,
            designs,
            block,
            left,
        } = self;
        let LaneSolver {
            batch,
            reader,
            stations,
            points,
            values,
            slopes,
            ..
        } = solver;
        let mut history = batch.history(like);
        let mut group = vec![Vector3::new(like, like, like); *points];
        let count = designs.len() / *points;
        let mut first = 0;
        while first < count {
            let lanes = (count - first).min(B::LANES);
            gather(designs, *points, first, lanes, &mut group);
            let design = batch.design(&group);
            let wheels = reader.wheels(&design, &group);
            let mut reading = Reading {
                reader,
                wheels: &wheels,
                inputs: reader.inputs(&wheels),
                count: stations.count(),
                first: 0,
                design_station: stations.design(),
                values,
                slopes,
            };
            let mut solved = design.is_regular();
            let mut rack = 0;
            while rack < stations.racks.len() {
                reading.first = stations.number(rack, 0);
                solved = solved & batch.solve(&design, rack, &mut history, &mut reading);
                rack += 1;
            }
            for lane in 0..lanes {
                if B::lane(solved, lane) {
                    scatter(values, B::LANES, lane, block.values_of(first + lane));
                    scatter(slopes, B::LANES, lane, block.slopes_of(first + lane));
                } else {
                    left.push(first + lane);
                }
            }
            first += lanes;
        }
    }
}

/// Puts designs side by side. Lanes for which there are none repeat the last.
#[inline(always)]
pub(super) fn gather<B: Bundle>(
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

/// Every `lanes`-th number from one on, those that are not finite as NaN.
#[inline(always)]
fn scatter(values: &[f64], lanes: usize, lane: usize, to: &mut [f64]) {
    for (to, numbers) in to.iter_mut().zip(values.chunks_exact(lanes)) {
        *to = finite(numbers[lane]);
    }
}

/// Reads the characteristics off the poses of a group.
struct Reading<'r, B: Bundle> {
    reader: &'r LaneReader<'r>,
    wheels: &'r LaneWheels<B>,
    inputs: Inputs<B>,
    /// Stations in all, and the first one with the rack where it is.
    count: usize,
    first: usize,
    design_station: usize,
    values: &'r mut [f64],
    slopes: &'r mut [f64],
}

impl<B: Bundle> Visit<B> for Reading<'_, B> {
    #[inline(always)]
    fn pose(&mut self, station: usize, at: &impl LanePose<B>) {
        let station = self.first + station;
        let in_design = station == self.design_station;
        let rates = in_design || self.reader.reads_rates();
        self.reader.read(self.wheels, at, rates, &mut self.inputs);
        let values = &mut self.values[station * B::LANES..];
        self.reader
            .values(&self.inputs, values, self.count * B::LANES);
        if in_design {
            for lane in 0..B::LANES {
                let series = LaneReader::series(&self.inputs, lane);
                for (k, c) in self.reader.characteristics().iter().enumerate() {
                    self.slopes[k * B::LANES + lane] = c.slope(&series);
                }
            }
        }
    }
}
