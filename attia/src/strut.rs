//! Design position of a strut, and the choice of points 6, 7 and 9 on its axis.

use super::Moving;
use hardpoint_engine::model::{Constraint, Mechanism, PointId};
use hardpoint_engine::number::Vector3;

/// Design positions of a strut's hardpoints (left wheel; x forward, y left, z up; any unit of length).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strut {
    /// Point 1, on the body.
    pub lower_arm_front: Vector3<f64>,
    /// Point 2, on the body.
    pub lower_arm_rear: Vector3<f64>,
    /// Point 3, on the rack.
    pub tie_rod_inner: Vector3<f64>,
    /// Point 4, on the body.
    pub strut_top: Vector3<f64>,
    /// Point 5, joint of arm and knuckle.
    pub lower_ball_joint: Vector3<f64>,
    /// Point 6, on the knuckle.
    pub strut_lower: Vector3<f64>,
    /// Point 7, on the knuckle. The strut's axis passes through point 4, parallel to the line 6-7. Without point 7 the axis is the
    /// line 6-4.
    pub strut_upper: Option<Vector3<f64>>,
    /// Point 8, joint of tie rod and knuckle.
    pub tie_rod_outer: Vector3<f64>,
    /// Point 9, on the strut's rod. Only [`StrutPoints::Study`] reads it.
    pub rod_point: Option<Vector3<f64>>,
    /// Point 10, on the knuckle.
    pub wheel_centre: Vector3<f64>,
}

/// Choice of the points of the strut's axis that the equations use as points 6, 7 and 9.
///
/// The pose does not depend on this choice, but the rounding error of the pose does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum StrutPoints {
    /// Points far apart, at fixed fractions of the strut's length. The equations are then as well conditioned as the suspension
    /// itself.
    #[default]
    Spread,
    /// Points of the study: the feet of `strut_lower`, `strut_upper` and `rod_point` on the axis. If points 6 and 7 are close
    /// together, the equations are badly conditioned. A missing `strut_upper` is replaced by the point half-way from point 6 to
    /// point 4. A missing `rod_point` is replaced by the point half-way from point 7 to point 4.
    Study,
}

impl Strut {
    /// Takes the strut's hardpoints from the arm and the constraints of a mechanism. `None` for any other topology.
    pub fn of(mechanism: &Mechanism, design: &[Vector3<f64>]) -> Option<Self> {
        let [arm] = mechanism.arms[..] else {
            return None;
        };
        let (mut line, mut tie_rod) = (None, None);
        for constraint in &mechanism.constraints {
            if let Constraint::StrutLine { top, lower, upper } = *constraint {
                line = Some((top, lower, upper));
            }
            let rod = constraint.link().filter(|(_, outer)| *outer != arm.outer);
            tie_rod = rod.or(tie_rod);
        }
        let at = |id: PointId| design[id.0];
        let ((top, lower, upper), (inner, outer)) = (line?, tie_rod?);
        Some(Strut {
            lower_arm_front: at(arm.front),
            lower_arm_rear: at(arm.rear),
            tie_rod_inner: at(inner),
            strut_top: at(top),
            lower_ball_joint: at(arm.outer),
            strut_lower: at(lower),
            strut_upper: upper.map(at),
            tie_rod_outer: at(outer),
            rod_point: None,
            wheel_centre: at(mechanism.wheel_centre),
        })
    }

    /// Sign, 1 or -1, of the rotation by [`Drive::ArmAngle`](crate::Drive::ArmAngle) that raises the ball joint. The
    /// drive turns the arm about the axis from front to rear.
    pub fn raising_turn(&self) -> f64 {
        let axis = self.lower_arm_rear - self.lower_arm_front;
        let rise = axis.cross(self.lower_ball_joint - self.lower_arm_front).z;
        if rise <= 0.0 { -1.0 } else { 1.0 }
    }

    /// True if every coordinate is a number.
    pub(crate) fn is_finite(&self) -> bool {
        let required = [
            self.lower_arm_front,
            self.lower_arm_rear,
            self.tie_rod_inner,
            self.strut_top,
            self.lower_ball_joint,
            self.strut_lower,
            self.tie_rod_outer,
            self.wheel_centre,
        ];
        let points = required
            .into_iter()
            .chain(self.strut_upper)
            .chain(self.rod_point);
        points.flat_map(Vector3::to_array).all(f64::is_finite)
    }

    /// Direction of the strut's axis, from the lower end towards the top mount. NaN if the points that define it coincide.
    pub fn axis(&self) -> Vector3<f64> {
        let upper = self.strut_upper.unwrap_or(self.strut_top);
        let direction = (upper - self.strut_lower).normalised();
        let upward = direction.dot(self.strut_top - self.lower_ball_joint);
        if upward < 0.0 { -direction } else { direction }
    }

    /// Unknown points in the design position.
    pub(crate) fn moving(&self, choice: StrutPoints) -> Moving {
        let (axis, top) = (self.axis(), self.strut_top);
        // Point of the axis at this distance below the top mount.
        let below = |distance: f64| top - axis * distance;
        let depth = |point: Vector3<f64>| (top - point).dot(axis);
        let [d6, d7, d9] = match choice {
            StrutPoints::Spread => {
                let length = depth(self.lower_ball_joint);
                SPREAD.map(|share| share * length)
            }
            StrutPoints::Study => {
                let d6 = depth(self.strut_lower);
                let d7 = self.strut_upper.map_or(0.5 * d6, depth);
                [d6, d7, self.rod_point.map_or(0.5 * d7, depth)]
            }
        };
        [
            self.lower_ball_joint,
            below(d6),
            below(d7),
            self.tie_rod_outer,
            below(d9),
        ]
    }
}

/// Depths of points 6, 7 and 9 below the top mount with [`StrutPoints::Spread`]. The unit is the distance from the mount to the
/// foot of the ball joint on the axis. Multiples of a quarter of this distance were tried. These three depths gave the lowest
/// median condition number, 73, over sixty road-car struts with random hardpoint moves of 50 mm.
const SPREAD: [f64; 3] = [1.25, 0.5, 0.5];
