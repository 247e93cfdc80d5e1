//! Arms with rigid or elastic legs (rods) on which a spring or the drop link of an anti-roll bar acts.
//!
//! The spring or drop link acts at the seat, a point of the arm. The seat is fixed in the frame of the arm's axis (unit
//! vector e) and outer joint. Let r be the unit vector from the axis to the joint, n = e x r, and l the joint's distance
//! from the axis. Let b and c be the seat's distances along r and n, and r' and n' the transposes of r and n. A force F
//! at the seat is equivalent to the following force at the joint. The tangent is its derivative with respect to the
//! joint's displacement, if F is constant:
//!
//! ```text
//! n p/l,   p = F.(b n - c r);   tangent -(p/l^2)(r n' + n r') - (F.(b r + c n)/l^2) n n'          (1)
//! ```

#![expect(
    clippy::needless_range_loop,
    reason = "rows and columns of matrices are named by their numbers"
)]

use super::algebra::Placed;
use super::limb::{Beside, Conditions, Evaluated, Followers, LimbState, Sum, TWIST_BESIDE};
use super::point::{BarSeat, PointForce, Seat, SeatForce, Stretched};
use crate::number::{Matrix3, Real, Valued, Vector3, outlined};

/// Point of an arm with rigid or elastic legs.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegPoint<T> {
    /// Vector from the carrier's reference point to the outer joint.
    pub(super) joint: Vector3<T>,
    /// Unit vector along the arm's axis.
    pub(super) axis: Vector3<T>,
    /// Vector from the axis to the outer joint, normal to the axis.
    pub(super) radius: Vector3<T>,
    /// Distances b and c of the point, as in equation (1) of this module.
    pub(super) place: [T; 2],
}

/// Spring that acts on an arm with rigid or elastic legs.
#[derive(Clone, Debug)]
pub(super) struct LegSeat<T> {
    pub(super) leg: LegPoint<T>,
    pub(super) seat: Seat<T>,
}

/// Present frame of an arm with legs: r, n, 1/l, b and c of equation (1) of this module, and the displacement of the
/// point.
struct LegFrame<T> {
    radial: Vector3<T>,
    normal: Vector3<T>,
    inverse: T,
    moved: Vector3<T>,
    /// Rotation of the arm per displacement of the joint.
    along: Vector3<T>,
    /// Displacement of the point per rotation of the arm.
    arm: Vector3<T>,
    place: [T; 2],
}

impl<T: Valued> LegFrame<T> {
    /// Returns the force at the outer joint that is equivalent to a force at the point, by equation (1) of this module.
    #[inline(always)]
    fn at_joint(&self, point: &PointForce<T>, balance_only: bool) -> PointForce<T> {
        let (r, n, [b, c]) = (self.radial, self.normal, self.place);
        let at_joint = |force: Vector3<T>| self.along * self.arm.dot(force);
        let mut stiffness = Matrix3::null(b);
        let bend = self.arm.dot(point.stiffness.apply(self.arm));
        stiffness.add_product(self.along, self.along, bend);
        if !balance_only {
            let square = self.inverse * self.inverse;
            let turning = -(self.arm.dot(point.force) * square);
            stiffness.add_product(r, n, turning);
            stiffness.add_product(n, r, turning);
            let radial = (r * b + n * c).dot(point.force) * square;
            stiffness.add_product(n, n, -radial);
        }
        PointForce {
            force: at_joint(point.force),
            condensed: at_joint(point.condensed),
            stiffness,
        }
    }
}

impl<T: Valued> LegPoint<T> {
    #[inline(always)]
    fn frame(&self, carrier: &Placed<T>) -> LegFrame<T> {
        let moved = carrier.displacement(self.joint).across(self.axis);
        let line = Stretched::of(self.radius, moved);
        let before = self.radius.normalised();
        // The difference r - r0 is computed from the displacement, so it keeps all digits.
        let change = (moved - before * line.stretch) * line.inverse_length;
        let turned = self.axis.cross(change);
        let (radial, normal) = (line.direction, self.axis.cross(line.direction));
        LegFrame {
            radial,
            normal,
            inverse: line.inverse_length,
            moved: change * self.place[0] + turned * self.place[1],
            along: normal * line.inverse_length,
            arm: normal * self.place[0] - radial * self.place[1],
            place: self.place,
        }
    }

    /// Returns the shift of the seat for a small step of the joint from the design position.
    pub(super) fn shift(&self, joint: Vector3<T>) -> Vector3<T> {
        let r = self.radius.normalised();
        let n = self.axis.cross(r);
        let turn = n.dot(joint) / self.radius.norm();
        (n * self.place[0] - r * self.place[1]) * turn
    }

    /// Returns the displacement of the point.
    #[inline(always)]
    pub(super) fn displacement(&self, carrier: &Placed<T>) -> Vector3<T> {
        self.frame(carrier).moved
    }
}

impl<T: Valued> LegSeat<T> {
    /// Returns the displacement of the seat. If the spring's upper end is on another body, the displacement is relative
    /// to this end.
    #[inline(always)]
    pub(super) fn displacement(&self, at: &Conditions<T>) -> Vector3<T> {
        let moved = self.leg.displacement(&at.carrier);
        if self.seat.is_across {
            moved - at.upper
        } else {
            moved
        }
    }

    #[inline(always)]
    pub(super) fn evaluate(
        &self,
        at: &Conditions<T>,
        state: &LimbState<T>,
        held: &[T; 7],
        sum: &mut Sum<T>,
        beside: Option<&mut Beside<T>>,
    ) -> Evaluated<T> {
        outlined!(
            [T: Valued] at.rack;
            own: &'p LegSeat<T> = self, at: &'p Conditions<T> = at, state: &'p LimbState<T> = state,
            held: &'p [T; 7] = held, sum: &'p mut Sum<T> = sum,
            beside: Option<&'p mut Beside<T>> = beside => Evaluated<T> {
                own.evaluate_inline(at, state, held, sum, beside)
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
        beside: Option<&mut Beside<T>>,
    ) -> Evaluated<T> {
        let frame = self.leg.frame(&at.carrier);
        let SeatForce {
            point,
            slide,
            moment,
            is_stable,
        } = self
            .seat
            .force(self.displacement(at), state.slide, held[6], at.balance_only);
        let lever = at.carrier.lever(self.leg.joint);
        if let Some(beside) = beside.filter(|_| self.seat.is_across) {
            let across = point.stiffness.apply(frame.arm).to_array();
            for k in 0..3 {
                beside.force[k] = -point.force.to_array()[k];
                for j in 0..3 {
                    beside.own[k][j] = point.stiffness.entry(k, j);
                }
                let by = -(frame.along * across[k]);
                beside.couple(k, lever, by, by);
            }
        }
        let at_joint = frame.at_joint(&point, at.balance_only);
        sum.add_point(lever, &at_joint.leverless_if(at.balance_only));
        let slide = slide.map(|slide| (frame.along * frame.arm.dot(slide.by), slide.rest));
        let mut inner = [at.rack.zero(); 7];
        inner[6] = moment;
        Evaluated {
            followers: Followers::of_joint(lever, slide),
            inner,
            is_stable,
            least_pivot: at.rack.plain_value().one(),
        }
    }
}

/// Drop link of an anti-roll bar. Its outer end is on the carrier, on an arm with legs, or on a rocker. If it is on a
/// rocker, the outer end of the rocker's rod takes its place in [`BarFoot`].
#[derive(Clone, Debug)]
pub(super) struct BarPart<T> {
    pub(super) foot: BarFoot<T>,
    pub(super) seat: BarSeat<T>,
}

/// Part on which the outer end of a drop link (or of the rod of its rocker) is.
#[derive(Clone, Copy, Debug)]
pub(super) enum BarFoot<T> {
    /// Point on the carrier, as a vector from the carrier's reference point.
    Carrier(Vector3<T>),
    /// Point on an arm with legs.
    Leg(LegPoint<T>),
}

impl<T: Valued> BarPart<T> {
    /// Displacement of the outer end of the drop link (or of the rod of its rocker).
    fn displacement(&self, carrier: &Placed<T>) -> Vector3<T> {
        match &self.foot {
            BarFoot::Carrier(lever) => carrier.displacement(*lever),
            BarFoot::Leg(leg) => leg.displacement(carrier),
        }
    }

    /// Angle of the anti-roll bar's lever.
    pub(super) fn angle(&self, at: &Conditions<T>) -> T {
        let moved = self.displacement(&at.carrier);
        self.seat.force(moved, at.twist).angle
    }

    #[inline(always)]
    pub(super) fn evaluate(&self, at: &Conditions<T>, sum: &mut Sum<T>, beside: &mut Beside<T>) {
        outlined!(
            [T: Valued] at.rack;
            own: &'p BarPart<T> = self, at: &'p Conditions<T> = at, sum: &'p mut Sum<T> = sum,
            beside: &'p mut Beside<T> = beside => () {
                own.evaluate_inline(at, sum, beside)
            }
        )
    }

    #[inline(always)]
    fn evaluate_inline(&self, at: &Conditions<T>, sum: &mut Sum<T>, beside: &mut Beside<T>) {
        let force = self.seat.force(self.displacement(&at.carrier), at.twist);
        beside.force[TWIST_BESIDE] = force.torque;
        beside.own[TWIST_BESIDE][TWIST_BESIDE] = self.seat.rate;
        match &self.foot {
            BarFoot::Carrier(lever) => {
                let lever = at.carrier.lever(*lever);
                sum.add_point(lever, &force.point);
                beside.couple(TWIST_BESIDE, lever, force.by_twist, force.by_twist);
            }
            BarFoot::Leg(leg) => {
                let frame = leg.frame(&at.carrier);
                let lever = at.carrier.lever(leg.joint);
                sum.add_point(lever, &frame.at_joint(&force.point, false));
                let by = frame.along * frame.arm.dot(force.by_twist);
                beside.couple(TWIST_BESIDE, lever, by, by);
            }
        }
    }
}
