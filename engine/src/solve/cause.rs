//! Cause of a fold, where a path turns back: the part of the suspension that is singular there, or no part.
//!
//! Let C be the five rows of the closure equations' Jacobian for the constraints, with the rack fixed. Let g be the row for
//! the drive. At a fold of the drive there is a twist t of the wheel carrier with
//!
//! ```text
//! C t = 0                                                                                     (1)
//! g . t = 0                                                                                   (2)
//! ```
//!
//! While only the drive moves, C has its full rank 5 at the fold. (Otherwise [C 0; g -1] would have a rank below 6, and the
//! path would not be a single path.) So t is the free motion of the mechanism. By equation (2) the drive value does not
//! change along t: the wheel centre is at its highest or lowest point. In general no single part causes this. If any one of
//! the constraints is removed, t is still one of the free motions, and it is orthogonal to the removed constraint. So this
//! property does not single out one part.
//!
//! A part is the cause if it is singular by itself. With the arm fixed, its outer joint b is fixed, and the carrier can
//! only rotate about b, with angular velocity w. Its upper end u then moves with w x (u - b). The upper arm or the strut
//! permits this motion only along one direction, with an unknown rate s.
//!
//! ```text
//! upper arm, axis e, foot c of u on it: w x (u - b) = s e x (u - c), so s (e x (u - c)).(u - b) = 0
//! strut along d through its mount u:     w x (u - b) = s d,           so s d.(u - b) = 0
//!
//!     U = (e x (u - c)).(u - b) / (|e x (u - c)| |u - b|)      or      d.(u - b) / (|d| |u - b|)    (3)
//!
//! if U is not 0, s = 0, and w = r k is a rotation about the steering axis, k along u - b; the tie rod from i to o
//! prevents it unless its moment about the axis vanishes:
//!
//!     T = k.((o - b) x (i - b)) / (|k x (o - b)| |k x (i - b)|)                                     (4)
//! ```
//!
//! U and T are sines. For an upper arm, U belongs to the angle between the steering axis and the plane through the arm's axis
//! and u. For a strut, U belongs to the deviation of strut and steering axis from a right angle. T belongs to the angle between
//! the half planes from the steering axis to the two ends of the tie rod. With the arm's angle as the drive, the determinant of
//! the closure equations is U T times lengths that are in general not zero. So:
//!
//! - every fold of the arm's angle has U T = 0, and the cause is the part whose factor is zero.
//! - if U T = 0, the arm does not move in the motion t, because C has rank 5. So a fold of the travel has this cause if and
//!   only if U T = 0 at that fold. The same holds for a fold of the rack at fixed travel. (An example is an upright steering
//!   axis, with which steering does not lift the wheel.) Otherwise no part is the cause.
//!
//! The links of a rigid axle have no such parts. Its limit (`analyse/limits.rs`) names the link with the largest multiplier
//! w_i in w J = 0. Here J is the whole Jacobian, and w contains one multiplier for each equation. This link carries the
//! largest force that holds the axle at the fold.
//!
//! If the rack moves, C has an additional column for it, and the path may be regular where C has rank 4. Then some
//! combination of the constraints, m C = 0, is the cause, namely the links with m not 0. Such a combination occurs only in
//! mechanisms without a closed form. With a closed form, the cause is a part with U = 0 or T = 0, by equation (3) or (4). A
//! hinge is never singular.

use super::closed_form::{Roles, UpperRoles};
use super::continuation::{Curve, CurvePoint, Moving};
use crate::mechanism::{Closure, Configuration, Driver, LimitCause, PartMeasure};
use crate::model::{AxleTravel, Drive, Mechanism, PointId, TwistBeam};
use crate::number::{Each, Vector3};
use nalgebra::{Matrix5, SMatrix};

/// A part counts as singular if its sine U or T, by equation (3) or (4) of this module, is smaller than this. Only rounding
/// errors limit the accuracy of a fold. But at a double root only half as many digits of a sine are correct.
pub(crate) const SINGULAR_PART: f64 = 1e-6;

/// An arm counts as vertical if the sine of its angle to the vertical is smaller than this (about half a degree).
const VERTICAL: f64 = 0.01;

impl Curve<'_> {
    /// Returns the reason why the path turns back at a fold.
    pub(crate) fn cause(&self, fold: &CurvePoint) -> LimitCause {
        if let Some(rigid) = &self.mechanism.rigid_axle {
            return match &rigid.twist_beam {
                None => LimitCause::AxleFolds,
                Some(beam) => self.cause_of_beam(beam, fold),
            };
        }
        let at = self.configuration(fold);
        let nearest = nearest_part(&at);
        if let Some(part) = nearest.filter(|part| part.sine < SINGULAR_PART) {
            return part.cause;
        }
        if !dependent_links(self.closure, &at, self.size).is_empty() {
            return LimitCause::DependentLinks;
        }
        match (self.moving, self.held.drive) {
            (Moving::Rack, _) => LimitCause::RackStandsStill,
            (Moving::Drive, Drive::ArmAngle) => LimitCause::ArmStandsStill,
            // The travel is highest where its second Taylor coefficient with respect to the arc length is negative.
            (Moving::Drive, Drive::Travel) if fold.moved[2] < 0.0 => LimitCause::CentreHighest,
            (Moving::Drive, Drive::Travel) => LimitCause::CentreLowest,
        }
    }

    /// Reason for a fold of a twist beam. In heave without a difference of travels, the arms of both halves are vertical at a
    /// fold. If the arms are not vertical, the path has met another path, on which the halves are twisted. The heave has an
    /// extreme along that other path.
    fn cause_of_beam(&self, beam: &TwistBeam, fold: &CurvePoint) -> LimitCause {
        let at = self.configuration(fold);
        let arm = at.point(self.mechanism.wheel_centre) - at.point(beam.mount);
        let is_vertical = arm.x.abs() < VERTICAL * arm.x.hypot(arm.z);
        // The held travel takes the place of the rack.
        let held = self.mechanism.rigid_axle.as_ref().map(|rigid| rigid.held);
        let is_level = match (self.moving, held) {
            (Moving::Rack, Some(AxleTravel::Mean)) => self.held.value == 0.0,
            (Moving::Drive, Some(AxleTravel::Difference)) => self.held.rack == 0.0,
            _ => false,
        };
        if is_level && !is_vertical {
            LimitCause::Unresolved
        } else {
            LimitCause::BeamFolds
        }
    }

    /// Configuration of the mechanism at a fold.
    pub(crate) fn configuration(&self, fold: &CurvePoint) -> Configuration<'_, f64> {
        Configuration::new(
            self.mechanism,
            self.design,
            fold.pose(),
            self.motion(fold.value()).rack,
        )
    }
}

/// Upper arm, strut or tie rod that is nearest to its singular position. `None` for a mechanism without such parts.
pub(crate) fn nearest_part(at: &Configuration<f64>) -> Option<PartMeasure> {
    let measures = part_measures(at)?;
    measures
        .into_iter()
        .min_by(|a, b| a.sine.total_cmp(&b.sine))
}

/// Sine U of the upper arm or strut, and sine T of the tie rod, by equations (3) and (4) of this module. `None` for a
/// mechanism without these parts.
fn part_measures(at: &Configuration<f64>) -> Option<[PartMeasure; 2]> {
    let roles = Roles::of(at.mechanism)?;
    let ball_joint = at.point(roles.ball_joint());
    let axis = at.point(roles.upper_end()) - ball_joint;
    let (cause, guide) = match roles.upper {
        UpperRoles::Strut { .. } => {
            let designed = roles.strut_line(at.design)?;
            (LimitCause::StrutSquare, at.pose.rotation.apply(designed))
        }
        UpperRoles::Arm(arm) => {
            let [front, rear, outer] = [arm.front, arm.rear, arm.outer].each(|id| at.point(id));
            let tangent = (front - rear).cross(outer - rear);
            (LimitCause::UpperArmStraight, tangent)
        }
    };
    let upper = PartMeasure {
        cause,
        sine: (guide.dot(axis) / (guide.norm() * axis.norm())).abs(),
    };
    let ends = roles
        .tie_rod()
        .each(|id| axis.cross(at.point(id) - ball_joint));
    let [inner, outer]: [Vector3<f64>; 2] = ends;
    // The cross products are normal to the half planes, and to the axis. If an end is on the axis, the tie rod has no moment
    // about it.
    let levers = inner.norm() * outer.norm();
    let tie_rod = PartMeasure {
        cause: LimitCause::TieRodToggle,
        sine: match levers {
            0.0 => 0.0,
            _ => inner.cross(outer).norm() / levers,
        },
    };
    Some([upper, tie_rod])
}

/// Outer ends of the links whose constraints depend on each other with the rack fixed. These links have a multiplier m that
/// is not 0 in m C = 0, with the constraints' Jacobian C of this module. Empty if C has its full rank, or is not finite.
pub(crate) fn dependent_links(
    closure: &Closure<f64>,
    at: &Configuration<f64>,
    size: f64,
) -> Vec<PointId> {
    let rows = closure.jacobian(at, Driver::Travel(0.0));
    let rows = SMatrix::<f64, 5, 6>::from_fn(|i, j| match j {
        0..3 => rows[i][j],
        _ => rows[i][j] / size,
    });
    let rows = SMatrix::<f64, 5, 6>::from_fn(|i, j| rows[(i, j)] / rows.row(i).norm());
    let gram: Matrix5<f64> = rows * rows.transpose();
    if gram.iter().any(|entry| !entry.is_finite()) {
        return Vec::new();
    }
    // The squares of the singular values of C are the eigenvalues of this matrix.
    let eigen = gram.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    if eigen.eigenvalues[least] > SINGULAR_PART * SINGULAR_PART {
        return Vec::new();
    }
    let multipliers = eigen.eigenvectors.column(least);
    let outer_ends = outer_ends(at.mechanism).into_iter().zip(multipliers.iter());
    let loaded = outer_ends.filter(|(_, m)| m.abs() > SINGULAR_PART.sqrt());
    loaded.filter_map(|(end, _)| end).collect()
}

/// Outer end of the link of each of the five equations. `None` for an equation that does not belong to a link.
pub(crate) fn outer_ends(mechanism: &Mechanism) -> Vec<Option<PointId>> {
    let ends = mechanism.constraints.iter().flat_map(|constraint| {
        let end = constraint.link().map(|(_, outer)| outer);
        std::iter::repeat_n(end, constraint.freedoms())
    });
    ends.collect()
}

#[cfg(test)]
mod tests {
    use super::{LimitCause, Roles, nearest_part};
    use crate::mechanism::{Configuration, Pose};
    use crate::model::Topology;
    use crate::number::Matrix3;
    use crate::study::Study;
    use std::path::Path;

    /// A tie rod with its inner end on the steering axis is singular.
    #[test]
    fn a_tie_rod_that_ends_on_the_steering_axis_is_singular() {
        let template = Topology::named("double_wishbone").unwrap().template;
        let study = Study::from_text("cause.toml", template, Path::new(".")).unwrap();
        let suspension = study.wheel();
        let mechanism = &suspension.mechanism;
        let roles = Roles::of(mechanism).unwrap();
        let mut design = suspension.design.clone();
        design[roles.tie_rod_inner.0] = design[roles.ball_joint().0];
        let pose = Pose {
            origin: design[mechanism.origin.0],
            rotation: Matrix3::identity(1.0),
        };
        let at = Configuration::new(mechanism, &design, pose, 0.0);
        let part = nearest_part(&at).unwrap();
        assert_eq!((part.cause, part.sine), (LimitCause::TieRodToggle, 0.0));
    }
}
