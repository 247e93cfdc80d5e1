//! Forces between two points: rods, and springs that act on the suspension directly or through a rocker.
//!
//! With the vector v from the fixed to the moving point, l = |v|, u = v/l and the tension T(l), the energy changes by T
//! u.dp. Its second derivative, with T' = dT/dl and the transpose u' of u, is
//!
//! ```text
//! T' u u' + T/l (I - u u')                                                                        (1)
//! ```
//!
//! The change of a rod's length is l - L = (2 v0.d + d.d)/(l + L), with the relative displacement d of its ends (2). This
//! form keeps all digits.
//!
//! A rod with axial stiffness turns a rocker by theta about the rocker's axis. The balance of moments about this axis is
//! a scalar equation, which eliminates theta. Let F be the force on the rod's outer end at p, and K = dF/dp. Let g be the
//! moment about the axis, g' = dg/dtheta, and k = dg/dp with the transpose k'. The tangent, the force and the response of
//! theta are
//!
//! ```text
//! K - k k'/g',   F - k g/g',   dtheta = -(g + k.dp)/g'                                            (3)
//! ```
//!
//! With a rigid rod, theta and the length of the spring are functions of the rod's outer end: see `rod_turn.rs`.
//!
//! An anti-roll bar of the rate k acts between levers at the angles b_l and b_r. It is equivalent to two bars of the rate 2
//! k that meet in the middle, where the twist is t:
//!
//! ```text
//! k (b_l - b_r)^2/2 = min over t of k (b_l - t)^2 + k (b_r - t)^2                                 (4)
//! ```
//!
//! So each wheel has its own part, and the twist is an unknown of the axle.

use super::algebra::cross_matrix;
use super::rod_turn::RodTurn;
use crate::axle::SpringLaw;
use crate::mechanism::Turn;
use crate::number::{MaskOf, Matrix3, SimdReal, Valued, Vector3, outlined};

/// Force at a moving point, with its tangent. The force is the derivative of an energy with respect to the point's
/// position.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointForce<T> {
    /// First derivative of the energy with respect to the point's position.
    pub(super) force: Vector3<T>,
    /// Force after elimination of inner unknowns, as in the equations of balance.
    pub(super) condensed: Vector3<T>,
    /// Second derivative of the energy, after elimination of inner unknowns.
    pub(super) stiffness: Matrix3<T>,
}

impl<T: Valued> PointForce<T> {
    /// Returns a zero force.
    #[inline(always)]
    pub(super) fn none(like: T) -> Self {
        let stiffness = Matrix3::null(like);
        let force = stiffness.columns[0];
        PointForce {
            force,
            condensed: force,
            stiffness,
        }
    }

    /// Removes the change of the moment with the lever arm from the tangent, if `balance_only` is true. The calculation
    /// of the forces at the design load does not need this change.
    #[inline(always)]
    pub(super) fn leverless_if(mut self, balance_only: bool) -> Self {
        if balance_only {
            self.force = self.force.zero();
        }
        self
    }

    #[inline(always)]
    pub(super) fn of(force: Vector3<T>, stiffness: Matrix3<T>) -> Self {
        PointForce {
            force,
            condensed: force,
            stiffness,
        }
    }

    /// Returns the tangents of force and moment on a body with respect to the body's shift and rotation, by equation
    /// (3) of `limb.rs`. The force acts at the end of `lever`.
    #[inline(always)]
    pub(super) fn tangents(&self, lever: Vector3<T>) -> [[Matrix3<T>; 2]; 2] {
        let across = cross_matrix(lever);
        let moment = self.stiffness.crossed_by(lever);
        let twist = moment.times(&across).negated();
        [
            [self.stiffness, self.stiffness.times(&across).negated()],
            [moment, twist.plus(&across.crossed_by(self.force))],
        ]
    }

    /// Makes the force of a tension `pull`, with its tangent by equation (1) of this module. The unit vector `u` points
    /// from the fixed to the moving point.
    #[inline(always)]
    pub(super) fn along(u: Vector3<T>, pull: T, rate: T, inverse_length: T) -> Self {
        let across = pull * inverse_length;
        let mut stiffness = Matrix3::null(pull);
        stiffness.add_product(u, u, rate - across);
        stiffness.add_identity(across);
        PointForce::of(u * pull, stiffness)
    }
}

/// Line between two points: change of its length by equation (2) of this module, present length, and direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretched<T> {
    pub(super) stretch: T,
    pub(super) inverse_length: T,
    pub(super) direction: Vector3<T>,
}

impl<T: Valued> Stretched<T> {
    /// Computes the present line. `designed` is the vector between the points in the design position, and
    /// `displacement` is the change of this vector.
    #[inline(always)]
    pub(super) fn of(designed: Vector3<T>, displacement: Vector3<T>) -> Self {
        let now = designed + displacement;
        let (before, length) = (designed.norm(), now.norm());
        let double = designed.dot(displacement);
        let inverse_length = length.one() / length;
        Stretched {
            stretch: (double + double + displacement.norm_squared()) / (length + before),
            inverse_length,
            direction: now * inverse_length,
        }
    }
}

/// Rocker and the rod that turns it, in the design position.
#[derive(Clone, Debug)]
pub(super) struct RockerSeat<T> {
    /// Two points on the rocker's axis; `inner` is the inner end of the rod.
    pub(super) axis: [Vector3<T>; 2],
    pub(super) inner: Vector3<T>,
    /// End of the spring on the rocker.
    pub(super) spring: Vector3<T>,
    /// Axial stiffness of the rod, and its tension in the design position; `None` for a rigid rod.
    pub(super) rod: Option<[T; 2]>,
}

/// Spring, with the point of the suspension on which it acts. This point is called the seat of the spring.
#[derive(Clone, Debug)]
pub(super) struct Seat<T> {
    /// End of the spring on the suspension, or outer end of the rocker's rod, in the design position.
    pub(super) point: Vector3<T>,
    /// End of the spring on the body.
    pub(super) upper: Vector3<T>,
    /// Law of the spring.
    pub(super) law: SpringLaw<T>,
    pub(super) rocker: Option<RockerSeat<T>>,
    /// True if the spring's upper end is on another body than the arm's axis.
    pub(super) is_across: bool,
}

/// Lever of an anti-roll bar and its drop link, in the design position.
#[derive(Clone, Debug)]
pub(super) struct BarSeat<T> {
    /// Outer end of the drop link. If the drop link is on a rocker: outer end of the rigid rod that turns this rocker.
    pub(super) point: Vector3<T>,
    /// Rocker that carries the drop link, and the point of the drop link on the rocker.
    pub(super) rocker: Option<(RockerSeat<T>, Vector3<T>)>,
    /// Two points on the lever's axis; `inner` is the inner end of the drop link.
    pub(super) axis: [Vector3<T>; 2],
    pub(super) inner: Vector3<T>,
    /// Rate of half the bar: torque per angle between the lever and the bar's middle.
    pub(super) rate: T,
}

/// Force of half an anti-roll bar at the point [`BarSeat::point`], by equation (4) of this module.
#[derive(Clone, Copy, Debug)]
pub(super) struct BarForce<T> {
    pub(super) point: PointForce<T>,
    /// Derivative of the force with respect to the twist of the bar's middle.
    pub(super) by_twist: Vector3<T>,
    /// Derivative of the energy with respect to the twist of the bar's middle.
    pub(super) torque: T,
    /// Angle of the anti-roll bar's lever.
    pub(super) angle: T,
}

impl<T: Valued> BarSeat<T> {
    /// Returns the force for a displacement of the point `point` and a twist of the bar's middle.
    #[inline(always)]
    pub(super) fn force(&self, displacement: Vector3<T>, twist: T) -> BarForce<T> {
        let now = self.point + displacement;
        let (angle, gradient, second) = match &self.rocker {
            None => {
                let lever = RodTurn::of(self.axis, self.inner, self.point, now);
                (lever.angle(), lever.by, lever.second)
            }
            Some((rocker, link)) => {
                let first = RodTurn::of(rocker.axis, rocker.inner, self.point, now);
                let [outer, along, bend] = first.moved(*link);
                let lever = RodTurn::of(self.axis, self.inner, *link, outer);
                let rate = lever.by.dot(along);
                let slope = along.dot(lever.second.apply(along)) + lever.by.dot(bend);
                let (by, second) = first.chained(rate, slope);
                (lever.angle(), by, second)
            }
        };
        let torque = self.rate * (angle - twist);
        let mut stiffness = Matrix3::null(torque);
        stiffness.add_product(gradient, gradient, self.rate);
        for (column, second) in stiffness.columns.iter_mut().zip(second.columns) {
            *column = *column + second * torque;
        }
        BarForce {
            point: PointForce::of(gradient * torque, stiffness),
            by_twist: -(gradient * self.rate),
            torque: -torque,
            angle,
        }
    }
}

/// Response dtheta = -(rest + by.dp) of the rocker's rotation theta to the displacement dp of the rod's outer end, by
/// equation (3) of this module.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slide<T> {
    pub(super) by: Vector3<T>,
    pub(super) rest: T,
}

/// Force on the suspension at the seat of a spring.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeatForce<T: Valued> {
    pub(super) point: PointForce<T>,
    pub(super) slide: Option<Slide<T>>,
    /// Unbalanced moment about the rocker's axis.
    pub(super) moment: T,
    /// False if the rocker alone is unstable.
    pub(super) is_stable: MaskOf<T>,
}

impl<T: Valued> SeatForce<T> {
    /// Makes the force of a spring without a rocker, or with a rocker on a rigid rod.
    #[inline(always)]
    fn plain(point: PointForce<T>) -> Self {
        let like = point.force.x;
        SeatForce {
            point,
            slide: None,
            moment: like.zero(),
            is_stable: like.plain_value().everywhere(),
        }
    }
}

/// Lengths and forces of a spring and its rod.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeatState<T> {
    pub(super) spring_length: T,
    pub(super) design_length: T,
    pub(super) spring_force: T,
    /// Tension of a rod with axial stiffness.
    pub(super) rod_tension: Option<T>,
}

impl<T: Valued> RockerSeat<T> {
    /// Returns the displacement of a point of the rocker at the rotation theta, with its first and second derivative
    /// with respect to theta. `half` is tan(theta/2).
    #[inline(always)]
    fn turned(&self, point: Vector3<T>, half: T) -> [Vector3<T>; 3] {
        let [first, second] = self.axis;
        let axis = (second - first).normalised();
        let lever = (point - first).across(axis);
        let one = half.one();
        let double = half + half;
        let factor = one / (one + half * half);
        let displacement = (axis.cross(lever) - lever * half) * (double * factor);
        let now = lever + displacement;
        [displacement, axis.cross(now), -now]
    }
}

impl<T: Valued> Seat<T> {
    /// Length of the spring in the design position.
    #[inline(always)]
    pub(super) fn design_length(&self) -> T {
        let lower = match &self.rocker {
            Some(rocker) => rocker.spring,
            None => self.point,
        };
        (lower - self.upper).norm()
    }

    /// Returns the force at the seat for a displacement of the seat. If `balance_only` is true (forces at the design
    /// load), the result omits the stiffness of the spring, the tension of an elastic rod and `held`. `slide` is
    /// tan(theta/2) of a rocker with an elastic rod. `held` is an external moment about the rocker's axis.
    #[inline(always)]
    pub(super) fn force(
        &self,
        displacement: Vector3<T>,
        slide: T,
        held: T,
        balance_only: bool,
    ) -> SeatForce<T> {
        outlined!(
            [T: Valued] slide;
            seat: &'p Seat<T> = self, displacement: Vector3<T> = displacement, slide: T = slide, held: T = held,
            balance_only: bool = balance_only => SeatForce<T> {
                seat.force_inline(displacement, slide, held, balance_only)
            }
        )
    }

    #[inline(always)]
    fn force_inline(
        &self,
        displacement: Vector3<T>,
        slide: T,
        held: T,
        balance_only: bool,
    ) -> SeatForce<T> {
        let like = slide;
        match &self.rocker {
            None => {
                let designed = self.point - self.upper;
                let line = Stretched::of(designed, displacement);
                let design = designed.norm();
                let (force, rate) = self.law.at(design + line.stretch, design);
                if balance_only {
                    let force = -(line.direction * force);
                    return SeatForce::plain(PointForce::of(force, Matrix3::null(like)));
                }
                SeatForce::plain(PointForce::along(
                    line.direction,
                    -force,
                    rate,
                    line.inverse_length,
                ))
            }
            Some(rocker) => match rocker.rod {
                None => {
                    SeatForce::plain(self.through_rigid_rod(rocker, displacement, balance_only))
                }
                Some(rod) => self.through_rod(rocker, rod, displacement, slide, held, balance_only),
            },
        }
    }

    #[inline(always)]
    fn through_rigid_rod(
        &self,
        rocker: &RockerSeat<T>,
        displacement: Vector3<T>,
        balance_only: bool,
    ) -> PointForce<T> {
        let turn = RodTurn::of(
            rocker.axis,
            rocker.inner,
            self.point,
            self.point + displacement,
        );
        let [end, along, bend] = turn.moved(rocker.spring);
        let line = end - self.upper;
        let length = line.norm();
        let direction = line * (length.one() / length);
        let slope = direction.dot(along);
        let second = (along.norm_squared() - slope * slope) / length + direction.dot(bend);
        let (gradient, second) = turn.chained(slope, second);
        let (force, rate) = self.law.at(length, self.design_length());
        let mut stiffness = Matrix3::null(force);
        if !balance_only {
            stiffness.add_product(gradient, gradient, rate);
            for (column, second) in stiffness.columns.iter_mut().zip(second.columns) {
                *column = *column - second * force;
            }
        }
        PointForce::of(-(gradient * force), stiffness)
    }

    #[inline(always)]
    fn through_rod(
        &self,
        rocker: &RockerSeat<T>,
        [rate, tension]: [T; 2],
        displacement: Vector3<T>,
        slide: T,
        held: T,
        balance_only: bool,
    ) -> SeatForce<T> {
        let [end, end_by, end_second] = rocker.turned(rocker.inner, slide);
        let rod = Stretched::of(self.point - rocker.inner, displacement - end);
        let pull = if balance_only {
            slide.zero()
        } else {
            tension + rate * rod.stretch
        };
        let point = PointForce::along(rod.direction, pull, rate, rod.inverse_length);
        let [_, by, second] = rocker.turned(rocker.spring, slide);
        let (length, force, spring_rate) = self.spring_on(rocker, slide);
        let along = self.spring_vector(rocker, slide) * (length.one() / length);
        let lever = along.dot(by);
        let mut moment = -(force * lever) - point.force.dot(end_by) - held;
        let turned = point.stiffness.apply(end_by);
        let mut slope = end_by.dot(turned);
        if balance_only {
            moment = -(force * lever);
        } else {
            let bent = (by.norm_squared() - lever * lever) / length + along.dot(second);
            slope =
                slope + spring_rate * lever * lever - force * bent - point.force.dot(end_second);
        }
        let inverse = slope.one() / slope;
        let mut stiffness = point.stiffness;
        stiffness.add_product(turned, turned, -inverse);
        SeatForce {
            point: PointForce {
                force: point.force,
                condensed: point.force + turned * (moment * inverse),
                stiffness,
            },
            slide: Some(Slide {
                by: -(turned * inverse),
                rest: moment * inverse,
            }),
            moment,
            is_stable: slope.is_above(0.0),
        }
    }

    /// Returns the vector from the spring's upper end to its lower end on a rocker.
    #[inline(always)]
    fn spring_vector(&self, rocker: &RockerSeat<T>, slide: T) -> Vector3<T> {
        rocker.spring - self.upper + rocker.turned(rocker.spring, slide)[0]
    }

    #[inline(always)]
    fn spring_on(&self, rocker: &RockerSeat<T>, slide: T) -> (T, T, T) {
        let designed = rocker.spring - self.upper;
        let moved = rocker.turned(rocker.spring, slide)[0];
        let design = designed.norm();
        let length = design + Stretched::of(designed, moved).stretch;
        let (force, rate) = self.law.at(length, design);
        (length, force, rate)
    }

    /// Adds the tension at the design load to the constant tension of the rod. The tension at the design load is
    /// computed from a small shift of the rod's outer end and a small rotation of the rocker.
    pub(super) fn preload_rod(&mut self, moved: Vector3<T>, slide: T) {
        let point = self.point;
        let Some(rocker) = &mut self.rocker else {
            return;
        };
        let [_, by, _] = rocker.turned(rocker.inner, slide.zero());
        let along = (point - rocker.inner).normalised();
        if let Some([rate, tension]) = &mut rocker.rod {
            *tension = *tension + *rate * along.dot(moved - by * slide);
        }
    }

    /// Returns the lengths and forces of spring and rod for a displacement of the seat.
    pub(super) fn state(&self, displacement: Vector3<T>, slide: T) -> SeatState<T> {
        let design_length = self.design_length();
        let (spring_length, rod_tension) = match &self.rocker {
            None => {
                let line = Stretched::of(self.point - self.upper, displacement);
                (design_length + line.stretch, None)
            }
            Some(rocker) => match rocker.rod {
                None => {
                    let [first, second] = rocker.axis;
                    let outer = self.point + displacement;
                    let ends = [first, second, rocker.inner, self.point, outer];
                    let end = Turn::of(ends).moved(rocker.spring);
                    ((end - self.upper).norm(), None)
                }
                Some([rate, tension]) => {
                    let [end, ..] = rocker.turned(rocker.inner, slide);
                    let rod = Stretched::of(self.point - rocker.inner, displacement - end);
                    let (length, ..) = self.spring_on(rocker, slide);
                    (length, Some(tension + rate * rod.stretch))
                }
            },
        };
        SeatState {
            spring_length,
            design_length,
            spring_force: self.law.at(spring_length, design_length).0,
            rod_tension,
        }
    }
}
