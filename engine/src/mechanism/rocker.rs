//! Angle to which a rod turns a rocker.
//!
//! A rocker turns about an axis fixed in its base, along the unit vector e. The base is the vehicle, or the knuckle of a rigid
//! axle: a solid axle, or the near half of a twist beam. On such a knuckle, all vectors below are in its frame in the design
//! position. Equation (12) converts them to the vehicle's frame.
//!
//! A rod of constant length turns the rocker. The vector l is this rod in the design position. c is the foot of the
//! perpendicular from the rod's inner end to the axis. r is the lever from c to that end in the design position, and
//! t = e x r. d is the displacement of the rod's outer end, and q is the vector from this end to c. The angle obeys
//!
//! ```text
//! |q + r cos + t sin| = |l| = |q + r + d|                                                       (1)
//! A cos + B sin = C,   A = q.r, B = q.t, C = A + E, E = l.d - d.d/2                             (2)
//! cos = (A C - B w)/H, sin = (B E + A (B + w))/H                                                (3)
//! H = A^2 + B^2, w^2 = H - C^2 = B^2 - E (2 A + E)                                              (4)
//! ```
//!
//! In the design position E = 0, cos = 1 and sin = 0, so w = -B there. w keeps this sign. |w| is the lever arm of the rod
//! about the axis times |l|. The ratio |w|/(|r| |l|) is the rod's *leverage*: 1 if the rod is square to lever and axis, 0
//! at toggle. At a toggle (dead centre), rod, lever and axis lie in one plane. A rocker stops there, and derivatives do not
//! exist.
//!
//! # Derivatives
//!
//! Let f be a point of the axis, and x' = f + R (x - f) a point of the rocker. The vector s' = n' - o' is the rod from its
//! outer end o' to its inner end n'. A change of axis and angle turns the rocker by the small rotation v, with de normal to
//! e:
//!
//! ```text
//! v = e dtheta + sin de + (1 - cos) e x de                                                      (5)
//! dx' = (1 - R) df + R dx + v x (x' - f)                                                        (6)
//! s'.(dn' - do') = l.(dn - do), because the rod keeps its length                                (7)
//! ```
//!
//! The tension k of the rod balances a gradient g at x' and a moment t about the axis:
//!
//! ```text
//! k = (e.(x' - f) x g + t)/(e.(n' - f) x s')                                                    (8)
//! M = (x' - f) x g - k (n' - f) x s',   h = g - k s'                                            (9)
//! ```
//!
//! A couple m on the rocker is the derivative with respect to its rotation. It is added to (x' - f) x g in equations (8)
//! and (9). The derivatives of g.x' + t theta are
//!
//! ```text
//! by x: R'g    by n: k (l - R's')    by o: -k l    by o': k s'                                  (10)
//! by f: h - R'h    by de: sin M + (1 - cos) M x e                                               (11)
//! ```
//!
//! A point y of the axle's frame is at x = p + Q (y - p0), with the pose p, Q of the axle's origin p0. With a gradient g
//! at x, Q'g at y, and the twist (v, w),
//!
//! ```text
//! g.dx = Q'g.(dy - dp0) + g.v + (x - p) x g.w,   g.dy of a point at x: dx = v + w x (x - p) + Q (dy - dp0)   (12)
//! ```

mod moving;

pub use moving::{BodyPlace, MovingAngle, MovingBody, MovingPoint};

use super::pose::{Configuration, Sink};
use crate::mechanism::DEGENERATE;
use crate::model::Body;
use crate::model::{Rocker, RockerId, Rod};
use crate::number::{Each, Matrix3, Real, Vector3, outlined};

/// Inputs for the rotation of a rocker: two points of its axis, the rod's inner and outer end in the design position,
/// and the present outer end.
pub(super) type Ends<T> = [Vector3<T>; 5];

/// Rotation of a rocker about its axis; NaN beyond a toggle.
pub(crate) struct Turn<T> {
    first: Vector3<T>,
    axis: Vector3<T>,
    cosine: T,
    sine: T,
    /// Sign of the rotation that a push of the rod causes: 1 or -1.
    pushed: T,
    /// Square of the leverage, w^2/(r.r l.l), with the symbols of this module.
    pub(crate) leverage_squared: T,
}

impl<T: Real> Turn<T> {
    /// Computes the rotation of a rocker from the five points in `Ends`.
    #[inline(always)]
    pub(crate) fn of([first, second, inner, outer, outer_now]: Ends<T>) -> Self {
        let axis = (second - first).normalised();
        let lever = (inner - first).across(axis);
        let centre = inner - lever;
        let turned = axis.cross(lever);
        let rod = inner - outer;
        let (q, way) = (centre - outer_now, outer_now - outer);
        let (a, b) = (q.dot(lever), q.dot(turned));
        let e = rod.dot(way) - way.norm_squared().scaled(0.5);
        let h = a * a + b * b;
        let square = b * b - e * (a + a + e);
        // In the design position, the number B of equation (2) is t.l.
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

    /// Present position of the rocker's point with the design position `point`.
    #[inline(always)]
    pub(crate) fn moved(&self, point: Vector3<T>) -> Vector3<T> {
        let lever = (point - self.first).across(self.axis);
        point - lever + lever * self.cosine + self.axis.cross(lever) * self.sine
    }

    /// Turns a vector v by the rocker's angle: R v, with the rotation R of equation (6).
    #[inline(always)]
    fn turned(&self, v: Vector3<T>) -> Vector3<T> {
        let lever = v.across(self.axis);
        v - lever + lever * self.cosine + self.axis.cross(lever) * self.sine
    }

    /// Turns a vector v back by the rocker's angle: R'v, with the rotation R of equation (6).
    #[inline(always)]
    fn turned_back(&self, v: Vector3<T>) -> Vector3<T> {
        let lever = v.across(self.axis);
        v - lever + lever * self.cosine - self.axis.cross(lever) * self.sine
    }

    /// Derivatives with respect to the five points in `Ends` and to the design position `point`. The differentiated
    /// quantity is `gradient . moved(point)`, plus `couple` times the rotation, plus `moment` times the angle.
    #[inline(always)]
    fn gradient(
        &self,
        [first, second, inner, outer, outer_now]: Ends<T>,
        point: Vector3<T>,
        [gradient, couple]: [Vector3<T>; 2],
        moment: T,
    ) -> (Ends<T>, Vector3<T>) {
        let (axis, one) = (self.axis, self.sine.one());
        let end = self.moved(inner);
        let rod = end - outer_now;
        let pull = (end - first).cross(rod);
        let push = (self.moved(point) - first).cross(gradient) + couple;
        let tension = (axis.dot(push) + moment) / axis.dot(pull);
        let pulled = rod * tension;
        let (back, rod_back) = (self.turned_back(gradient), self.turned_back(pulled));
        let turning = push - pull * tension;
        let by_axis = turning * self.sine + turning.cross(axis) * (one - self.cosine);
        let along = axis.dot(second - first);
        let by_second = by_axis.across(axis) * (one / along);
        let designed = (inner - outer) * tension;
        let by_ends = [
            gradient - pulled - back + rod_back - by_second,
            by_second,
            designed - rod_back,
            -designed,
            pulled,
        ];
        (by_ends, back)
    }

    /// Angle from the design position. The angle is positive if the rod has pushed the rocker. For a pullrod, the angle is positive
    /// if the rod has pulled the rocker.
    #[inline(always)]
    pub(crate) fn angle(&self, rod: Rod) -> T {
        (self.sine * self.sense(rod)).atan2(self.cosine)
    }

    /// Sign of the rotation that counts as positive: 1 or -1.
    #[inline(always)]
    pub(crate) fn sense(&self, rod: Rod) -> T {
        match rod {
            Rod::Pushrod
            | Rod::DropLink
            | Rod::WattLink
            | Rod::DragLink
            | Rod::TieRod
            | Rod::TwistBeam => self.pushed,
            Rod::Pullrod => -self.pushed,
        }
    }
}

/// Returns true if the squared leverage w^2/(r.r l.l) of a rod is large enough for six accurate digits of a derivative. The
/// absolute error of the squared leverage is a few rounding units. Returns false for NaN.
#[inline]
pub(crate) fn is_effective(ends: Ends<f64>) -> bool {
    Turn::of(ends).leverage_squared > DEGENERATE
}

/// Returns true if the rod can turn its rocker in the design position, away from a toggle.
pub fn has_leverage(rocker: &Rocker, design: &[Vector3<f64>]) -> bool {
    let outer = design[rocker.outer.0];
    let [first, second, inner] =
        [rocker.first, rocker.second, rocker.inner].each(|id| design[id.0]);
    is_effective([first, second, inner, outer, outer])
}

impl<T: Real> Configuration<'_, T> {
    #[inline(always)]
    pub(crate) fn ends(&self, rocker: Rocker) -> Ends<T> {
        self.ends_with(rocker, self.point(rocker.outer))
    }

    /// Points that determine the rotation of a rocker, in coordinates of its base. `now` is the present position of the rod's
    /// outer end in coordinates of the chassis.
    #[inline(always)]
    fn ends_with(&self, rocker: Rocker, now: Vector3<T>) -> Ends<T> {
        self.ends_in_base(rocker, self.in_base(rocker, now))
    }

    /// Returns true if the base of a rocker is the knuckle: a solid axle, or the near half of a twist beam.
    #[inline(always)]
    fn is_on_axle(&self, rocker: Rocker) -> bool {
        self.mechanism.body(rocker.first) == Body::Knuckle
    }

    /// Position of the point `now` relative to the base of a rocker, in the axes of the base: y of equation (12) of this
    /// module.
    #[inline(always)]
    fn in_base(&self, rocker: Rocker, now: Vector3<T>) -> Vector3<T> {
        if self.is_on_axle(rocker) {
            let from_origin = now - self.pose.origin;
            let lever = self.pose.rotation.apply_transposed(from_origin);
            self.designed(self.mechanism.origin) + lever
        } else {
            now
        }
    }

    /// Inverse of [`Configuration::in_base`]: x of equation (12) of this module.
    #[inline(always)]
    pub(super) fn out_of_base(&self, rocker: Rocker, place: Vector3<T>) -> Vector3<T> {
        if self.is_on_axle(rocker) {
            let lever = place - self.designed(self.mechanism.origin);
            self.pose.origin + self.pose.rotation.apply(lever)
        } else {
            place
        }
    }

    /// Points that determine the rotation of a rocker, in coordinates of the body that carries the rocker (the base). `now` is
    /// the present position of the rod's outer end in these coordinates.
    #[inline(always)]
    fn ends_in_base(&self, rocker: Rocker, now: Vector3<T>) -> Ends<T> {
        [
            self.designed(rocker.first),
            self.designed(rocker.second),
            self.designed(rocker.inner),
            self.designed(rocker.outer),
            now,
        ]
    }

    /// Frame of unit vectors on the body of a rod's outer end, in the directions of the rocker's base.
    #[inline(always)]
    pub(crate) fn rod_frame(&self, rocker: Rocker) -> [Vector3<T>; 3] {
        let frame = match self.mechanism.body(rocker.outer) {
            Body::Knuckle | Body::StrutRod(_) => self.pose.rotation.columns,
            Body::Arm(arm) => self.arm_frame(self.mechanism.arms[arm.0]),
            Body::Rocker(id) => self.rocker_rotation(id).columns,
            _ => Matrix3::identity(self.rack).columns,
        };
        if self.is_on_axle(rocker) {
            frame.each(|direction| self.pose.rotation.apply_transposed(direction))
        } else {
            frame
        }
    }

    /// Present position of a point of a rocker. This code is large and rarely used, so it is not inlined.
    #[inline(always)]
    pub(crate) fn rocker_point(&self, id: RockerId, designed: Vector3<T>) -> Vector3<T> {
        outlined!(
            [T: Real] self.rack;
            at: &'p Configuration<'p, T> = self, id: RockerId = id, designed: Vector3<T> = designed => Vector3<T> {
                let rocker = at.mechanism.rocker(id);
                at.out_of_base(rocker, Turn::of(at.ends(rocker)).moved(designed))
            }
        )
    }

    /// Rotation of a rocker from the design position: the rotation of its base times the rotation about its axis.
    #[inline(always)]
    pub(crate) fn rocker_rotation(&self, id: RockerId) -> Matrix3<T> {
        outlined!(
            [T: Real] self.rack; at: &'p Configuration<'p, T> = self, id: RockerId = id => Matrix3<T> {
                let rocker = at.mechanism.rocker(id);
                let turn = Turn::of(at.ends(rocker));
                let on_axle = at.is_on_axle(rocker);
                let columns = Matrix3::identity(at.rack).columns.each(|column| {
                    let turned = turn.turned(column);
                    if on_axle { at.pose.rotation.apply(turned) } else { turned }
                });
                Matrix3 { columns }
            }
        )
    }

    /// Angle of a rocker from its design position. The angle is positive if the rod has pushed the rocker, or if a pullrod has
    /// pulled it. NaN beyond a toggle.
    #[inline(always)]
    pub fn rocker_angle(&self, id: RockerId) -> T {
        outlined!(
            [T: Real] self.rack; at: &'p Configuration<'p, T> = self, id: RockerId = id => T {
                let rocker = at.mechanism.rocker(id);
                Turn::of(at.ends(rocker)).angle(rocker.rod)
            }
        )
    }

    /// Adds the derivative of `gradient . rocker_point(id, designed)` to the sink. The derivative with respect to the
    /// point's own design position is returned instead of added.
    #[inline(always)]
    pub(crate) fn push_rocker_point(
        &self,
        id: RockerId,
        designed: Vector3<T>,
        gradient: Vector3<T>,
        sink: &mut impl Sink<T>,
    ) -> Vector3<T> {
        self.push_rocker(id, RockerSeed::Point { designed, gradient }, sink)
    }

    /// Adds the derivative of `gradient * rocker_angle(id)` to the sink.
    #[inline(always)]
    pub(crate) fn push_rocker_angle(&self, id: RockerId, gradient: T, sink: &mut impl Sink<T>) {
        self.push_rocker(id, RockerSeed::Angle(gradient), sink);
    }

    /// Adds the derivative with respect to a small rotation of a rocker to the sink.
    #[inline(always)]
    pub(crate) fn push_rocker_turn(
        &self,
        id: RockerId,
        couple: Vector3<T>,
        sink: &mut impl Sink<T>,
    ) {
        self.push_rocker(id, RockerSeed::Turn(couple), sink);
    }

    #[inline(always)]
    fn push_rocker(
        &self,
        id: RockerId,
        seed: RockerSeed<T>,
        sink: &mut impl Sink<T>,
    ) -> Vector3<T> {
        let seed = self.seed_in_base(self.mechanism.rocker(id), seed, sink);
        let (by, by_point) = outlined!(
            [T: Real] self.rack;
            at: &'p Configuration<'p, T> = self, id: RockerId = id, seed: RockerSeed<T> = seed
                => (Ends<T>, Vector3<T>) { at.rocker_gradient(id, seed) }
        );
        let rocker = self.mechanism.rocker(id);
        let designed = [rocker.first, rocker.second, rocker.inner, rocker.outer];
        for (k, id) in designed.iter().enumerate() {
            sink.hardpoint(*id, by[k]);
        }
        let by_outer = if self.is_on_axle(rocker) {
            // The second form of equation (12) converts the outer end to the frame of the axle.
            let pull = self.pose.rotation.apply(by[4]);
            let lever = self.point(rocker.outer) - self.pose.origin;
            sink.wrench(-pull, -lever.cross(pull));
            sink.hardpoint(self.mechanism.origin, by[4]);
            pull
        } else {
            by[4]
        };
        self.push_point(rocker.outer, by_outer, sink);
        by_point
    }

    /// Converts the seed (the quantity to differentiate) to the frame of the rocker's base. First adds the other terms of
    /// equation (12) to the sink.
    #[inline(always)]
    fn seed_in_base(
        &self,
        rocker: Rocker,
        seed: RockerSeed<T>,
        sink: &mut impl Sink<T>,
    ) -> RockerSeed<T> {
        match seed {
            RockerSeed::Point { designed, gradient } if self.is_on_axle(rocker) => {
                let place = self.out_of_base(rocker, Turn::of(self.ends(rocker)).moved(designed));
                let in_base = self.pose.rotation.apply_transposed(gradient);
                sink.wrench(gradient, (place - self.pose.origin).cross(gradient));
                sink.hardpoint(self.mechanism.origin, -in_base);
                RockerSeed::Point {
                    designed,
                    gradient: in_base,
                }
            }
            RockerSeed::Turn(couple) if self.is_on_axle(rocker) => {
                sink.wrench(couple.zero(), couple);
                RockerSeed::Turn(self.pose.rotation.apply_transposed(couple))
            }
            seed => seed,
        }
    }

    /// Derivatives of the seed with respect to the rod's ends and to the design position of the seed's point.
    #[inline(always)]
    fn rocker_gradient(&self, id: RockerId, seed: RockerSeed<T>) -> (Ends<T>, Vector3<T>) {
        let rocker = self.mechanism.rocker(id);
        let ends = self.ends(rocker);
        let turn = Turn::of(ends);
        let zero = self.rack.zero();
        let none = Vector3::new(zero, zero, zero);
        // If the quantity to differentiate is an angle or a rotation, it does not refer to a point of the rocker. The
        // formulas then use a point of the axis, with a zero gradient.
        let (designed, gradients, moment) = match seed {
            RockerSeed::Point { designed, gradient } => (designed, [gradient, none], zero),
            RockerSeed::Angle(gradient) => (ends[0], [none; 2], gradient * turn.sense(rocker.rod)),
            RockerSeed::Turn(couple) => (ends[0], [none, couple], zero),
        };
        turn.gradient(ends, designed, gradients, moment)
    }
}

/// Quantity to differentiate: `gradient` times the position of a point of the rocker, a number times its angle, or a vector
/// times its small rotation.
enum RockerSeed<T> {
    Point {
        designed: Vector3<T>,
        gradient: Vector3<T>,
    },
    Angle(T),
    Turn(Vector3<T>),
}

impl Configuration<'_, f64> {
    /// Leverage of a rocker's rod: 1 if the rod is square to lever and axis, 0 at toggle, NaN beyond the toggle.
    pub(crate) fn leverage(&self, id: RockerId) -> f64 {
        let turn = Turn::of(self.ends(self.mechanism.rocker(id)));
        turn.leverage_squared.sqrt()
    }

    /// Rod at or beyond a toggle that stops a rocker here: the rocker's own rod, or the rod of a rocker that turns it. `None` if
    /// no such rod is at or beyond a toggle.
    pub(crate) fn toggle(&self, id: RockerId) -> Option<Rod> {
        let before = self
            .mechanism
            .rockers_moving(self.mechanism.rocker(id).outer);
        let stuck = std::iter::once(id)
            .chain(before)
            .filter(|id| !is_effective(self.ends(self.mechanism.rocker(*id))));
        stuck.last().map(|id| self.mechanism.rocker(id).rod)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::arm::tests::assert_gradient;
    use crate::number::{Dual, Jet};

    /// The derivatives from the rod's tension equal the results of dual numbers. Their rates along a motion are also equal.
    #[test]
    fn the_gradient_is_that_of_dual_numbers() {
        let at = |x: f64, y: f64, z: f64| {
            let series = |c: f64, k: f64| Jet::<f64, 2>([c, 0.2 * k - 0.3 * c]);
            Vector3::new(series(x, y), series(y, z), series(z, x))
        };
        let ends = [
            at(0.01, 0.32, 0.58),
            at(-0.07, 0.33, 0.61),
            at(0.02, 0.38, 0.66),
            at(0.03, 0.64, 0.22),
            at(0.04, 0.63, 0.26),
        ];
        let (point, gradient, moment) = (at(0.0, 0.3, 0.7), at(0.4, -1.2, 0.6), Jet([0.8, -0.5]));
        let gradients = [gradient, gradient.zero()];
        let (by_ends, by_point) = Turn::of(ends).gradient(ends, point, gradients, moment);
        let [a, b, c, d, e] = by_ends;
        let [f, g, h, i, j] = ends;
        let inputs = [f, g, h, i, j, point];
        let found = [a, b, c, d, e, by_point];
        assert_gradient(inputs, found, 1e-12, |[ends @ .., point]| {
            let turn = Turn::of(ends);
            let angle = turn.sine.atan2(turn.cosine) * Dual::constant(moment);
            turn.moved(point).dot(gradient.map(Dual::constant)) + angle
        });
    }
}
