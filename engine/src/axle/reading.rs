//! Reads one wheel as a function of its own travel and rack.
//!
//! Everything is in the kernel's frame of a left wheel; of a right wheel that is its mirror image.

use super::taylor::{Line, Taylor};
use crate::characteristics::{Constants, Inputs, Slot, Slots, Wheel};
use crate::derive::{Linearised, MotionPoint, Seeds};
use crate::mechanism::Configuration;
use crate::model::{Drive, PointId};
use crate::number::{Jet, Matrix3, Real, Tape, Tracked, Vector3, outlined};
use std::ops::Range;

/// Count of numbers that are read of a wheel.
const PARTS: usize = 37;
/// The most lines along which they are read, and the most coefficients along each.
const MOST_LINES: usize = 4;
const MOST_POWERS: usize = 4;

pub(super) const CENTRE: usize = 0;
/// The columns of the carrier's rotation, one after the other.
const ROTATION: usize = 3;
pub(super) const SPIN_AXIS: usize = 12;
pub(super) const STEERING_POINT: usize = 15;
pub(super) const STEERING_DIRECTION: usize = 18;
pub(super) const SPRING: usize = 21;
pub(super) const STRUT_UPPER: usize = 24;
pub(super) const SPRING_LENGTH: usize = 27;
pub(super) const ROCKER_ANGLE: usize = 28;
pub(super) const BAR_ANGLE: usize = 29;
/// From here on parts do not change in the motion.
const DESIGN: usize = 30;
pub(super) const DESIGN_SPIN_AXIS: usize = 30;
pub(super) const DESIGN_CENTRE: usize = 33;
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
pub(super) const ALWAYS: &[Slot] = &[
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
    /// The parts of these slots, and those that every axle reads.
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
    /// A snapshot with nothing read yet: all NaN.
    pub fn unknown() -> Self {
        Snapshot([Jet::constant(f64::NAN); PARTS])
    }

    /// Reads a configuration.
    pub fn of(at: &Configuration<Jet<f64, N>>, parts: &Parts) -> Self {
        let inputs = Inputs::without_rates(at, Constants::default(), parts.slots);
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
    /// The wheel as the series along the lines of [`Line::needed`] determine it.
    pub fn of<const N: usize>(lines: &[Snapshot<N>]) -> Self {
        let part = |part: usize| {
            let mut series: [&[f64]; MOST_LINES] = [&[]; MOST_LINES];
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

impl<const N: usize> Reading<Jet<f64, N>> {
    /// A wheel whose numbers are series in another variable than its motion. Its derivatives by travel and rack are
    /// unknown.
    pub fn without_rates(read: &Snapshot<N>) -> Self {
        let part = |part: usize| match part {
            DESIGN.. => Taylor::constant(read.0[part]),
            _ => Taylor::through(&[&[read.0[part]]]),
        };
        Reading(std::array::from_fn(part))
    }
}

impl<'t> Reading<Tracked<'t>> {
    /// The wheel with every number an input on the tape, line by line, part by part, power by power.
    pub fn on_tape<const N: usize>(tape: &'t Tape, lines: &[Snapshot<N>], parts: &Parts) -> Self {
        const { assert!(N <= MOST_POWERS) };
        let mut inputs = [Tracked::constant(0.0); MOST_LINES * PARTS * MOST_POWERS];
        let mut series = inputs.chunks_exact_mut(N);
        for line in lines {
            for (part, series) in parts.indices().zip(&mut series) {
                for (input, value) in series.iter_mut().zip(line.0[part].0) {
                    *input = tape.input(value);
                }
            }
        }
        Reading::of_inputs(&inputs, parts, lines.len(), N)
    }

    /// The wheel as these inputs on the tape determine it.
    fn of_inputs(inputs: &[Tracked<'t>], parts: &Parts, lines: usize, powers: usize) -> Self {
        let mut reading = [Taylor::unknown(Tracked::constant(0.0)); PARTS];
        let count = parts.indices().count();
        for (place, part) in parts.indices().enumerate() {
            let series = |line: usize| &inputs[(line * count + place) * powers..][..powers];
            let along: [&[Tracked]; MOST_LINES] = std::array::from_fn(series);
            reading[part] = match part {
                DESIGN.. => Taylor::constant(along[0][0]),
                _ => Taylor::through(&along[..lines]),
            };
        }
        Reading(reading)
    }
}

/// Count of numbers that a reading along `lines` lines puts on a tape.
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

/// What formulas read of one wheel: its parts as functions of its travel and the rack.
///
/// Vectors and twists are formed out of line, since formulas are full of them.
pub trait WheelParts<T: Real>: Copy {
    /// The coefficient of a part with these powers of travel and rack; NaN where it is not known.
    fn coefficient(&self, part: usize, powers: [usize; 2]) -> T;

    /// The value of a part.
    #[inline(always)]
    fn number(&self, part: usize) -> T {
        self.coefficient(part, [0, 0])
    }

    /// Three parts in a row as a vector, or their coefficients with these powers.
    #[inline(always)]
    fn vector(&self, first: usize, powers: [usize; 2]) -> Vector3<T> {
        outlined!(
            [T: Real, W: WheelParts<T>] self.like();
            parts: &'p W = self, first: usize = first, powers: [usize; 2] = powers => Vector3<T> {
                Vector3::new(
                    parts.coefficient(first, powers),
                    parts.coefficient(first + 1, powers),
                    parts.coefficient(first + 2, powers),
                )
            }
        )
    }

    /// Position of the wheel centre.
    #[inline(always)]
    fn centre(&self) -> Vector3<T> {
        self.vector(CENTRE, [0, 0])
    }

    /// How far the wheel centre is above its design position.
    #[inline(always)]
    fn travel(&self) -> T {
        self.centre().z - self.design_centre().z
    }

    /// Unit vector along the spin axis, outboard.
    #[inline(always)]
    fn spin_axis(&self) -> Vector3<T> {
        self.vector(SPIN_AXIS, [0, 0])
    }

    /// Wheel centre in the design position.
    #[inline(always)]
    fn design_centre(&self) -> Vector3<T> {
        self.vector(DESIGN_CENTRE, [0, 0])
    }

    /// Spin axis in the design position.
    #[inline(always)]
    fn design_spin_axis(&self) -> Vector3<T> {
        self.vector(DESIGN_SPIN_AXIS, [0, 0])
    }

    /// Length of spring or strut with its derivative by travel, and the length in the design position.
    #[inline(always)]
    fn spring_length(&self) -> (T, T, T) {
        (
            self.number(SPRING_LENGTH),
            self.coefficient(SPRING_LENGTH, [1, 0]),
            self.number(DESIGN_SPRING_LENGTH),
        )
    }

    /// Angle of the anti-roll bar's lever and its derivative by travel.
    #[inline(always)]
    fn bar_angle(&self) -> (T, T) {
        (self.number(BAR_ANGLE), self.coefficient(BAR_ANGLE, [1, 0]))
    }

    /// Point and direction of the steering axis.
    #[inline(always)]
    fn steering_axis(&self) -> (Vector3<T>, Vector3<T>) {
        (
            self.vector(STEERING_POINT, [0, 0]),
            self.vector(STEERING_DIRECTION, [0, 0]),
        )
    }

    /// Velocity of the wheel centre and angular velocity of the carrier, by travel.
    #[inline(always)]
    fn by_travel(&self) -> [Vector3<T>; 2] {
        self.twist([1, 0])
    }

    /// Velocity of the wheel centre and angular velocity of the carrier by the rack displacement, at held height of the
    /// wheel centre.
    #[inline(always)]
    fn by_rack(&self) -> [Vector3<T>; 2] {
        self.twist([0, 1])
    }

    /// Velocity and angular velocity by travel or rack: half the sum of column x rate of column.
    #[inline(always)]
    fn twist(&self, powers: [usize; 2]) -> [Vector3<T>; 2] {
        outlined!(
            [T: Real, W: WheelParts<T>] self.like();
            parts: &'p W = self, powers: [usize; 2] = powers => [Vector3<T>; 2] {
                let rotation = parts.vector(ROTATION, [0, 0]);
                let mut turn = rotation.cross(parts.vector(ROTATION, powers));
                for first in [ROTATION + 3, ROTATION + 6] {
                    let column = parts.vector(first, [0, 0]);
                    turn = turn + column.cross(parts.vector(first, powers));
                }
                let half = rotation.x.lit(0.5);
                [parts.vector(CENTRE, powers), turn * half]
            }
        )
    }

    /// The inputs of the characteristics catalogue.
    #[inline(always)]
    fn inputs(&self, constants: Constants) -> Inputs<T> {
        let now = wheel(self, [0, 0]);
        let [_, turn] = self.by_travel();
        Inputs {
            design: Wheel {
                spin_axis: self.design_spin_axis(),
                centre: self.design_centre(),
                ..now
            },
            now,
            rate: wheel(self, [1, 0]),
            turn,
            constants,
        }
    }

    /// A number in the shape of the others.
    fn like(&self) -> T;

    /// The wheel as series in a motion with these rates of travel and rack; `None` for a rack at rest. One degree less
    /// is known.
    #[inline(always)]
    fn moving(&self, travel: T, rack: Option<T>) -> Moving<'_, Self, T> {
        Moving {
            of: self,
            travel,
            rack,
        }
    }
}

/// The wheel as the characteristics catalogue reads it: values for powers `[0, 0]`, derivatives for others.
#[inline(always)]
fn wheel<T: Real>(parts: &impl WheelParts<T>, powers: [usize; 2]) -> Wheel<T> {
    Wheel {
        spin_axis: parts.vector(SPIN_AXIS, powers),
        centre: parts.vector(CENTRE, powers),
        steering_point: parts.vector(STEERING_POINT, powers),
        steering_direction: parts.vector(STEERING_DIRECTION, powers),
        spring_length: parts.coefficient(SPRING_LENGTH, powers),
        spring: parts.vector(SPRING, powers),
        rocker_angle: parts.coefficient(ROCKER_ANGLE, powers),
        bar_angle: parts.coefficient(BAR_ANGLE, powers),
        strut_upper: parts.vector(STRUT_UPPER, powers),
    }
}

impl<T: Real> WheelParts<T> for Reading<T> {
    #[inline(always)]
    fn like(&self) -> T {
        self.0[CENTRE].coefficient([0, 0])
    }

    #[inline(always)]
    fn coefficient(&self, part: usize, powers: [usize; 2]) -> T {
        self.0[part].coefficient(powers)
    }
}

/// A wheel that moves: its parts are formed as they are read.
#[derive(Debug)]
pub struct Moving<'w, W, T> {
    of: &'w W,
    travel: T,
    rack: Option<T>,
}

impl<W, T: Copy> Clone for Moving<'_, W, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<W, T: Copy> Copy for Moving<'_, W, T> {}

impl<T: Real, W: WheelParts<T>> WheelParts<Jet<T, 2>> for Moving<'_, W, T> {
    #[inline(always)]
    fn like(&self) -> Jet<T, 2> {
        Jet::constant(self.travel)
    }

    #[inline(always)]
    fn coefficient(&self, part: usize, [i, j]: [usize; 2]) -> Jet<T, 2> {
        let Moving { of, travel, rack } = self;
        let value = of.coefficient(part, [i, j]);
        if part >= DESIGN {
            return Jet([value, value.zero()]);
        }
        let mut rate = of.coefficient(part, [i + 1, j]).scaled((i + 1) as f64) * *travel;
        if let Some(rack) = rack {
            rate = rate + of.coefficient(part, [i, j + 1]).scaled((j + 1) as f64) * *rack;
        }
        Jet([value, rate])
    }
}

impl<T: Real> Reading<T> {
    /// The wheel about a point moved a little in travel; see [`Taylor::shifted`].
    pub fn shifted(&self, travel: T) -> Self {
        let part = |part: usize| match part {
            DESIGN.. => self.0[part],
            _ => self.0[part].shifted(travel),
        };
        Reading(std::array::from_fn(part))
    }
}

/// The rotation of the carrier.
impl Reading<f64> {
    /// Rotation of the carrier from the design position.
    pub fn rotation(&self) -> Matrix3<f64> {
        Matrix3 {
            columns: [0, 1, 2].map(|i| self.vector(ROTATION + 3 * i, [0, 0])),
        }
    }
}
