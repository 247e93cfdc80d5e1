//! Why a path turns back at a fold: the part that is singular there by itself, or none.
//!
//! Let C be the five constraints' rows of the Jacobian, with the rack held, and g the drive's row. At a fold of
//! the drive there is a twist t of the wheel carrier with
//!
//! ```text
//! C t = 0                                                                                     (1)
//! g . t = 0                                                                                   (2)
//! ```
//!
//! While only the drive moves, C has its full rank 5 there (else [C 0; g -1] had less than 6, and the path were
//! not one path). So t is the motion that the mechanism is free in, and (2) says that the drive stands still in
//! it: the wheel centre is at its highest or lowest point. In general that is no part's doing. Whichever
//! constraint is taken away, t is among the motions then left, and that constraint is at right angles to it: by
//! this measure every part is as much the cause as every other.
//!
//! A part is the cause where it is singular by itself. With the arm held, its outer joint b stands still and the
//! carrier can only turn about it, by w. Its upper end u then moves with w x (u - b).
//!
//! ```text
//! upper arm, axis e, foot c of u on it: w x (u - b) = s e x (u - c), so s (e x (u - c)).(u - b) = 0
//! strut along d through its mount u:     w x (u - b) = s d,           so s d.(u - b) = 0
//!
//!     U = (e x (u - c)).(u - b) / (|e x (u - c)| |u - b|)      or      d.(u - b) / (|d| |u - b|)    (3)
//!
//! where U is not 0, s is, and w = r k turns about the steering axis, k along u - b; the tie rod from i to o
//! holds against it unless its moment about the axis vanishes:
//!
//!     T = k.((o - b) x (i - b)) / (|k x (o - b)| |k x (i - b)|)                                     (4)
//! ```
//!
//! U is the sine by which upper arm (seen along its axis) and steering axis are out of line, or strut and steering
//! axis out of square; T that of the angle between the half planes from the steering axis to the two ends of the
//! tie rod. The determinant of the closure with the arm's angle as its drive is U T times lengths that a design
//! has or not. So:
//!
//! - every fold of the arm's angle has U T = 0, and the part whose factor it is;
//! - where U T = 0 the motion t is the one in which the arm rests, C having rank 5: a fold of the travel, or of
//!   the rack at held travel, has that cause if and only if U T = 0 there too (as with an upright steering axis,
//!   where steering does not lift the wheel). Else it has none.
//!
//! The links of a rigid axle have no such parts. Its limit names the link with the largest multiplier w in w J = 0, J the
//! whole Jacobian: the largest force that holds the axle at the fold.
//!
//! With the rack moving, its column comes to C, and the path may be regular where C has rank 4: then some
//! combination of the constraints, m C = 0, is the cause, of the links with m not 0. That takes a mechanism without
//! arms, as with them it is one of (3) and (4). A hinge is never singular.

use super::closed_form::{Roles, UpperRoles};
use super::continuation::{Curve, CurvePoint, Moving};
use crate::mechanism::{Closure, Configuration, Driver, LimitCause, PartMeasure};
use crate::model::{Drive, Mechanism, PointId};
use crate::number::Vector3;
use nalgebra::{Matrix5, SMatrix};

/// A part counts as singular if its measure, a sine, is less than this. Folds are found to rounding, but a sine has
/// only half as many digits at a double root.
pub(crate) const SINGULAR_PART: f64 = 1e-6;

impl Curve<'_> {
    /// Returns the reason why the path turns back at a fold.
    pub(crate) fn cause(&self, fold: &CurvePoint) -> LimitCause {
        if self.mechanism.rigid_axle.is_some() {
            return LimitCause::AxleFolds;
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
            // The second coefficient of the travel by the arc length.
            (Moving::Drive, Drive::Travel) if fold.moved[2] < 0.0 => LimitCause::CentreHighest,
            (Moving::Drive, Drive::Travel) => LimitCause::CentreLowest,
        }
    }

    /// The mechanism at a fold.
    pub(crate) fn configuration(&self, fold: &CurvePoint) -> Configuration<'_, f64> {
        Configuration::new(
            self.mechanism,
            self.design,
            fold.pose(),
            self.motion(fold.value()).rack,
        )
    }
}

/// The part nearest to a singular position; `None` for a mechanism without such parts.
pub(crate) fn nearest_part(at: &Configuration<f64>) -> Option<PartMeasure> {
    let measures = part_measures(at)?;
    measures
        .into_iter()
        .min_by(|a, b| a.sine.total_cmp(&b.sine))
}

/// The measures (3) and (4) of a mechanism that has these parts.
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
            let [front, rear, outer] = [arm.front, arm.rear, arm.outer].map(|id| at.point(id));
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
        .map(|id| axis.cross(at.point(id) - ball_joint));
    let [inner, outer]: [Vector3<f64>; 2] = ends;
    // The cross products are normal to the half planes, and to the axis.
    let tie_rod = PartMeasure {
        cause: LimitCause::TieRodToggle,
        sine: inner.cross(outer).norm() / (inner.norm() * outer.norm()),
    };
    Some([upper, tie_rod])
}

/// The links that have become dependent on each other, with the rack held: those with m not 0 in m C = 0, if C has lost
/// rank. They are given by their outer ends.
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
    // The singular values of C are the roots of these.
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

/// For each of the five equations, the outer end of its link; `None` if it is not a link's.
pub(crate) fn outer_ends(mechanism: &Mechanism) -> Vec<Option<PointId>> {
    let ends = mechanism.constraints.iter().flat_map(|constraint| {
        let end = constraint.link().map(|(_, outer)| outer);
        std::iter::repeat_n(end, constraint.freedoms())
    });
    ends.collect()
}
