//! A link of which one end is on a rocker: the second link of a Watt linkage.
//!
//! The rocker turns about an axis in its base, the body or the knuckle, and its rod turns it (see module `rocker`). With x the end
//! on the rocker, p the other end, d the way from the inner to the outer end, and d0 that way in the design position,
//!
//! ```text
//! F = (d.d - d0.d0)/(2 |d0|),   dF = g.(d outer - d inner) + ..,   g = d/|d0|                    (1)
//! ```
//!
//! G and H = -G are the parts of (1) at x and p: G = (x - p)/|d0| for an outer and for an inner x. Let f be a point of the axis and e its
//! direction, n and o the rod's ends on the rocker and off it, s = n - o. The rod's tension k balances G about the axis:
//!
//! ```text
//! k = N/D,   N = e.(x - f) x G,   D = e.(n - f) x s                                              (2)
//! ```
//!
//! So p has the force H, o has K = k s, and the base has the rest: the force G - K with the moment of G at x less that of K
//! at o. Those of them on the knuckle are the row (f, m).
//!
//! Rates along the motion: points of the knuckle move with it, those of the body stand still. The rod keeps its length, so
//! the rocker turns in its base with
//!
//! ```text
//! w' = s.(o' - b)/(s.e x (n - f)),   b the velocity of the base at n                             (3)
//! ```
//!
//! which gives x', n' and s'. Then G' = (x' - p')/|d0|, and (2) by the quotient rule:
//!
//! ```text
//! k' = (N' - k D')/D,   K' = k' s + k s'                                                         (4)
//! ```

use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{Body, PointId, Rocker};
use crate::number::{Each, Real, Vector3, outlined};

/// The equation of the link.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RockerEnd<T> {
    pub inner: PointId,
    pub outer: PointId,
    /// d0.d0/2
    half_squared_length: T,
    /// 1/|d0|
    scale: T,
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
    /// The link of a design.
    #[inline(always)]
    pub(crate) fn new(inner: PointId, outer: PointId, design: &[Vector3<T>]) -> Self {
        let squared = (design[outer.0] - design[inner.0]).norm_squared();
        RockerEnd {
            inner,
            outer,
            half_squared_length: squared.scaled(0.5),
            scale: squared.one() / squared.sqrt(),
        }
    }

    /// Equation (1).
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        let d = at.point(self.outer) - at.point(self.inner);
        (d.norm_squared().scaled(0.5) - self.half_squared_length) * self.scale
    }

    /// Adds `weight` times the differential of (1).
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let weight = weight * self.scale;
        let now = (at.point(self.outer) - at.point(self.inner)) * weight;
        let designed = (at.designed(self.outer) - at.designed(self.inner)) * weight;
        at.push_point(self.outer, now, sink);
        at.push_point(self.inner, -now, sink);
        sink.hardpoint(self.outer, -designed);
        sink.hardpoint(self.inner, designed);
    }

    /// Rates (4) of the row. In a function of its own: it is rare, and large.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        outlined!(
            [T: Real] at.rack;
            row: &'p RockerEnd<T> = self, at: &'p Configuration<'p, T> = at, along: &'p Twist<T> = along
                => Wrench<T> { row.wrench_rate_here(at, along) }
        )
    }

    #[inline(always)]
    fn wrench_rate_here(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
        let ends = [self.inner, self.outer];
        let on_rocker = |id: PointId| match at.mechanism.body(id) {
            Body::Rocker(rocker) => Some(at.mechanism.rocker(rocker)),
            _ => None,
        };
        let (rocker, x, p) = match ends.map(on_rocker) {
            [Some(rocker), _] => (rocker, ends[0], ends[1]),
            [None, Some(rocker)] => (rocker, ends[1], ends[0]),
            // Such a link is another row.
            [None, None] => return Wrench::zero(at.rack),
        };
        let is_carried = |id: PointId| at.mechanism.body(id) == Body::Knuckle;
        let (is_carrying, is_held) = (is_carried(rocker.first), is_carried(p));
        let velocity = |place: Vector3<T>, moves: bool| match moves {
            true => along.shift + along.turn.cross(place - at.pose.origin),
            false => place.zero(),
        };
        let moving = |id: PointId| {
            let now = at.point(id);
            let rate = velocity(now, is_carried(id));
            Moving { now, rate }
        };
        let Rocker {
            first,
            second,
            inner,
            outer,
            ..
        } = rocker;
        let (foot, other) = (moving(first), moving(second));
        let direction = other.minus(foot);
        let axis = direction.times(direction.now.x.one() / direction.now.norm());
        let off = moving(outer);
        let [end, place] = [inner, x].each(|id| at.point(id));
        let s = end - off.now;
        let base = velocity(end, is_carrying);
        let tangent = axis.now.cross(end - foot.now);
        let speed = s.dot(off.rate - base) / s.dot(tangent);
        let turned = |now: Vector3<T>| Moving {
            now,
            rate: velocity(now, is_carrying) + axis.now.cross(now - foot.now) * speed,
        };
        let (end, place) = (turned(end), turned(place));
        let s = end.minus(off);
        let other_end = moving(p);
        // G is along the way from p to x, whichever end is on the rocker.
        let push = place.minus(other_end).times(self.scale);
        let [n, n_rate] = axis.dot(place.minus(foot).cross(push));
        let [d, d_rate] = axis.dot(end.minus(foot).cross(s));
        let k = n / d;
        let k_rate = (n_rate - k * d_rate) / d;
        let tension = Moving {
            now: s.now * k,
            rate: s.now * k_rate + s.rate * k,
        };
        let origin = Moving {
            now: at.pose.origin,
            rate: along.shift,
        };
        let mut wrench = Wrench::zero(at.rack);
        let mut add = |force: Moving<T>, point: Moving<T>, sign: T| {
            let moment = point.minus(origin).cross(force);
            wrench.force = wrench.force + force.rate * sign;
            wrench.moment = wrench.moment + moment.rate * sign;
        };
        let one = at.rack.one();
        if is_held {
            add(push, other_end, -one);
        }
        if is_carried(outer) {
            add(tension, off, one);
        }
        if is_carrying {
            add(push, place, one);
            add(tension, off, -one);
        }
        wrench
    }
}
