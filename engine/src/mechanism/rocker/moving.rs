//! Points and angles of rockers with their velocities, in SIMD lanes.

use super::Turn;
use crate::mechanism::pose::{Configuration, Pose, Twist};
use crate::mechanism::rod_reach::RodReach;
use crate::model::{Body, PointId, Rocker, RockerId};
use crate::number::{Matrix3, Real, SimdReal, Vector3, outlined};

/// Rotation of a rocker and its rate.
struct Turning<T> {
    rocker: Rocker,
    turn: Turn<T>,
    /// Angular rate of the rocker about its axis.
    speed: T,
    /// Square of the smallest leverage (w^2/(r.r l.l) in module `rocker`) among this rocker and the rockers that turn it.
    leverage_squared: T,
}

/// Point with its velocity.
#[derive(Clone, Copy, Debug)]
pub struct MovingPoint<T> {
    /// Present position of the point.
    pub now: Vector3<T>,
    /// Velocity of the point.
    pub rate: Vector3<T>,
    /// Square of the smallest leverage among the rockers that move the point; 1 without a rocker.
    pub leverage_squared: T,
}

/// Angle of a rocker, with its rate.
#[derive(Clone, Copy, Debug)]
pub struct MovingAngle<T> {
    /// Angle as in [`Configuration::rocker_angle`].
    pub now: T,
    /// Rate of change of the angle.
    pub rate: T,
    /// Square of the smallest leverage among this rocker and the rockers that turn it.
    pub leverage_squared: T,
}

/// Position of a body: its rotation, and the position of one of its points.
#[derive(Clone, Copy, Debug)]
pub struct BodyPlace<T> {
    /// Rotation from the design position.
    pub rotation: Matrix3<T>,
    /// Design position of the point.
    pub designed: Vector3<T>,
    /// Present position of the point.
    pub now: Vector3<T>,
}

impl<T: Real> BodyPlace<T> {
    /// Present position of a point of the body, from its design position.
    #[inline(always)]
    pub fn point(&self, designed: Vector3<T>) -> Vector3<T> {
        self.now + self.rotation.apply(designed - self.designed)
    }
}

/// Position of a body with its motion.
#[derive(Clone, Copy, Debug)]
pub struct MovingBody<T> {
    /// Position of the body.
    pub place: BodyPlace<T>,
    /// Velocity of the point, and angular velocity of the body.
    pub motion: Twist<T>,
    /// Square of the smallest leverage among the rockers that move the body; 1 for the knuckle.
    pub leverage_squared: T,
}

impl<T: Real> MovingBody<T> {
    /// Velocity of a point of the body, from its present position.
    #[inline(always)]
    pub fn velocity(&self, now: Vector3<T>) -> Vector3<T> {
        self.motion.shift + self.motion.turn.cross(now - self.place.now)
    }
}

/// Rockers and their points in SIMD lanes. Their velocities follow from the velocity of the knuckle, without recursion.
impl<B: SimdReal> Configuration<'_, B> {
    #[inline(always)]
    fn turning(&self, id: RockerId, motion: &Twist<B>) -> Turning<B> {
        outlined!(
            [B: SimdReal] self.rack;
            at: &'p Configuration<'p, B> = self, id: RockerId = id, motion: &'p Twist<B> = motion => Turning<B> {
                at.turning_inline(id, motion)
            }
        )
    }

    #[inline(always)]
    fn turning_inline(&self, id: RockerId, motion: &Twist<B>) -> Turning<B> {
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
            [outer, rate] = self.moving_in_base(rocker, [outer, rate], motion);
            let (first, inner) = (self.designed(rocker.first), self.designed(rocker.inner));
            let (second, designed) = (self.designed(rocker.second), self.designed(rocker.outer));
            let turn = Turn::of([first, second, inner, designed, outer]);
            // The rod keeps its length, so both ends have the same velocity along it.
            let end = turn.moved(inner);
            let rod = end - outer;
            let speed = rod.dot(rate) / rod.dot(turn.axis.cross(end - first));
            // The selection returns NaN if this rocker's leverage is NaN. A rocker whose leverage is NaN also makes the
            // leverages of the rockers that it turns NaN.
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
            // The rocker that this rocker turns can have another base.
            [outer, rate] =
                self.moving_out_of_base(before(depth + 1).unwrap_or(id), [outer, rate], motion);
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
                let rate = turn.axis.cross(now - turn.first) * speed;
                let [now, rate] = self.moving_out_of_base(rocker, [now, rate], motion);
                MovingPoint {
                    now,
                    rate,
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

    /// Position of the knuckle, or of a rocker.
    #[inline(always)]
    pub fn body_place(&self, body: Option<RockerId>) -> BodyPlace<B> {
        match body {
            None => self.knuckle_place(),
            Some(id) => outlined!(
                [B: SimdReal] self.rack;
                at: &'p Configuration<'p, B> = self, id: RockerId = id => BodyPlace<B> {
                    let rocker = at.mechanism.rocker(id);
                    at.rocker_place(rocker, &Turn::of(at.ends(rocker)))
                }
            ),
        }
    }

    /// Position of the knuckle or of a rocker, with its motion.
    #[inline(always)]
    pub fn moving_body(&self, body: Option<RockerId>, motion: &Twist<B>) -> MovingBody<B> {
        match body {
            None => MovingBody {
                place: self.knuckle_place(),
                motion: *motion,
                leverage_squared: self.rack.one(),
            },
            Some(id) => outlined!(
                [B: SimdReal] self.rack;
                at: &'p Configuration<'p, B> = self, id: RockerId = id, motion: &'p Twist<B> = motion
                    => MovingBody<B> { at.moving_rocker_body(id, motion) }
            ),
        }
    }

    #[inline(always)]
    fn knuckle_place(&self) -> BodyPlace<B> {
        BodyPlace {
            rotation: self.pose.rotation,
            designed: self.designed(self.mechanism.origin),
            now: self.pose.origin,
        }
    }

    #[inline(always)]
    fn rocker_place(&self, rocker: Rocker, turn: &Turn<B>) -> BodyPlace<B> {
        let [x, y, z] = Matrix3::identity(self.rack).columns;
        let mut columns = [turn.turned(x), turn.turned(y), turn.turned(z)];
        if self.is_on_axle(rocker) {
            for column in &mut columns {
                *column = self.pose.rotation.apply(*column);
            }
        }
        let designed = self.designed(rocker.first);
        BodyPlace {
            rotation: Matrix3 { columns },
            designed,
            now: self.out_of_base(rocker, designed),
        }
    }

    #[inline(always)]
    fn moving_rocker_body(&self, id: RockerId, motion: &Twist<B>) -> MovingBody<B> {
        let Turning {
            rocker,
            turn,
            speed,
            leverage_squared,
        } = self.turning_inline(id, motion);
        let place = self.rocker_place(rocker, &turn);
        let own = turn.axis * speed;
        let motion = if self.is_on_axle(rocker) {
            Twist {
                shift: motion.shift + motion.turn.cross(place.now - self.pose.origin),
                turn: motion.turn + self.pose.rotation.apply(own),
            }
        } else {
            Twist {
                shift: own.zero(),
                turn: own,
            }
        };
        MovingBody {
            place,
            motion,
            leverage_squared,
        }
    }

    /// Rod of a rocker in this pose, in the coordinates of the rocker's base.
    #[inline(always)]
    pub fn moving_rod(&self, id: RockerId, motion: &Twist<B>) -> RodReach<B> {
        let rocker = self.mechanism.rocker(id);
        let now = self.moving_point(rocker.outer, motion).now;
        RodReach::of(self.ends_with(rocker, now), self.rod_frame(rocker))
    }

    /// Rod of a rocker in the design position, in the coordinates of the rocker's base.
    #[inline(always)]
    pub fn designed_rod(&self, id: RockerId) -> RodReach<B> {
        let rocker = self.mechanism.rocker(id);
        let ends = self.ends_in_base(rocker, self.designed(rocker.outer));
        RodReach::of(ends, self.at_rest().rod_frame(rocker))
    }

    /// Rod of a rocker while the knuckle is in its design position, in the coordinates of the rocker's base. A steering
    /// gear may have moved the rod.
    #[inline(always)]
    pub fn rod_at_rest(&self, id: RockerId) -> RodReach<B> {
        let (at_rest, rocker) = (self.at_rest(), self.mechanism.rocker(id));
        RodReach::of(at_rest.ends(rocker), at_rest.rod_frame(rocker))
    }

    /// The same mechanism with the knuckle in its design position.
    #[inline(always)]
    fn at_rest(&self) -> Self {
        let pose = Pose {
            origin: self.designed(self.mechanism.origin),
            rotation: Matrix3::identity(self.rack),
        };
        Configuration { pose, ..*self }
    }

    /// Position and velocity of a point in the base of a rocker.
    #[inline(always)]
    fn moving_in_base(
        &self,
        rocker: Rocker,
        [now, rate]: [Vector3<B>; 2],
        motion: &Twist<B>,
    ) -> [Vector3<B>; 2] {
        if self.is_on_axle(rocker) {
            let carried = motion.shift + motion.turn.cross(now - self.pose.origin);
            let rate = self.pose.rotation.apply_transposed(rate - carried);
            [self.in_base(rocker, now), rate]
        } else {
            [now, rate]
        }
    }

    /// Inverse of [`Configuration::moving_in_base`].
    #[inline(always)]
    fn moving_out_of_base(
        &self,
        id: RockerId,
        [now, rate]: [Vector3<B>; 2],
        motion: &Twist<B>,
    ) -> [Vector3<B>; 2] {
        let rocker = self.mechanism.rocker(id);
        if self.is_on_axle(rocker) {
            let now = self.out_of_base(rocker, now);
            let carried = motion.shift + motion.turn.cross(now - self.pose.origin);
            [now, carried + self.pose.rotation.apply(rate)]
        } else {
            [now, rate]
        }
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
