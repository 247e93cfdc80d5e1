//! What is read of one wheel, with its dependence on the wheel's own travel and the rack.
//!
//! Everything is in the kernel's frame of a left wheel; of a right wheel that is its mirror image.

use super::taylor::{Line, Taylor};
use crate::characteristics::{Constants, Inputs, Slot, Slots, Wheel};
use crate::derive::{Linearised, MotionPoint, Seeds};
use crate::mechanism::Configuration;
use crate::model::{Drive, PointId};
use crate::number::{Jet, Matrix3, Real, Tape, Tracked, Vector3};
use std::ops::Range;

/// Numbers that are read of a wheel.
const PARTS: usize = 37;

const CENTRE: usize = 0;
/// The columns of the carrier's rotation, one after the other.
const ROTATION: usize = 3;
const SPIN_AXIS: usize = 12;
const STEERING_POINT: usize = 15;
const STEERING_DIRECTION: usize = 18;
const SPRING: usize = 21;
const STRUT_UPPER: usize = 24;
const SPRING_LENGTH: usize = 27;
const ROCKER_ANGLE: usize = 28;
const BAR_ANGLE: usize = 29;
/// From here on parts do not change in the motion.
const DESIGN: usize = 30;
const DESIGN_SPIN_AXIS: usize = 30;
const DESIGN_CENTRE: usize = 33;
const DESIGN_SPRING_LENGTH: usize = 36;

/// The parts that a slot of the corner's catalogue is made of. All others come with every reading.
fn parts_of(slot: Slot) -> Range<usize> {
    match slot {
        Slot::SpinAxis | Slot::SpinAxisRate => SPIN_AXIS..SPIN_AXIS + 3,
        Slot::Centre | Slot::CentreRate => CENTRE..CENTRE + 3,
        Slot::SteeringPoint => STEERING_POINT..STEERING_POINT + 3,
        Slot::SteeringDirection | Slot::SteeringDirectionRate => {
            STEERING_DIRECTION..STEERING_DIRECTION + 3
        }
        Slot::SpringLength | Slot::SpringLengthRate => SPRING_LENGTH..SPRING_LENGTH + 1,
        Slot::Spring => SPRING..SPRING + 3,
        Slot::RockerAngle => ROCKER_ANGLE..ROCKER_ANGLE + 1,
        Slot::BarAngle | Slot::BarAngleRate => BAR_ANGLE..BAR_ANGLE + 1,
        Slot::StrutUpper => STRUT_UPPER..STRUT_UPPER + 3,
        Slot::Turn => ROTATION..ROTATION + 9,
        Slot::DesignSpinAxis => DESIGN_SPIN_AXIS..DESIGN_SPIN_AXIS + 3,
        Slot::DesignCentre => DESIGN_CENTRE..DESIGN_CENTRE + 3,
    }
}

/// Slots whose seeds are vectors of parts, in the form the corner's catalogue seeds them.
const SEEDED: [(Slot, usize); 12] = [
    (Slot::Centre, CENTRE),
    (Slot::SpinAxis, SPIN_AXIS),
    (Slot::SteeringPoint, STEERING_POINT),
    (Slot::SteeringDirection, STEERING_DIRECTION),
    (Slot::Spring, SPRING),
    (Slot::StrutUpper, STRUT_UPPER),
    (Slot::SpringLength, SPRING_LENGTH),
    (Slot::RockerAngle, ROCKER_ANGLE),
    (Slot::BarAngle, BAR_ANGLE),
    (Slot::DesignSpinAxis, DESIGN_SPIN_AXIS),
    (Slot::DesignCentre, DESIGN_CENTRE),
    (Slot::Turn, ROTATION),
];

/// What every axle reads of its wheels.
const ALWAYS: &[Slot] = &[
    Slot::SpinAxis,
    Slot::Centre,
    Slot::Turn,
    Slot::DesignSpinAxis,
    Slot::DesignCentre,
];

/// Which parts are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    slots: Slots,
    used: [bool; PARTS],
}

impl Parts {
    /// Those of these slots, and what every axle reads.
    pub fn of(slots: &[Slot]) -> Self {
        let slots = Slots::default().with(ALWAYS).with(slots);
        let mut used = [false; PARTS];
        for slot in Slot::ALL.iter().filter(|slot| slots.contains(**slot)) {
            used[parts_of(*slot)].fill(true);
        }
        used[DESIGN_SPRING_LENGTH] = used[SPRING_LENGTH];
        Parts { slots, used }
    }

    /// Whether the steering axis is among them.
    pub fn contain_steering_axis(&self) -> bool {
        self.slots.contain_steering_axis()
    }

    fn indices(&self) -> impl Iterator<Item = usize> {
        (0..PARTS).filter(|part| self.used[*part])
    }
}

/// The parts along one line in travel and rack, as power series. What is not read is NaN.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<const N: usize>([Jet<f64, N>; PARTS]);

impl<const N: usize> Snapshot<N> {
    /// Nothing is read yet.
    pub fn unknown() -> Self {
        Snapshot([Jet::constant(f64::NAN); PARTS])
    }

    /// Reads a configuration.
    pub fn of(at: &Configuration<Jet<f64, N>>, parts: &Parts) -> Self {
        let inputs = Inputs::standing(at, Constants::default(), parts.slots);
        let mut values = [Jet::constant(f64::NAN); PARTS];
        let mut set = |first: usize, v: Vector3<Jet<f64, N>>| {
            values[first..first + 3].copy_from_slice(&v.to_array());
        };
        let Inputs { now, design, .. } = inputs;
        set(CENTRE, now.centre);
        for (i, column) in at.pose.rotation.columns.into_iter().enumerate() {
            set(ROTATION + 3 * i, column);
        }
        set(SPIN_AXIS, now.spin_axis);
        set(STEERING_POINT, now.steering_point);
        set(STEERING_DIRECTION, now.steering_direction);
        set(SPRING, now.spring);
        set(STRUT_UPPER, now.strut_upper);
        set(DESIGN_SPIN_AXIS, design.spin_axis);
        set(DESIGN_CENTRE, design.centre);
        values[SPRING_LENGTH] = now.spring_length;
        values[ROCKER_ANGLE] = now.rocker_angle;
        values[BAR_ANGLE] = now.bar_angle;
        if let Some(spring) = at.mechanism.spring {
            let along = at.designed(spring.upper) - at.designed(spring.lower);
            values[DESIGN_SPRING_LENGTH] = along.norm();
        }
        Snapshot(values)
    }
}

/// The motion along a line, from a point.
pub(super) fn along<const N: usize>(
    line: &Line,
    travel: f64,
    rack: f64,
) -> MotionPoint<Jet<f64, N>> {
    let series = |value: f64, rate: f64| {
        let mut series = Jet::constant(value);
        if N > 1 {
            series.0[1] = rate;
        }
        series
    };
    MotionPoint {
        drive: Drive::Travel,
        value: series(travel, line.travel),
        rack: series(rack, line.rack),
    }
}

/// A wheel: its parts as functions of travel and rack.
#[derive(Clone, Copy, Debug)]
pub struct Reading<T>([Taylor<T>; PARTS]);

impl Reading<f64> {
    /// From what was read along the lines.
    pub fn of<const N: usize>(lines: &[Snapshot<N>]) -> Self {
        let part = |part: usize| {
            let mut series: [&[f64]; 4] = [&[]; 4];
            for (series, line) in series.iter_mut().zip(lines) {
                *series = &line.0[part].0;
            }
            match part {
                DESIGN.. => Taylor::constant(series[0][0]),
                _ => Taylor::through(&series[..lines.len()]),
            }
        };
        Reading(std::array::from_fn(part))
    }
}

impl<'t> Reading<Tracked<'t>> {
    /// The same with every number an input on the tape, line by line, part by part, power by power.
    pub fn on_tape<const N: usize>(tape: &'t Tape, lines: &[Snapshot<N>], parts: &Parts) -> Self {
        let mut reading = [Taylor::unknown(Tracked::constant(0.0)); PARTS];
        let mut series = [[[Tracked::constant(f64::NAN); N]; PARTS]; 4];
        for (series, line) in series.iter_mut().zip(lines) {
            for part in parts.indices() {
                series[part] = line.0[part].0.map(|value| tape.input(value));
            }
        }
        for part in parts.indices() {
            let along: [&[Tracked]; 4] = std::array::from_fn(|line| &series[line][part][..]);
            reading[part] = match part {
                DESIGN.. => Taylor::constant(along[0][0]),
                _ => Taylor::through(&along[..lines.len()]),
            };
        }
        Reading(reading)
    }
}

/// Numbers that a reading along so many lines puts on a tape.
pub(super) fn inputs_on_tape<const N: usize>(parts: &Parts, lines: usize) -> usize {
    parts.indices().count() * N * lines
}

/// The gradient by every hardpoint of an output whose derivatives by the numbers of one line are `by`, in
/// the order of [`Reading::on_tape`]; added to `gradient`. `buffer` has a place for each point.
///
/// An adjoint pass on series yields the series of S.u_p for any seed series S. With the derivative by the
/// coefficient of e^k as the coefficient of e^(N-1-k) of S, the coefficient of e^(N-1) is the sum wanted.
pub(super) fn add_gradient<const N: usize>(
    linearised: &Linearised<'_, N>,
    parts: &Parts,
    by: &[f64],
    buffer: &mut [Vector3<Jet<f64, N>>],
    gradient: &mut [Vector3<f64>],
) {
    if by.iter().all(|b| *b == 0.0) {
        return;
    }
    let zero = Jet::constant(0.0);
    let mut seeds = [zero; PARTS];
    for (part, by) in parts.indices().zip(by.chunks_exact(N)) {
        for (k, by) in by.iter().enumerate() {
            seeds[part].0[N - 1 - k] = *by;
        }
    }
    buffer.fill(Vector3::new(zero, zero, zero));
    linearised.gradient(buffer, |sink| push(linearised, parts, &seeds, sink));
    for (total, series) in gradient.iter_mut().zip(buffer) {
        *total = *total + series.map(|c| c[N - 1]);
    }
}

fn push<const N: usize>(
    linearised: &Linearised<'_, N>,
    parts: &Parts,
    seeds: &[Jet<f64, N>; PARTS],
    sink: &mut Seeds<'_, '_, Jet<f64, N>>,
) {
    let vector = |first: usize| Vector3::new(seeds[first], seeds[first + 1], seeds[first + 2]);
    let at = &linearised.at;
    for (slot, first) in SEEDED {
        let range = parts_of(slot);
        if !parts.used[range.start] {
            continue;
        }
        match slot {
            // A turn d of the carrier moves a column c by d x c, so that g.(d x c) = d.(c x g).
            Slot::Turn => {
                for (i, column) in at.pose.rotation.columns.into_iter().enumerate() {
                    sink.turn(column.cross(vector(first + 3 * i)));
                }
            }
            _ if range.len() == 1 => {
                let zero = Jet::constant(0.0);
                slot.push(Vector3::new(seeds[first], zero, zero), at, sink);
            }
            _ => slot.push(vector(first), at, sink),
        }
    }
    if let (true, Some(spring)) = (parts.used[DESIGN_SPRING_LENGTH], at.mechanism.spring) {
        let along = (at.designed(spring.upper) - at.designed(spring.lower)).normalised();
        let by: Vector3<_> = along * seeds[DESIGN_SPRING_LENGTH];
        let mut end = |id: PointId, by| sink.hardpoint(id, by);
        end(spring.upper, by);
        end(spring.lower, -by);
    }
}

impl<T: Real> Reading<T> {
    fn vector(&self, first: usize, of: impl Fn(&Taylor<T>) -> T) -> Vector3<T> {
        Vector3::new(
            of(&self.0[first]),
            of(&self.0[first + 1]),
            of(&self.0[first + 2]),
        )
    }

    /// About a point that moves at these rates; see [`Taylor::moving`].
    pub fn moving(&self, travel: T, rack: Option<T>) -> Reading<Jet<T, 2>> {
        let part = |part: usize| match part {
            DESIGN.. => Taylor::constant(Jet::constant(self.0[part].value())),
            _ => self.0[part].moving(travel, rack),
        };
        Reading(std::array::from_fn(part))
    }

    /// About a point moved a little in travel; see [`Taylor::shifted`].
    pub fn shifted(&self, travel: T) -> Self {
        let part = |part: usize| match part {
            DESIGN.. => self.0[part],
            _ => self.0[part].shifted(travel),
        };
        Reading(std::array::from_fn(part))
    }

    /// Position of the wheel centre.
    pub fn centre(&self) -> Vector3<T> {
        self.vector(CENTRE, Taylor::value)
    }

    /// Unit vector along the spin axis, outboard.
    pub fn spin_axis(&self) -> Vector3<T> {
        self.vector(SPIN_AXIS, Taylor::value)
    }

    /// Wheel centre in the design position.
    pub fn design_centre(&self) -> Vector3<T> {
        self.vector(DESIGN_CENTRE, Taylor::value)
    }

    /// Spin axis in the design position.
    pub fn design_spin_axis(&self) -> Vector3<T> {
        self.vector(DESIGN_SPIN_AXIS, Taylor::value)
    }

    /// Length of spring or strut with its derivative by travel, and the length in the design position.
    pub fn spring_length(&self) -> (T, T, T) {
        let length = &self.0[SPRING_LENGTH];
        let design = self.0[DESIGN_SPRING_LENGTH].value();
        (length.value(), length.by_travel(), design)
    }

    /// Angle of the anti-roll bar's lever and its derivative by travel.
    pub fn bar_angle(&self) -> (T, T) {
        let angle = &self.0[BAR_ANGLE];
        (angle.value(), angle.by_travel())
    }

    /// Point and direction of the steering axis.
    pub fn steering_axis(&self) -> (Vector3<T>, Vector3<T>) {
        (
            self.vector(STEERING_POINT, Taylor::value),
            self.vector(STEERING_DIRECTION, Taylor::value),
        )
    }

    /// Velocity of the wheel centre and angular velocity of the carrier, by travel.
    pub fn by_travel(&self) -> [Vector3<T>; 2] {
        self.twist(Taylor::by_travel)
    }

    /// The same by the rack displacement, the height of the wheel centre held.
    pub fn by_rack(&self) -> [Vector3<T>; 2] {
        self.twist(Taylor::by_rack)
    }

    fn twist(&self, rate: fn(&Taylor<T>) -> T) -> [Vector3<T>; 2] {
        let column = |i: usize| {
            let first = ROTATION + 3 * i;
            self.vector(first, Taylor::value)
                .cross(self.vector(first, rate))
        };
        let turn = (column(0) + column(1) + column(2)) * self.0[CENTRE].value().lit(0.5);
        [self.vector(CENTRE, rate), turn]
    }

    /// What the corner's catalogue reads.
    pub fn inputs(&self, constants: Constants) -> Inputs<T> {
        let wheel = |of: fn(&Taylor<T>) -> T| Wheel {
            spin_axis: self.vector(SPIN_AXIS, of),
            centre: self.vector(CENTRE, of),
            steering_point: self.vector(STEERING_POINT, of),
            steering_direction: self.vector(STEERING_DIRECTION, of),
            spring_length: of(&self.0[SPRING_LENGTH]),
            spring: self.vector(SPRING, of),
            rocker_angle: of(&self.0[ROCKER_ANGLE]),
            bar_angle: of(&self.0[BAR_ANGLE]),
            strut_upper: self.vector(STRUT_UPPER, of),
        };
        let now = wheel(Taylor::value);
        let rate = wheel(Taylor::by_travel);
        let [_, turn] = self.by_travel();
        Inputs {
            design: Wheel {
                spin_axis: self.design_spin_axis(),
                centre: self.design_centre(),
                ..now
            },
            now,
            rate,
            turn,
            constants,
        }
    }

    /// A number in the shape of the others.
    pub fn like(&self) -> T {
        self.0[CENTRE].value()
    }
}

/// The rotation of the carrier.
impl Reading<f64> {
    /// Rotation of the carrier from the design position.
    pub fn rotation(&self) -> Matrix3<f64> {
        Matrix3 {
            columns: [0, 1, 2].map(|i| self.vector(ROTATION + 3 * i, Taylor::value)),
        }
    }
}
