//! Rigid axle: one body carries both wheels.
//!
//! A rigid axle has the mechanism of one wheel, the near wheel. The other wheel is the far wheel. The knuckle of this mechanism
//! is the axle itself. The mechanism has the points of both halves. Two travels drive the axle. With the heights z_n and z_f of
//! the near and the far wheel centre above their design positions, the travels are
//!
//! ```text
//! mean        (z_n + z_f)/2                                                        (1)
//! difference  (z_n - z_f)/2                                                        (2)
//! ```
//!
//! One travel is the drive. The other travel replaces the displacement of the rack; a constraint keeps it constant. As seen
//! from the far wheel, the mean (1) is the same and the difference (2) has the opposite sign.

use super::{AxleSteering, PointId, TwistBeam};
use crate::number::{Real, Vector3};

/// One of the two travels of a rigid axle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxleTravel {
    /// Mean travel, equation (1) of this module: both wheels rise.
    Mean,
    /// Half the difference of the travels, equation (2) of this module: the near wheel rises and the far wheel falls.
    Difference,
}

impl AxleTravel {
    /// Returns the other one of the two travels.
    pub fn other(self) -> AxleTravel {
        match self {
            AxleTravel::Mean => AxleTravel::Difference,
            AxleTravel::Difference => AxleTravel::Mean,
        }
    }

    /// Factor on the far wheel's height in equations (1) and (2) of this module: 1 or -1.
    #[inline(always)]
    pub fn far_sign(self) -> f64 {
        match self {
            AxleTravel::Mean => 1.0,
            AxleTravel::Difference => -1.0,
        }
    }
}

/// The far half of a rigid axle. The mechanism belongs to the near wheel, and the far half carries the other wheel.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidAxle {
    /// Points of the near half, each with its counterpart in the far half.
    pub pairs: Vec<[PointId; 2]>,
    /// Points that exist once on the axle, such as the ends of a Panhard rod.
    pub singles: Vec<PointId>,
    /// Centre of the far wheel.
    pub far_centre: PointId,
    /// Travel that a constraint keeps constant. The other travel is the drive.
    pub held: AxleTravel,
    /// Links of the far half that have no constraint. As rigid links they would overconstrain the axle; the study may
    /// give them as elastic links.
    pub extra_links: Vec<[PointId; 2]>,
    /// Further points, if the axle is a twist beam.
    pub twist_beam: Option<TwistBeam>,
    /// Knuckles and further points, if the wheels are steered.
    pub steering: Option<AxleSteering>,
}

/// Mirror image of a position about the middle plane of the vehicle.
#[inline(always)]
pub fn mirrored<T: Real>(position: Vector3<T>) -> Vector3<T> {
    Vector3::new(position.x, -position.y, position.z)
}

impl RigidAxle {
    /// Returns true for a point of the far half, and for a point that a study does not give because it moves with another
    /// point.
    pub fn is_far(&self, id: PointId) -> bool {
        let mut following = self.followers();
        self.pairs.iter().any(|[_, far]| *far == id) || following.any(|[point, _]| point == id)
    }

    /// Points that a study does not give, each with the point with which it moves.
    #[inline]
    fn followers(&self) -> impl Iterator<Item = [PointId; 2]> {
        let beam = self.twist_beam.iter().flat_map(TwistBeam::followers);
        beam.chain(self.steering.iter().map(AxleSteering::follower))
    }

    /// Counterpart in the far half of a point of the near half.
    pub fn far_of(&self, id: PointId) -> Option<PointId> {
        let pair = self.pairs.iter().find(|[near, _]| *near == id);
        pair.map(|[_, far]| *far)
    }

    /// Moves a point of the far half to another position. Points that move with this point keep their offsets from it.
    pub(crate) fn put_far(&self, far: PointId, place: Vector3<f64>, design: &mut [Vector3<f64>]) {
        let way = place - design[far.0];
        design[far.0] = place;
        for [point, _] in self.followers().filter(|[_, beside]| *beside == far) {
            design[point.0] = design[point.0] + way;
        }
    }

    /// Moves the far half with the near half. `own` is a design with both halves. If the far half of `own` deviates from a
    /// mirror image of the near half, the moved far half has the same deviations.
    #[inline(always)]
    pub fn complete<T: Real>(&self, own: &[Vector3<f64>], design: &mut [Vector3<T>]) {
        for [near, far] in &self.pairs {
            let apart = own[far.0] - mirrored(own[near.0]);
            let apart = apart.map(|c| design[near.0].x.constant(c));
            design[far.0] = mirrored(design[near.0]) + apart;
        }
        for [point, beside] in self.followers() {
            let apart = own[point.0] - own[beside.0];
            design[point.0] = design[beside.0] + apart.map(|c| design[beside.0].x.constant(c));
        }
    }

    /// Writes the axle as seen from its other wheel, in the frame of that side, into `into`. A point that the study does not
    /// give keeps its offset from the point with which it moves. So the steering gear of a steered axle must be centred.
    #[inline(always)]
    pub fn turn_over<T: Real>(&self, design: &[Vector3<T>], into: &mut [Vector3<T>]) {
        into.copy_from_slice(design);
        for [near, far] in &self.pairs {
            into[near.0] = mirrored(design[far.0]);
            into[far.0] = mirrored(design[near.0]);
        }
        for single in &self.singles {
            into[single.0] = mirrored(design[single.0]);
        }
        for [point, beside] in self.followers() {
            into[point.0] = into[beside.0] + (design[point.0] - design[beside.0]);
        }
    }

    /// Returns true if the far half is the mirror image of the near half. The drag link of a steered axle has no mirror image.
    pub fn is_symmetric(&self, design: &[Vector3<f64>]) -> bool {
        if self.steering.is_some() {
            return false;
        }
        let mut pairs = self.pairs.iter();
        let mut singles = self.singles.iter();
        pairs.all(|[near, far]| design[far.0] == mirrored(design[near.0]))
            && singles.all(|single| design[single.0] == mirrored(design[single.0]))
    }

    /// Adds the derivatives with respect to all copies of a point to the derivatives with respect to this point in the left
    /// half. The copies are in the far half, and in the axle as seen from the right wheel.
    pub fn gather(&self, [left, right]: [&mut [Vector3<f64>]; 2]) {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        for [point, beside] in self.followers() {
            for half in [&mut *left, &mut *right] {
                half[beside.0] = half[beside.0] + half[point.0];
                half[point.0] = zero;
            }
        }
        for [near, far] in &self.pairs {
            let of_far = mirrored(left[far.0] + right[far.0]);
            left[near.0] = left[near.0] + right[near.0] + of_far;
            left[far.0] = zero;
            right[far.0] = zero;
            right[near.0] = zero;
        }
        for single in &self.singles {
            left[single.0] = left[single.0] + mirrored(right[single.0]);
            right[single.0] = zero;
        }
    }
}
