//! Inputs of formulas: the wheel, its steering axis, and their derivatives with respect to the drive coordinate.

use super::Constants;
use crate::mechanism::Ground;
use crate::number::{Dual, Jet, Real, Vector3};

/// Defines the parts of a wheel, one per line. The result is [`Wheel`] with its fields, the list of their names, and
/// the slots that read each field.
macro_rules! wheel {
    (
        vectors { $($(#[$about_vector:meta])* $vector:ident: $Vector:ident [$($of_vector:ident),+];)* }
        numbers { $($(#[$about_number:meta])* $number:ident: $Number:ident [$($of_number:ident),+];)* }
    ) => {
        /// Wheel and steering axis in one pose, or their derivatives. A part that is not read is NaN.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Wheel<T> {
            $($(#[$about_vector])* pub $vector: Vector3<T>,)*
            $($(#[$about_number])* pub $number: T,)*
        }

        /// Part of a wheel that is a vector.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum VectorPart {
            $($(#[$about_vector])* $Vector,)*
        }

        /// Part of a wheel that is a number.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum NumberPart {
            $($(#[$about_number])* $Number,)*
        }

        impl VectorPart {
            /// All parts that are vectors, in the order of the fields.
            pub(crate) const ALL: &'static [VectorPart] = &[$(VectorPart::$Vector),*];

            /// Slots that read the part: the part itself, then its rate if any formula reads it.
            pub(crate) fn slots(self) -> &'static [Slot] {
                match self {
                    $(VectorPart::$Vector => &[$(Slot::$of_vector),+],)*
                }
            }
        }

        impl NumberPart {
            /// All parts that are numbers, in the order of the fields.
            pub(crate) const ALL: &'static [NumberPart] = &[$(NumberPart::$Number),*];

            /// Slots that read the part: the part itself, then its rate if any formula reads it.
            pub(crate) fn slots(self) -> &'static [Slot] {
                match self {
                    $(NumberPart::$Number => &[$(Slot::$of_number),+],)*
                }
            }
        }

        impl<T> Wheel<T> {
            /// Makes the wheel. The two functions return its vectors and its numbers.
            #[inline(always)]
            pub(crate) fn of_parts(
                vector: impl Fn(VectorPart) -> Vector3<T>,
                number: impl Fn(NumberPart) -> T,
            ) -> Self {
                Wheel {
                    $($vector: vector(VectorPart::$Vector),)*
                    $($number: number(NumberPart::$Number),)*
                }
            }
        }

        impl<T: Copy> Wheel<T> {
            /// Part that is a vector.
            #[inline(always)]
            pub(crate) fn vector(&self, part: VectorPart) -> Vector3<T> {
                match part {
                    $(VectorPart::$Vector => self.$vector,)*
                }
            }

            /// Part that is a number.
            #[inline(always)]
            pub(crate) fn number(&self, part: NumberPart) -> T {
                match part {
                    $(NumberPart::$Number => self.$number,)*
                }
            }

            /// Converts the wheel to another number type. `f` gets vectors first, in the order of the fields.
            #[inline(always)]
            pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Wheel<U> {
                Wheel {
                    $($vector: self.$vector.map(f),)*
                    $($number: f(self.$number),)*
                }
            }

            /// Combines each number with the corresponding number of another wheel.
            #[inline(always)]
            pub(crate) fn zip<U: Copy, V: Copy>(
                &self,
                other: &Wheel<U>,
                f: impl Fn(T, U) -> V + Copy,
            ) -> Wheel<V> {
                Wheel {
                    $($vector: self.$vector.zip(other.$vector, f),)*
                    $($number: f(self.$number, other.$number),)*
                }
            }
        }
    };
}

wheel! {
    vectors {
        /// Wheel centre.
        centre: Centre [Centre, CentreRate];
        /// Unit vector along the spin axis, positive outboard.
        spin_axis: SpinAxis [SpinAxis, SpinAxisRate];
        /// A point of the steering axis.
        steering_point: SteeringPoint [SteeringPoint];
        /// Upward vector along the steering axis, of any length.
        steering_direction: SteeringDirection [SteeringDirection, SteeringDirectionRate];
        /// Vector from the lower end of the spring or strut to its upper end.
        spring: Spring [Spring];
        /// Upper of the two knuckle points that give a strut its axis.
        strut_upper: StrutUpper [StrutUpper];
        /// End of the heave spring on the rocker.
        heave_spring: HeaveSpring [HeaveSpring];
    }
    numbers {
        /// Length of the spring or strut.
        spring_length: SpringLength [SpringLength, SpringLengthRate];
        /// Angle of the spring's rocker from its design position.
        rocker_angle: RockerAngle [RockerAngle];
        /// Angle of the anti-roll bar's lever from its design position.
        bar_angle: BarAngle [BarAngle, BarAngleRate];
    }
}

/// Wheel in the design position. A part that is not read is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DesignWheel<T> {
    /// Unit vector along the spin axis, positive outboard.
    pub spin_axis: Vector3<T>,
    /// Wheel centre.
    pub centre: Vector3<T>,
    /// Length of the spring or strut.
    pub spring_length: T,
    /// End of the heave spring on the rocker.
    pub heave_spring: Vector3<T>,
}

impl<T: Copy> DesignWheel<T> {
    /// Makes a design wheel in which every number equals `number`.
    #[inline(always)]
    pub(crate) fn filled(number: T) -> Self {
        let vector = Vector3::new(number, number, number);
        DesignWheel {
            spin_axis: vector,
            centre: vector,
            spring_length: number,
            heave_spring: vector,
        }
    }

    /// Contact point on level ground.
    #[inline(always)]
    pub(super) fn contact_point(&self, radius: f64) -> Vector3<T>
    where
        T: Real,
    {
        self.centre + Ground::level(self.spin_axis.x).contact_lever(self.spin_axis, radius)
    }

    /// Converts the design wheel to another number type. `f` gets the numbers in the order of the fields.
    #[inline(always)]
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> DesignWheel<U> {
        DesignWheel {
            spin_axis: self.spin_axis.map(f),
            centre: self.centre.map(f),
            spring_length: f(self.spring_length),
            heave_spring: self.heave_spring.map(f),
        }
    }
}

/// All possible inputs of a formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs<T> {
    /// Wheel in the present pose.
    pub now: Wheel<T>,
    /// Derivatives of `now` with respect to the drive coordinate.
    pub rate: Wheel<T>,
    /// Angular velocity of the knuckle with respect to the drive coordinate.
    pub turn: Vector3<T>,
    /// Wheel in the design position.
    pub design: DesignWheel<T>,
    /// Constants of the study, such as the wheel's radius.
    pub constants: Constants,
}

/// Defines the slots, one per line: kind (vector or number), and field in [`Inputs`].
macro_rules! slots {
    ($($slot:ident: $kind:ident $($place:ident).+;)*) => {
        /// Input of a formula: one vector or one number of [`Inputs`]. The derivative with respect to a slot is stored
        /// as a vector. For a number, only the first component is used. The plan computes only the slots that formulas
        /// read. Each slot has its own seed in the computation of sensitivities.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Slot {
            $(#[doc = concat!("`", stringify!($($place).+), "`, a ", stringify!($kind))] $slot,)*
        }

        impl Slot {
            /// All slots (inputs of formulas).
            pub const ALL: &'static [Slot] = &[$(Slot::$slot),*];

            /// Copies this input from `from` to `to`, converted by `f`.
            #[inline(always)]
            fn carry<T: Real, U: Copy>(self, from: &Inputs<T>, to: &mut Inputs<U>, f: impl Fn(T) -> U + Copy) {
                match self {
                    $(Slot::$slot => to.$($place).+ = slots!(@map $kind from.$($place).+, f),)*
                }
            }

            /// Sets the derivative of this slot of `inputs` with respect to itself to `by_itself`. With 1 the slot becomes
            /// the independent variable, with 0 it becomes constant again.
            #[inline]
            pub(super) fn seed<T: Real>(self, inputs: &mut Inputs<Dual<T, 3>>, by_itself: T) {
                match self {
                    $(Slot::$slot => slots!(@seed $kind inputs.$($place).+, by_itself),)*
                }
            }
        }
    };
    (@map vector $of:expr, $f:ident) => { $of.map($f) };
    (@map number $of:expr, $f:ident) => { $f($of) };
    (@seed vector $of:expr, $by_itself:ident) => {{
        let vector = &mut $of;
        vector.x.partials[0] = $by_itself;
        vector.y.partials[1] = $by_itself;
        vector.z.partials[2] = $by_itself;
    }};
    (@seed number $of:expr, $by_itself:ident) => { $of.partials[0] = $by_itself };
}

slots! {
    SpinAxis: vector now.spin_axis;
    Centre: vector now.centre;
    SteeringPoint: vector now.steering_point;
    SteeringDirection: vector now.steering_direction;
    SpringLength: number now.spring_length;
    Spring: vector now.spring;
    RockerAngle: number now.rocker_angle;
    BarAngle: number now.bar_angle;
    StrutUpper: vector now.strut_upper;
    HeaveSpring: vector now.heave_spring;
    SpinAxisRate: vector rate.spin_axis;
    CentreRate: vector rate.centre;
    SteeringDirectionRate: vector rate.steering_direction;
    SpringLengthRate: number rate.spring_length;
    BarAngleRate: number rate.bar_angle;
    Turn: vector turn;
    DesignSpinAxis: vector design.spin_axis;
    DesignCentre: vector design.centre;
    DesignSpringLength: number design.spring_length;
    DesignHeaveSpring: vector design.heave_spring;
}

/// A set of slots (inputs of formulas).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slots(u32);

impl Slots {
    /// The set of all slots.
    pub const ALL: Slots = Slots(u32::MAX);

    /// Returns true if the set contains a slot (an input of a formula).
    #[inline]
    pub fn contains(self, slot: Slot) -> bool {
        self.0 & (1 << slot as u32) != 0
    }

    /// Returns true if the set contains one of these slots.
    #[inline]
    pub(crate) fn contain_any(self, slots: &[Slot]) -> bool {
        self.0 & Slots::default().with(slots).0 != 0
    }

    /// Returns true if the set contains the slot `now` of a quantity, or the slot `rate` of its derivative.
    #[inline]
    pub fn contain_either(self, now: Slot, rate: Slot) -> bool {
        self.contains(now) || self.contains(rate)
    }

    /// Returns true if the set contains a part of the steering axis.
    #[inline]
    pub fn contain_steering_axis(self) -> bool {
        const PARTS: u32 = 1 << Slot::SteeringPoint as u32
            | 1 << Slot::SteeringDirection as u32
            | 1 << Slot::SteeringDirectionRate as u32;
        self.0 & PARTS != 0
    }

    /// All slots of several lists.
    pub fn of<'s>(read: impl IntoIterator<Item = &'s [Slot]>) -> Self {
        read.into_iter().fold(Slots::default(), Slots::with)
    }

    /// The slots of both sets.
    pub fn and(self, other: Slots) -> Self {
        Slots(self.0 | other.0)
    }

    /// The set with these slots added.
    pub fn with(self, slots: &[Slot]) -> Self {
        Slots(slots.iter().fold(self.0, |set, s| set | 1 << *s as u32))
    }
}

impl Slot {
    /// Largest number of slots that one formula may read.
    pub const MOST: usize = 4;

    /// Returns true if the slot (an input of a formula) is a velocity.
    #[inline]
    pub const fn is_rate(self) -> bool {
        matches!(
            self,
            Slot::SpinAxisRate
                | Slot::CentreRate
                | Slot::SteeringDirectionRate
                | Slot::SpringLengthRate
                | Slot::BarAngleRate
                | Slot::Turn
        )
    }

    /// Returns true for the slots of springs, rockers and bars. They may move with a rocker that carries no wheel.
    pub(crate) fn may_turn(self) -> bool {
        use Slot::{BarAngle, BarAngleRate, HeaveSpring, RockerAngle};
        use Slot::{Spring, SpringLength, SpringLengthRate};
        let of_springs = matches!(self, Spring | SpringLength | SpringLengthRate | HeaveSpring);
        of_springs || matches!(self, RockerAngle | BarAngle | BarAngleRate)
    }

    /// Returns true if the slot is a part of the steering axis.
    pub fn is_of_steering_axis(self) -> bool {
        Slots::default().with(&[self]).contain_steering_axis()
    }
}

impl<T: Real> Wheel<T> {
    /// Makes a wheel in which every number has the same value.
    #[inline(always)]
    pub(super) fn filled(number: T) -> Self {
        let vector = Vector3::new(number, number, number);
        Wheel::of_parts(|_| vector, |_| number)
    }

    /// The wheel as a first-order series, from its value and its derivatives.
    #[inline(always)]
    pub(super) fn with_rate(&self, rate: &Wheel<T>) -> Wheel<Jet<T, 2>> {
        self.zip(rate, |value, rate| Jet([value, rate]))
    }

    /// Vector from the wheel centre to the contact point on level ground.
    #[inline(always)]
    fn contact_lever(&self, radius: f64) -> Vector3<T> {
        Ground::level(self.spin_axis.x).contact_lever(self.spin_axis, radius)
    }

    /// Contact point C of a wheel with this radius on level ground.
    #[inline(always)]
    pub(super) fn contact_point(&self, radius: f64) -> Vector3<T> {
        self.centre + self.contact_lever(radius)
    }

    /// Unit vectors in the ground plane: the heading of the wheel, and the outboard direction normal to it.
    #[inline(always)]
    pub(super) fn heading_and_outboard(&self) -> (Vector3<T>, Vector3<T>) {
        Wheel::heading_and_outboard_of(self.spin_axis)
    }

    /// Heading and outboard direction in the ground plane, for a wheel with this spin axis.
    #[inline(always)]
    pub(crate) fn heading_and_outboard_of(a: Vector3<T>) -> (Vector3<T>, Vector3<T>) {
        let zero = a.x.zero();
        let scale = a.x.one() / (a.x * a.x + a.y * a.y).sqrt();
        (
            Vector3::new(a.y * scale, -(a.x * scale), zero),
            Vector3::new(a.x * scale, a.y * scale, zero),
        )
    }

    /// Point of the steering axis at this height.
    #[inline(always)]
    pub(super) fn steering_axis_at(&self, height: T) -> Vector3<T> {
        let (point, along) = (self.steering_point, self.steering_direction);
        point + along * ((height - point.z) / along.z)
    }
}

impl<T: Real> Inputs<T> {
    /// Converts only these slots to another number type. Every other number is `nothing`, which is NaN.
    #[inline(always)]
    pub(super) fn only<U: Real>(
        &self,
        slots: &[Slot],
        nothing: U,
        f: impl Fn(T) -> U + Copy,
    ) -> Inputs<U> {
        let mut inputs = Inputs::unknown(nothing, self.constants);
        for slot in slots {
            slot.carry(self, &mut inputs, f);
        }
        inputs
    }

    /// Converts the inputs to another number type.
    #[inline]
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> Inputs<U> {
        Inputs {
            now: self.now.map(f),
            rate: self.rate.map(f),
            turn: self.turn.map(f),
            design: self.design.map(f),
            constants: self.constants,
        }
    }

    /// Contact point in the present pose.
    #[inline(always)]
    pub(super) fn contact_point(&self) -> Vector3<T> {
        self.now.contact_point(self.constants.wheel_radius)
    }

    /// Velocity of the knuckle-fixed point that currently coincides with the contact point. The wheel is treated as locked
    /// to the knuckle.
    #[inline(always)]
    pub(super) fn contact_velocity(&self) -> Vector3<T> {
        let lever = self.now.contact_lever(self.constants.wheel_radius);
        self.rate.centre + self.turn.cross(lever)
    }

    /// Velocity of the point of the tyre at the contact point. The carrier takes the fraction `by_carrier` of the torque
    /// about the spin axis, and a shaft takes the rest: W' + (w - (1 - by_carrier) (w.a) a) x (C - W).
    #[inline(always)]
    pub(super) fn tyre_velocity(&self, by_carrier: f64) -> Vector3<T> {
        let (axis, lever) = (
            self.now.spin_axis,
            self.now.contact_lever(self.constants.wheel_radius),
        );
        let spin = self.turn.dot(axis).scaled(1.0 - by_carrier);
        self.rate.centre + (self.turn - axis * spin).cross(lever)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A wheel in a generic pose.
    pub(crate) fn sample() -> Inputs<f64> {
        let wheel = |t: f64| Wheel {
            spin_axis: Vector3::new(0.02 + t, 1.0, 0.03 - t).normalised(),
            centre: Vector3::new(3.0 + t, 760.0 - t, 300.0 + 2.0 * t),
            steering_point: Vector3::new(5.0, 705.0 + t, 190.0),
            steering_direction: Vector3::new(-40.0 - 2.0 * t, -130.0 + t, 660.0 + 3.0 * t),
            spring_length: 480.0 - t,
            spring: Vector3::new(-20.0 + t, -60.0 - t, 475.0 - 2.0 * t),
            rocker_angle: 0.2 + t,
            bar_angle: -0.1 + 0.5 * t,
            strut_upper: Vector3::new(-17.0, 611.0 + t, 490.0 - t),
            heave_spring: Vector3::new(4.0 + t, 120.0 - t, 520.0 + t),
        };
        Inputs {
            now: wheel(0.01),
            rate: wheel(0.3),
            turn: Vector3::new(5e-4, -1e-4, 8e-5),
            design: DesignWheel {
                spin_axis: wheel(0.0).spin_axis,
                centre: wheel(0.0).centre,
                spring_length: wheel(0.0).spring_length,
                heave_spring: wheel(0.0).heave_spring,
            },
            constants: Constants {
                size: 800.0,
                wheel_radius: 300.0,
                rim_diameter: 430.0,
                wheelbase: 2600.0,
                cg_height: 500.0,
                is_front: true,
                brake_share: 0.65,
                drive_share: 0.4,
                brake_torque_by_carrier: 1.0,
                drive_torque_by_carrier: 0.0,
            },
        }
    }
}
