//! Parts at the carrier itself: the top mount of a strut, a spring on the carrier, rigid rods and joints.
//!
//! **Top mount.** The strut's line is fixed in the carrier, along the unit vector a. A point of the carrier, at the
//! vector l from the carrier's reference point, coincides with `strut_top` in the design position. The mount is on the
//! line, at the distance t from that point of the carrier. With the carrier's shift u and rotation R (D = R - I), the
//! mount moves by d. Small changes du and dt and a small rotation w change d by dd:
//!
//! ```text
//! d = u + D l + a t,   dd = du + w x r + a dt,   r = R l + a t                                    (1)
//! ```
//!
//! A bushing with three rates holds the mount. The spring acts between its lower end on the carrier and the mount. The
//! rod of the strut can rotate freely about its line. The tilt of the strut from its direction a0 in the design position,
//!
//! ```text
//! q = (a0 x a) s/sin s,   cos s = a0.a                                                            (2)
//! ```
//!
//! has components about the mount's x and y axes.

use super::algebra::{angle_by_sine, cross_matrix, second_order};
use super::bushing::Bushing;
use super::limb::{Conditions, Evaluated, Followers, LimbState, Sum, joined, tangent_of};
use super::point::{PointForce, Seat, Stretched};
use crate::axle::SpringLaw;
use crate::number::{Dual, Each, Matrix3, Real, SimdReal, Valued, Vector3, outlined};

/// Top mount of a strut with its spring.
#[derive(Clone, Debug)]
pub(super) struct Mount<T> {
    /// Vector from the carrier's reference point to `strut_top`.
    pub(super) top: Vector3<T>,
    /// Direction a0 of the strut in the design position.
    pub(super) along: Vector3<T>,
    /// Vector from the spring's lower end to `strut_top`.
    pub(super) spring_line: Vector3<T>,
    pub(super) bushing: Bushing<T>,
    pub(super) spring: Option<SpringLaw<T>>,
}

/// Deflections and forces of a top mount.
#[derive(Clone, Copy, Debug)]
pub(super) struct MountState<T> {
    /// Deflection of the mount's bushing, in the mount's axes.
    pub(super) deflection: Vector3<T>,
    /// Force of the bushing of the mount.
    pub(super) force: Vector3<T>,
    pub(super) tilt: [T; 2],
    pub(super) tilt_torque: [T; 2],
    pub(super) spring_length: T,
    pub(super) design_length: T,
    pub(super) spring_force: T,
}

impl<T: Valued> Mount<T> {
    fn displacement(&self, at: &Conditions<T>, slide: T) -> Vector3<T> {
        let along = at.carrier.lever(self.along);
        at.carrier.displacement(self.top) + along * slide
    }

    /// Returns the length of the spring, with its first and second derivative with respect to the sliding distance t of
    /// equation (1) of this module.
    fn spring_length(&self, slide: T) -> (T, T, T) {
        let moved = self.along * slide;
        let line = Stretched::of(self.spring_line, moved);
        let length = self.spring_line.norm() + line.stretch;
        let slope = line.direction.dot(self.along);
        (
            length,
            slope,
            (slope.one() - slope * slope) * line.inverse_length,
        )
    }

    /// Returns the tilt for a direction `along` of the strut, by equation (2) of this module.
    fn tilt(&self, along: Vector3<T>) -> [T; 2] {
        let across = self.along.cross(along);
        let ratio = angle_by_sine(across.norm_squared(), self.along.dot(along));
        let [x, y, _] = self.bushing.axes.columns;
        [x.dot(across) * ratio, y.dot(across) * ratio]
    }

    pub(super) fn state(&self, at: &Conditions<T>, state: &LimbState<T>) -> MountState<T> {
        let nothing = Matrix3::null(at.rack);
        let bushing = self
            .bushing
            .state(self.displacement(at, state.slide), &nothing);
        let (spring_length, ..) = self.spring_length(state.slide);
        let design_length = self.spring_line.norm();
        let tilt = self.tilt(at.carrier.lever(self.along));
        let torque = |k: usize| self.bushing.laws[3 + k].at(tilt[k]).0;
        let law = self.spring.as_ref();
        MountState {
            deflection: bushing.deflection,
            force: bushing.force,
            tilt,
            tilt_torque: [torque(0), torque(1)],
            spring_length,
            design_length,
            spring_force: law.map_or(at.rack.zero(), |law| law.at(spring_length, design_length).0),
        }
    }

    /// Adds the moment of the mount against the tilt, and its tangent.
    fn add_tilt(&self, along: Vector3<T>, sum: &mut Sum<T>) {
        let mut by_turn = Matrix3::null(along.x);
        let mut moment = by_turn.columns[0];
        let constant = |v: Vector3<T>| v.map(|c| Dual::constant(Dual::constant(c)));
        for k in 0..2 {
            let nothing = along.zero().to_array();
            let (tilt, gradient, second) = second_order(nothing, |turn| {
                let (turn, along) = (Vector3::from(turn), constant(along));
                let once = turn.cross(along);
                let now = along + once + turn.cross(once).scaled(0.5);
                let across = constant(self.along).cross(now);
                let cosine = constant(self.along).dot(now);
                let ratio = angle_by_sine(across.norm_squared(), cosine);
                constant(self.bushing.axes.columns[k]).dot(across) * ratio
            });
            let (torque, rate) = self.bushing.laws[3 + k].at(tilt);
            let gradient = Vector3::from(gradient);
            moment = moment + gradient * torque;
            by_turn.add_product(gradient, gradient, rate);
            for (column, second) in by_turn.columns.iter_mut().zip(second) {
                *column = *column + Vector3::from(second) * torque;
            }
        }
        // The second derivative is with respect to the rotation vector. Half of the moment is subtracted to convert it
        // to small rotations about fixed axes.
        let half = moment * moment.x.constant(-0.5);
        sum.add_moment(moment, &by_turn.plus(&cross_matrix(half)));
    }

    pub(super) fn evaluate(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Option<Evaluated<T>> {
        let like = at.rack;
        let nothing = Matrix3::null(like);
        let along = at.carrier.lever(self.along);
        let lever = at.carrier.lever(self.top) + along * state.slide;
        let bushing = if at.balance_only {
            self.bushing.slack()
        } else {
            let moved = self.displacement(at, state.slide);
            self.bushing.force(moved, &nothing, None)
        };
        let (force, stiffness) = (bushing.force, bushing.by_shift);
        sum.add_point(lever, &PointForce::of(force, stiffness));
        if !at.balance_only {
            self.add_tilt(along, sum);
        }
        let (length, slope, bend) = self.spring_length(state.slide);
        let spring = self.spring.as_ref();
        let (push, rate) = spring.map_or((like.zero(), like.zero()), |law| {
            law.at(length, self.spring_line.norm())
        });
        let turned = stiffness.apply(along);
        let moment = along.dot(force) - push * slope - held[0];
        let mut own = along.dot(turned);
        if !at.balance_only {
            own = own + rate * slope * slope - push * bend;
        }
        let twisted = along.cross(force) + lever.cross(turned);
        let by = [
            turned.x, turned.y, turned.z, twisted.x, twisted.y, twisted.z,
        ];
        let by = by.each(|c| tangent_of(c, at.is_correction));
        let own = tangent_of(own, at.is_correction);
        let inverse = own.one() / own;
        let mut followers = Followers::of_one(like);
        for i in 0..6 {
            followers.by[0][i] = by[i] * inverse;
            sum.force[i] = sum.force[i] - by[i] * (moment * inverse);
            for j in 0..6 {
                sum.tangent[i][j] = sum.tangent[i][j] - by[i] * by[j] * inverse;
            }
        }
        followers.rest[0] = moment * inverse;
        let mut inner = [like.zero(); 7];
        inner[0] = moment;
        let (size, is_stable) = (own.plain_value(), own.is_above(0.0));
        T::Plain::any(size.abs().is_below(f64::INFINITY)).then_some(Evaluated {
            followers,
            inner,
            is_stable,
            least_pivot: <T::Plain as SimdReal>::select(is_stable, size.one(), size.zero()),
        })
    }
}

/// Spring that acts directly on the carrier.
#[derive(Clone, Debug)]
pub(super) struct CarrierSeat<T> {
    /// Vector from the carrier's reference point to the seat.
    pub(super) lever: Vector3<T>,
    pub(super) seat: Seat<T>,
}

impl<T: Valued> CarrierSeat<T> {
    #[inline(always)]
    pub(super) fn evaluate(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Evaluated<T> {
        outlined!(
            [T: Valued] at.rack;
            own: &'p CarrierSeat<T> = self, at: &'p Conditions<T> = at, state: &'p LimbState<T> = state,
            held: &'p [T; 7] = held, sum: &'p mut Sum<T> = sum => Evaluated<T> {
                own.evaluate_inline(at, state, held, sum)
            }
        )
    }

    #[inline(always)]
    fn evaluate_inline(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
    ) -> Evaluated<T> {
        let moved = at.carrier.displacement(self.lever);
        let force = self
            .seat
            .force(moved, state.slide, held[6], at.balance_only);
        let lever = at.carrier.lever(self.lever);
        sum.add_point(lever, &force.point.leverless_if(at.balance_only));
        let mut inner = [at.rack.zero(); 7];
        inner[6] = force.moment;
        Evaluated {
            followers: Followers::of_carrier(
                at.rack,
                force.slide.map(|slide| (lever, slide.by, slide.rest)),
            ),
            inner,
            is_stable: force.is_stable,
            least_pivot: at.rack.plain_value().one(),
        }
    }
}

/// Rod between body or rack and the carrier, rigid or with axial stiffness.
#[derive(Clone, Debug)]
pub(super) struct RodPart<T> {
    /// Vector from the carrier's reference point to the outer end.
    pub(super) joint: Vector3<T>,
    /// Vector from the inner to the outer end.
    pub(super) along: Vector3<T>,
    pub(super) on_rack: bool,
    /// Axial stiffness and tension in the design position; `None` for a rigid rod.
    pub(super) elastic: Option<[T; 2]>,
}

impl<T: Valued> RodPart<T> {
    #[inline(always)]
    pub(super) fn line(&self, at: &Conditions<T>) -> Stretched<T> {
        let moved = at.carrier.displacement(self.joint) - at.ground(self.on_rack);
        Stretched::of(self.along, moved)
    }

    /// Adds the force and the tangent of a rod with axial stiffness.
    pub(super) fn add(&self, at: &Conditions<T>, elastic: [T; 2], sum: &mut Sum<T>) {
        outlined!(
            [T: Valued] at.rack;
            rod: &'p RodPart<T> = self, at: &'p Conditions<T> = at, elastic: [T; 2] = elastic,
            sum: &'p mut Sum<T> = sum => () {
                rod.add_inline(at, elastic, sum);
            }
        );
    }

    #[inline(always)]
    fn add_inline(&self, at: &Conditions<T>, [rate, tension]: [T; 2], sum: &mut Sum<T>) {
        let line = self.line(at);
        let pull = if at.balance_only {
            rate.zero()
        } else {
            tension + rate * line.stretch
        };
        let point = PointForce::along(line.direction, pull, rate, line.inverse_length);
        sum.add_point(at.carrier.lever(self.joint), &point);
    }
}

/// Rigid joint of the carrier: it adds one equation, and its force is an unknown.
#[derive(Clone, Debug)]
pub(super) enum Joint<T> {
    /// Rigid rod: the distance between its ends is constant.
    Rod(RodPart<T>),
    /// Equation of a rigid mount of a strut. Two such equations keep the mount on the line of the strut.
    Line {
        /// Direction on the carrier normal to the line, in the design position.
        normal: Vector3<T>,
        /// Vector from the carrier's reference point to `strut_top`.
        top: Vector3<T>,
    },
    /// Point of the carrier that is fixed in one direction of the body.
    Pin {
        /// Vector from the carrier's reference point to the fixed point.
        lever: Vector3<T>,
        /// Direction in which the body holds the point.
        direction: Vector3<T>,
    },
}

impl<T: Valued> Joint<T> {
    /// Returns true if the rack holds the joint.
    pub(super) fn is_on_rack(&self) -> bool {
        matches!(self, Joint::Rod(rod) if rod.on_rack)
    }

    /// Returns the residual of the joint's equation, and its derivatives with respect to the carrier's motion. Adds the
    /// joint's force and its tangent to the sum.
    #[inline(always)]
    pub(super) fn evaluate(&self, at: &Conditions<T>, force: T, sum: &mut Sum<T>) -> (T, [T; 6]) {
        outlined!(
            [T: Valued] force;
            joint: &'p Joint<T> = self, at: &'p Conditions<T> = at, force: T = force,
            sum: &'p mut Sum<T> = sum => (T, [T; 6]) {
                joint.evaluate_inline(at, force, sum)
            }
        )
    }

    #[inline(always)]
    fn evaluate_inline(&self, at: &Conditions<T>, force: T, sum: &mut Sum<T>) -> (T, [T; 6]) {
        match self {
            Joint::Rod(rod) => {
                let line = rod.line(at);
                let lever = at.carrier.lever(rod.joint);
                let point =
                    PointForce::along(line.direction, force, force.zero(), line.inverse_length);
                sum.add_point(lever, &point);
                (
                    line.stretch,
                    joined(line.direction, lever.cross(line.direction)),
                )
            }
            Joint::Line { normal, top } => {
                let moved = at.carrier.displacement(*top);
                let normal = at.carrier.lever(*normal);
                let lever = at.carrier.lever(*top) - moved;
                // The force acts at a fixed point of the body. Relative to the moving carrier, this point moves by dr =
                // -du.
                let pull = normal * force;
                let nothing = Matrix3::null(force);
                let across = cross_matrix(pull);
                sum.add_force(pull, lever.cross(pull));
                sum.add_blocks([
                    [&nothing, &across.negated()],
                    [&across, &across.crossed_by(lever).negated()],
                ]);
                (normal.dot(moved), joined(normal, lever.cross(normal)))
            }
            Joint::Pin { lever, direction } => {
                let now = at.carrier.lever(*lever);
                let pull = PointForce::of(*direction * force, Matrix3::null(force));
                sum.add_point(now, &pull);
                let residual = direction.dot(at.carrier.displacement(*lever));
                (residual, joined(*direction, now.cross(*direction)))
            }
        }
    }
}
