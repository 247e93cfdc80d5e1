//! One of the two travels of a rigid axle (see `model/rigid_axle.rs`).
//!
//! The axle is described as seen from one wheel, the near wheel. The wheel on the other side is the far wheel. z_n and z_f are
//! the heights of the near and the far wheel centre above their design positions. s = 1 for the mean and s = -1 for the
//! difference. r is the prescribed value. Other mechanisms prescribe the rack's displacement instead.
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
//! For a steered axle, heights count from the positions of the wheel centres after the knuckles have turned, with the axle
//! itself at rest. Then r is smaller by the travel that the steering alone causes (see (4) of `model/steered_axle.rs`). A
//! row computes these positions from its design. Derivatives with respect to hardpoints are taken at constant travel, and
//! travel counts from the hardpoints. So a row differentiates the height of a wheel centre above its hardpoint.
//!
//! F is linear in the pose, with two exceptions. The far wheel of a twist beam is on a rocker of the near half, and both
//! wheels of a steered axle are on rockers. Then F is not linear. The wrench of a wheel centre's height and the rate of
//! this wrench are then computed as for a force on a rocker (see `rocker_end.rs`).

use super::rocker_end::constant_push_rate;
use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Pose, Twist, Wrench};
use crate::model::{AxleTravel, Body, Mechanism, PointId};
use crate::number::{Each, Matrix3, Real, Vector3};

/// Heights of two wheel centres with the axle at rest. The steering gear of a steered axle may have turned the knuckles.
#[inline(always)]
pub(crate) fn heights_at_rest<T: Real>(
    mechanism: &Mechanism,
    centres: [PointId; 2],
    design: &[Vector3<T>],
) -> [T; 2] {
    if mechanism.axle_steering().is_none() {
        return centres.each(|id| design[id.0].z);
    }
    let zero = design[0].x.zero();
    let pose = Pose {
        origin: design[mechanism.origin.0],
        rotation: Matrix3::identity(zero.one()),
    };
    let at = Configuration::new(mechanism, design, pose, zero);
    [at.point(centres[0]).z, at.point(centres[1]).z]
}

/// Travel of a rigid axle, as a function of the pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TravelRow<T> {
    /// Both wheel centres, each with the factor of its height in equation (1).
    centres: [(PointId, f64); 2],
    /// Heights from which z_n and z_f count.
    zeros: [T; 2],
}

impl<T: Real> TravelRow<T> {
    /// Makes the equation for one travel of an axle: the mean of the heights of both wheel centres, or half their difference. The
    /// heights count from `zeros`.
    #[inline(always)]
    pub(crate) fn new([near, far]: [PointId; 2], travel: AxleTravel, zeros: [T; 2]) -> Self {
        TravelRow {
            centres: [(near, 0.5), (far, 0.5 * travel.far_sign())],
            zeros,
        }
    }

    /// Makes the equation for the other travel of this axle: half the difference instead of the mean, or the mean instead of half
    /// the difference.
    #[inline(always)]
    pub(crate) fn of_other_travel(&self) -> Self {
        let [near, (far, factor)] = self.centres;
        TravelRow {
            centres: [near, (far, -factor)],
            ..*self
        }
    }

    /// Centre of the far wheel (the wheel on the other side of the axle).
    pub(crate) fn far(&self) -> PointId {
        self.centres[1].0
    }

    /// Travel in a pose: equation (1) of this file without the prescribed value r.
    #[inline(always)]
    pub(crate) fn value(&self, at: &Configuration<T>) -> T {
        let [(near, near_factor), (far, far_factor)] = self.centres;
        let near = self.place(at, near).z - self.zeros[0];
        let far = self.place(at, far).z - self.zeros[1];
        near.scaled(near_factor) + far.scaled(far_factor)
    }

    #[inline(always)]
    fn place(&self, at: &Configuration<T>, id: PointId) -> Vector3<T> {
        match at.mechanism.body(id) {
            Body::Rocker(_) => at.point(id),
            _ => at.carried(id),
        }
    }

    /// Adds the derivatives of the travel, equation (2) of this file without dr, times `weight` to the sink.
    #[inline(always)]
    pub(crate) fn push(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
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

    /// Rates of the constraint's force and moment along a motion of the knuckle, equation (4) of this file.
    #[inline(always)]
    pub(crate) fn wrench_rate(&self, at: &Configuration<T>, along: &Twist<T>) -> Wrench<T> {
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
                _ => levers = levers + at.designed_lever(id).scaled(factor),
            }
        }
        let velocity = along.turn.cross(at.pose.rotation.apply(levers));
        let moment = Vector3::new(velocity.y, -velocity.x, velocity.x.zero());
        wrench.moment = wrench.moment + moment;
        wrench
    }

    /// Residual of the constraint, as a length: F in equation (1) of this file.
    #[inline(always)]
    pub(crate) fn residual(&self, at: &Configuration<T>) -> T {
        self.value(at) - at.rack
    }

    /// Adds the derivatives of the residual, equation (2) of this file, times `weight` to the sink.
    #[inline(always)]
    pub(crate) fn differential(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        self.push(at, weight, sink);
        sink.rack(-weight);
    }
}
