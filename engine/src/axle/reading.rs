//! One wheel as a function of its own travel and of the rack.
//!
//! All numbers are in the kernel's frame of a left wheel. A right wheel is described as its mirror image.

use super::carriers::Carriers;
use super::moving::Moving;
use super::taylor::{Line, Taylor};
use crate::characteristics::{
    Constants, DesignWheel, Inputs, NumberPart, Slot, Slots, VectorPart, Wheel,
};
use crate::derive::MotionPoint;
use crate::mechanism::Configuration;
use crate::model::Drive;
use crate::number::{Each, Jet, Matrix3, Real, Vector3, outlined};
use std::cell::Cell;

/// Largest number of straight lines in the plane of travel and rack along which the values of a wheel are computed.
pub(super) const MOST_LINES: usize = 4;

/// Slots (values of a wheel) that are computed for every axle.
pub(super) const ALWAYS: &[Slot] = &[
    Slot::SpinAxis,
    Slot::Centre,
    Slot::Turn,
    Slot::DesignSpinAxis,
    Slot::DesignCentre,
];

/// Values of a wheel in one pose: inputs of formulas, the columns of its carrier's rotation matrix, and values of its
/// design. For a steered axle, in which the carrier turns, also the columns x and y of the axle's rotation matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelPose<T> {
    pub(super) wheel: Wheel<T>,
    pub(super) rotation: [Vector3<T>; 3],
    pub(super) axle: [Vector3<T>; 2],
    pub(super) design: DesignWheel<T>,
}

impl<T: Copy> WheelPose<T> {
    pub(super) fn filled(number: T) -> Self {
        let vector = Vector3::new(number, number, number);
        WheelPose {
            wheel: Wheel::of_parts(|_| vector, |_| number),
            rotation: [vector; 3],
            axle: [vector; 2],
            design: DesignWheel::filled(number),
        }
    }

    /// Converts the pose to another number type. The function calls `f` for the numbers in a fixed order.
    pub(super) fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> WheelPose<U> {
        WheelPose {
            wheel: self.wheel.map(f),
            rotation: self.rotation.each(|column| column.map(f)),
            axle: self.axle.each(|column| column.map(f)),
            design: self.design.map(f),
        }
    }
}

/// Selection of the values of a wheel that formulas use, and the index of each value on a tape (recorded operations for
/// derivatives).
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    slots: Slots,
    /// Index of each value on the tape. `None` for values that are not used.
    pub(super) places: WheelPose<Option<usize>>,
    pub(super) count: usize,
}

impl Parts {
    /// Selects the values in these slots, and the values that every axle of this kind uses.
    pub fn of(slots: &[Slot], carriers: Carriers) -> Self {
        let mut slots = Slots::default().with(ALWAYS).with(slots);
        let is_steered = matches!(carriers, Carriers::Steered(_));
        if is_steered {
            // The kingpin is a line that is fixed in the axle. So its point and the axle's rotation give the motion of the
            // axle.
            slots = slots.with(&[Slot::SteeringPoint]);
        }
        if slots.contain_any(NumberPart::SpringLength.slots()) {
            slots = slots.with(&[Slot::DesignSpringLength]);
        }
        if slots.contain_any(VectorPart::HeaveSpring.slots()) {
            slots = slots.with(&[Slot::DesignHeaveSpring]);
        }
        let all = |is_read: bool| Vector3::new(is_read, is_read, is_read);
        let read = WheelPose {
            wheel: Wheel::of_parts(
                |part| all(slots.contain_any(part.slots())),
                |part| slots.contain_any(part.slots()),
            ),
            rotation: [all(slots.contains(Slot::Turn)); 3],
            axle: [all(is_steered); 2],
            design: DesignWheel {
                spin_axis: all(slots.contains(Slot::DesignSpinAxis)),
                centre: all(slots.contains(Slot::DesignCentre)),
                spring_length: slots.contains(Slot::DesignSpringLength),
                heave_spring: all(slots.contains(Slot::DesignHeaveSpring)),
            },
        };
        let next = Cell::new(0);
        let places = read.map(|is_read: bool| {
            let place = next.get();
            next.set(place + is_read as usize);
            is_read.then_some(place)
        });
        Parts {
            slots,
            places,
            count: next.get(),
        }
    }

    /// Returns true if the selected values include the steering axis.
    pub fn contain_steering_axis(&self) -> bool {
        self.slots.contain_steering_axis()
    }
}

/// Values of a wheel along one straight line in travel and rack, as power series. Values that are not used are NaN.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<const N: usize>(pub(super) WheelPose<Jet<f64, N>>);

impl<const N: usize> Snapshot<N> {
    /// Returns a wheel whose values are all unknown (NaN).
    pub fn unknown() -> Self {
        Snapshot(WheelPose::filled(Jet::constant(f64::NAN)))
    }

    /// Reads the selected values of the wheel from a configuration.
    pub fn of(at: &Configuration<Jet<f64, N>>, parts: &Parts) -> Self {
        let inputs = Inputs::without_rates(at, Constants::default(), parts.slots);
        Snapshot(WheelPose {
            wheel: inputs.now,
            rotation: at.carrier_rotation().columns,
            axle: [0, 1].each(|column| at.pose.rotation.columns[column]),
            design: inputs.design,
        })
    }
}

/// Makes the motion that starts at these values of travel and rack, and follows a line in travel and rack.
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

/// A wheel as a function of its travel and rack.
#[derive(Clone, Copy, Debug)]
pub struct Reading<T> {
    wheel: Wheel<Taylor<T>>,
    /// Columns of the carrier's rotation from the design position.
    rotation: [Vector3<Taylor<T>>; 3],
    /// Columns of the rotation of a steered axle.
    axle: [Vector3<Taylor<T>>; 2],
    design: DesignWheel<T>,
}

impl<T: Real> Reading<T> {
    /// Makes a wheel from a pose. `moving` converts numbers that change with travel and rack to polynomials. `fixed`
    /// converts constant numbers.
    pub(super) fn made_of<U: Copy>(
        pose: &WheelPose<U>,
        moving: impl Fn(U) -> Taylor<T> + Copy,
        fixed: impl Fn(U) -> T + Copy,
    ) -> Self {
        Reading {
            wheel: pose.wheel.map(moving),
            rotation: pose.rotation.each(|column| column.map(moving)),
            axle: pose.axle.each(|column| column.map(moving)),
            design: pose.design.map(fixed),
        }
    }

    /// Returns the wheel as series about a slightly different travel; see [`Taylor::shifted`].
    pub fn shifted(&self, travel: T) -> Self {
        let shifted = |polynomial: Taylor<T>| polynomial.shifted(travel);
        Reading {
            wheel: self.wheel.map(shifted),
            rotation: self.rotation.each(|column| column.map(shifted)),
            axle: self.axle.each(|column| column.map(shifted)),
            design: self.design,
        }
    }
}

impl Reading<f64> {
    /// Makes the wheel from its series along the lines of [`Line::needed`].
    pub fn of<const N: usize>(lines: &[Snapshot<N>]) -> Self {
        let mut along = [WheelPose::filled(Jet::constant(f64::NAN)); MOST_LINES];
        for (along, line) in along.iter_mut().zip(lines) {
            *along = line.0;
        }
        let [first, second, third, fourth] = &along;
        let pairs = zipped(&zipped(first, second), &zipped(third, fourth));
        let moving = |((a, b), (c, d)): SeriesOfLines<N>| {
            let series: [&[f64]; MOST_LINES] = [&a.0, &b.0, &c.0, &d.0];
            Taylor::through(&series[..lines.len()])
        };
        Reading::made_of(&pairs, moving, |((first, _), _): SeriesOfLines<N>| first[0])
    }

    /// Rotation of the carrier from the design position.
    pub fn rotation(&self) -> Matrix3<f64> {
        Matrix3 {
            columns: [0, 1, 2].each(|i| self.column(i, [0, 0])),
        }
    }
}

/// Series of one number along up to four lines.
type SeriesOfLines<const N: usize> = ((Jet<f64, N>, Jet<f64, N>), (Jet<f64, N>, Jet<f64, N>));

/// Pairs each number with the same number in another pose.
pub(super) fn zipped<T: Copy, U: Copy>(
    one: &WheelPose<T>,
    other: &WheelPose<U>,
) -> WheelPose<(T, U)> {
    let pair = |a: T, b: U| (a, b);
    let [x, y, z] = one.rotation;
    let [u, v, w] = other.rotation;
    let ([i, j], [m, n]) = (one.axle, other.axle);
    let (a, b) = (&one.design, &other.design);
    WheelPose {
        wheel: one.wheel.zip(&other.wheel, pair),
        rotation: [x.zip(u, pair), y.zip(v, pair), z.zip(w, pair)],
        axle: [i.zip(m, pair), j.zip(n, pair)],
        design: DesignWheel {
            spin_axis: a.spin_axis.zip(b.spin_axis, pair),
            centre: a.centre.zip(b.centre, pair),
            spring_length: pair(a.spring_length, b.spring_length),
            heave_spring: a.heave_spring.zip(b.heave_spring, pair),
        },
    }
}

impl<const N: usize> Reading<Jet<f64, N>> {
    /// Makes a wheel without derivatives with respect to travel and rack. Its numbers are series in another variable.
    pub fn without_rates(read: &Snapshot<N>) -> Self {
        let value = |series: Jet<f64, N>| Taylor::through(&[&[series]]);
        Reading::made_of(&read.0, value, |series| series)
    }
}

/// Values of one wheel as functions of its travel and the rack, for formulas.
///
/// The compiler makes separate functions for vectors and twists, because many formulas use them.
pub trait WheelParts<T: Real>: Copy {
    /// True if there are coefficients of the fourth power of travel. For a rigid axle, they may be zero instead of known.
    const HAS_FOURTH: bool = false;
    /// True if the values of the wheel are used only at the travel of the coefficients, without a step away from it.
    const IS_AT_TRAVELS: bool = false;

    /// Returns a vector of the wheel. The powers `[0, 0]` of travel and rack give the vector itself. Other powers give
    /// the coefficient with these powers in the Taylor series of the vector. NaN if unknown.
    fn read_vector(&self, part: VectorPart, powers: [usize; 2]) -> Vector3<T>;

    /// Returns one value of the wheel. The powers `[0, 0]` of travel and rack give the value itself. Other powers give
    /// the coefficient with these powers in the Taylor series of the value. NaN if unknown.
    fn number(&self, part: NumberPart, powers: [usize; 2]) -> T;

    /// Returns a column of the carrier's rotation matrix, with powers as in [`WheelParts::read_vector`].
    fn column(&self, i: usize, powers: [usize; 2]) -> Vector3<T>;

    /// Returns a column of the rotation matrix of a steered axle, along x (0) or y (1), with powers as in
    /// [`WheelParts::read_vector`].
    fn axle_column(&self, i: usize, powers: [usize; 2]) -> Vector3<T>;

    /// Values of the wheel in the design position.
    fn design(&self) -> DesignWheel<T>;

    /// Returns any one value of the wheel. New constants copy the number type and the count of coefficients from this
    /// value.
    fn like(&self) -> T;

    /// Calls [`WheelParts::read_vector`] through a function that is compiled separately.
    #[inline(always)]
    fn vector(&self, part: VectorPart, powers: [usize; 2]) -> Vector3<T> {
        outlined!(
            [T: Real, W: WheelParts<T>] self.like();
            parts: &'p W = self, part: VectorPart = part, powers: [usize; 2] = powers => Vector3<T> {
                parts.read_vector(part, powers)
            }
        )
    }

    /// Position of the wheel centre.
    #[inline(always)]
    fn centre(&self) -> Vector3<T> {
        self.vector(VectorPart::Centre, [0, 0])
    }

    /// Height of the wheel centre above its design position.
    #[inline(always)]
    fn travel(&self) -> T {
        self.centre().z - self.design().centre.z
    }

    /// Unit vector along the spin axis, positive outboard.
    #[inline(always)]
    fn spin_axis(&self) -> Vector3<T> {
        self.vector(VectorPart::SpinAxis, [0, 0])
    }

    /// Length of the spring or strut, its derivative with respect to travel, and its length in the design position.
    #[inline(always)]
    fn spring_length(&self) -> (T, T, T) {
        let part = NumberPart::SpringLength;
        (
            self.number(part, [0, 0]),
            self.number(part, [1, 0]),
            self.design().spring_length,
        )
    }

    /// Angle of the anti-roll bar's lever and its derivative with respect to travel.
    #[inline(always)]
    fn bar_angle(&self) -> (T, T) {
        let part = NumberPart::BarAngle;
        (self.number(part, [0, 0]), self.number(part, [1, 0]))
    }

    /// Point and direction of the steering axis.
    #[inline(always)]
    fn steering_axis(&self) -> (Vector3<T>, Vector3<T>) {
        (
            self.vector(VectorPart::SteeringPoint, [0, 0]),
            self.vector(VectorPart::SteeringDirection, [0, 0]),
        )
    }

    /// Velocity of the wheel centre and angular velocity of the carrier, with respect to travel.
    #[inline(always)]
    fn by_travel(&self) -> [Vector3<T>; 2] {
        self.twist([1, 0])
    }

    /// Velocity of the wheel centre and angular velocity of the carrier, with respect to the rack displacement. The
    /// height of the wheel centre stays constant.
    #[inline(always)]
    fn by_rack(&self) -> [Vector3<T>; 2] {
        self.twist([0, 1])
    }

    /// Velocity of the wheel centre and angular velocity of the carrier, with respect to travel or rack. The angular
    /// velocity is half the sum of (column x rate of column).
    #[inline(always)]
    fn twist(&self, powers: [usize; 2]) -> [Vector3<T>; 2] {
        outlined!(
            [T: Real, W: WheelParts<T>] self.like();
            parts: &'p W = self, powers: [usize; 2] = powers => [Vector3<T>; 2] {
                let first = parts.column(0, [0, 0]);
                let mut turn = first.cross(parts.column(0, powers));
                for i in [1, 2] {
                    turn = turn + parts.column(i, [0, 0]).cross(parts.column(i, powers));
                }
                let half = first.x.constant(0.5);
                [parts.read_vector(VectorPart::Centre, powers), turn * half]
            }
        )
    }

    /// Velocity of the steering axis's point, and angular velocity of a steered axle, with respect to travel or rack.
    /// With a and b the columns along x and y, the angular velocity is a x a' + a (b'.(a x b)).
    #[inline(always)]
    fn axle_twist(&self, powers: [usize; 2]) -> [Vector3<T>; 2] {
        outlined!(
            [T: Real, W: WheelParts<T>] self.like();
            parts: &'p W = self, powers: [usize; 2] = powers => [Vector3<T>; 2] {
                let [a, b] = [0, 1].each(|i| parts.axle_column(i, [0, 0]));
                let [a_rate, b_rate] = [0, 1].each(|i| parts.axle_column(i, powers));
                let turn = a.cross(a_rate) + a * b_rate.dot(a.cross(b));
                [parts.read_vector(VectorPart::SteeringPoint, powers), turn]
            }
        )
    }

    /// Collects the inputs of the characteristics catalogue.
    #[inline(always)]
    fn inputs(&self, constants: Constants) -> Inputs<T> {
        let wheel = |powers: [usize; 2]| {
            Wheel::of_parts(
                |part| self.vector(part, powers),
                |part| self.number(part, powers),
            )
        };
        let [_, turn] = self.by_travel();
        Inputs {
            now: wheel([0, 0]),
            rate: wheel([1, 0]),
            turn,
            design: self.design(),
            constants,
        }
    }

    /// Returns the wheel as series in a motion with these rates of travel and rack. `None` means that the rack is at
    /// rest. If coefficients of this wheel are known up to a degree, coefficients of the result are known up
    /// to one degree less.
    #[inline(always)]
    fn moving(&self, travel: T, rack: Option<T>) -> Moving<'_, Self, T> {
        Moving {
            of: self,
            travel,
            rack,
        }
    }
}

impl<T: Real> WheelParts<T> for Reading<T> {
    #[inline(always)]
    fn like(&self) -> T {
        self.wheel.centre.x.coefficient([0, 0])
    }

    #[inline(always)]
    fn read_vector(&self, part: VectorPart, powers: [usize; 2]) -> Vector3<T> {
        self.wheel
            .vector(part)
            .map(|number| number.coefficient(powers))
    }

    #[inline(always)]
    fn number(&self, part: NumberPart, powers: [usize; 2]) -> T {
        self.wheel.number(part).coefficient(powers)
    }

    #[inline(always)]
    fn column(&self, i: usize, powers: [usize; 2]) -> Vector3<T> {
        self.rotation[i].map(|number| number.coefficient(powers))
    }

    #[inline(always)]
    fn axle_column(&self, i: usize, powers: [usize; 2]) -> Vector3<T> {
        self.axle[i].map(|number| number.coefficient(powers))
    }

    #[inline(always)]
    fn design(&self) -> DesignWheel<T> {
        self.design
    }
}
