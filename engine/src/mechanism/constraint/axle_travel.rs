//! One of the two travels of a rigid axle (see `model/rigid_axle.rs`).
//!
//! With z_n and z_f the heights of the near and the far wheel centre over their design positions, s = 1 for the mean or
//! s = -1 for the difference, and r the value that is held, where other mechanisms have the rack's displacement:
//!
//! ```text
//! F  = (z_n + s z_f)/2 - r                                          (1)
//! dF = (dz_n + s dz_f)/2 - dr                                       (2)
//! f  = (1 + s)/2 z,   m = (l_n + s l_f)/2 x z,   q = -1             (3)
//! ```
//!
//! l_n and l_f are the levers of both centres about the origin, z the vertical unit vector. Rates along the motion (v, w):
//!
//! ```text
//! f' = 0,   m' = (w x (l_n + s l_f)/2) x z,   q' = 0                (4)
//! ```
//!
//! The heights of a steered axle are those over the places that the wheel centres have after their turn, the axle at rest, and r is
//! smaller by the same amount (see (4) of `model/steered_axle.rs`). Derivatives by hardpoints hold the travel from the hardpoints
//! themselves, so they are those of the height over the hardpoint.
//!
//! F is linear in the pose. The far wheel of a twist beam stands on a rocker of the near half, and both wheels of a
//! steered axle stand on rockers. Then the wrench of the height and its rate are those of a force on a rocker (see
//! `rocker_end.rs`), and F is not linear.

use super::rocker_end::constant_push_rate;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{AxleTravel, Body, PointId};
use crate::number::{Real, Vector3};

/// Travel of a rigid axle, as a function of the pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TravelRow {
    /// Both wheel centres, each with its factor in (1).
    centres: [(PointId, f64); 2],
}

impl TravelRow {
    /// Makes the mean or the difference of the heights of both wheel centres.
    #[inline(always)]
    pub(crate) fn new(near: PointId, far: PointId, travel: AxleTravel) -> Self {
        TravelRow {
            centres: [(near, 0.5), (far, 0.5 * travel.far_sign())],
        }
    }

    /// Centre of the far wheel.
    pub(crate) fn far(&self) -> PointId {
        self.centres[1].0
    }

    /// Travel in a pose: (1) without r.
    #[inline(always)]
    pub(crate) fn value<T: Real>(&self, at: &Configuration<T>) -> T {
        let [(near, near_factor), (far, far_factor)] = self.centres;
        let [over_near, over_far] = match at.mechanism.axle_steering() {
            None => [near, far],
            Some(steering) => steering.turned_centres,
        };
        let near = self.place(at, near).z - at.designed(over_near).z;
        let far = self.place(at, far).z - at.designed(over_far).z;
        near.scaled(near_factor) + far.scaled(far_factor)
    }

    #[inline(always)]
    fn place<T: Real>(&self, at: &Configuration<T>, id: PointId) -> Vector3<T> {
        match at.mechanism.body(id) {
            Body::Rocker(_) => at.point(id),
            _ => at.carried(id),
        }
    }

    /// Adds `weight` times (2), without dr.
    #[inline(always)]
    pub(crate) fn push<T: Real>(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let zero = weight.zero();
        for (id, factor) in self.centres {
            let up = Vector3::new(zero, zero, weight.scaled(factor));
            match at.mechanism.body(id) {
                Body::Rocker(_) => at.push_point(id, up, sink),
                _ => at.push_carried(id, up, sink),
            }
            sink.hardpoint(id, -up);
        }
    }

    /// Equation (4).
    #[inline(always)]
    pub(crate) fn wrench_rate<T: Real>(
        &self,
        at: &Configuration<T>,
        along: &Twist<T>,
    ) -> Wrench<T> {
        let mut wrench = Wrench::zero(at.rack);
        let mut levers = Vector3::new(at.rack, at.rack, at.rack).zero();
        for (id, factor) in self.centres {
            match at.mechanism.body(id) {
                Body::Rocker(_) => {
                    let zero = at.rack.zero();
                    let up = Vector3::new(zero, zero, zero.constant(factor));
                    let rate = constant_push_rate(id, up, at, along);
                    wrench.force = wrench.force + rate.force;
                    wrench.moment = wrench.moment + rate.moment;
                }
                _ => levers = levers + at.designed_lever(id).map(|c| c.scaled(factor)),
            }
        }
        let velocity = along.turn.cross(at.pose.rotation.apply(levers));
        let moment = Vector3::new(velocity.y, -velocity.x, velocity.x.zero());
        wrench.moment = wrench.moment + moment;
        wrench
    }

    /// Equation (1).
    #[inline(always)]
    pub(crate) fn residual<T: Real>(&self, at: &Configuration<T>) -> T {
        self.value(at) - at.rack
    }

    /// Adds `weight` times (2).
    #[inline(always)]
    pub(crate) fn differential<T: Real>(
        &self,
        at: &Configuration<T>,
        weight: T,
        sink: &mut impl Sink<T>,
    ) {
        self.push(at, weight, sink);
        sink.rack(-weight);
    }
}
