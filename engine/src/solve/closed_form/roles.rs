//! Roles of the hardpoints in the closed form, and checks for degenerate designs.

use super::ClosedForm;
use super::upper::Upper;
use crate::mechanism::DEGENERATE;
use crate::mechanism::DesignFault;
use crate::model;
use crate::model::{Arm, Constraint, Mechanism, PointId};
use crate::number::Vector3;

/// Hardpoints of the closed form.
#[derive(Clone, Copy, Debug)]
pub struct Roles {
    pub(crate) lower_arm: Arm,
    pub(crate) upper: UpperRoles,
    pub(crate) tie_rod_inner: PointId,
    pub(crate) tie_rod_outer: PointId,
    pub(crate) wheel_centre: PointId,
}

/// Member that holds the upper end of the steering axis.
#[derive(Clone, Copy, Debug)]
pub(crate) enum UpperRoles {
    Strut {
        top: PointId,
        lower: PointId,
        upper: Option<PointId>,
    },
    Arm(Arm),
}

impl Roles {
    /// Reads the roles of the hardpoints from the constraints. `None` for a mechanism without a closed form.
    pub fn of(mechanism: &Mechanism) -> Option<Self> {
        let upper = match mechanism.closed_form? {
            model::ClosedForm::Strut => mechanism.constraints.iter().find_map(|c| match *c {
                Constraint::StrutLine { top, lower, upper } => {
                    Some(UpperRoles::Strut { top, lower, upper })
                }
                _ => None,
            }),
            model::ClosedForm::DoubleWishbone => {
                mechanism.arms.get(1).copied().map(UpperRoles::Arm)
            }
        };
        let lower_arm = *mechanism.arms.first()?;
        let tie_rod = mechanism.constraints.last()?;
        let Constraint::Link { inner, outer } = *tie_rod else {
            return None;
        };
        Some(Roles {
            lower_arm,
            upper: upper?,
            tie_rod_inner: inner,
            tie_rod_outer: outer,
            wheel_centre: mechanism.wheel_centre,
        })
    }

    /// Lower end of the steering axis.
    pub(crate) fn ball_joint(&self) -> PointId {
        self.lower_arm.outer
    }

    /// Upper end of the steering axis.
    pub(crate) fn upper_end(&self) -> PointId {
        match self.upper {
            UpperRoles::Strut { top, .. } => top,
            UpperRoles::Arm(arm) => arm.outer,
        }
    }

    /// Inner and outer end of the tie rod.
    pub(crate) fn tie_rod(&self) -> [PointId; 2] {
        [self.tie_rod_inner, self.tie_rod_outer]
    }

    /// Direction of a strut's line in the design position.
    pub(crate) fn strut_line(&self, design: &[Vector3<f64>]) -> Option<Vector3<f64>> {
        match self.upper {
            UpperRoles::Strut { top, lower, upper } => {
                Some(design[upper.unwrap_or(top).0] - design[lower.0])
            }
            UpperRoles::Arm(_) => None,
        }
    }

    /// Returns true if the upper end is a strut's mount.
    pub(crate) fn is_strut(&self) -> bool {
        matches!(self.upper, UpperRoles::Strut { .. })
    }
}

impl ClosedForm<f64> {
    /// Returns an error if the design is degenerate for the closed form, for example with the tie rod at its toggle. The
    /// error names the cause.
    pub(crate) fn check(&self, roles: &Roles, design: &[Vector3<f64>]) -> Result<(), DesignFault> {
        let ball_joint = design[roles.lower_arm.outer.0];
        let to_upper = design[roles.upper_end().0] - ball_joint;
        let to_rack = design[roles.tie_rod_inner.0] - ball_joint;
        let tie = design[roles.tie_rod_outer.0] - ball_joint;
        let (dd, gg) = (to_upper.norm_squared(), to_rack.norm_squared());
        let normal = to_upper.cross(to_rack);
        let small = DEGENERATE * DEGENERATE;
        // NaN does not exceed the bound.
        let exceeds = |value: f64, bound: f64| value > bound;
        match &self.upper {
            // The strut's length is the root of dd - foot_squared, so this difference must have enough digits.
            Upper::Strut { foot_squared, .. } => {
                if !exceeds(dd * (1.0 - DEGENERATE), *foot_squared) {
                    return Err(DesignFault::NoStrutLength);
                }
            }
            Upper::Arm { circle, scale, .. } => {
                let lever = (circle.centre - ball_joint).dot(circle.turned) * scale;
                if !exceeds(lever.abs(), DEGENERATE) {
                    return Err(DesignFault::UpperArmInLine {
                        outer: roles.upper_end(),
                    });
                }
            }
        }
        if !exceeds(normal.norm_squared(), small * dd * gg) {
            return Err(DesignFault::NoSteering {
                end: roles.tie_rod_inner,
            });
        }
        let steering_arm = to_upper.cross(tie).norm_squared();
        if !exceeds(steering_arm, small * dd * self.tie_squared) {
            return Err(DesignFault::NoSteering {
                end: roles.tie_rod_outer,
            });
        }
        // `height` is |normal| times the distance of the tie rod's outer end from the plane through steering axis and
        // rack joint. In the design position it is known without a square root.
        let height = tie.dot(normal).abs();
        let longest = (self.tie_squared * normal.norm_squared()).sqrt();
        if !exceeds(height, DEGENERATE * longest) {
            return Err(DesignFault::Toggle);
        }
        Ok(())
    }
}
