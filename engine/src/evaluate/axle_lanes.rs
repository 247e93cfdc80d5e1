//! Axles in SIMD lanes.

use super::axle::AxleStations;
use super::block::{Block, SIDE_BY_SIDE};
use super::evaluator::{Pairs, SolvesInLanes};
use super::lanes::{NotInLanes, gather};
use crate::axle::{Axle, AxleState, Carriers, Hold, LaneWheel, Placement, Quantity, Setup};
use crate::characteristics::{LaneInputs, LaneReader, LaneWheels, Slots};
use crate::model::Side;
use crate::number::{Each, SimdReal, SimdTask, Vector3, Width};
use crate::solve::{
    Acceptance, AxleTracker, GroundContact, LanePose, PairDrive, PairStations, StationOrder,
    VisitPair,
};
use crate::threads::Interrupt;

/// Solves as many axles at a time as the processor has lanes.
pub(super) struct AxleLanes<'a> {
    width: Width,
    batch: AxleTracker<'a>,
    readers: [LaneReader<'a>; 2],
    groups: Vec<Group>,
    rates: bool,
    hold: Hold,
    quantities: &'a [Quantity],
    setup: &'a Setup,
    stations: &'a AxleStations<'a>,
}

/// Stations that the batch visits together: those with the same heave and rack displacement.
struct Group {
    rack: f64,
    /// Indices of the stations, in the order of the batch.
    numbers: Vec<usize>,
}

/// Heave, rack displacement and moving coordinate (roll angle, or travel of both wheels) of a placement. `None` for a
/// placement that lanes cannot solve. For a rigid axle, the mean travel takes the place of the rack, and half the difference
/// of its travels that of the travel.
fn parts(placement: &Placement, is_rigid: bool) -> Option<[f64; 3]> {
    let [heave, rack, value] = match *placement {
        Placement::Roll { heave, roll, rack } => [heave, rack, roll],
        Placement::Travels {
            travels: [left, right],
            rack,
            on_plane: false,
        } if left == right => {
            if is_rigid {
                [left, 0.0, 0.0]
            } else {
                [0.0, rack, left]
            }
        }
        Placement::AtLoad { .. } | Placement::Travels { .. } => return None,
    };
    Some(if is_rigid {
        [0.0, heave, value]
    } else {
        [heave, rack, value]
    })
}

impl<'a> AxleLanes<'a> {
    /// Makes a solver of these stations, or returns the reason why lanes cannot solve them.
    pub(super) fn new(stations: &'a AxleStations<'a>, width: Width) -> Result<Self, NotInLanes> {
        let axle: &Axle = &stations.axle;
        let quantities = &stations.quantities[..];
        if !quantities.iter().all(|q| q.is_for_lanes()) {
            return Err(NotInLanes::Reading);
        }
        // The steering gear changes the design from station to station.
        if axle.left.mechanism.axle_steering().is_some() {
            return Err(NotInLanes::SteeringGear);
        }
        let mut grouped: Vec<([f64; 2], Vec<f64>, Vec<usize>)> = Vec::new();
        for (number, placement) in stations.placements.iter().enumerate() {
            let found = parts(placement, axle.is_rigid());
            let [heave, rack, value] = found.ok_or(NotInLanes::Travels)?;
            let known = grouped.iter_mut().find(|g| g.0 == [heave, rack]);
            match known {
                Some((_, values, numbers)) => {
                    values.push(value);
                    numbers.push(number);
                }
                None => grouped.push(([heave, rack], vec![value], vec![number])),
            }
        }
        let hold = stations.placements[0].hold();
        let suspensions = Side::ALL.each(|side| axle.suspension(side));
        let half_track = suspensions
            .iter()
            .map(|s| 0.5 * s.design[s.mechanism.wheel_centre.0].y)
            .sum();
        let drive = match (hold, axle.setup.wheel_radius) {
            (Hold::MeanTravel, Some(radius)) => PairDrive::Roll { half_track, radius },
            (Hold::MeanTravel, None) => return Err(NotInLanes::Mechanism),
            _ => PairDrive::Heave,
        };
        let visits: Vec<_> = grouped
            .iter()
            .map(|([heave, rack], values, _)| PairStations {
                heave: *heave,
                rack: *rack,
                order: StationOrder::through(values),
            })
            .collect();
        let mechanisms = suspensions.each(|s| &s.mechanism);
        let bases = suspensions.each(|s| &s.design[..]);
        let batch = AxleTracker::new(mechanisms, bases, drive, &visits);
        let batch = batch.ok_or(NotInLanes::Mechanism)?;
        if !batch.is_complete() {
            return Err(NotInLanes::Stations);
        }
        let rates = quantities.iter().any(|q| q.rate_order() > 0);
        // Each wheel of a rigid axle moves with both travels.
        let by_rack = axle.is_rigid() || quantities.iter().any(|q| q.info().by_rack);
        let reader = |side: Side| {
            let slots = quantities.iter().map(|q| q.lane_slots(side));
            let slots = slots.fold(Slots::default(), Slots::and);
            let mechanism = &axle.suspension(side).mechanism;
            let wheel = batch.wheel(side as usize);
            LaneReader::of_slots(mechanism, wheel, axle.setup.constants, slots, rates)
                .map(|reader| reader.with_derivatives_by_rack(by_rack))
                .ok_or(NotInLanes::Reading)
        };
        let groups = grouped.into_iter();
        Ok(AxleLanes {
            width,
            readers: [reader(Side::Left)?, reader(Side::Right)?],
            groups: groups
                .map(|([_, rack], _, numbers)| Group { rack, numbers })
                .collect(),
            batch,
            rates,
            hold,
            quantities,
            setup: &axle.setup,
            stations,
        })
    }
}

impl SolvesInLanes for AxleLanes<'_> {
    fn evaluate(
        &mut self,
        designs: Pairs<'_>,
        interrupt: Interrupt<'_>,
        block: &mut Block,
        fallback: &mut Vec<usize>,
    ) {
        self.width.run(AxleBlockTask {
            solver: self,
            designs,
            interrupt,
            block,
            fallback,
        });
    }
}

struct AxleBlockTask<'s, 'a> {
    solver: &'s AxleLanes<'a>,
    designs: Pairs<'s>,
    interrupt: Interrupt<'s>,
    block: &'s mut Block,
    fallback: &'s mut Vec<usize>,
}

impl SimdTask for AxleBlockTask<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let AxleBlockTask {
            solver,
            designs: [designs, rights],
            interrupt,
            block,
            fallback,
        } = self;
        let AxleLanes { batch, readers, .. } = solver;
        let points = solver.stations.axle.left.design.len();
        let rights = if rights.is_empty() { designs } else { rights };
        let mut history = batch.history(like);
        let mut group_left = vec![Vector3::new(like, like, like); points];
        let mut group_right = group_left.clone();
        let mut left_inputs = readers[0].inputs(like);
        let mut right_inputs = readers[1].inputs(like);
        let count = designs.len() / points;
        let mut first = 0;
        while first < count && !interrupt.is_raised() {
            let lanes = (count - first).min(B::LANES);
            gather(designs, points, first, lanes, &mut group_left);
            let rigid = solver.stations.axle.left.mechanism.rigid_axle.as_ref();
            match rigid.filter(|_| !solver.stations.of_builds) {
                None => gather(rights, points, first, lanes, &mut group_right),
                Some(rigid) => {
                    rigid.complete(&solver.stations.axle.left.design, &mut group_left);
                    rigid.turn_over(&group_left, &mut group_right);
                }
            }
            let left_design = batch.wheel(0).design(&group_left);
            let right_design = batch.wheel(1).design(&group_right);
            let left_wheels = readers[0].wheels(&left_design, &group_left);
            let right_wheels = readers[1].wheels(&right_design, &group_right);
            readers[0].read_designs(&group_left, &mut left_inputs);
            readers[1].read_designs(&group_right, &mut right_inputs);
            let (values, _) = block.from(first);
            let mut reading = Reading {
                solver,
                left_inputs: &mut left_inputs,
                right_inputs: &mut right_inputs,
                wheels: [&left_wheels, &right_wheels],
                numbers: &[],
                rack: like,
                accepted: like.everywhere(),
                values,
            };
            let mut number = 0;
            while number < solver.groups.len() {
                let group = &solver.groups[number];
                reading.numbers = &group.numbers;
                reading.rack = like.constant(group.rack);
                reading.left_inputs.begin();
                reading.right_inputs.begin();
                let solved = batch.solve(
                    [&left_design, &right_design],
                    [&group_left, &group_right],
                    number,
                    &mut history,
                    &mut reading,
                );
                reading.accepted = reading.accepted & solved.everywhere();
                number += 1;
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

/// Reads the quantities from the poses of a group.
struct Reading<'r, 'a, B: SimdReal> {
    solver: &'r AxleLanes<'a>,
    wheels: [&'r LaneWheels<B>; 2],
    left_inputs: &'r mut LaneInputs<B>,
    right_inputs: &'r mut LaneInputs<B>,
    /// Index in the block of each station of this group.
    numbers: &'r [usize],
    rack: B,
    /// Lanes accepted so far.
    accepted: B::Mask,
    /// Destination of the values, in the layout of [`Block::from`].
    values: &'r mut [f64],
}

impl<B: SimdReal> VisitPair<B> for Reading<'_, '_, B> {
    #[inline(always)]
    fn pair<P: LanePose<B>>(
        &mut self,
        station: usize,
        [left, right]: [&P; 2],
        stand: GroundContact<B>,
        _: Acceptance<B>,
    ) {
        let AxleLanes {
            readers,
            batch,
            rates,
            hold,
            quantities,
            setup,
            stations,
            ..
        } = self.solver;
        let [left_wheels, right_wheels] = self.wheels;
        let (rack, inputs) = (self.rack, &mut *self.left_inputs);
        let left_known = readers[0].read(left_wheels, left, rack, *rates, inputs);
        let inputs = &mut *self.right_inputs;
        let right_rack = rack.scaled(batch.right_rack());
        let right_known = readers[1].read(right_wheels, right, right_rack, *rates, inputs);
        self.accepted = self.accepted & left_known & right_known;
        let state = AxleState {
            readings: [
                LaneWheel::of(self.left_inputs),
                LaneWheel::of(self.right_inputs),
            ],
            ground: stand.ground,
            roll: stand.roll,
            hold: *hold,
            carriers: Carriers::of(&stations.axle),
            setup,
        };
        let count = stations.placements.len();
        let values = &mut self.values[self.numbers[station] * SIDE_BY_SIDE..];
        for (k, quantity) in quantities.iter().enumerate() {
            let value = quantity.value_in_lanes(&state);
            value.store(&mut values[k * count * SIDE_BY_SIDE..]);
        }
    }
}
