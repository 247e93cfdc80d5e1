//! Springs between the rockers of both wheels: heave spring, T-bar and heave bar.
//!
//! l is the distance between the points `heave_spring` of both rockers, l0 its value in the design position. rho_l and
//! rho_r are the angles of the rockers. Each spring has a rate k. In the design position, the heave spring has the force F
//! and the heave bar the torque M. The energies are
//!
//! ```text
//! heave spring    F s + k s^2/2                  s = l0 - l                                                     (1)
//! T-bar           k (rho_l - rho_r)^2/2                                                                         (2)
//! heave bar       M r + k r^2/2                  r = rho_l + rho_r                                              (3)
//! ```
//!
//! A monoshock is a heave spring or a heave bar without springs at the wheels.

use super::reading::WheelParts;
use crate::characteristics::{NumberPart, VectorPart};
use crate::number::{Each, Real, Vector3};

/// A linear force law with a preload in the design position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preloaded<T = f64> {
    /// Force or torque in the design position.
    pub load: T,
    /// Force per shortening, or torque per angle.
    pub rate: T,
}

/// Laws of the springs between the rockers. `None` for springs that do not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RockerSprings<T = f64> {
    /// Force of the heave spring as a function of its shortening.
    pub heave_spring: Option<Preloaded<T>>,
    /// Rate of the T-bar: torque per difference of the rocker angles.
    pub t_bar: Option<T>,
    /// Torque of the heave bar as a function of the sum of the rocker angles.
    pub heave_bar: Option<Preloaded<T>>,
}

/// Motion of one wheel's rocker with the wheel's travel, in the frame of its side. Numbers that do not exist are NaN.
#[derive(Clone, Copy, Debug)]
pub struct RockerMotion<T> {
    /// End point of the heave spring, and its rate with respect to the wheel's travel.
    pub end: [Vector3<T>; 2],
    /// End point of the heave spring in the design position.
    pub design_end: Vector3<T>,
    /// Angle of the rocker, and its rate with respect to the wheel's travel.
    pub angle: [T; 2],
}

/// Forces of the springs between the rockers. Forces of springs that do not exist are NaN.
#[derive(Clone, Copy, Debug)]
pub struct RockerForces<T> {
    /// Force of the heave spring, positive in compression.
    pub heave_spring: T,
    /// Length of the heave spring.
    pub heave_spring_length: T,
    /// Shortening of the heave spring from the design position.
    pub heave_spring_travel: T,
    /// Torque of the T-bar that acts on the left rocker, against the direction of its angle.
    pub t_bar: T,
    /// Torque of the heave bar that acts on both rockers, against the direction of their angles.
    pub heave_bar: T,
    /// Derivatives of the energy with respect to the travels of the left and the right wheel.
    pub work: [T; 2],
    /// Energy of heave spring, T-bar and heave bar, relative to the design position: equations (1) to (3).
    pub energy: T,
}

/// Vector from the right wheel's end of the heave spring to the left wheel's end, in the frame of the left wheel. Each
/// argument is in the frame of its side.
#[inline(always)]
pub(super) fn between<T: Real>(left: Vector3<T>, right: Vector3<T>) -> Vector3<T> {
    Vector3::new(left.x - right.x, left.y + right.y, left.z - right.z)
}

impl RockerSprings {
    /// Returns true if a spring between the rockers carries a part of the car's weight.
    pub fn carry(&self) -> bool {
        self.heave_spring.is_some() || self.heave_bar.is_some()
    }

    /// Returns true if the axle has no spring between its rockers.
    pub fn are_none(&self) -> bool {
        *self == RockerSprings::default()
    }
}

impl<T: Copy> Preloaded<T> {
    #[inline(always)]
    fn map<U: Copy>(self, f: impl Fn(T) -> U) -> Preloaded<U> {
        Preloaded {
            load: f(self.load),
            rate: f(self.rate),
        }
    }
}

impl<T: Copy> RockerSprings<T> {
    /// Converts the laws to another number type.
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> RockerSprings<U> {
        RockerSprings {
            heave_spring: self.heave_spring.map(|law| law.map(f)),
            t_bar: self.t_bar.map(f),
            heave_bar: self.heave_bar.map(|law| law.map(f)),
        }
    }
}

impl<T: Real> RockerSprings<T> {
    /// Forces of the springs between the rockers of left and right wheel.
    #[inline(always)]
    pub fn forces(&self, [left, right]: &[RockerMotion<T>; 2]) -> RockerForces<T> {
        let mut forces = RockerForces::none(left.angle[0]);
        if let Some(law) = self.heave_spring {
            let apart = between(left.end[0], right.end[0]);
            let length = apart.norm();
            let along = apart * (length.one() / length);
            let shortened = between(left.design_end, right.design_end).norm() - length;
            let force = law.load + law.rate * shortened;
            // Rates of the length with respect to both travels. The right wheel's frame is a mirror image.
            let rates = [
                along.dot(left.end[1]),
                Vector3::new(-along.x, along.y, -along.z).dot(right.end[1]),
            ];
            forces.heave_spring = force;
            forces.heave_spring_length = length;
            forces.heave_spring_travel = shortened;
            forces.work = rates.each(|rate| -(force * rate));
            forces.energy = shortened * (law.load + (law.rate * shortened).scaled(0.5));
        }
        if let Some(rate) = self.t_bar {
            let difference = left.angle[0] - right.angle[0];
            let torque = rate * difference;
            forces.t_bar = torque;
            forces.work[0] = forces.work[0] + torque * left.angle[1];
            forces.work[1] = forces.work[1] - torque * right.angle[1];
            forces.energy = forces.energy + (torque * difference).scaled(0.5);
        }
        if let Some(law) = self.heave_bar {
            let sum = left.angle[0] + right.angle[0];
            let torque = law.load + law.rate * sum;
            forces.heave_bar = torque;
            forces.work[0] = forces.work[0] + torque * left.angle[1];
            forces.work[1] = forces.work[1] + torque * right.angle[1];
            forces.energy = forces.energy + sum * (law.load + (law.rate * sum).scaled(0.5));
        }
        forces
    }
}

impl<T: Real> RockerForces<T> {
    /// Forces of an axle without springs between its rockers. Constants get the number type and the count of coefficients of
    /// `like`.
    #[inline(always)]
    pub fn none(like: T) -> Self {
        let none = like.constant(f64::NAN);
        RockerForces {
            heave_spring: none,
            heave_spring_length: none,
            heave_spring_travel: none,
            t_bar: none,
            heave_bar: none,
            work: [like.zero(); 2],
            energy: like.zero(),
        }
    }
}

impl<T: Copy> RockerMotion<T> {
    /// Converts all numbers to another number type.
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> RockerMotion<U> {
        RockerMotion {
            end: self.end.each(|end| end.map(f)),
            design_end: self.design_end.map(f),
            angle: self.angle.each(f),
        }
    }
}

impl<T: Real> RockerMotion<T> {
    /// Reads the motion of a wheel's rocker.
    pub fn read(wheel: &impl WheelParts<T>) -> Self {
        let (end, angle) = (VectorPart::HeaveSpring, NumberPart::RockerAngle);
        RockerMotion {
            end: [[0, 0], [1, 0]].each(|powers| wheel.read_vector(end, powers)),
            design_end: wheel.design().heave_spring,
            angle: [[0, 0], [1, 0]].each(|powers| wheel.number(angle, powers)),
        }
    }
}
