//! Equation (15) of Attia's paper, the drive. There are three forms: the one of the paper and two that are regular.
//!
//! - [`Drive::Travel`]: height of the wheel centre above its design height, a length.
//! - [`Drive::ArmAngle`]: rotation of the lower arm from its design position, in radians, about the direction from
//!   `lower_arm_front` to `lower_arm_rear` (positive: wheel down). Regular except at a tie-rod toggle.
//! - [`Drive::PaperTheta`]: equation (15), z5 - z1 = d51 cos(theta), with theta in radians from the vertical. The equation
//!   contains only the cosine. So if theta passes a multiple of pi, the arm does not pass its dead centre. It turns back on the
//!   side from which it came. At the dead centre the equation is singular. If `lower_arm_front` is not beside the ball joint, d51
//!   is longer than the arm's radius. Then there is no solution near a multiple of pi.

use super::knuckle::KnucklePoint;
use super::{Moving, Strut};
use hardpoint_engine::number::Vector3;
pub use hardpoint_engine::solve::Drive;

/// Equation (15) of Attia's paper at one value of the drive. It is linear in points 5 to 8. Multiplied by d51, the distance of
/// points 1 and 5, its terms are squared lengths. The products `gradient` times point add up to the constant right-hand side
/// `level`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Driver {
    pub(crate) gradient: [Vector3<f64>; 4],
    pub(crate) level: f64,
}

impl Driver {
    pub(crate) fn residual(&self, moving: &Moving) -> f64 {
        let pairs = self.gradient.iter().zip(moving);
        pairs.map(|(g, p)| g.dot(*p)).sum::<f64>() - self.level
    }
}

/// Circle on which point 5 moves, and further inputs of the drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Driving {
    kind: Drive,
    /// Centre of the circle on which point 5 moves. It is on the line through points 1 and 2.
    centre: Vector3<f64>,
    /// Unit vectors in the plane of the circle: one towards the design position of point 5, one 90 degrees ahead of
    /// it.
    ahead: [Vector3<f64>; 2],
    radius: f64,
    z1: f64,
    /// Distance d51 from point 1 to point 5.
    d51: f64,
    wheel_centre: KnucklePoint,
    wheel_centre_height: f64,
}

const UP: Vector3<f64> = Vector3::new(0.0, 0.0, 1.0);

impl Driving {
    pub(crate) fn new(kind: Drive, strut: &Strut, wheel_centre: KnucklePoint) -> Self {
        let p1 = strut.lower_arm_front;
        let axis = (strut.lower_arm_rear - p1).normalised();
        let leg = strut.lower_ball_joint - p1;
        let centre = p1 + axis * leg.dot(axis);
        let arm = strut.lower_ball_joint - centre;
        let radius = arm.norm();
        let out = arm * (1.0 / radius);
        Driving {
            kind,
            centre,
            ahead: [out, axis.cross(out)],
            radius,
            z1: p1.z,
            d51: leg.norm(),
            wheel_centre,
            wheel_centre_height: strut.wheel_centre.z,
        }
    }

    pub(crate) fn kind(&self) -> Drive {
        self.kind
    }

    /// Value of the drive in the design position.
    pub(crate) fn design_value(&self) -> f64 {
        match self.kind {
            Drive::ArmAngle | Drive::Travel => 0.0,
            Drive::PaperTheta => {
                let height = self.centre.z + self.radius * self.ahead[0].z;
                ((height - self.z1) / self.d51).acos()
            }
        }
    }

    /// Form in which the drive's value enters the equation: the cosine for the paper's angle, else the value itself. Continuation
    /// from pose to pose uses this form as its parameter.
    pub(crate) fn parameter(&self, value: f64) -> f64 {
        match self.kind {
            Drive::PaperTheta => value.cos(),
            Drive::ArmAngle | Drive::Travel => value,
        }
    }

    /// Inverse of [`Driving::parameter`]: the value of the drive for this parameter.
    pub(crate) fn value(&self, parameter: f64) -> f64 {
        match self.kind {
            Drive::PaperTheta => parameter.acos(),
            Drive::ArmAngle | Drive::Travel => parameter,
        }
    }

    /// Sine of the arm's true angle from its highest position: zero at the dead centres.
    pub(crate) fn arm_sine(&self, moving: &Moving) -> f64 {
        let [e1, e2] = self.ahead;
        e1.cross(e2).cross(moving[0] - self.centre).z / (self.radius * e1.z.hypot(e2.z))
    }

    /// Radius of the arm divided by d51. Zero if point 5 lies on the arm's axis.
    pub(crate) fn arm_share(&self) -> f64 {
        self.radius / self.d51
    }

    /// Drive equation for the arm angle at this position. Its left-hand side is a length, which changes at the speed of point
    /// 5.
    pub(crate) fn along_the_arm(&self, moving: &Moving) -> Driver {
        let [e1, e2] = self.ahead;
        let ahead = e1.cross(e2).cross(moving[0] - self.centre).normalised();
        Driver {
            gradient: [ahead, ahead.zero(), ahead.zero(), ahead.zero()],
            level: ahead.dot(moving[0]),
        }
    }

    /// Two unit vectors with the arm at `angle`: the direction in which point 5 advances, and the direction from the centre to
    /// point 5.
    fn turned(&self, angle: f64) -> [Vector3<f64>; 2] {
        let ([e1, e2], (sine, cosine)) = (self.ahead, angle.sin_cos());
        [e2 * cosine - e1 * sine, e1 * cosine + e2 * sine]
    }

    /// Equation (15) of Attia's paper for this value of [`Driving::parameter`].
    pub(crate) fn driver(&self, parameter: f64) -> Driver {
        let on_five = |g: Vector3<f64>| [g, g.zero(), g.zero(), g.zero()];
        match self.kind {
            Drive::ArmAngle => {
                let gradient = self.turned(parameter)[0] * self.d51;
                Driver {
                    gradient: on_five(gradient),
                    level: gradient.dot(self.centre),
                }
            }
            Drive::PaperTheta => Driver {
                gradient: on_five(UP * self.d51),
                level: self.d51 * (self.z1 + self.d51 * parameter),
            },
            Drive::Travel => Driver {
                gradient: self
                    .wheel_centre
                    .shares()
                    .map(|w| UP * (w * self.travel_scale())),
                level: (self.wheel_centre_height + parameter) * self.travel_scale(),
            },
        }
    }

    /// Scale of the drive with the wheel travel. The equation is divided by the sum of the absolute weights of points 5 to 8 in
    /// the wheel centre. So its rounding error is as small as the rounding errors of the other equations.
    fn travel_scale(&self) -> f64 {
        self.d51 / self.wheel_centre.shares().map(f64::abs).iter().sum::<f64>()
    }

    /// Right-hand side `-C_t` of the velocity equation for equation (15) of Attia's paper and a unit rate of the drive's value. C_t
    /// is the partial derivative of equation (15) with respect to the drive, while the points are held fixed.
    pub(crate) fn rate(&self, value: f64, moving: &Moving) -> f64 {
        match self.kind {
            Drive::ArmAngle => self.d51 * self.turned(value)[1].dot(moving[0] - self.centre),
            Drive::PaperTheta => -self.d51 * self.d51 * value.sin(),
            Drive::Travel => self.travel_scale(),
        }
    }

    /// Part `-2 C_qt v rate - C_tt rate^2` of the right-hand side of the acceleration equation. C is the left-hand side of the
    /// drive equation minus its right-hand side. Its subscripts denote derivatives with respect to the points' coordinates q and
    /// the drive's value t. `rate` is the rate of the drive's value. `velocity` holds the velocities v of the points at this rate.
    /// The remaining part belongs to the acceleration of the drive.
    pub(crate) fn curvature(&self, value: f64, rate: f64, velocity: &Moving) -> f64 {
        match self.kind {
            // The equation's difference C is harmonic in the angle, so C_tt = -C. At a solution C = 0, so C_tt vanishes.
            Drive::ArmAngle => 2.0 * self.d51 * self.turned(value)[1].dot(velocity[0]) * rate,
            Drive::PaperTheta => -self.d51 * self.d51 * value.cos() * rate * rate,
            Drive::Travel => 0.0,
        }
    }
}
