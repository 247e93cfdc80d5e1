//! A link with one end on a rocker, such as the second link of a Watt linkage.
//!
//! The rocker's axis is fixed in its base, the body or the knuckle, and its rod turns it (see module `rocker`). Let x be the end
//! on the rocker and p the other end. d is the vector from the inner to the outer end, and d0 that vector in the design position:
//!
//! ```text
//! F = (d.d - d0.d0)/(2 |d0|),   dF = g.(d outer - d inner) + ..,   g = d/|d0|                    (1)
//! ```
//!
//! The derivatives of F in equation (1) with respect to x and p are G and H = -G. G = (x - p)/|d0|, whether x is the inner or the
//! outer end. Let f be a point of the axis and e its direction. n is the rod's end on the rocker, o its other end,
//! and s = n - o. The rod's tension k balances G about the axis:
//!
//! ```text
//! k = N/D,   N = e.(x - f) x G,   D = e.(n - f) x s                                              (2)
//! ```
//!
//! So the force H acts at p, and K = k s acts at o. The base receives the force G - K, and the moment of G at x minus the
//! moment of K at o. The row (f, m) contains only the forces that act on the knuckle.
//!
//! Rates along the motion: points of the knuckle move with it, and points of the body do not move. The rod keeps its length, so
//! the rocker turns in its base with
//!
//! ```text
//! w' = s.(o' - b)/(s.e x (n - f)),   b the velocity of the base at n                             (3)
//! ```
//!
//! which gives x', n' and s'. Then G' = (x' - p')/|d0|. The quotient rule applied to equation (2) gives
//!
//! ```text
//! k' = (N' - k D')/D,   K' = k' s + k s'                                                         (4)
//! ```
//!
//! The rod may be mounted on another rocker, as the tie rod of a steered axle is. Then o moves with that rocker, and K is a
//! force on it. Equations (2) to (4) hold for that rocker with K in place of G.
//!
//! The mount of a twist beam is a point of the body that moves sideways opposite to a point c of the knuckle. A force on this
//! mount acts on c along y with the opposite sign.

use super::link::{RodLength, push_hardpoints};
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{Body, PointId, Rocker, RockerId};
use crate::number::{Real, Vector3, outlined};

/// Equation of the link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RockerEnd<T> {
    pub inner: PointId,
    pub outer: PointId,
    pub length: RodLength<T>,
}

/// A point or a vector with its rate.
#[derive(Clone, Copy)]
struct Moving<T> {
    now: Vector3<T>,
    rate: Vector3<T>,
}

impl<T: Real> Moving<T> {
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Moving {
            now: self.now - other.now,
            rate: self.rate - other.rate,
        }
    }

    #[inline(always)]
    fn times(self, factor: T) -> Self {
        Moving {
            now: self.now * factor,
            rate: self.rate * factor,
        }
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Self {
        Moving {
            now: self.now.cross(other.now),
            rate: self.rate.cross(other.now) + self.now.cross(other.rate),
        }
    }

    #[inline(always)]
    fn dot(self, other: Self) -> [T; 2] {
        let rate = self.rate.dot(other.now) + self.now.dot(other.rate);
        [self.now.dot(other.now), rate]
    }
}

impl<T: Real> RockerEnd<T> {
    /// Residual of the constraint, as a length: F in equation (1) of this file.
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        self.length
            .residual(at.point(self.outer) - at.point(self.inner))
    }

    /// Adds the derivatives of the residual, equation (1) of this file, times `weight` to the sink.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let weight = weight * self.length.scale;
        let now = (at.point(self.outer) - at.point(self.inner)) * weight;
        at.push_point(self.outer, now, sink);
        at.push_point(self.inner, -now, sink);
        push_hardpoints([self.inner, self.outer], at, weight, sink);
    }

    /// Rates of the constraint's force and moment along a motion of the knuckle, by equation (4). A separate function, because it
    /// is large and rarely used.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        outlined!(
            [T: Real] at.rack;
            row: &'p RockerEnd<T> = self, at: &'p Configuration<'p, T> = at, along: &'p Twist<T> = along
                => Wrench<T> { row.wrench_rate_inline(at, along) }
        )
    }

    #[inline(always)]
    fn wrench_rate_inline(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        let [inner, outer] = [self.inner, self.outer];
        let on_rocker = |id: PointId| matches!(at.mechanism.body(id), Body::Rocker(_));
        let (x, p) = if on_rocker(inner) {
            (inner, outer)
        } else {
            (outer, inner)
        };
        let Some(turned) = TurnedRockers::under(x, at, along) else {
            // Neither end is on a rocker. Such a link, for example on a twist beam's mount, has a row of another type. So
            // this row has no wrench.
            return Wrench::zero(at.rack);
        };
        let knuckle = KnuckleMotion { at, along };
        let (place, other_end) = (turned.point(x), knuckle.point(p));
        // G has the direction from p to x, whichever end is on the rocker.
        let push = place.minus(other_end).times(self.length.scale);
        let mut wrench = turned.wrench_rate(place, push);
        knuckle.add(p, other_end, push, -at.rack.one(), &mut wrench);
        wrench
    }
}

/// Knuckle with its motion.
#[derive(Clone, Copy)]
struct KnuckleMotion<'a, 'c, T> {
    at: &'a Configuration<'c, T>,
    along: &'a Twist<T>,
}

impl<T: Real> KnuckleMotion<'_, '_, T> {
    /// Velocity of the knuckle's point at this position.
    #[inline(always)]
    fn velocity(&self, place: Vector3<T>) -> Vector3<T> {
        self.along.shift + self.along.turn.cross(place - self.at.pose.origin)
    }

    /// Point of the knuckle or the body, or a mount that moves opposite to a knuckle point, with its rate.
    #[inline(always)]
    fn point(&self, id: PointId) -> Moving<T> {
        let now = self.at.point(id);
        let rate = match self.at.mechanism.body(id) {
            Body::Knuckle => self.velocity(now),
            Body::Opposite(other) => {
                let opposite = self.velocity(self.at.carried(other));
                Vector3::new(now.x.zero(), -opposite.y, now.x.zero())
            }
            _ => now.zero(),
        };
        Moving { now, rate }
    }

    /// Adds the rate of the wrench of a force, multiplied by `sign`. The force acts at a point that is not on a rocker.
    #[inline(always)]
    fn add(
        &self,
        id: PointId,
        place: Moving<T>,
        force: Moving<T>,
        sign: T,
        wrench: &mut Wrench<T>,
    ) {
        match self.at.mechanism.body(id) {
            Body::Knuckle => self.add_at(place, force, sign, wrench),
            Body::Opposite(other) => {
                let zero = sign.zero();
                let across = |v: Vector3<T>| Vector3::new(zero, -v.y, zero);
                let now = self.at.carried(other);
                let rate = self.velocity(now);
                let force = Moving {
                    now: across(force.now),
                    rate: across(force.rate),
                };
                self.add_at(Moving { now, rate }, force, sign, wrench);
            }
            _ => {}
        }
    }

    /// Adds the rate of the wrench of a force, multiplied by `sign`. The force acts at a point of the knuckle.
    #[inline(always)]
    fn add_at(&self, place: Moving<T>, force: Moving<T>, sign: T, wrench: &mut Wrench<T>) {
        let origin = Moving {
            now: self.at.pose.origin,
            rate: self.along.shift,
        };
        let moment = place.minus(origin).cross(force);
        wrench.force = wrench.force + force.rate * sign;
        wrench.moment = wrench.moment + moment.rate * sign;
    }
}

/// Rotation of a rocker and its rate by equation (3), computed from the rod of the rocker.
#[derive(Clone, Copy)]
struct TurnedRocker<'a, 'c, T> {
    knuckle: KnuckleMotion<'a, 'c, T>,
    rocker: Rocker,
    /// True if the knuckle carries the axis.
    is_on_knuckle: bool,
    foot: Moving<T>,
    axis: Moving<T>,
    /// Angular rate of the rocker about its axis, relative to its base.
    speed: T,
    off: Moving<T>,
}

impl<'a, 'c, T: Real> TurnedRocker<'a, 'c, T> {
    /// Computes the rotation of a rocker. `off` is the end of its rod away from the rocker.
    #[inline(always)]
    fn of(id: RockerId, knuckle: KnuckleMotion<'a, 'c, T>, off: Moving<T>) -> Self {
        let at = knuckle.at;
        let rocker = at.mechanism.rocker(id);
        let is_on_knuckle = at.mechanism.body(rocker.first) == Body::Knuckle;
        let (foot, other) = (knuckle.point(rocker.first), knuckle.point(rocker.second));
        let direction = other.minus(foot);
        let axis = direction.times(direction.now.x.one() / direction.now.norm());
        let end = at.point(rocker.inner);
        let s = end - off.now;
        let base = if is_on_knuckle {
            knuckle.velocity(end)
        } else {
            end.zero()
        };
        let tangent = axis.now.cross(end - foot.now);
        let speed = s.dot(off.rate - base) / s.dot(tangent);
        TurnedRocker {
            knuckle,
            rocker,
            is_on_knuckle,
            foot,
            axis,
            speed,
            off,
        }
    }

    /// Position of a point of the rocker, with its velocity.
    #[inline(always)]
    fn point(&self, id: PointId) -> Moving<T> {
        let now = self.knuckle.at.point(id);
        let turning = self.axis.now.cross(now - self.foot.now) * self.speed;
        let rate = if self.is_on_knuckle {
            self.knuckle.velocity(now) + turning
        } else {
            turning
        };
        Moving { now, rate }
    }

    /// Adds the rates of the wrench on the knuckle that the force G = `push` at a point of the rocker causes, by equations
    /// (2) and (4). Returns the force K with which the rod pulls at its other end.
    #[inline(always)]
    fn add(&self, place: Moving<T>, push: Moving<T>, wrench: &mut Wrench<T>) -> Moving<T> {
        let (axis, foot, off) = (self.axis, self.foot, self.off);
        let end = self.point(self.rocker.inner);
        let s = end.minus(off);
        let [n, n_rate] = axis.dot(place.minus(foot).cross(push));
        let [d, d_rate] = axis.dot(end.minus(foot).cross(s));
        let k = n / d;
        let k_rate = (n_rate - k * d_rate) / d;
        let tension = Moving {
            now: s.now * k,
            rate: s.now * k_rate + s.rate * k,
        };
        let one = k.one();
        if self.is_on_knuckle {
            self.knuckle.add_at(place, push, one, wrench);
            self.knuckle.add_at(off, tension, -one, wrench);
        }
        tension
    }
}

/// The rocker that carries a point. Also the rocker on which the rod of this rocker is mounted, if there is one.
struct TurnedRockers<'a, 'c, T> {
    knuckle: KnuckleMotion<'a, 'c, T>,
    own: TurnedRocker<'a, 'c, T>,
    before: Option<TurnedRocker<'a, 'c, T>>,
}

impl<'a, 'c, T: Real> TurnedRockers<'a, 'c, T> {
    /// Returns the rockers that move a point: the rocker that carries the point, and the rocker before it, if there is one. The
    /// rocker before it carries the outer end of the rod that turns the first rocker. `None` for a point of another body.
    #[inline(always)]
    fn under(x: PointId, at: &'a Configuration<'c, T>, along: &'a Twist<T>) -> Option<Self> {
        let knuckle = KnuckleMotion { at, along };
        let Body::Rocker(id) = at.mechanism.body(x) else {
            return None;
        };
        let outer = at.mechanism.rocker(id).outer;
        let before = match at.mechanism.body(outer) {
            Body::Rocker(before) => {
                let off = knuckle.point(at.mechanism.rocker(before).outer);
                Some(TurnedRocker::of(before, knuckle, off))
            }
            _ => None,
        };
        let off = match &before {
            Some(before) => before.point(outer),
            None => knuckle.point(outer),
        };
        Some(TurnedRockers {
            knuckle,
            own: TurnedRocker::of(id, knuckle, off),
            before,
        })
    }

    /// Position of a point of the rocker, with its velocity.
    #[inline(always)]
    fn point(&self, id: PointId) -> Moving<T> {
        self.own.point(id)
    }

    /// Rates of the wrench on the knuckle. The wrench is the effect of the force G = `push` at a point of the rocker.
    #[inline(always)]
    fn wrench_rate(&self, place: Moving<T>, push: Moving<T>) -> Wrench<T> {
        let one = place.now.x.one();
        let mut wrench = Wrench::zero(one);
        let mut last = self.own;
        let mut tension = last.add(place, push, &mut wrench);
        if let Some(before) = self.before {
            tension = before.add(last.off, tension, &mut wrench);
            last = before;
        }
        self.knuckle
            .add(last.rocker.outer, last.off, tension, one, &mut wrench);
        wrench
    }
}

/// Rates of the wrench on the knuckle due to a constant force at a point of a rocker, by equation (4) with G' = 0. A separate
/// function, because it is large and rarely used.
#[inline(always)]
pub(super) fn constant_push_rate<T: Real>(
    x: PointId,
    push: Vector3<T>,
    at: &Configuration<T>,
    along: &Twist<T>,
) -> Wrench<T> {
    outlined!(
        [T: Real] at.rack;
        x: PointId = x, push: Vector3<T> = push, at: &'p Configuration<'p, T> = at, along: &'p Twist<T> = along
            => Wrench<T> {
                let push = Moving { now: push, rate: push.zero() };
                match TurnedRockers::under(x, at, along) {
                    Some(turned) => turned.wrench_rate(turned.point(x), push),
                    None => Wrench::zero(at.rack),
                }
            }
    )
}
