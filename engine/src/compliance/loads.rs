//! Loads on the wheel, with fixed directions. The wheel is locked to the carrier.
//!
//! W is the wheel centre, C the lowest point of the disc, and T the horizontal heading of the wheel. Forces act at C, at C -
//! trail T and at W, and a moment acts on the carrier. C and T depend on the spin axis, so a force at C or C - trail T has
//! a tangent. For side forces this tangent is not symmetric, because their work along a closed path is not zero.

use super::algebra::Placed;
use super::limb::Sum;
use crate::characteristics::Wheel;
use crate::mechanism::Ground;
use crate::number::{Dual, Matrix3, Real, Valued, Vector3, outlined};

/// Loads on the wheel, in the kernel's frame of a left wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelLoads<T = f64> {
    /// Force at the contact point.
    pub contact: Vector3<T>,
    /// Force to the inside of the car. It acts at C - `trail` T.
    pub side: T,
    /// Distance of the side force behind the contact point.
    pub trail: T,
    /// Force at the wheel centre.
    pub centre: Vector3<T>,
    /// Moment on the carrier, with a fixed direction.
    pub moment: Vector3<T>,
}

impl<T: Real> WheelLoads<T> {
    /// Zero load, with the number type of `like`.
    #[inline(always)]
    pub fn none(like: T) -> Self {
        let zero = like.zero();
        let none = Vector3::new(zero, zero, zero);
        WheelLoads {
            contact: none,
            side: zero,
            trail: zero,
            centre: none,
            moment: none,
        }
    }

    /// Converts the load to another number type.
    #[inline(always)]
    pub fn map<U: Copy>(&self, f: impl Fn(T) -> U + Copy) -> WheelLoads<U> {
        WheelLoads {
            contact: self.contact.map(f),
            side: f(self.side),
            trail: f(self.trail),
            centre: self.centre.map(f),
            moment: self.moment.map(f),
        }
    }

    /// Returns the load at a fraction `share` of the way from this load to the load `to`, with the trail of `to`.
    pub(super) fn towards(&self, to: &Self, share: T) -> Self {
        let from = self;
        let between = |a: Vector3<T>, b: Vector3<T>| a + (b - a) * share;
        WheelLoads {
            contact: between(from.contact, to.contact),
            side: from.side + (to.side - from.side) * share,
            trail: to.trail,
            centre: between(from.centre, to.centre),
            moment: between(from.moment, to.moment),
        }
    }

    /// Returns this load plus a multiple of another load, with the trail of the other load. If both have a side force, their
    /// trails must be equal.
    #[inline(always)]
    pub fn plus(&self, other: &Self, factor: T) -> Self {
        WheelLoads {
            contact: self.contact + other.contact * factor,
            side: self.side + other.side * factor,
            trail: other.trail,
            centre: self.centre + other.centre * factor,
            moment: self.moment + other.moment * factor,
        }
    }
}

/// Wheel and its axis in the design position.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelPart<T> {
    /// Vector from the carrier's reference point to the wheel centre.
    pub(super) centre: Vector3<T>,
    /// Unit vector along the spin axis, outboard.
    pub(super) spin_axis: Vector3<T>,
    pub(super) radius: f64,
}

/// Force and moment on the carrier about its reference point.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadWrench<T> {
    pub(super) force: Vector3<T>,
    pub(super) moment: Vector3<T>,
}

impl<T: Valued> LoadWrench<T> {
    /// Components of force and moment.
    #[inline(always)]
    pub(super) fn to_array(self) -> [T; 6] {
        let (f, m) = (self.force, self.moment);
        [f.x, f.y, f.z, m.x, m.y, m.z]
    }
}

/// Returns a vector that rotates with the carrier, with its derivatives with respect to a small rotation.
#[inline(always)]
fn following<T: Real>(turn: Vector3<Dual<T, 3>>, v: Vector3<T>) -> Vector3<Dual<T, 3>> {
    let v = v.map(Dual::constant);
    v + turn.cross(v)
}

/// Returns the force and moment of a load. `axis` is the spin axis. `centre` is the vector from the carrier's reference point to
/// the wheel centre. The moment is about the reference point.
#[inline(always)]
fn wrench<T: Real>(
    loads: &WheelLoads<T>,
    axis: Vector3<T>,
    centre: Vector3<T>,
    radius: f64,
) -> LoadWrench<T> {
    let contact = centre + Ground::level(axis.x).contact_lever(axis, radius);
    let (heading, _) = Wheel::<T>::heading_and_outboard_of(axis);
    let zero = axis.x.zero();
    let side = Vector3::new(zero, -loads.side, zero);
    let side_at = contact - heading * loads.trail;
    LoadWrench {
        force: loads.contact + loads.centre + side,
        moment: contact.cross(loads.contact)
            + centre.cross(loads.centre)
            + side_at.cross(side)
            + loads.moment,
    }
}

impl<T: Valued> WheelPart<T> {
    /// Force and moment of a load on the carrier, about the carrier's reference point.
    #[inline(always)]
    pub(super) fn wrench(&self, carrier: &Placed<T>, loads: &WheelLoads<T>) -> LoadWrench<T> {
        let axis = carrier.lever(self.spin_axis);
        wrench(loads, axis, carrier.lever(self.centre), self.radius)
    }

    /// Subtracts the force and moment of a load, and their tangent, from the sum.
    #[inline(always)]
    pub(super) fn subtract(&self, carrier: &Placed<T>, loads: &WheelLoads<T>, sum: &mut Sum<T>) {
        outlined!(
            [T: Valued] loads.side;
            wheel: &'p WheelPart<T> = self, carrier: &'p Placed<T> = carrier, loads: &'p WheelLoads<T> = loads,
            sum: &'p mut Sum<T> = sum => () {
                wheel.subtract_inline(carrier, loads, sum);
            }
        );
    }

    #[inline(always)]
    fn subtract_inline(&self, carrier: &Placed<T>, loads: &WheelLoads<T>, sum: &mut Sum<T>) {
        let turn = Dual::inputs(carrier.shift.zero());
        let loads = loads.map(Dual::constant);
        let axis = following(turn, carrier.lever(self.spin_axis));
        let centre = following(turn, carrier.lever(self.centre));
        let found = wrench(&loads, axis, centre, self.radius);
        let force = found.force.map(|c| -c.value);
        let Vector3 { x, y, z } = found.moment;
        sum.add_force(force, force.zero());
        let mut columns = [force; 3];
        for (k, column) in columns.iter_mut().enumerate() {
            *column = Vector3::new(-x.partials[k], -y.partials[k], -z.partials[k]);
        }
        let tangent = Matrix3 { columns };
        sum.add_moment(Vector3::new(-x.value, -y.value, -z.value), &tangent);
    }
}
