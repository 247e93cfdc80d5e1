//! What the formulas read: the wheel, its steering axis and their rates.

use super::Constants;
use crate::mechanism::Ground;
use crate::number::{Dual, Jet, Real, Vector3};

/// Wheel and steering axis in one position, or their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel<T> {
    /// Unit vector along the spin axis, outboard.
    pub spin_axis: Vector3<T>,
    /// Wheel centre.
    pub centre: Vector3<T>,
    /// A point of the steering axis.
    pub steering_point: Vector3<T>,
    /// Along the steering axis, upward; not normalised.
    pub steering_direction: Vector3<T>,
    /// Length of the spring or strut; zero where there is none.
    pub spring_length: T,
    /// From the lower end of the spring or strut to its upper end.
    pub spring: Vector3<T>,
    /// Angle of the spring's rocker from its design position.
    pub rocker_angle: T,
    /// Angle of the anti-roll bar's lever from its design position.
    pub bar_angle: T,
    /// The upper of the two knuckle points that give a strut its axis; zero where the study gives none.
    pub strut_upper: Vector3<T>,
}

/// Everything a formula may read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs<T> {
    /// The wheel in the present pose.
    pub now: Wheel<T>,
    /// Derivatives of `now` by the drive.
    pub rate: Wheel<T>,
    /// Angular velocity of the knuckle by the drive.
    pub turn: Vector3<T>,
    /// The wheel in the design position.
    pub design: Wheel<T>,
    /// Figures of the study.
    pub constants: Constants,
}

/// The slots, a line each: whether it is a vector or a number, and where it is in [`Inputs`].
macro_rules! slots {
    ($($slot:ident: $kind:ident $($place:ident).+;)*) => {
        /// A part of [`Inputs`] that a formula may read; a number is its first component. The plan computes what the slots in
        /// use need, and sensitivities are seeded slot by slot.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Slot {
            $(#[doc = concat!("`", stringify!($($place).+), "`, a ", stringify!($kind))] $slot,)*
        }

        impl Slot {
            /// Every slot.
            pub const ALL: &'static [Slot] = &[$(Slot::$slot),*];

            /// Takes this slot over from inputs of another kind of number.
            #[inline(always)]
            fn carry<T: Real, U>(self, from: &Inputs<T>, to: &mut Inputs<U>, f: impl Fn(T) -> U + Copy) {
                match self {
                    $(Slot::$slot => to.$($place).+ = slots!(@map $kind from.$($place).+, f),)*
                }
            }

            /// Makes this slot of `inputs` the independent variables, with a derivative by themselves of 1; of 0,
            /// constants again.
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
    SpinAxisRate: vector rate.spin_axis;
    CentreRate: vector rate.centre;
    SteeringDirectionRate: vector rate.steering_direction;
    SpringLengthRate: number rate.spring_length;
    BarAngleRate: number rate.bar_angle;
    Turn: vector turn;
    DesignSpinAxis: vector design.spin_axis;
    DesignCentre: vector design.centre;
}

/// Some of the slots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slots(u32);

impl Slots {
    /// Every slot.
    pub const ALL: Slots = Slots(u32::MAX);

    /// Whether a slot is among them.
    #[inline]
    pub fn contains(self, slot: Slot) -> bool {
        self.0 & (1 << slot as u32) != 0
    }

    /// Whether a quantity or its rate is among them.
    #[inline]
    pub fn contain_either(self, now: Slot, rate: Slot) -> bool {
        self.contains(now) || self.contains(rate)
    }

    /// Whether a part of the steering axis is among them.
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
    /// The most slots one formula may read.
    pub const MOST: usize = 4;

    /// Whether the slot is a velocity.
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

    /// Whether the slot may move with a rocker: of springs, rockers and bars.
    pub(crate) fn may_turn(self) -> bool {
        use Slot::{BarAngle, BarAngleRate, RockerAngle, Spring, SpringLength, SpringLengthRate};
        let of_springs = matches!(self, Spring | SpringLength | SpringLengthRate);
        of_springs || matches!(self, RockerAngle | BarAngle | BarAngleRate)
    }

    /// Whether the slot is a part of the steering axis.
    pub fn is_of_steering_axis(self) -> bool {
        Slots::default().with(&[self]).contain_steering_axis()
    }
}

impl<T: Real> Wheel<T> {
    /// A wheel in which every number is the same, for wheels that are not read.
    #[inline(always)]
    pub(super) fn filled(number: T) -> Self {
        let vector = Vector3::new(number, number, number);
        Wheel {
            spin_axis: vector,
            centre: vector,
            steering_point: vector,
            steering_direction: vector,
            spring_length: number,
            spring: vector,
            rocker_angle: number,
            bar_angle: number,
            strut_upper: vector,
        }
    }

    /// The wheel over another kind of number.
    #[inline]
    pub fn map<U>(&self, f: impl Fn(T) -> U + Copy) -> Wheel<U> {
        Wheel {
            spin_axis: self.spin_axis.map(f),
            centre: self.centre.map(f),
            steering_point: self.steering_point.map(f),
            steering_direction: self.steering_direction.map(f),
            spring_length: f(self.spring_length),
            spring: self.spring.map(f),
            rocker_angle: f(self.rocker_angle),
            bar_angle: f(self.bar_angle),
            strut_upper: self.strut_upper.map(f),
        }
    }

    /// The wheel as a series, from its derivatives.
    pub(super) fn with_rate(&self, rate: &Wheel<T>) -> Wheel<Jet<T, 2>> {
        let pair = |value: T, rate: T| Jet([value, rate]);
        Wheel {
            spin_axis: self.spin_axis.with_rate(rate.spin_axis),
            centre: self.centre.with_rate(rate.centre),
            steering_point: self.steering_point.with_rate(rate.steering_point),
            steering_direction: self.steering_direction.with_rate(rate.steering_direction),
            spring_length: pair(self.spring_length, rate.spring_length),
            spring: self.spring.with_rate(rate.spring),
            rocker_angle: pair(self.rocker_angle, rate.rocker_angle),
            bar_angle: pair(self.bar_angle, rate.bar_angle),
            strut_upper: self.strut_upper.with_rate(rate.strut_upper),
        }
    }

    /// From the wheel centre to the contact point on level ground.
    #[inline(always)]
    fn contact_lever(&self, radius: f64) -> Vector3<T> {
        Ground::level(self.spin_axis.x).contact_lever(self.spin_axis, radius)
    }

    /// The contact point C.
    #[inline(always)]
    pub(super) fn contact_point(&self, radius: f64) -> Vector3<T> {
        self.centre + self.contact_lever(radius)
    }

    /// Unit vectors in the ground plane: the heading of the wheel and the direction outboard, normal
    /// to it.
    #[inline(always)]
    pub(super) fn heading_and_outboard(&self) -> (Vector3<T>, Vector3<T>) {
        let a = self.spin_axis;
        let zero = a.x.zero();
        let scale = a.x.one() / (a.x * a.x + a.y * a.y).sqrt();
        (
            Vector3::new(a.y * scale, -(a.x * scale), zero),
            Vector3::new(a.x * scale, a.y * scale, zero),
        )
    }

    /// The point of the steering axis at this height.
    #[inline(always)]
    pub(super) fn steering_axis_at(&self, height: T) -> Vector3<T> {
        let (point, along) = (self.steering_point, self.steering_direction);
        point + along * ((height - point.z) / along.z)
    }
}

impl<T: Real> Inputs<T> {
    /// These slots over another kind of number; everything else is `nothing`, a NaN.
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

    /// The inputs over another kind of number.
    #[inline]
    pub fn map<U>(&self, f: impl Fn(T) -> U + Copy) -> Inputs<U> {
        Inputs {
            now: self.now.map(f),
            rate: self.rate.map(f),
            turn: self.turn.map(f),
            design: self.design.map(f),
            constants: self.constants,
        }
    }

    /// The contact point in the present pose.
    #[inline(always)]
    pub(super) fn contact_point(&self) -> Vector3<T> {
        self.now.contact_point(self.constants.wheel_radius)
    }

    /// Velocity of the knuckle-fixed point that is at the contact point now: the wheel is taken as
    /// locked to the knuckle.
    #[inline(always)]
    pub(super) fn contact_velocity(&self) -> Vector3<T> {
        let lever = self.now.contact_lever(self.constants.wheel_radius);
        self.rate.centre + self.turn.cross(lever)
    }

    /// Velocity of the point of the tyre that is at the contact point now, where the carrier takes this part of the
    /// torque about the spin axis and a shaft the rest: W' + (w - (1 - part) (w.a) a) x (C - W).
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

    /// A wheel in a pose with nothing special about it.
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
        };
        Inputs {
            now: wheel(0.01),
            rate: wheel(0.3),
            turn: Vector3::new(5e-4, -1e-4, 8e-5),
            design: wheel(0.0),
            constants: Constants {
                size: 800.0,
                wheel_radius: 300.0,
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
