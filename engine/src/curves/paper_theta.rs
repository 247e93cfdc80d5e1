//! Drive angle theta of equation (15) in Attia's paper, converted to the arm angle.
//!
//! ```text
//! z5 - z1 = d51 cos(theta)
//! ```
//!
//! Point 1 is the first named point of the arm's axis (`lower_arm_front`), and point 5 is the arm's outer joint. The distance
//! between these points is d51. The angle theta is the inclination of the line 1-5 from the vertical. On the arm's circle,
//! with psi the arm's angle from its highest position,
//!
//! ```text
//! z5 = zc + rho cos(psi)   so that   cos(psi) = (z1 - zc + d51 cos(theta))/rho
//! ```
//!
//! with zc the height of the circle's centre and rho its vertical half-extent. The arm angle is psi minus its design value.
//! Near 1 and -1, the cosine would lose half of the digits of psi. With z1 - zc = o rho and d51 = (1 + e) rho, the accurate
//! form is
//!
//! ```text
//! 1 + cos(psi) = o - e + 2 (1 + e) cos^2(theta/2)
//! 1 - cos(psi) = -o - e + 2 (1 + e) sin^2(theta/2),   tan^2(psi/2) = (1 - cos(psi))/(1 + cos(psi))
//! ```
//!
//! The equation contains only the cosine, so psi stays on the same side (positive or negative) as in the design position.
//! When theta passes a multiple of pi, the arm does not pass its highest or lowest position (its dead centre), but turns
//! back. At the dead centre itself, the given speed of theta would need an infinite speed of the arm. If the line 1-5 is not
//! normal to the axis (d51 > rho), there are no positions near the dead centre.

use crate::mechanism::DesignFault;
use crate::mechanism::constraint::axis_ends;
use crate::model::Mechanism;
use crate::number::Jet;
use crate::number::Real;
use crate::number::Vector3;

/// Conversion from the paper's theta to the arm angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperTheta {
    /// Number o = (z1 - zc)/rho.
    offset: f64,
    /// Number e = (d51 - rho)/rho.
    excess: f64,
    /// Angle psi in the design position, in (-pi, pi]. In other poses, psi is this angle plus the arm angle.
    design: f64,
}

/// Threshold of 1 + cos(psi) or 1 - cos(psi), which is half the square of the angle from a dead centre. Below the threshold,
/// half of the digits of the arm angle are lost.
const DEAD_CENTRE: f64 = f64::EPSILON;

impl PaperTheta {
    /// Makes the drive of a design, which must not be at the dead centre of its first arm.
    pub fn of(mechanism: &Mechanism, design: &[Vector3<f64>]) -> Result<Self, DesignFault> {
        let arm = mechanism.arms[0];
        let (tail, head) = axis_ends(arm, design);
        let axis = (design[head.0] - design[tail.0]).normalised();
        let leg = design[arm.outer.0] - design[arm.front.0];
        let along = axis.dot(leg);
        let radius = leg - axis * along;
        let (up, ahead) = (radius.z, axis.cross(radius).z);
        let rho = up.hypot(ahead);
        // d51^2 = along^2 + |radius|^2 and rho^2 = |radius|^2 (1 - axis_z^2).
        let difference = along * along + radius.norm_squared() * axis.z * axis.z;
        let drive = PaperTheta {
            offset: -(axis.z * along) / rho,
            excess: difference / (rho * (leg.norm() + rho)),
            design: (-ahead).atan2(up),
        };
        // This form of the test also refuses NaN, which comes from an arm without a radius or on a vertical axis.
        if ahead * ahead > DEAD_CENTRE * rho * rho {
            Ok(drive)
        } else {
            Err(DesignFault::DeadCentre { outer: arm.outer })
        }
    }

    /// Angle theta in the design position, in (0, pi).
    pub fn design_value(&self) -> f64 {
        ((self.design.cos() - self.offset) / (1.0 + self.excess)).acos()
    }

    /// Taylor series of the arm angle, in the same variable as the series `theta`. `None` at a dead centre and beyond.
    pub fn arm_angle<const N: usize>(&self, theta: Jet<f64, N>) -> Option<Jet<f64, N>> {
        let (sine, cosine) = theta.scaled(0.5).sin_cos();
        let twice = 2.0 * (1.0 + self.excess);
        let one_minus = sine.squared().scaled(twice) - Jet::constant(self.excess + self.offset);
        let one_plus = cosine.squared().scaled(twice) - Jet::constant(self.excess - self.offset);
        if one_minus[0].min(one_plus[0]) > DEAD_CENTRE {
            let half = one_minus.sqrt().atan2(one_plus.sqrt());
            Some(half.scaled(2.0 * self.design.signum()) - Jet::constant(self.design))
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Topology;

    fn sample() -> PaperTheta {
        let topology = Topology::named("macpherson").unwrap();
        let names: Vec<_> = topology.hardpoints.iter().map(|h| h.name).collect();
        let mechanism = (topology.build)(topology, &names);
        let mut design = vec![Vector3::new(0.0, 0.0, 0.0); names.len()];
        let arm = mechanism.arms[0];
        design[arm.front.0] = Vector3::new(0.0, 0.0, 0.0);
        design[arm.rear.0] = Vector3::new(-1.0, 0.0, 0.0);
        design[arm.outer.0] = Vector3::new(0.0, 3.0, 4.0);
        PaperTheta::of(&mechanism, &design).unwrap()
    }

    /// If the line 1-5 is normal to a horizontal axis, theta equals psi. The arm falls as theta grows, and rises again
    /// beyond pi.
    #[test]
    fn the_arm_turns_back_at_pi() {
        let drive = sample();
        assert!((drive.design_value() - 0.75_f64.atan()).abs() < 4.0 * f64::EPSILON);
        for (theta, slope) in [
            (1.0, -1.0),
            (3.0, -1.0),
            (4.0, 1.0),
            (6.0, 1.0),
            (7.0, -1.0),
        ] {
            let angle = drive.arm_angle(Jet::<f64, 3>::variable(theta)).unwrap();
            let folded = theta.cos().acos();
            let rounding = 16.0 * f64::EPSILON;
            let off = angle[0] - (0.75_f64.atan() - folded);
            assert!(off.abs() < rounding / theta.sin().abs(), "{angle:?}");
            assert!((angle[1] - slope).abs() < rounding, "{angle:?}");
            assert!(angle[2].abs() < rounding, "{angle:?}");
        }
        for k in 0..4 {
            let theta = f64::from(k) * std::f64::consts::PI;
            assert_eq!(drive.arm_angle(Jet::<f64, 1>::variable(theta)), None);
        }
    }
}
