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
//! F is linear in the pose.

use crate::mechanism::pose::Sink;
use crate::mechanism::{Configuration, Twist, Wrench};
use crate::model::{AxleTravel, PointId};
use crate::number::{Each, Real, Vector3};

/// A travel of a rigid axle, as a function of the pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TravelRow {
    /// Both wheel centres, each with its factor in (1).
    centres: [(PointId, f64); 2],
}

impl TravelRow {
    /// The mean or the difference of the heights of both wheel centres.
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

    /// The travel in a pose: (1) without r.
    #[inline(always)]
    pub(crate) fn value<T: Real>(&self, at: &Configuration<T>) -> T {
        let [near, far] = self
            .centres
            .each(|(id, factor)| (at.carried(id).z - at.designed(id).z).scaled(factor));
        near + far
    }

    /// Adds `weight` times (2), without dr.
    #[inline(always)]
    pub(crate) fn push<T: Real>(&self, at: &Configuration<T>, weight: T, sink: &mut impl Sink<T>) {
        let zero = weight.zero();
        for (id, factor) in self.centres {
            let up = Vector3::new(zero, zero, weight.scaled(factor));
            at.push_carried(id, up, sink);
            sink.hardpoint(id, -up);
        }
    }

    /// The moment of (4).
    #[inline(always)]
    pub(crate) fn moment_rate<T: Real>(
        &self,
        at: &Configuration<T>,
        along: &Twist<T>,
    ) -> Vector3<T> {
        let [near, far] = self
            .centres
            .each(|(id, factor)| at.designed_lever(id).map(|c| c.scaled(factor)));
        let velocity = along.turn.cross(at.pose.rotation.apply(near + far));
        Vector3::new(velocity.y, -velocity.x, velocity.x.zero())
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

    /// Equation (4).
    #[inline(always)]
    pub(crate) fn wrench_rate<T: Real>(
        &self,
        at: &Configuration<T>,
        along: &Twist<T>,
    ) -> Wrench<T> {
        Wrench {
            moment: self.moment_rate(at, along),
            ..Wrench::zero(at.rack)
        }
    }
}
