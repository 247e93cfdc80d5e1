//! Where a rocker has turned to.
//!
//! A rocker is hinged about a line fixed in the vehicle, along the unit vector e, and turned by a rod, l in the
//! design position, which keeps its length. With c the foot of the rod's inner end on the axis, r the lever from
//! there to that end in the design position, t = e x r, d the way the rod's outer end has gone and q from where
//! it is to c, the angle obeys
//!
//! ```text
//! |q + r cos + t sin| = |l| = |q + r + d|
//! A cos + B sin = C,   A = q.r, B = q.t, C = A + E, E = l.d - d.d/2
//! cos = (A C - B w)/H, sin = (B E + A (B + w))/H,   H = A^2 + B^2, w^2 = H - C^2 = B^2 - E (2 A + E)
//! ```
//!
//! In the design position E = 0, cos = 1 and sin = 0, so w = -B there, and w keeps that sign. |w| is the lever arm of
//! the rod about the axis times |l|: |w|/(|r| |l|) is the rod's *leverage*, 1 where it stands square to the lever,
//! 0 at toggle, where rod, lever and axis lie in one plane. A rocker goes no further than a toggle, and
//! derivatives do not exist there.

use super::pose::{Configuration, Sink, Twist, gradient_by};
use super::rod_reach::RodReach;
use crate::mechanism::DEGENERATE;
use crate::model::{Body, PointId};
use crate::model::{Rocker, RockerId, Rod};
use crate::number::Real;
use crate::number::SimdReal;
use crate::number::Vector3;

/// What the turn of a rocker is made of: two points of its axis, the rod's inner and outer end in the design
/// position, and the outer end now.
pub(super) type Ends<T> = [Vector3<T>; 5];

/// A turn about an axis. Beyond a toggle it is not a number.
pub(crate) struct Turn<T> {
    first: Vector3<T>,
    axis: Vector3<T>,
    cosine: T,
    sine: T,
    /// 1 or -1: the sign of the turn by which the rod pushes its inner end.
    pushed: T,
    /// w^2/(r.r l.l)
    pub(crate) leverage_squared: T,
}

impl<T: Real> Turn<T> {
    /// By the rod's ends.
    #[inline(always)]
    pub(crate) fn of([first, second, inner, outer, outer_now]: Ends<T>) -> Self {
        let axis = (second - first).normalised();
        let from_first = inner - first;
        let lever = from_first - axis * axis.dot(from_first);
        let centre = inner - lever;
        let turned = axis.cross(lever);
        let rod = inner - outer;
        let (q, way) = (centre - outer_now, outer_now - outer);
        let (a, b) = (q.dot(lever), q.dot(turned));
        let e = rod.dot(way) - way.norm_squared().scaled(0.5);
        let h = a * a + b * b;
        let square = b * b - e * (a + a + e);
        // B of the design position is t.l.
        let pushed = turned.dot(rod).sign();
        let w = -(pushed * square.sqrt());
        let inverse = h.one() / h;
        Turn {
            first,
            axis,
            cosine: (a * (a + e) - b * w) * inverse,
            sine: (b * e + a * (b + w)) * inverse,
            pushed,
            leverage_squared: square / (lever.norm_squared() * rod.norm_squared()),
        }
    }

    /// Where a point of the rocker has come to.
    #[inline(always)]
    pub(crate) fn moved(&self, point: Vector3<T>) -> Vector3<T> {
        let from_first = point - self.first;
        let lever = from_first - self.axis * self.axis.dot(from_first);
        point - lever + lever * self.cosine + self.axis.cross(lever) * self.sine
    }

    /// The angle, positive as a rod of this kind turns it from the design position: pushed, or pulled by a
    /// pullrod.
    #[inline(always)]
    fn angle(&self, rod: Rod) -> T {
        (self.sine * self.sense(rod)).atan2(self.cosine)
    }

    /// 1 or -1: the sign of the turn that counts as positive.
    #[inline(always)]
    fn sense(&self, rod: Rod) -> T {
        match rod {
            Rod::Pushrod | Rod::DropLink => self.pushed,
            Rod::Pullrod => -self.pushed,
        }
    }
}

/// A rocker that turns.
struct Turning<T> {
    rocker: Rocker,
    turn: Turn<T>,
    /// How fast, about its axis.
    speed: T,
    /// The least w^2/(r.r l.l) of this rocker and those that turn it.
    leverage_squared: T,
}

/// A point on its way.
#[derive(Clone, Copy, Debug)]
pub struct MovingPoint<T> {
    /// Where it is.
    pub now: Vector3<T>,
    /// Its velocity.
    pub rate: Vector3<T>,
    /// The square of the least leverage of the rockers it moves with; 1 without any.
    pub leverage_squared: T,
}

/// A rocker's angle on its way.
#[derive(Clone, Copy, Debug)]
pub struct MovingAngle<T> {
    /// As [`Configuration::rocker_angle`] has it.
    pub now: T,
    /// Its derivative.
    pub rate: T,
    /// The square of the least leverage of this rocker and those that turn it.
    pub leverage_squared: T,
}

/// Rockers and what stands on them in SIMD lanes, with their velocities from that of the knuckle: everything
/// inline, nothing recursive.
impl<B: SimdReal> Configuration<'_, B> {
    #[inline(always)]
    fn turning(&self, id: RockerId, motion: &Twist<B>) -> Turning<B> {
        let mechanism = self.mechanism;
        let before = |depth: usize| {
            let carrying = mechanism.rockers_moving(mechanism.rocker(id).outer);
            std::iter::once(id).chain(carrying).nth(depth)
        };
        let mut depth = 0;
        while before(depth + 1).is_some() {
            depth += 1;
        }
        let mut rocker = mechanism.rocker(before(depth).unwrap_or(id));
        let [mut outer, mut rate] = self.moving_below_rockers(rocker.outer, motion);
        let mut least = outer.x.one();
        loop {
            let (first, inner) = (self.designed(rocker.first), self.designed(rocker.inner));
            let (second, designed) = (self.designed(rocker.second), self.designed(rocker.outer));
            let turn = Turn::of([first, second, inner, designed, outer]);
            // The rod keeps its length: its ends have the same velocity along it.
            let end = turn.moved(inner);
            let rod = end - outer;
            let speed = rod.dot(rate) / rod.dot(turn.axis.cross(end - first));
            // So that NaN is kept.
            least = B::select(
                least.less(turn.leverage_squared),
                least,
                turn.leverage_squared,
            );
            if depth == 0 {
                return Turning {
                    rocker,
                    turn,
                    speed,
                    leverage_squared: least,
                };
            }
            depth -= 1;
            rocker = mechanism.rocker(before(depth).unwrap_or(id));
            outer = turn.moved(self.designed(rocker.outer));
            rate = turn.axis.cross(outer - first) * speed;
        }
    }

    /// Present position and velocity of a point.
    #[inline(always)]
    pub fn moving_point(&self, id: PointId, motion: &Twist<B>) -> MovingPoint<B> {
        match self.mechanism.body(id) {
            Body::Rocker(rocker) => {
                let Turning {
                    turn,
                    speed,
                    leverage_squared,
                    ..
                } = self.turning(rocker, motion);
                let now = turn.moved(self.designed(id));
                MovingPoint {
                    now,
                    rate: turn.axis.cross(now - turn.first) * speed,
                    leverage_squared,
                }
            }
            _ => {
                let [now, rate] = self.moving_below_rockers(id, motion);
                MovingPoint {
                    now,
                    rate,
                    leverage_squared: now.x.one(),
                }
            }
        }
    }

    /// Where the rod of a rocker is.
    #[inline(always)]
    pub fn moving_rod(&self, id: RockerId, motion: &Twist<B>) -> RodReach<B> {
        let rocker = self.mechanism.rocker(id);
        let now = self.moving_point(rocker.outer, motion).now;
        self.rod_with_end_at(rocker, now)
    }

    /// Where the rod of a rocker is in the design position.
    #[inline(always)]
    pub fn designed_rod(&self, id: RockerId) -> RodReach<B> {
        let rocker = self.mechanism.rocker(id);
        self.rod_with_end_at(rocker, self.designed(rocker.outer))
    }

    #[inline(always)]
    fn rod_with_end_at(&self, rocker: Rocker, now: Vector3<B>) -> RodReach<B> {
        let [first, second, inner, outer] =
            [rocker.first, rocker.second, rocker.inner, rocker.outer].map(|id| self.designed(id));
        RodReach::of([first, second, inner, outer, now])
    }

    /// Angle of a rocker and its derivative.
    #[inline(always)]
    pub fn moving_rocker(&self, id: RockerId, motion: &Twist<B>) -> MovingAngle<B> {
        let Turning {
            rocker,
            turn,
            speed,
            leverage_squared,
        } = self.turning(id, motion);
        MovingAngle {
            now: turn.angle(rocker.rod),
            rate: speed * turn.sense(rocker.rod),
            leverage_squared,
        }
    }
}

/// Whether six digits of a derivative would be left of this w^2/(r.r l.l), which is known to a few units of
/// the last place. Written so that NaN has not.
#[inline]
pub(super) fn is_enough(leverage_squared: f64) -> bool {
    leverage_squared > DEGENERATE
}

/// w^2/(r.r l.l) of a rod.
#[inline]
pub(super) fn leverage_squared<T: Real>(ends: Ends<T>) -> T {
    Turn::of(ends).leverage_squared
}

/// Whether a rocker is away from its toggle in the design position, so that its rod can turn it.
pub fn has_leverage(rocker: &Rocker, design: &[Vector3<f64>]) -> bool {
    let outer = design[rocker.outer.0];
    let [first, second, inner] = [rocker.first, rocker.second, rocker.inner].map(|id| design[id.0]);
    is_enough(Turn::of([first, second, inner, outer, outer]).leverage_squared)
}

impl<T: Real> Configuration<'_, T> {
    #[inline]
    pub(super) fn ends(&self, rocker: Rocker) -> Ends<T> {
        let [first, second, inner, outer] =
            [rocker.first, rocker.second, rocker.inner, rocker.outer].map(|id| self.designed(id));
        [first, second, inner, outer, self.point(rocker.outer)]
    }

    /// Present position of a point of a rocker. Out of line: it is rare, and large.
    #[inline(never)]
    pub(crate) fn rocker_point(&self, id: RockerId, designed: Vector3<T>) -> Vector3<T> {
        Turn::of(self.ends(self.mechanism.rocker(id))).moved(designed)
    }

    /// Angle of a rocker from its design position, positive where its rod has pushed it, or a pullrod pulled
    /// it. NaN beyond a toggle.
    #[inline(never)]
    pub fn rocker_angle(&self, id: RockerId) -> T {
        let rocker = self.mechanism.rocker(id);
        Turn::of(self.ends(rocker)).angle(rocker.rod)
    }

    /// Adds the derivative of `gradient . rocker_point(id, point)` to the sink, but for that by the place of
    /// the point in the design, which is returned.
    #[inline(never)]
    pub(crate) fn push_rocker_point(
        &self,
        id: RockerId,
        designed: Vector3<T>,
        gradient: Vector3<T>,
        sink: &mut impl Sink<T>,
    ) -> Vector3<T> {
        let rocker = self.mechanism.rocker(id);
        let [first, second, inner, outer, now] = self.ends(rocker);
        let inputs = [first, second, inner, outer, now, designed];
        let [by @ .., by_point] = gradient_by(inputs, gradient, |[ends @ .., point]| {
            Turn::of(ends).moved(point)
        });
        self.push_ends(rocker, by, sink);
        by_point
    }

    /// Adds the derivative of `gradient * rocker_angle(id)` to the sink.
    #[inline(never)]
    pub(crate) fn push_rocker_angle(&self, id: RockerId, gradient: T, sink: &mut impl Sink<T>) {
        let rocker = self.mechanism.rocker(id);
        let zero = gradient.zero();
        let by = gradient_by(
            self.ends(rocker),
            Vector3::new(gradient, zero, zero),
            |ends| {
                let angle = Turn::of(ends).angle(rocker.rod);
                Vector3::new(angle, angle.zero(), angle.zero())
            },
        );
        self.push_ends(rocker, by, sink);
    }

    fn push_ends(&self, rocker: Rocker, by: Ends<T>, sink: &mut impl Sink<T>) {
        let designed = [rocker.first, rocker.second, rocker.inner, rocker.outer];
        for (id, gradient) in designed.into_iter().zip(by) {
            sink.hardpoint(id, gradient);
        }
        self.push_point(rocker.outer, by[4], sink);
    }
}

impl Configuration<'_, f64> {
    /// The rod that keeps a rocker from turning here: its own, or that of a rocker which turns it.
    pub(crate) fn toggle(&self, id: RockerId) -> Option<Rod> {
        let before = self
            .mechanism
            .rockers_moving(self.mechanism.rocker(id).outer);
        let stuck = std::iter::once(id).chain(before).filter(|id| {
            let ends = self.ends(self.mechanism.rocker(*id));
            !is_enough(Turn::of(ends).leverage_squared)
        });
        stuck.last().map(|id| self.mechanism.rocker(id).rod)
    }

    /// Tension in the rod of a rocker for a force of one at a point of the rocker: moments about the axis.
    pub(crate) fn rod_tension(&self, id: RockerId, at: Vector3<f64>, force: Vector3<f64>) -> f64 {
        let rocker = self.mechanism.rocker(id);
        let [first, second] = [rocker.first, rocker.second].map(|id| self.designed(id));
        let axis = second - first;
        let [inner, outer] = [rocker.inner, rocker.outer].map(|id| self.point(id));
        let moment = |at: Vector3<f64>, force: Vector3<f64>| axis.dot((at - first).cross(force));
        -moment(at, force) / moment(inner, (outer - inner).normalised())
    }
}
