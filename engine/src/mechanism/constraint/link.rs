//! A rod between two ball joints.
//!
//! d is the vector from the inner to the outer joint, d0 in the design position. o is the knuckle's origin, and l = outer -
//! o the lever of the outer joint:
//!
//! ```text
//! F  = (d.d - d0.d0)/(2 |d0|)                                               (1)
//! dF = d.(d outer - d inner)/|d0| - d0.(d outer0 - d inner0)/|d0|           (2)
//! f  = d/|d0|,   m = l x d/|d0|,   q = -d_y/|d0| if the rack carries inner  (3)
//! ```
//!
//! F has no square root, so it is quadratic in the pose and smooth everywhere. The factor 1/|d0| only scales the row to a
//! length. Equation (2) treats the factor as constant, which is exact where F = 0.
//!
//! Rates along the motion (v, w), from d' = v + w x l and l' = w x l:
//!
//! ```text
//! f' = d'/|d0|,   m' = (l' x d + l x d')/|d0|,   q' = -d'_y/|d0|            (4)
//! ```
//!
//! An inner joint may move sideways in the opposite direction to a point c of the knuckle (the mount of a twist beam). Then
//! d' has the additional term c'_y along y. The row has the additional wrench of h = d_y/|d0| y at c, whose lever is k:
//!
//! ```text
//! f = h,   m = k x h,   f' = h',   m' = k' x h + k x h'                     (5)
//! ```

use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{Body, PointId};
use crate::number::{Real, Vector3, outlined};

/// Fixed length of a rod: the constants of equation (1) of this file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RodLength<T> {
    /// Number d0.d0/2, half the squared length in the design position.
    half_squared: T,
    /// Inverse length 1/|d0| of the rod.
    pub(super) scale: T,
}

impl<T: Real> RodLength<T> {
    /// Distance between two points of a design.
    #[inline(always)]
    pub(super) fn of_design(inner: PointId, outer: PointId, design: &[Vector3<T>]) -> Self {
        RodLength::of_squared((design[outer.0] - design[inner.0]).norm_squared())
    }

    /// Makes the constants from the square of the rod's length. A built rod's length does not follow from the positions of
    /// its ends.
    #[inline(always)]
    pub(super) fn of_squared(squared: T) -> Self {
        RodLength {
            half_squared: squared.scaled(0.5),
            scale: squared.one() / squared.sqrt(),
        }
    }

    /// Residual of the constraint, as a length: F in equation (1) of this file.
    #[inline(always)]
    pub(super) fn residual(&self, d: Vector3<T>) -> T {
        (d.norm_squared().scaled(0.5) - self.half_squared) * self.scale
    }
}

/// Adds `weight` times the derivatives with respect to the design positions of both ends: the term -d0.(d outer0 - d
/// inner0) of equation (2).
#[inline(always)]
pub(super) fn push_hardpoints<T: Real>(
    [inner, outer]: [PointId; 2],
    at: &Configuration<T>,
    weight: T,
    sink: &mut impl Sink<T>,
) {
    let designed = (at.designed(outer) - at.designed(inner)) * weight;
    sink.hardpoint(outer, -designed);
    sink.hardpoint(inner, designed);
}

/// Equation of one rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<T> {
    pub inner: PointId,
    pub outer: PointId,
    pub length: RodLength<T>,
}

impl<T: Real> Link<T> {
    /// Residual of the constraint, as a length: F in equation (1) of this file.
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        self.length
            .residual(at.carried(self.outer) - at.grounded(self.inner))
    }

    /// Adds the derivatives of the residual, equation (2) of this file, times `weight` to the sink.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let (inner, outer) = (self.inner, self.outer);
        let weight = weight * self.length.scale;
        let now = (at.carried(outer) - at.grounded(inner)) * weight;
        at.push_carried(outer, now, sink);
        at.push_grounded(inner, -now, sink);
        push_hardpoints([inner, outer], at, weight, sink);
    }

    /// Rates of the constraint's force and moment along a motion of the knuckle, equation (4) of this file.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        let lever = at.pose.rotation.apply(at.designed_lever(self.outer));
        let d = (at.pose.origin + lever - at.grounded(self.inner)) * self.length.scale;
        let lever_rate = along.turn.cross(lever);
        let d_rate = (along.shift + lever_rate) * self.length.scale;
        if let Body::Opposite(other) = at.mechanism.body(self.inner) {
            return self.opposite_rate(at, along, other, [lever, lever_rate, d, d_rate]);
        }
        Wrench {
            force: d_rate,
            moment: lever_rate.cross(d) + lever.cross(d_rate),
            rack: match at.mechanism.body(self.inner) {
                Body::Rack => -d_rate.y,
                _ => d_rate.y.zero(),
            },
        }
    }

    /// Rates of force and moment by equations (4) and (5), for a mount that moves opposite to the knuckle. A separate function,
    /// because it is rarely used.
    #[inline(always)]
    fn opposite_rate(
        &self,
        at: &Configuration<T>,
        along: &Twist<T>,
        other: PointId,
        moving: [Vector3<T>; 4],
    ) -> Wrench<T> {
        outlined!(
            [T: Real] at.rack;
            row: &'p Link<T> = self, at: &'p Configuration<'p, T> = at, along: &'p Twist<T> = along,
            other: PointId = other, moving: [Vector3<T>; 4] = moving
                => Wrench<T> { row.opposite_rate_inline(at, along, other, moving) }
        )
    }

    #[inline(always)]
    fn opposite_rate_inline(
        &self,
        at: &Configuration<T>,
        along: &Twist<T>,
        other: PointId,
        [lever, lever_rate, d, d_rate]: [Vector3<T>; 4],
    ) -> Wrench<T> {
        let zero = d.x.zero();
        let across = |y: T| Vector3::new(zero, y, zero);
        let arm = at.carried(other) - at.pose.origin;
        let arm_rate = along.turn.cross(arm);
        let d_rate = d_rate + across((along.shift.y + arm_rate.y) * self.length.scale);
        let (push, push_rate) = (across(d.y), across(d_rate.y));
        Wrench {
            force: d_rate + push_rate,
            moment: lever_rate.cross(d)
                + lever.cross(d_rate)
                + arm_rate.cross(push)
                + arm.cross(push_rate),
            rack: zero,
        }
    }
}
