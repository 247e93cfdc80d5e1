//! Steering gear of a steered axle, in a design over any number type.

use super::AxleSolver;
use crate::analyse::{Limit, Range, RangeEnd};
use crate::mechanism::{Configuration, Pose};
use crate::model::{AxleTravel, Drive, Mechanism};
use crate::number::{Each, Matrix3, Real, Vector3};

/// Moves the drag link's end in a design, and the wheel centres at rest with it: (1) of `model/steered_axle.rs`. Returns the lift of
/// both wheel centres by (4) and (5): of the travel that drives the axle, then of the one that is held. Both are 0 if no drag link
/// steers the axle.
pub(crate) fn displace<T: Real>(
    mechanism: &Mechanism,
    design: &mut [Vector3<T>],
    displacement: f64,
) -> [T; 2] {
    let zero = design[0].x.zero();
    let Some(rigid) = mechanism.rigid_axle.as_ref() else {
        return [zero; 2];
    };
    if rigid.steering.is_none() {
        return [zero; 2];
    }
    let centres = rigid.displace(displacement, design);
    let turned = {
        let pose = Pose {
            origin: design[mechanism.origin.0],
            rotation: Matrix3::identity(zero.one()),
        };
        let at = Configuration::new(mechanism, design, pose, zero);
        centres.each(|[_, centre]| at.point(centre))
    };
    let mut rises = [zero; 2];
    for ((rise, [point, centre]), turned) in rises.iter_mut().zip(centres).zip(turned) {
        *rise = turned.z - design[centre.0].z;
        design[point.0] = turned;
    }
    let [near, far] = rises;
    let travel = |travel: AxleTravel| (near + far.scaled(travel.far_sign())).scaled(0.5);
    [travel(rigid.held.other()), travel(rigid.held)]
}

impl<const N: usize> AxleSolver<'_, N> {
    /// Fold before the axle is level with its steering gear displaced, first of the held travel, then of the other. `None` if it does
    /// not fold.
    pub(in crate::axle) fn level_fold(&mut self) -> Option<Limit> {
        let corner = &mut self.corners[0];
        let (drive, held) = corner.inner(0.0, 0.0);
        let before = |range: Range, value: f64| {
            let end = if value < 0.0 {
                range.lower
            } else {
                range.upper
            };
            match end {
                RangeEnd::Fold(limit) if limit.value.abs() <= value.abs() => Some(limit),
                _ => None,
            }
        };
        let of_held = before(corner.solver.rack_range().ok()?, held);
        of_held.or_else(|| before(corner.solver.drive_range(Drive::Travel, held).ok()?, drive))
    }
}
