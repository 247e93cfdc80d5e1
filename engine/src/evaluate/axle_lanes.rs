//! Solution of axles in SIMD lanes.

use super::axle::AxleStations;
use super::block::SIDE_BY_SIDE;
use super::evaluator::{LaneWork, Pairs, SolvesInLanes};
use super::lanes::{NotInLanes, gather};
use crate::axle::{
    Axle, AxleState, Carriers, Hold, LaneWheel, Placement, Quantity, Setup, displace,
};
use crate::characteristics::{LaneInputs, LaneReader, LaneWheels, Slot, Slots};
use crate::mechanism::{Configuration, Pose, RodReach};
use crate::model::{Mechanism, RockerId, Side, Suspension};
use crate::number::{Each, Matrix3, SimdReal, SimdTask, Vector3, Width, outlined};
use crate::solve::{
    Acceptance, AxleTracker, GroundContact, LanePose, PairDrive, PairStations, StationOrder,
    VisitPair,
};

/// Longest step of a steering gear, as a share of the axle's size ([`Suspension::size`]).
const GEAR_STEP: f64 = 0.02;

/// Solves as many axles at a time as the processor has lanes.
pub(super) struct AxleLanes<'a> {
    width: Width,
    batch: AxleTracker<'a>,
    readers: [LaneReader<'a>; 2],
    gears: Vec<Gear>,
    rates: bool,
    hold: Hold,
    quantities: &'a [Quantity],
    setup: &'a Setup,
    stations: &'a AxleStations<'a>,
}

/// Displacement of the steering gear of a steered axle, with the groups of stations at this displacement. Other axles have a
/// single displacement, which is 0.
struct Gear {
    displacement: f64,
    /// Number of steps in which the gear reaches the displacement. During each step, the rods that turn the knuckles must
    /// keep their leverage about the kingpins.
    steps: usize,
    groups: Vec<Group>,
}

/// Stations that the tracker visits together, because they have the same heave, rack displacement and steering gear
/// displacement.
struct Group {
    rack: f64,
    /// Index of the group in the tracker.
    index: usize,
    /// Indices of the stations, in the order in which the tracker visits them.
    numbers: Vec<usize>,
}

/// Coordinates of a required position of the axle, as the pose tracker uses them.
struct Spot {
    /// Displacement of the steering gear of a steered axle, else 0.
    gear: f64,
    heave: f64,
    /// Displacement of the rack. For a rigid axle in roll, this field holds the mean travel.
    rack: f64,
    /// Moving coordinate: the roll angle, or the travel of both wheels.
    value: f64,
}

impl Spot {
    /// Returns the tracker's coordinates of a required position. `None` for a position that cannot be solved in SIMD
    /// lanes.
    fn of(placement: &Placement, carriers: Carriers) -> Option<Spot> {
        let gear = match carriers {
            Carriers::Steered(_) => placement.rack(),
            Carriers::Independent | Carriers::Rigid(_) => 0.0,
        };
        match *placement {
            Placement::Roll { heave, roll, rack } => {
                let [heave, rack] = if carriers.is_rigid() {
                    [0.0, heave]
                } else {
                    [heave, rack]
                };
                Some(Spot {
                    gear,
                    heave,
                    rack,
                    value: roll,
                })
            }
            Placement::Travels {
                travels: [left, right],
                rack,
                on_plane: false,
            } if left == right => Some(Spot {
                gear,
                heave: 0.0,
                rack: if carriers.is_rigid() { 0.0 } else { rack },
                value: left,
            }),
            Placement::AtLoad { .. } | Placement::Travels { .. } => None,
        }
    }
}

/// Positions with the same heave, rack displacement and steering gear displacement.
struct Together {
    gear: f64,
    heave: f64,
    rack: f64,
    values: Vec<f64>,
    numbers: Vec<usize>,
}

/// Groups the required positions of the axle for the tracker. `None` if one of them cannot be solved in SIMD lanes.
fn grouped(placements: &[Placement], carriers: Carriers) -> Option<Vec<Together>> {
    let mut groups: Vec<Together> = Vec::new();
    for (number, placement) in placements.iter().enumerate() {
        let Spot {
            gear,
            heave,
            rack,
            value,
        } = Spot::of(placement, carriers)?;
        let known = groups
            .iter_mut()
            .find(|g| [g.gear, g.heave, g.rack] == [gear, heave, rack]);
        if let Some(group) = known {
            group.values.push(value);
            group.numbers.push(number);
        } else {
            groups.push(Together {
                gear,
                heave,
                rack,
                values: vec![value],
                numbers: vec![number],
            });
        }
    }
    Some(groups)
}

/// Collects the groups with the same displacement of the steering gear. `size` is the length [`Suspension::size`] of the axle.
fn by_gear(grouped: Vec<Together>, size: f64) -> Vec<Gear> {
    let mut gears: Vec<Gear> = Vec::new();
    for (index, group) in grouped.into_iter().enumerate() {
        let found = gears.iter_mut().find(|g| g.displacement == group.gear);
        let own = Group {
            rack: group.rack,
            index,
            numbers: group.numbers,
        };
        if let Some(gear) = found {
            gear.groups.push(own);
        } else {
            let share = group.gear.abs() / (GEAR_STEP * size);
            gears.push(Gear {
                displacement: group.gear,
                steps: share.ceil() as usize,
                groups: vec![own],
            });
        }
    }
    gears
}

/// Largest vertical displacement (lift) of a wheel centre when the steering gear moves by `gear`, for the axle's own
/// design in the design position. The result is at most the displacement of the gear.
fn lift(suspension: &Suspension, gear: f64) -> f64 {
    let mut design = suspension.design.clone();
    let [difference, mean] = displace(&suspension.mechanism, &mut design, gear);
    let lift = difference.abs() + mean.abs();
    // Beyond a toggle (a rod in line with its lever), the lift is NaN.
    if lift < gear.abs() { lift } else { gear.abs() }
}

impl<'a> AxleLanes<'a> {
    /// Makes a solver of these stations, or returns the reason why they cannot be solved in SIMD lanes.
    pub(super) fn new(stations: &'a AxleStations<'a>, width: Width) -> Result<Self, NotInLanes> {
        let axle: &Axle = &stations.axle;
        let quantities = &stations.quantities[..];
        if !quantities.iter().all(|q| q.is_for_lanes()) {
            return Err(NotInLanes::Reading);
        }
        let carriers = Carriers::of(axle);
        let grouped = grouped(&stations.placements, carriers).ok_or(NotInLanes::Travels)?;
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
            .map(|group| PairStations {
                heave: group.heave,
                rack: group.rack,
                lift: lift(&axle.left, group.gear),
                order: StationOrder::through(&group.values),
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
        // The pose of each wheel of a rigid axle depends on two travels. The second travel takes the place of the rack
        // displacement.
        let by_rack = axle.is_rigid() || quantities.iter().any(|q| q.info().by_rack);
        let reader = |side: Side| {
            let slots = quantities.iter().map(|q| q.lane_slots(side));
            let mut slots = slots.fold(Slots::default(), Slots::and);
            if let Carriers::Steered(_) = carriers {
                // The kingpin is an axis fixed in the axle, so the reader also needs a point of its line.
                slots = slots.with(&[Slot::SteeringPoint]);
            }
            let mechanism = &axle.suspension(side).mechanism;
            let wheel = batch.wheel(side as usize);
            LaneReader::of_slots(mechanism, wheel, axle.setup.constants, slots, rates)
                .map(|reader| reader.with_derivatives_by_rack(by_rack))
                .map(|reader| reader.with_axle(axle.is_rigid()))
                .ok_or(NotInLanes::Reading)
        };
        Ok(AxleLanes {
            width,
            readers: [reader(Side::Left)?, reader(Side::Right)?],
            gears: by_gear(grouped, axle.left.size()),
            batch,
            rates,
            hold,
            quantities,
            setup: &axle.setup,
            stations,
        })
    }

    /// Gathers the points of both wheels of designs, from the design number `first`. The right wheel of a rigid axle (solid axle
    /// or twist beam) follows from the left wheel, except in builds.
    #[inline(always)]
    fn gather<B: SimdReal>(
        &self,
        [lefts, rights]: Pairs<'_>,
        first: usize,
        lanes: usize,
        [left, right]: [&mut [Vector3<B>]; 2],
    ) {
        let suspension = &self.stations.axle.left;
        let design = &suspension.design;
        gather(lefts, design.len(), first, lanes, left);
        let rigid = suspension.mechanism.rigid_axle.as_ref();
        match rigid.filter(|_| !self.stations.of_builds) {
            None => gather(rights, design.len(), first, lanes, right),
            Some(rigid) => {
                rigid.complete(design, left);
                rigid.turn_over(left, right);
            }
        }
    }
}

impl SolvesInLanes for AxleLanes<'_> {
    fn evaluate(&mut self, work: LaneWork<'_>) {
        self.width.run(AxleBlockTask { solver: self, work });
    }
}

struct AxleBlockTask<'s, 'a> {
    solver: &'s AxleLanes<'a>,
    work: LaneWork<'s>,
}

impl SimdTask for AxleBlockTask<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<B: SimdReal>(self, like: B) {
        let AxleBlockTask { solver, work } = self;
        let LaneWork {
            designs,
            interrupt,
            block,
            fallback,
        } = work;
        let [designs, rights] = designs.wheels;
        let AxleLanes { batch, readers, .. } = solver;
        let axle = &solver.stations.axle;
        let [left, right] = Side::ALL.each(|side| &axle.suspension(side).mechanism);
        let points = axle.left.design.len();
        let pairs = [designs, if rights.is_empty() { designs } else { rights }];
        let mut history = batch.history(like);
        let mut group_left = vec![Vector3::new(like, like, like); points];
        let mut group_right = group_left.clone();
        let mut moved_left = group_left.clone();
        let mut moved_right = group_left.clone();
        let mut left_inputs = readers[0].inputs(like);
        let mut right_inputs = readers[1].inputs(like);
        let count = designs.len() / points;
        let mut first = 0;
        while first < count && !interrupt.is_raised() {
            let lanes = (count - first).min(B::LANES);
            solver.gather(pairs, first, lanes, [&mut group_left, &mut group_right]);
            let (values, _) = block.from(first);
            let mut accepted = like.everywhere();
            for gear in &solver.gears {
                moved_left.copy_from_slice(&group_left);
                moved_right.copy_from_slice(&group_right);
                let mut rest = [like.zero(); 2];
                if gear.displacement != 0.0 {
                    let displacement = like.constant(gear.displacement);
                    accepted = accepted & keeps_leverage(left, gear, &mut moved_left);
                    rest = displace_in_lanes(left, displacement, &mut moved_left);
                    displace_in_lanes(right, displacement, &mut moved_right);
                }
                let left_design = batch.wheel(0).design(&moved_left);
                let right_design = batch.wheel(1).design(&moved_right);
                let left_wheels = readers[0].wheels(&left_design, &moved_left);
                let right_wheels = readers[1].wheels(&right_design, &moved_right);
                readers[0].read_designs(&moved_left, &mut left_inputs);
                readers[1].read_designs(&moved_right, &mut right_inputs);
                let mut reading = Reading {
                    solver,
                    left_inputs: &mut left_inputs,
                    right_inputs: &mut right_inputs,
                    wheels: [&left_wheels, &right_wheels],
                    numbers: &[],
                    rack: like,
                    accepted,
                    values,
                };
                for group in &gear.groups {
                    reading.numbers = &group.numbers;
                    reading.rack = like.constant(group.rack);
                    reading.left_inputs.begin();
                    reading.right_inputs.begin();
                    let solved = batch.solve(
                        [&left_design, &right_design],
                        [&moved_left, &moved_right],
                        rest,
                        group.index,
                        &mut history,
                        &mut reading,
                    );
                    reading.accepted = reading.accepted & solved.everywhere();
                }
                accepted = reading.accepted;
            }
            for lane in 0..lanes {
                if !B::lane(accepted, lane) {
                    fallback.push(first + lane);
                }
            }
            first += lanes;
        }
    }
}

/// Moves the steering gear of designs. Returns the resulting change of the mean travel, and of half the difference of the
/// travels.
#[inline(always)]
fn displace_in_lanes<B: SimdReal>(
    mechanism: &Mechanism,
    displacement: B,
    design: &mut [Vector3<B>],
) -> [B; 2] {
    outlined!(
        [B: SimdReal] displacement;
        mechanism: &'p Mechanism = mechanism, displacement: B = displacement, design: &'p mut [Vector3<B>] = design
            => [B; 2] {
            let [difference, mean] = displace(mechanism, design, displacement);
            [mean, difference]
        }
    )
}

/// Returns the lanes in which the rods of both knuckles keep their leverage about the kingpins while the steering gear
/// moves. The axle itself stays in the design position.
#[inline(always)]
fn keeps_leverage<B: SimdReal>(
    mechanism: &Mechanism,
    gear: &Gear,
    design: &mut [Vector3<B>],
) -> B::Mask {
    let like = design[0].x;
    let mut keeps = like.everywhere();
    let Some(steering) = mechanism.axle_steering() else {
        return keeps;
    };
    let knuckles = [steering.near_knuckle, steering.far_knuckle];
    let mut before = rods_at_rest(mechanism, knuckles, design);
    for step in 1..=gear.steps {
        let part = step as f64 / gear.steps as f64;
        displace_in_lanes(mechanism, like.constant(part * gear.displacement), design);
        let now = rods_at_rest(mechanism, knuckles, design);
        keeps = keeps & before[0].keeps_leverage_to(&now[0]) & before[1].keeps_leverage_to(&now[1]);
        before = now;
    }
    keeps
}

/// Rods of two knuckles in the design position of the axle, in the coordinates of the knuckles.
#[inline(always)]
fn rods_at_rest<B: SimdReal>(
    mechanism: &Mechanism,
    knuckles: [RockerId; 2],
    design: &[Vector3<B>],
) -> [RodReach<B>; 2] {
    outlined!(
        [B: SimdReal] design[0].x;
        mechanism: &'p Mechanism = mechanism, knuckles: [RockerId; 2] = knuckles, design: &'p [Vector3<B>] = design
            => [RodReach<B>; 2] {
            let zero = design[0].x.zero();
            let pose = Pose {
                origin: design[mechanism.origin.0],
                rotation: Matrix3::identity(zero),
            };
            let at = Configuration::new(mechanism, design, pose, zero);
            [at.rod_at_rest(knuckles[0]), at.rod_at_rest(knuckles[1])]
        }
    )
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
    /// SIMD lanes whose poses the pose tracker has accepted so far.
    accepted: B::Mask,
    /// Destination of the values, in the order of [`Block::from`](super::Block::from).
    values: &'r mut [f64],
}

impl<B: SimdReal> VisitPair<B> for Reading<'_, '_, B> {
    #[inline(always)]
    fn pair<P: LanePose<B>, Q: LanePose<B>>(
        &mut self,
        station: usize,
        left: &P,
        right: &Q,
        stand: GroundContact<B>,
        _: Acceptance<B>,
    ) {
        let AxleLanes {
            readers,
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
        let right_known = readers[1].read(right_wheels, right, -rack, *rates, inputs);
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
